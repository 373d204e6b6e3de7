//! The independent judge: the same picture in f64, one ray and one object at a time, written to be obviously right.
//!
//! For: answering what a ray truly hits ([`Reference::closest`]), whether a single-precision answer is as right as single
//! precision can be ([`Reference::check_primary`], [`Reference::check_weights`]), and what a path, a pixel truly carries ([`Reference::path`],
//! [`Reference::pixel`]).
//! May import: the types of `scene`, the integer hash and the dimensions of `sampling::random` (at width one; judge and
//! judged follow the same paths because they draw the same numbers), and glam's `DVec3`.
//! Must never know: kernels, warps, buffers, acceleration structures, packets. It shares no equation's code with what it
//! judges, and speed is no concern of it.
//!
//! | file | what it does |
//! |---|---|
//! | `geometry` | spheres, triangles, the closest hit |
//! | `verdict` | is a single-precision answer within its bounds? |
//! | `path` | camera, sky, and the path from one to the other |
//! | `lobes` | how materials scatter |
//! | `texture` | how pictures are read |

mod geometry;
mod lobes;
mod path;
mod texture;
mod verdict;

pub use geometry::Hit;
pub use path::PathSettings;
pub use verdict::Verdict;

use crate::scene::{Camera, Material, Scene, Sky, Texture};
use geometry::{Sphere, Triangle};
use glam::{DVec2, DVec3};

/// A scene in double precision.
pub struct Reference {
    camera: Camera,
    sky: Sky,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    spheres: Vec<Sphere>,
    triangles: Vec<Triangle>,
}

impl Reference {
    /// Copies the scene; every single-precision number converts exactly.
    pub fn new(scene: &Scene) -> Self {
        let spheres = scene.spheres.iter().map(|sphere| Sphere {
            center: sphere.center.as_dvec3(),
            radius: f64::from(sphere.radius),
            turn: f64::from(sphere.texture_turn),
            picture_from: sphere.texture_side,
            material: sphere.material as usize,
        });
        let triangles = scene.triangles.iter().enumerate().map(|(index, triangle)| Triangle {
            vertices: triangle.vertices.map(|vertex| vertex.as_dvec3()),
            normals: scene
                .normals
                .get(index)
                .map_or([DVec3::ZERO; 3], |normals| normals.map(|n| n.as_dvec3())),
            uvs: scene.uvs.get(index).map_or([DVec2::ZERO; 3], |uvs| uvs.map(|uv| uv.as_dvec2())),
            material: triangle.material as usize,
        });
        Self {
            camera: scene.camera,
            sky: scene.sky,
            materials: scene.materials.clone(),
            textures: scene.textures.clone(),
            spheres: spheres.collect(),
            triangles: triangles.collect(),
        }
    }

    /// The average of the pixel's samples 0 to `samples` − 1, in linear RGB; black if there are none.
    pub fn pixel(&self, settings: PathSettings, x: u32, y: u32, samples: u32) -> [f64; 3] {
        let sum: DVec3 =
            (0..samples).map(|sample| DVec3::from_array(self.path(settings, x, y, sample))).sum();
        (sum / f64::from(samples.max(1))).to_array()
    }
}
