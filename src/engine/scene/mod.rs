//! The scene: the form that every renderer reads.
//!
//! For: [`Scene`], whose existence is the proof of validity, and its parts.

mod camera;
mod framing;
mod material;
mod model;
mod shapes;
mod texture;

pub use camera::{Camera, CameraFault, MIN_LENGTH};
pub use framing::{bounds, framing};
pub use material::{Material, MaterialKind};
pub use model::{MAX_BOUNCES, MAX_SIDE, Scene, Sky};
pub use shapes::{Primitive, Side, Sphere, Triangle};
pub use texture::{Filter, TexelKind, Texels, Texture, srgb_to_linear};
