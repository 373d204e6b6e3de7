//! Rays against triangles, by several methods side by side. Both sides of a triangle can be hit.

mod baldwin_weber;
mod method;
mod moller_trumbore;
mod plucker;
mod woop;

pub use baldwin_weber::{AffineMap, BaldwinWeber};
pub use method::{PairHit, TriangleHit, TriangleMethod};
pub use moller_trumbore::{Edges, MollerTrumbore, MollerTrumboreEpsilon};
pub use plucker::Plucker;
pub use woop::{StoredWoopRay, TriangleBlock, Woop, WoopContracted, WoopRay, WoopTriangle};
