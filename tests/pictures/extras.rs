//! The law of the parameters that few materials have: partial transmission, absorption, reflectance, clear
//! coat. Pictures are the reference's, and ways to find light differ in noise alone.

use crate::common::statistics::mean_and_error;
use crate::common::*;
use crate::judged::{assert_is_the_references, balls};

fn absorbing(color: Vec3, distance: f32) -> MaterialExtras {
    MaterialExtras { attenuation: Some(Attenuation { color, distance }), ..MaterialExtras::default() }
}

/// Materials with each parameter, and with several.
fn materials() -> Vec<(MaterialKind, MaterialExtras)> {
    let plain = MaterialExtras::default;
    let plastic = MetalRough { roughness: 0.5, metallic: 0.0, ior: 1.4 };
    let smooth = MetalRough { roughness: 0.0, metallic: 0.25, ior: 1.5 };
    let tint = vec3(0.5, 1.0, 3.0);
    vec![
        (Glass { ior: 1.5 }, absorbing(vec3(0.9, 0.5, 0.0), 0.7)),
        (RoughGlass { roughness: 0.4, ior: 1.5, thin: false }, absorbing(vec3(0.2, 0.6, 0.9), 2.0)),
        (plastic, MaterialExtras { transmission: 0.6, ..absorbing(vec3(0.3, 0.9, 0.7), 1.0) }),
        (smooth, MaterialExtras { transmission: 1.0, thin: true, ..plain() }),
        (plastic, MaterialExtras { specular: 0.3, specular_color: tint, ..plain() }),
        (smooth, MaterialExtras { clearcoat: 0.8, clearcoat_roughness: 0.4, ..plain() }),
        (plastic, MaterialExtras { clearcoat: 1.0, specular: 0.0, ..plain() }),
        (
            plastic,
            MaterialExtras {
                clearcoat: 0.6,
                clearcoat_roughness: 0.2,
                transmission: 0.3,
                specular: 0.7,
                ..plain()
            },
        ),
    ]
}

#[test]
fn picture_is_the_references_with_extras_of_materials() {
    for (kind, extras) in materials() {
        for mut scene in [balls(kind), smooth_ball(kind)] {
            scene.materials[0].extras = extras.clone();
            assert_is_the_references(&format!("{kind:?}, {extras:?}"), &scene, 4);
        }
        // The maps of a roughness and a metallic share.
        let mut rng = Rng(3);
        let mut scene = smooth_ball(kind);
        scene.textures = vec![noise(&mut rng, 8, 6, Filter::Bilinear)];
        scene.materials[0].roughness_map = kind.has_roughness().then_some(0);
        scene.materials[0].extras = extras.clone();
        scene.uvs =
            scene.triangles.iter().map(|it| it.vertices.map(|v| vec2(0.3 * v.x + v.z, v.y))).collect();
        assert_is_the_references(&format!("maps, {kind:?}, {extras:?}"), &scene, 2);
    }
}

/// Two walls half a unit apart, around glass that does not bend light.
#[test]
fn slab_leaves_what_its_thickness_must() {
    let (color, distance) = (vec3(0.8, 0.5, 0.1), 0.2);
    let wall = |z: f32, side: f32| {
        triangle([vec3(-9.0 * side, -9.0, z), vec3(9.0 * side, -9.0, z), vec3(0.0, 18.0, z)], 0)
    };
    let scene = Scene {
        camera: camera(Vec3::Z * 3.0, Vec3::ZERO, 1.0),
        materials: vec![Material { extras: absorbing(color, distance), ..material(Glass { ior: 1.0 }) }],
        triangles: vec![wall(0.25, 1.0), wall(-0.25, -1.0)],
        ..empty()
    };
    let expected = color.powf(0.5 / distance);
    for pixel in render(&scene, Settings::of(&scene), 1).pixels {
        assert!(Vec3::from(pixel).abs_diff_eq(expected, 1e-4), "{pixel:?}, not {expected}");
    }
}

#[test]
fn search_changes_no_expectation_with_extras_of_materials() {
    const RUNS: u32 = 16;
    for (kind, extras) in materials() {
        let mut scene = round_ball(kind);
        scene.materials[0].extras = extras.clone();
        scene.materials.push(emitter(vec3(9.0, 6.0, 3.0)));
        scene.spheres.push(sphere(vec3(-0.6, 1.4, -1.4), 0.5, 1));
        scene.spheres.push(sphere(vec3(1.5, 1.0, 1.2), 0.3, 1));
        scene = Scene { sky: Sky::Color(Vec3::splat(0.1)), resolution: [24, 16], ..scene };
        let [on, off] = [(LightChoice::On, 8), (LightChoice::Off, 64)].map(|(lights, samples)| {
            let run = |seed| mean(&render(&scene, Settings { seed, ..with_lights(&scene, lights) }, samples));
            mean_and_error(&(0..RUNS).map(run).collect::<Vec<_>>())
        });
        let error = on.1.hypot(off.1);
        assert!((on.0 - off.0).abs() < 4.5 * error, "{kind:?}, {extras:?}: {on:?}, {off:?}");
        assert!(error < 0.02 * off.0, "{kind:?}, {extras:?}: {error}");
    }
}
