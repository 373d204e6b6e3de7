//! Notes glass whose index of refraction is surely a mistake.

use super::builder::SceneBuilder;
use super::json::JsonPath;
use glam::Vec3;
use octray_engine::scene::{MaterialKind, Sphere};

/// Most spheres of glass that are compared with each other.
const MOST_NESTED: usize = 1_000;

/// Notes spheres of glass directly inside others whose `ior` is surely a mistake: as every `ior` is relative
/// to vacuum, 1 has no effect, and that of the outer sphere refracts again.
pub fn note_glass_in_glass(builder: &mut SceneBuilder, place: &JsonPath) {
    let SceneBuilder { scene, notes, .. } = builder;
    let ior_of = |sphere: &Sphere| match scene.materials[sphere.material as usize].kind {
        MaterialKind::Glass { ior } | MaterialKind::RoughGlass { ior, thin: false, .. } => Some(ior),
        _ => None,
    };
    let glass = scene.spheres.iter().enumerate().filter(|(_, sphere)| ior_of(sphere).is_some());
    let glass: Vec<_> = glass.take(MOST_NESTED).collect();
    for &(index, sphere) in &glass {
        let is_around = |outer: &&Sphere| {
            let larger = outer.radius - sphere.radius;
            larger > 0.0 && outer.center.distance(sphere.center) <= larger
        };
        let is_in_glass = glass.iter().any(|(_, outer)| is_around(outer));
        // The sphere around may be of any material. An opaque one hides the glass in it.
        let around = scene.spheres.iter().filter(|outer| is_in_glass && is_around(outer));
        let around = around.min_by(|a, b| a.radius.total_cmp(&b.radius));
        let (Some(ior), Some(outer)) = (ior_of(sphere), around.and_then(ior_of)) else { continue };
        let material = &scene.materials[sphere.material as usize];
        let is_clear = material.color == Vec3::ONE && material.textures().next().is_none();
        let why = match ior {
            _ if outer <= 1.0 => continue,
            1.0 if is_clear && !material.emits() => "is invisible",
            _ if ior == outer => "refracts once more",
            _ => continue,
        };
        let what = format!(
            "glass of `ior` {ior} inside glass of {outer} {why}, as each `ior` is relative to vacuum: for air inside, \
             write `ior` {:.3} (1 / {outer})",
            outer.recip()
        );
        notes.add(&place.item(index), what);
    }
}
