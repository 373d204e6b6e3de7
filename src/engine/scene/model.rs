//! The scene as a whole.

use super::camera::Camera;
use super::material::Material;
use super::shapes::{Primitive, Sphere, Triangle};
use super::texture::Texture;
use glam::{Vec2, Vec3};
use std::path::PathBuf;

/// A valid scene: every index is in range, every number finite, every radius positive, no triangle has zero
/// area.
///
/// Units: lengths in scene units; y up, right-handed; colours linear RGB; radiance in the same units
/// everywhere.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Short name for tables: `builtin:three`, or the name of the file.
    pub name: String,
    /// Where it is seen from.
    pub camera: Camera,
    /// Pixels: width, height; each from 1 to [`MAX_SIDE`].
    pub resolution: [u32; 2],
    /// Largest number of scattering events on a path.
    pub max_bounces: u32,
    /// What rays see that hit nothing.
    pub sky: Sky,
    /// Primitives refer to them by index.
    pub materials: Vec<Material>,
    /// Materials and the sky refer to them by index.
    pub textures: Vec<Texture>,
    /// All spheres.
    pub spheres: Vec<Sphere>,
    /// All triangles.
    pub triangles: Vec<Triangle>,
    /// Texture coordinates of the triangles' vertices, v upwards: one entry per triangle; empty if no
    /// material has a texture.
    pub uvs: Vec<[Vec2; 3]>,
    /// Unit vertex normals: one entry per triangle, zero vectors for a flat one; empty if all triangles are
    /// flat.
    pub normals: Vec<[Vec3; 3]>,
    /// Warnings, each a full sentence: what was odd but not wrong.
    pub warnings: Vec<String>,
    /// The files that the scene was read from and those that were not found, each path once and as given: the
    /// scene file first; after a view, the scene that it names. Empty for built-in scenes.
    pub files: Vec<PathBuf>,
}

impl Scene {
    /// The number of primitives.
    pub fn primitives(&self) -> usize {
        self.spheres.len() + self.triangles.len()
    }
    /// A primitive by its number, as hits name it: spheres first, then triangles.
    ///
    /// # Panics
    /// If there are not so many.
    pub fn primitive(&self, number: usize) -> Primitive<'_> {
        match self.spheres.get(number) {
            Some(sphere) => Primitive::Sphere(sphere),
            None => {
                let index = number - self.spheres.len();
                Primitive::Triangle(&self.triangles[index], index)
            }
        }
    }
}

/// Largest width and height of an image in pixels.
pub const MAX_SIDE: u32 = 16_384;
/// Largest number of scattering events on a path.
pub const MAX_BOUNCES: u32 = 1_024;

/// The radiance of rays that miss everything.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // The variants' text explains their fields.
pub enum Sky {
    /// The same radiance from all directions.
    Color(Vec3),
    /// From `bottom` (straight down) to `top` (straight up), linear in the direction's y.
    Gradient { bottom: Vec3, top: Vec3 },
    /// An environment map in latitude and longitude (equirectangular), its upper edge straight up, times a
    /// colour. The direction (x, y, z) has the texture coordinates u = atan2(z, x) / 2π + `turn`, wrapped to
    /// [0, 1), and acos(y) / π from the top. `turn` rotates the sky around the vertical axis, in whole turns,
    /// anticlockwise seen from above, in [0, 1).
    Texture { texture: u32, color: Vec3, turn: f32 },
}

impl Sky {
    /// Whether its colours are black, whatever its texture.
    pub fn is_black(&self) -> bool {
        match *self {
            Self::Color(color) | Self::Texture { color, .. } => color == Vec3::ZERO,
            Self::Gradient { bottom, top } => bottom == Vec3::ZERO && top == Vec3::ZERO,
        }
    }
}
