//! Which primitive a ray hits first.
//!
//! For: [`Methods`], the choice of equations; [`Primitives`], a scene ready for intersection; and the ways through it. May import:
//! `lane`, `math`, `kernel`, `scene`, `buffers`, `bvh`, `camera`. Must never know: queues, materials, pixels.
//!
//! | way | for |
//! |---|---|
//! | [`linear`] | few primitives: every one is tested, or for primary rays every one that their tile can see ([`Visible`]) |
//! | [`scalar`] | one ray on the binary tree: the baseline |
//! | [`single`] | one ray against eight boxes and eight primitives at once |
//! | [`tile`] | camera rays by the tile, each packet in a [`frustum`] |
//! | [`stream`] | batches of rays, whatever their order |
//! | [`batch`] | the choice between them |
//!
//! [`tally`] counts what they test.
//!
//! The law of every traversal: it gives the same hit, bit for bit, as testing every primitive in order, spheres first, then
//! triangles, the nearest t winning and the lower index on a tie.

pub mod batch;
pub mod frustum;
pub mod hierarchy;
pub mod linear;
mod methods;
mod primitives;
pub mod rays;
pub mod scalar;
pub mod single;
pub mod stream;
pub mod tally;
pub mod tile;
mod visible;

pub use methods::{BoxChoice, Methods, SphereChoice, TraversalChoice, TriangleChoice};
pub use primitives::{Batch, Primitives};
pub use visible::Visible;
