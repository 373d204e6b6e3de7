//! Computes the power of emitters, by which next event estimation chooses among them.

use crate::buffers::block_means::BlockMeans;
use crate::primitives;
use crate::scene::{Material, MaterialKind, Primitive, Scene, Sphere};
use glam::Vec3;
use std::collections::{HashMap, HashSet};

/// The emission of the primitives of a scene.
pub(super) struct Emitted<'a> {
    pub(super) scene: &'a Scene,
    /// The textures that multiply emission, by index.
    textures: HashMap<u32, BlockMeans<'a>>,
}

impl<'a> Emitted<'a> {
    /// Reads the textures of all emitters.
    pub(super) fn by(scene: &'a Scene) -> Self {
        let used: HashSet<u32> = scene.all_primitives().map(|primitive| primitive.material()).collect();
        let materials = used.into_iter().map(|material| &scene.materials[material as usize]);
        let emitters = materials.filter(|material| material.emission != Vec3::ZERO);
        let used: HashSet<u32> = emitters.filter_map(emission_texture).collect();
        let means = |index| (index, BlockMeans::of(&scene.textures[index as usize]));
        Self { scene, textures: used.into_iter().map(means).collect() }
    }

    /// Returns the power that a primitive emits; 0 for a sphere around the camera, unless `surrounding` ones
    /// count.
    pub(super) fn power(&self, number: usize, surrounding: bool) -> f64 {
        let primitive = self.scene.primitive(number);
        if let Primitive::Sphere(sphere) = primitive
            && !surrounding
            && surrounds(self.scene, sphere)
        {
            return 0.0;
        }
        let material = &self.scene.materials[primitive.material() as usize];
        primitives::unit_power(primitive) * self.mean_radiance(number) * f64::from(material.opacity)
    }

    /// Returns the emitted radiance of a primitive, the mean of its points and channels.
    fn mean_radiance(&self, number: usize) -> f64 {
        let material = &self.scene.materials[self.scene.primitive(number).material() as usize];
        let Some(texture) = self.texture(material) else {
            return f64::from(material.emission.element_sum()) / 3.0;
        };
        let Some((sum, weights)) = primitives::sum_of_texels(self.scene, number, texture) else {
            return 0.0;
        };
        (material.emission.as_dvec3() * sum).element_sum() / (3.0 * weights)
    }

    /// Returns the texture that multiplies a material's emission.
    pub(super) fn texture(&self, material: &Material) -> Option<&BlockMeans<'a>> {
        emission_texture(material).and_then(|index| self.textures.get(&index))
    }
}

/// Tests whether the camera is within this sphere: then every ray that misses the other primitives hits it.
fn surrounds(scene: &Scene, sphere: &Sphere) -> bool {
    let to = scene.camera.position.as_dvec3() - sphere.center.as_dvec3();
    to.length() < f64::from(sphere.radius)
}

/// Returns the index of the texture that multiplies a material's emission.
fn emission_texture(material: &Material) -> Option<u32> {
    let of_emitter = material.texture.filter(|_| material.kind == MaterialKind::Emitter);
    material.emission_map.or(of_emitter)
}

/// Tests whether a texture multiplies a primitive's emission.
pub(super) fn has_texture(scene: &Scene, number: usize) -> bool {
    emission_texture(&scene.materials[scene.primitive(number).material() as usize]).is_some()
}
