//! The scene in double precision, and the closest hit of a ray.

use super::geometry::{self, Hit, Primitive, Shape};
use super::texture;
use crate::scene::{Camera, Material, Scene, Sky};
use glam::{DVec2, DVec3};

/// A scene in double precision.
pub struct Reference {
    pub(super) camera: Camera,
    pub(super) sky: Sky,
    pub(super) materials: Vec<Material>,
    textures: Vec<texture::Levels>,
    pub(super) primitives: Vec<Shape>,
}

impl Reference {
    /// Copies the scene. Points are those of its file if it was loaded so ([`Scene::unrounded`]).
    pub fn new(scene: &Scene) -> Self {
        Self {
            camera: scene.camera,
            sky: scene.sky,
            materials: scene.materials.clone(),
            textures: scene.textures.iter().map(texture::Levels::new).collect(),
            primitives: geometry::primitives(scene),
        }
    }

    /// The nearest hit with t > 0 of the ray from `origin` along `direction`, which need not have unit
    /// length. Of equal t, the lower index. Surfaces are hit from both sides.
    pub fn closest(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let mut nearest: Option<Hit> = None;
        for (number, primitive) in self.primitives.iter().enumerate() {
            if let Some((t, u, v)) = primitive.hit(origin, direction)
                && nearest.is_none_or(|nearest| t < nearest.t)
            {
                nearest = Some(Hit { primitive: number as u32, t, u, v });
            }
        }
        nearest
    }

    /// The colour of texture `texture` at `uv` where a path sees `area` of it, white if there is none; see
    /// [`texture::Levels::lookup`].
    pub(super) fn lookup(&self, texture: Option<u32>, uv: DVec2, wraps: bool, area: f64) -> DVec3 {
        texture.map_or(DVec3::ONE, |index| self.textures[index as usize].lookup(uv, wraps, area))
    }
}
