//! The reference: the picture in f64, one ray and one primitive at a time, written to be obviously right.
//!
//! It shares no equation's code with what it checks. Speed is no goal.
//!
//! | file | what it holds |
//! |---|---|
//! | `texture` | texture lookup |
//! | `geometry` | spheres and triangles: hits, surface points |
//! | `scene` | the scene in f64, the closest hit |
//! | `lobes` | how materials scatter |
//! | [`path`] | how one pixel comes to be: the walk from camera ray to film, with its equations |
//! | `verdict` | whether a single-precision hit is within its error bound |

mod geometry;
mod lobes;
pub mod path;
mod scene;
mod texture;
mod verdict;

pub use geometry::{Hit, hit_sphere};
pub use path::PathSettings;
pub use scene::Reference;
pub use verdict::Verdict;
