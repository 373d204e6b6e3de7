//! The scene as a whole, and the kinds of its primitives: spheres and triangles.
//!
//! Code that differs by kind is a method of [`Primitive`], a row of `buffers/geometry.rs`, and a light of
//! [`crate::lights`]; the intersection tests are in [`crate::rays`].

use super::camera::Camera;
use super::light::PunctualLight;
use super::material::Material;
use super::texture::Texture;
use glam::{DVec3, Vec2, Vec3};
use octray_rays::{Coordinates, Geometry, Kind, KindCounts, Shape};
use serde::Deserialize;
use std::path::PathBuf;

/// A valid scene: every index is in range, every number finite, every radius positive, no triangle has zero
/// area.
///
/// Units: lengths in scene units, see [`Coordinates`]; y up, right-handed; colours linear RGB; radiance in
/// the same units everywhere. The default is not valid: it lacks a camera and a resolution, and serves to
/// build other scenes.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The short name for tables: `builtin:three`, or the name of the file.
    pub name: String,
    /// The place of the scene's coordinates in its file.
    pub coordinates: Coordinates,
    /// The points before rounding, if the scene was loaded for the reference.
    pub unrounded: Option<Box<Unrounded>>,
    /// The camera that sees the scene.
    pub camera: Camera,
    /// The width and height in pixels, each from 1 to [`MAX_SIDE`].
    pub resolution: [u32; 2],
    /// The largest number of scattering events on a path.
    pub max_bounces: u32,
    /// The environment, seen by rays that hit nothing.
    pub sky: Sky,
    /// The materials; primitives refer to them by index.
    pub materials: Vec<Material>,
    /// The textures; materials and the sky refer to them by index.
    pub textures: Vec<Texture>,
    /// The lights that are no primitives.
    pub lights: Vec<PunctualLight>,
    /// All spheres.
    pub spheres: Vec<Sphere>,
    /// All triangles.
    pub triangles: Vec<Triangle>,
    /// Texture coordinates of the triangles' vertices, v upwards: one entry per triangle; empty if no
    /// material has a texture.
    pub uvs: Vec<[Vec2; 3]>,
    /// The quads through which the sky is sampled.
    pub portals: Vec<Portal>,
    /// Unit vertex normals: one entry per triangle, zero vectors for a flat one; empty if all triangles are
    /// flat.
    pub normals: Vec<[Vec3; 3]>,
    /// Warnings about valid but suspicious content, each a full sentence.
    pub warnings: Vec<String>,
    /// The files that the scene was read from and those that were not found, each path once and as given: the
    /// scene file first; after a view, the scene that it names. Empty for built-in scenes.
    pub files: Vec<PathBuf>,
}

/// The geometry of a scene's primitives as in its file: in the scene's [`Coordinates`], not rounded.
#[derive(Clone, Debug, Default)]
pub struct Unrounded {
    /// The centres and radii of spheres.
    pub spheres: Vec<(DVec3, f64)>,
    /// The vertices of triangles.
    pub triangles: Vec<[DVec3; 3]>,
}

impl Scene {
    /// Returns the number of primitives.
    pub fn primitives(&self) -> usize {
        self.counts().total()
    }
    /// Returns the numbers of primitives by kind.
    pub fn counts(&self) -> KindCounts {
        KindCounts([self.spheres.len(), self.triangles.len()])
    }
    /// Iterates over all primitives in the order of hits' indices: spheres first, then triangles.
    pub fn all_primitives(&self) -> impl Iterator<Item = Primitive<'_>> {
        self.counts().places().map(|place| self.primitive_at(place))
    }
    /// Returns a primitive by its number.
    ///
    /// # Panics
    /// If `number` is not below [`Scene::primitives`].
    pub fn primitive(&self, number: usize) -> Primitive<'_> {
        self.primitive_at(self.counts().place(number))
    }
    fn primitive_at(&self, (kind, index): (Kind, usize)) -> Primitive<'_> {
        match kind {
            Kind::Sphere => Primitive::Sphere(&self.spheres[index]),
            Kind::Triangle => Primitive::Triangle(&self.triangles[index]),
        }
    }
    /// Returns the list of a scene file that has this primitive, given by its number, and the index there.
    pub fn place(&self, number: usize) -> (&'static str, usize) {
        match self.counts().place(number) {
            (Kind::Sphere, index) => ("spheres", index),
            (Kind::Triangle, index) => ("triangles", index),
        }
    }
    /// Tests whether any primitive or light emits light.
    pub fn emits(&self) -> bool {
        self.lights.iter().any(|light| light.shape.brightness() != Vec3::ZERO)
            || self.all_primitives().any(|primitive| self.materials[primitive.material() as usize].emits())
    }
    /// Returns the geometry of all primitives, for tracing rays.
    pub fn geometry(&self) -> Geometry {
        Geometry {
            coordinates: self.coordinates,
            spheres: self.spheres.iter().map(Sphere::shape).collect(),
            triangles: self.triangles.iter().map(|triangle| triangle.vertices).collect(),
        }
    }
}

