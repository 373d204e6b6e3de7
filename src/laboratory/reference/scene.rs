//! The scene in double precision, and the closest hit of a ray.

use super::geometry::{self, Crossing, Hit, Primitive, Sphere, Triangle};
use super::texture;
use crate::scene::{Camera, Material, Scene, Sky};
use glam::{DVec2, DVec3};

/// A scene in double precision.
pub struct Reference {
    pub(super) camera: Camera,
    pub(super) sky: Sky,
    pub(super) materials: Vec<Material>,
    textures: Vec<texture::Levels>,
    spheres: Vec<Sphere>,
    triangles: Vec<Triangle>,
}

impl Reference {
    /// Copies the scene. Points are those of its file if it was loaded so ([`Scene::unrounded`]).
    pub fn new(scene: &Scene) -> Self {
        let (spheres, triangles) = geometry::primitives(scene);
        Self {
            camera: scene.camera,
            sky: scene.sky,
            materials: scene.materials.clone(),
            textures: scene.textures.iter().map(texture::Levels::new).collect(),
            spheres,
            triangles,
        }
    }

    /// The nearest hit with t > 0 of the ray from `origin` along `direction`, which need not have unit
    /// length. Of equal t, the lower index. Surfaces are hit from both sides.
    pub fn closest(&self, origin: DVec3, direction: DVec3) -> Option<Hit> {
        let spheres = self.spheres.iter().map(|sphere| sphere.hit(origin, direction));
        let triangles = self.triangles.iter().map(|triangle| triangle.hit(origin, direction));
        let hits = spheres.chain(triangles).zip(0..).filter_map(|(hit, primitive)| {
            let (t, u, v) = hit?;
            Some(Hit { primitive, t, u, v })
        });
        hits.min_by(|a, b| a.t.total_cmp(&b.t))
    }

    /// All crossings of a ray, by the numbers of the primitives.
    pub(super) fn crossings(&self, origin: DVec3, unit: DVec3) -> impl Iterator<Item = (u32, Crossing)> {
        let spheres = self.spheres.iter().map(move |sphere| sphere.crossings(origin, unit));
        let triangles = self.triangles.iter().map(move |triangle| triangle.crossings(origin, unit));
        let all = spheres.chain(triangles).zip(0..);
        all.flat_map(|(crossings, number)| crossings.into_iter().map(move |crossing| (number, crossing)))
    }

    /// The primitive of this number: spheres first, in the scene's order, then triangles.
    pub(super) fn primitive(&self, number: u32) -> Option<&dyn Primitive> {
        let number = number as usize;
        match self.spheres.get(number) {
            Some(sphere) => Some(sphere),
            None => Some(self.triangles.get(number - self.spheres.len())?),
        }
    }

    /// The colour of texture `texture` at `uv` where a path sees `area` of it, white if there is none; see
    /// [`texture::Levels::lookup`].
    pub(super) fn lookup(&self, texture: Option<u32>, uv: DVec2, wraps: bool, area: f64) -> DVec3 {
        texture.map_or(DVec3::ONE, |index| self.textures[index as usize].lookup(uv, wraps, area))
    }
}
