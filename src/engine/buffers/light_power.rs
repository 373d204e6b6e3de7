//! The power of emitters, by which next event estimation chooses among them.

use super::environment_light::EnvironmentLight;
use crate::math::portable;
use crate::scene::{Material, MaterialKind, Primitive, Scene, Sphere, Texture};
use glam::{DVec2, DVec3};
use std::f32::consts::PI;

/// The power that a primitive emits; 0 of a sphere around the camera, unless `surrounding` ones count.
pub(super) fn power_of(scene: &Scene, number: usize, surrounding: bool) -> f64 {
    match scene.primitive(number) {
        Primitive::Sphere(sphere) if !surrounding && surrounds(scene, sphere) => 0.0,
        primitive => {
            let material = &scene.materials[primitive.material() as usize];
            primitive.unit_power() * mean_emission(scene, number, material)
        }
    }
}

/// The power that arrives from the sky at a sphere around the scene.
pub(super) fn sky_power(scene: &Scene, sky: &EnvironmentLight) -> f64 {
    let (lower, upper) = scene.bounds();
    let radius = (upper - lower).length() / 2.0;
    4.0 * f64::from(PI) * f64::from(PI) * radius * radius * sky.mean
}

/// Whether the camera is within this sphere: then every ray that misses the other primitives hits it.
fn surrounds(scene: &Scene, sphere: &Sphere) -> bool {
    let to = scene.camera.position.as_dvec3() - sphere.center.as_dvec3();
    to.length() < f64::from(sphere.radius)
}

/// The texture that multiplies a material's emission.
fn emission_texture<'a>(scene: &'a Scene, material: &Material) -> Option<&'a Texture> {
    let of_emitter = material.texture.filter(|_| material.kind == MaterialKind::Emitter);
    material.emission_map.or(of_emitter).map(|index| &scene.textures[index as usize])
}

/// Whether a texture multiplies what a primitive emits.
pub(super) fn has_texture(scene: &Scene, number: usize) -> bool {
    number < scene.primitives() && {
        let material = scene.primitive(number).material();
        emission_texture(scene, &scene.materials[material as usize]).is_some()
    }
}

/// Points along each side of a grid over a primitive at which its texture is read.
const GRID: usize = 16;

/// The emitted radiance of a primitive, the mean of its points and channels.
fn mean_emission(scene: &Scene, number: usize, material: &Material) -> f64 {
    let Some(texture) = emission_texture(scene, material) else {
        return f64::from(material.emission.element_sum()) / 3.0;
    };
    let texel = |uv: DVec2| {
        let at = |x: f64, count: u32| (x.rem_euclid(1.0) * f64::from(count)) as usize % count as usize;
        let (column, row) = (at(uv.x, texture.width), at(1.0 - uv.y, texture.height));
        DVec3::from_array(texture.texels.linear(row * texture.width as usize + column))
    };
    let cells = (0..GRID * GRID)
        .map(|cell| DVec2::new((cell % GRID) as f64 + 0.5, (cell / GRID) as f64 + 0.5) / GRID as f64);
    let (mut mean, mut weights) = (DVec3::ZERO, 0.0);
    let mut add = |weight: f64, texel: DVec3| {
        mean += weight * texel;
        weights += weight;
    };
    match scene.primitive(number) {
        Primitive::Triangle(_) => {
            let Some(uvs) = scene.uvs.get(number - scene.first_triangle()) else { return 0.0 };
            let [a, b, c] = uvs.map(|uv| uv.as_dvec2());
            let inside = |at: DVec2| if at.x + at.y > 1.0 { DVec2::ONE - at } else { at };
            cells.map(inside).for_each(|at| add(1.0, texel(a + (b - a) * at.x + (c - a) * at.y)));
        }
        // By the circumferences of its circles of latitude.
        _ => cells.for_each(|at| add(portable::sin_cos(f64::from(PI) * at.y).0, texel(at))),
    }
    (material.emission.as_dvec3() * mean).element_sum() / (3.0 * weights)
}
