//! The scene: the form that every renderer reads.

mod camera;
mod framing;
mod light;
mod material;
mod model;
mod texture;

pub use camera::{Camera, CameraFault, Lens, MIN_LENGTH, Projection, VERTICAL_FOV};
pub use light::{LightShape, LightUnits, PunctualLight};
pub use material::{Attenuation, Material, MaterialExtras, MaterialKind};
pub use model::*;
pub use octray_rays::coordinates::{Coordinates, MAX_COORDINATE};
pub use texture::{Filter, SRGB_BORDERS, TexelKind, Texels, Texture, Wrap, srgb_to_linear};
