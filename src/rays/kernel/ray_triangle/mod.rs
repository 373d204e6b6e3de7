//! Rays against triangles, by several methods side by side. Both sides of a triangle can be hit.

mod method;
mod moller_trumbore;
mod woop;

pub use method::{PairHit, TriangleHit, TriangleMethod};
pub use moller_trumbore::{Edges, MollerTrumbore};
pub use woop::{StoredWoopRay, TriangleBlock, Woop, WoopRay, WoopTriangle};
