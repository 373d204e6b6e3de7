//! The scene in double precision, and the closest hit of a ray.

use super::geometry::{Hit, Sphere, Surface, Triangle};
use super::texture;
use crate::scene::{Camera, Material, Scene, Sky};
use glam::{DVec2, DVec3};

/// A scene in double precision.
pub struct Reference {
    pub(super) camera: Camera,
    pub(super) sky: Sky,
    pub(super) materials: Vec<Material>,
    textures: Vec<texture::Levels>,
    pub(super) spheres: Vec<Sphere>,
    pub(super) triangles: Vec<Triangle>,
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
            textures: scene.textures.iter().map(texture::Levels::new).collect(),
            spheres: spheres.collect(),
            triangles: triangles.collect(),
        }
    }

    /// The nearest hit with t > 0 of the ray from `origin` along `direction`, which need not have unit
    /// length. Of equal t, the lower index. Surfaces are hit from both sides.
    pub fn closest(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let spheres = self.spheres.iter().map(|sphere| sphere.hit(origin, direction).map(|t| (t, 0.0, 0.0)));
        let triangles = self.triangles.iter().map(|triangle| triangle.hit(origin, direction));
        let mut nearest: Option<Hit> = None;
        for (primitive, hit) in spheres.chain(triangles).enumerate() {
            if let Some((t, u, v)) = hit
                && nearest.is_none_or(|nearest| t < nearest.t)
            {
                nearest = Some(Hit { primitive: primitive as u32, t, u, v });
            }
        }
        nearest
    }

    pub(super) fn surface(&self, origin: DVec3, direction: DVec3, hit: Hit) -> Surface {
        let index = hit.primitive as usize;
        match self.spheres.get(index) {
            Some(sphere) => sphere.surface(origin + direction * hit.t),
            None => self.triangles[index - self.spheres.len()].surface(hit.u, hit.v),
        }
    }

    /// The colour of texture `texture` at `uv` where a path sees `area` of it, white if there is none; see
    /// [`texture::Levels::lookup`].
    pub(super) fn lookup(&self, texture: Option<u32>, uv: DVec2, wraps: bool, area: f64) -> DVec3 {
        texture.map_or(DVec3::ONE, |index| self.textures[index as usize].lookup(uv, wraps, area))
    }
}
