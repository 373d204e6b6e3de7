//! Which primitive a ray hits first.
//!
//! For: [`Methods`], the choice of equations; [`Primitives`], a scene ready for intersection; and the ways through it:
//! [`linear`], which tests every primitive, or for primary rays every one that their tile can see ([`Visible`]). May import: `lane`, `math`, `kernel`, `scene`, `buffers`. Must never know: queues,
//! materials, pixels.
//!
//! The law of every traversal: it gives the same hit, bit for bit, as testing every primitive in order, spheres first, then
//! triangles, the nearest t winning and the lower index on a tie.

pub mod batch;
pub mod frustum;
pub mod hierarchy;
pub mod linear;
mod methods;
pub mod rays;
pub mod scalar;
pub mod single;
pub mod stream;
mod visible;

pub use methods::{Batch, Methods, Primitives, SphereChoice, TriangleChoice};
pub use visible::Visible;