/// The largest width and height of an image in pixels.
pub const MAX_SIDE: u32 = 16_384;
/// The largest number of scattering events on a path.
pub const MAX_BOUNCES: u32 = 1_024;

/// The radiance of rays that miss everything.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // The variants' text explains their fields.
pub enum Sky {
    /// The same radiance from all directions.
    Color(Vec3),
    /// A gradient from `bottom` (straight down) to `top` (straight up), linear in the direction's y.
    Gradient { bottom: Vec3, top: Vec3 },
    /// An environment map in latitude and longitude (equirectangular), its upper edge straight up, times a
    /// colour. The direction (x, y, z) has the texture coordinates u = atan2(z, x) / 2π + `turn`, wrapped to
    /// [0, 1), and acos(y) / π from the top. `turn` rotates the sky around the vertical axis, in whole turns,
    /// anticlockwise seen from above, in [0, 1).
    Texture { texture: u32, color: Vec3, turn: f32 },
}

impl Sky {
    /// Tests whether the colours are black; the texture is ignored.
    pub fn is_black(&self) -> bool {
        match *self {
            Self::Color(color) | Self::Texture { color, .. } => color == Vec3::ZERO,
            Self::Gradient { bottom, top } => bottom == Vec3::ZERO && top == Vec3::ZERO,
        }
    }
}

impl Default for Sky {
    fn default() -> Self {
        Self::Color(Vec3::ZERO)
    }
}

/// A sphere. A point with outward unit normal n has the texture coordinates acos(n.y) / π from the top and,
/// with a = atan2(n.z, n.x) / 2π, u = a + `texture_turn` if the texture reads right from inside (as the sky's
/// does), or u = −(a + `texture_turn`) if from outside; both wrapped to [0, 1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// The centre of the sphere.
    pub center: Vec3,
    /// The radius, above 0.
    pub radius: f32,
    /// The index of the material.
    pub material: u32,
    /// The rotation of the texture around the vertical axis, in whole turns, anticlockwise seen from above,
    /// in [0, 1).
    pub texture_turn: f32,
    /// The side from which the texture is not mirrored.
    pub texture_side: Side,
}

impl Sphere {
    /// Returns the geometry of the sphere.
    fn shape(&self) -> octray_rays::Sphere {
        octray_rays::Sphere { center: self.center, radius: self.radius }
    }
}

/// A side of a sphere. Scene files have these names in lower case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The outer side, as on a globe.
    #[default]
    Outside,
    /// The inner side, as in a sky.
    Inside,
}

/// A triangle with an area above 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle {
    /// The corners of the triangle.
    pub vertices: [Vec3; 3],
    /// The index of the material.
    pub material: u32,
}

/// A parallelogram, such as a window's opening, through which next event estimation samples the sky, for
/// points on its lit side. It is no primitive: rays pass it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Portal {
    /// The corners, anticlockwise as seen from the lit side: from inside the room.
    pub vertices: [Vec3; 4],
}

/// The largest number of portals in a scene. Every ray that misses the scene is tested against all of them.
pub const MAX_PORTALS: usize = 64;

/// A primitive of a scene: see [`Scene::primitive`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Primitive<'a> {
    /// A sphere.
    Sphere(&'a Sphere),
    /// A triangle.
    Triangle(&'a Triangle),
}

impl<'a> Primitive<'a> {
    /// Returns the index of the material.
    pub fn material(self) -> u32 {
        match self {
            Self::Sphere(sphere) => sphere.material,
            Self::Triangle(triangle) => triangle.material,
        }
    }
    /// Returns points and a radius: the hull of balls of this radius around them contains the primitive.
    pub fn hull(self) -> (&'a [Vec3], f32) {
        match self {
            Self::Sphere(sphere) => (std::slice::from_ref(&sphere.center), sphere.radius),
            Self::Triangle(triangle) => (&triangle.vertices, 0.0),
        }
    }
    /// Returns the geometry of the primitive.
    pub fn shape(self) -> Shape {
        match self {
            Self::Sphere(sphere) => Shape::Sphere(sphere.shape()),
            Self::Triangle(triangle) => Shape::Triangle(triangle.vertices),
        }
    }
}
