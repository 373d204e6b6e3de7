//! What a scene is: the form that every tracer reads.
//!
//! For: [`Scene`], whose existence is the proof of validity, and its parts. May import: nothing. Must never know: file formats, buffers, lanes,
//! pipelines, pixels.

mod camera;
mod framing;

pub use camera::{Camera, CameraFault, MIN_LENGTH};
pub use framing::{bounds, framing};

use glam::{Vec2, Vec3};
use std::path::PathBuf;

/// A valid scene: every index is in range, every number finite, every radius positive, no triangle has zero area.
///
/// Units: lengths in scene units; y up, right-handed; colours linear RGB; radiance in the same units everywhere.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Short name for tables: `builtin:three`, or the file's name.
    pub name: String,
    pub camera: Camera,
    /// Pixels: width, height; each from 1 to [`MAX_SIDE`].
    pub resolution: [u32; 2],
    /// Scattering events allowed on a path.
    pub max_bounces: u32,
    pub sky: Sky,
    pub materials: Vec<Material>,
    pub textures: Vec<Texture>,
    pub spheres: Vec<Sphere>,
    pub triangles: Vec<Triangle>,
    /// Texture coordinates of the triangles' vertices, v upwards: one entry a triangle, or none at all where nothing needs
    /// them.
    pub uvs: Vec<[Vec2; 3]>,
    /// Unit vertex normals: one entry a triangle (zero vectors where it is flat), or none at all where everything is.
    pub normals: Vec<[Vec3; 3]>,
    /// What was odd but not wrong, each a full sentence.
    pub warnings: Vec<String>,
    /// The files that it was read from and those that were looked for in vain, each path once and as it was asked for: the scene file first;
    /// after a view, the scene that it names. None of a scene inside the program.
    pub files: Vec<PathBuf>,
}

/// Largest width and height of a picture in pixels.
pub const MAX_SIDE: u32 = 16_384;
/// Largest number of scattering events on a path.
pub const MAX_BOUNCES: u32 = 1_024;

/// The light that comes from where nothing is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Sky {
    /// The same radiance from everywhere.
    Color(Vec3),
    /// From `bottom` (straight down) to `top` (straight up), linear in the direction's y.
    Gradient { bottom: Vec3, top: Vec3 },
    /// A latitude/longitude picture, its upper edge straight up, times a colour. The direction (x, y, z) is seen at
    /// u = atan2(z, x) / 2π, wrapped to [0, 1), and at acos(y) / π from the top.
    Texture { texture: u32, color: Vec3 },
}

/// How a surface scatters and shines.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    pub kind: MaterialKind,
    /// Reflectance (transmittance of glass), each channel in [0, 1].
    pub color: Vec3,
    /// Multiplies `color`; of an [`MaterialKind::Emitter`], multiplies `emission`.
    pub texture: Option<u32>,
    /// Its red, linear, multiplies the roughness of what has one; what is above 1 counts as 1.
    pub roughness_map: Option<u32>,
    /// A relief in the frame of the surface: x = 2 red − 1 along growing u, y = 2 green − 1 along growing v (up), z = 2 blue − 1 along
    /// the outward normal, as OpenGL has it. Seen from behind, it is the same relief from behind.
    pub normal_map: Option<u32>,
    /// Radiance, the same in every direction and on both sides; each channel ≥ 0.
    pub emission: Vec3,
}

impl Material {
    /// Everything that is looked up at texture coordinates.
    pub fn pictures(&self) -> impl Iterator<Item = u32> {
        [self.texture, self.roughness_map, self.normal_map].into_iter().flatten()
    }
}

