//! The reference: the picture in f64, one ray and one primitive at a time, written to be obviously right.
//!
//! It shares no equation's code with what it checks. Speed is no goal.
//!
//! | file | what it holds |
//! |---|---|
//! | `texture` | texture lookup |
//! | `geometry` | the scene in f64: spheres and triangles, the closest hit, surface points |
//! | `camera` | camera rays, and the points of a lens |
//! | `lights` | lights that are no primitives: what they add at a point, and the discs of suns |
//! | `lobes`, `rough_glass` | how materials scatter |
//! | `values` | the BSDF in a given direction |
//! | [`path`] | how one pixel comes to be: the walk from camera ray to film, with its equations |
//! | `verdict` | whether a single-precision hit is within its error bound |

mod camera;
mod geometry;
pub(crate) mod lights;
mod lobes;
pub mod path;
mod rough_glass;
mod texture;
mod values;
mod verdict;

pub use geometry::{Hit, Reference, hit_sphere};
pub use path::PathSettings;
pub use verdict::Verdict;