impl MaterialKind {
    /// Does a roughness map change it?
    pub fn has_roughness(self) -> bool {
        match self {
            Self::Metal { roughness } | Self::Plastic { roughness, .. } | Self::Scatter { roughness } => {
                roughness > 0.0
            }
            Self::Diffuse | Self::Glass { .. } | Self::Emitter => false,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MaterialKind {
    /// Lambert.
    Diffuse,
    /// GGX with alpha = roughness², reflectance `color` at every angle; a mirror at roughness 0. Roughness in [0, 1].
    Metal { roughness: f32 },
    /// Smooth dielectric between a medium of index `ior` inside and vacuum outside; `color` scales what it transmits and
    /// reflects. `ior` > 0.
    Glass { ior: f32 },
    /// The thesis's lobe: direction = normalize(reflected + roughness · u), u uniform on the unit sphere; absorbed where it
    /// points below the surface. Roughness ≥ 0.
    Scatter { roughness: f32 },
    /// A dielectric coat of index `ior` over Lambert's base of colour `color`: GGX with alpha = roughness², smooth at roughness
    /// 0. Roughness in [0, 1], `ior` in [1, 3].
    Plastic { roughness: f32, ior: f32 },
    /// Shines and scatters nothing.
    Emitter,
}

/// A picture for surfaces or the sky.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    pub name: String,
    pub width: u32,
    pub height: u32,
    pub filter: Filter,
    /// Row by row from the top; `width · height` of them.
    pub texels: Texels,
}

/// The texels of a picture, as small as its accuracy allows: a picture that fits the cache is read several times as fast.
#[derive(Clone, Debug, PartialEq)]
pub enum Texels {
    /// Display values (sRGB) of red, green and blue, and an unused fourth byte.
    Display(Vec<[u8; 4]>),
    /// Numbers that are no light, from 0 to 1 in 255 steps: directions, roughness.
    Data(Vec<[u8; 4]>),
    /// Linear red, green and blue, and an unused fourth number.
    Linear(Vec<[f32; 4]>),
}

impl Texels {
    pub fn len(&self) -> usize {
        match self {
            Self::Display(texels) | Self::Data(texels) => texels.len(),
            Self::Linear(texels) => texels.len(),
        }
    }
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
    pub fn bytes(&self) -> usize {
        match self {
            Self::Display(texels) | Self::Data(texels) => size_of_val(texels.as_slice()),
            Self::Linear(texels) => size_of_val(texels.as_slice()),
        }
    }
    /// One texel as linear light, display values decoded by IEC 61966-2-1, or as the numbers that it holds.
    pub fn linear(&self, index: usize) -> [f64; 3] {
        match self {
            Self::Display(texels) => {
                let [r, g, b, _] = texels[index];
                [r, g, b].map(|byte| srgb_to_linear(f64::from(byte) / 255.0))
            }
            Self::Data(texels) => {
                let [r, g, b, _] = texels[index];
                [r, g, b].map(|byte| f64::from(byte) / 255.0)
            }
            Self::Linear(texels) => {
                let [r, g, b, _] = texels[index];
                [r, g, b].map(f64::from)
            }
        }
    }
}

/// What the numbers in a picture are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Meaning {
    /// Colours: files of display values are decoded.
    Light,
    /// Directions or roughness: read as they stand.
    Data,
}

/// The linear intensity of a display value: IEC 61966-2-1. Both are 1 at 1; values above 1 follow the same curve.
pub fn srgb_to_linear(x: f64) -> f64 {
    if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
}

/// How a texture is read between texel centres. It repeats in both directions; on spheres and the sky the vertical
/// direction never wraps, because v stays within [0, 1].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Default)]
pub enum Filter {
    Nearest,
    #[default]
    Bilinear,
}

/// A sphere. A point with outward unit normal n shows its texture at acos(n.y) / π from the top and, with a = atan2(n.z, n.x) / 2π,
/// at u = a + `turn` where the picture reads right from inside (as the sky's does), at u = −(a + `turn`) where it does from
/// outside; both wrapped to [0, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    pub center: Vec3,
    /// Above 0.
    pub radius: f32,
    pub material: u32,
    /// Whole turns of the picture around the vertical axis, anticlockwise seen from above, in [0, 1).
    pub turn: f32,
    pub picture_from: Side,
}

/// The side of a sphere from which its picture is not mirrored.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Side {
    /// A globe.
    #[default]
    Outside,
    /// A sky.
    Inside,
}

/// A triangle with an area above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    pub vertices: [Vec3; 3],
    pub material: u32,
}
