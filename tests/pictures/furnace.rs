//! The law of energy: no material adds light, none loses more than it says. A white furnace: whatever has the
//! colour 1 under a sky of 1 is invisible.

use crate::common::*;
use crate::judged::assert_is_the_references;
use octray::integrate::pipeline_for;

/// Two balls over a floor, all of one material: paths go back and forth between them.
fn room(kind: MaterialKind) -> Scene {
    // A single sheet of glass leads into glass without end, so there is no floor of it.
    let is_glass = matches!(kind, Glass { .. } | RoughGlass { thin: false, .. });
    Scene {
        camera: Camera { position: vec3(0.0, 0.5, 5.0), ..empty().camera },
        resolution: [48, 32],
        materials: vec![material(kind)],
        spheres: vec![sphere(vec3(-0.9, 0.0, 0.0), 1.0, 0), sphere(vec3(1.1, -0.2, 0.4), 0.9, 0)],
        triangles: if is_glass { vec![] } else { vec![triangle(ground(30.0, -1.5), 0)] },
        ..empty()
    }
}

/// Lit by chance alone, by paths of any length.
fn render(scene: &Scene, max_bounces: u32, samples: u32, lanes: usize) -> Picture {
    let settings = Settings { max_bounces, lanes, seed: 9, ..with_lights(scene, LightChoice::Off) };
    crate::common::render(scene, settings, samples)
}

fn channels(picture: &Picture) -> impl Iterator<Item = f32> {
    picture.pixels.iter().flatten().copied()
}

/// Enough that no path is cut off: each segment escapes with a chance of a quarter at least.
const UNBOUNDED: u32 = 300;
const SAMPLES: u32 = 32;

#[test]
fn white_furnace_is_exactly_white_where_every_weight_is_one() {
    // Throughput is a product of ones, the sky is 1, and a sum of n ones divided by n is 1: no rounding
    // anywhere. A path that is lost (absorbed below the surface, caught in it, cut off) would show as 31/32.
    for kind in [Diffuse, Metal { roughness: 0.0 }, ThinGlass { ior: 1.5 }, ThinGlass { ior: 0.7 }] {
        for lanes in WIDTHS {
            let picture = render(&room(kind), UNBOUNDED, SAMPLES, lanes);
            assert!(channels(&picture).all(|x| x == 1.0), "{kind:?}");
        }
    }
}

#[test]
fn white_furnace_of_glass_is_white_within_rounding() {
    // Entering weighs η², leaving 1/η², each rounded twice: 6 ε a passage, and few paths pass more than a
    // dozen times.
    for ior in [1.5, 1.05, 2.4, 0.7] {
        let picture = render(&room(Glass { ior }), UNBOUNDED, SAMPLES, 8);
        let worst = channels(&picture).fold(0.0_f32, |worst, x| worst.max((x - 1.0).abs()));
        assert!(worst <= 1e-5, "ior {ior}: {worst:e}");
    }
}

#[test]
fn rough_glass_keeps_the_light() {
    for (roughness, ior) in
        [(0.05, 1.5), (0.3, 1.1), (0.5, 2.4), (0.7, 1.5), (1.0, 1.33), (1.0, 2.4), (0.6, 0.7)]
    {
        for thin in [false, true] {
            let kind = RoughGlass { roughness, ior, thin };
            // The square of the index makes noise.
            let kept = mean(&render(&room(kind), UNBOUNDED, 4 * SAMPLES, 8));
            assert!((0.98..1.005).contains(&kept), "{kind:?} keeps {kept:.4} of the light");
        }
    }
}

/// A panel of rough glass is nearly that of smooth glass.
#[test]
fn rough_glass_becomes_smooth_glass() {
    let of = |kind| render(&Scene { sky: lit(), ..room(kind) }, 16, SAMPLES, 8);
    for (smooth, thin) in [(Glass { ior: 1.5 }, false), (ThinGlass { ior: 1.5 }, true)] {
        let off = |roughness| rmse(&of(smooth), &of(RoughGlass { roughness, ior: 1.5, thin }));
        let (narrow, wide) = (off(0.005), off(0.3));
        assert!(narrow < 2e-3 && wide > 3.0 * narrow, "{smooth:?}: {narrow}, {wide}");
    }
}

fn lit() -> Sky {
    Sky::Gradient { bottom: Vec3::splat(0.2), top: Vec3::ONE }
}

#[test]
fn absorbing_materials_never_exceed_white() {
    for roughness in [0.2, 0.6, 1.2, 2.0] {
        let picture = render(&room(FuzzyMirror { roughness }), UNBOUNDED, SAMPLES, 8);
        // Each weight is at most 1 up to its own rounding.
        let most = channels(&picture).fold(0.0, f32::max);
        assert!(channels(&picture).all(|x| (0.0..=1.0 + 1e-5).contains(&x)), "{roughness}: {most}");
        let kept = mean(&picture);
        assert!((0.3..1.0).contains(&kept), "{roughness}: keeps {kept:.3} of the light");
    }
}

#[test]
fn rough_metals_and_dielectrics_keep_the_light() {
    for roughness in [0.1, 0.3, 0.6, 1.0] {
        let rough = |metallic| MetalRough { roughness, metallic, ior: 1.5 };
        for kind in [Metal { roughness }, rough(1.0), rough(0.0)] {
            let kept = mean(&render(&room(kind), UNBOUNDED, SAMPLES, 8));
            assert!((0.98..1.005).contains(&kept), "{kind:?} keeps {kept:.4} of the light");
        }
    }
}

#[test]
fn emission_adds_to_what_is_scattered() {
    // The ball is convex: a path shines once, goes to the sky, and adds 1. It fills the middle of the
    // picture.
    let middle = |kind, sky, bounces| {
        let scene = Scene {
            materials: vec![Material { emission: vec3(0.5, 0.25, 2.0), ..material(kind) }],
            spheres: vec![sphere(Vec3::ZERO, 3.0, 0)],
            sky: Sky::Color(sky),
            ..empty()
        };
        render(&scene, bounces, SAMPLES, 8).pixels[8 * 24 + 12]
    };
    assert_eq!(middle(Diffuse, Vec3::ONE, 4), [1.5, 1.25, 3.0]);
    assert_eq!(middle(Diffuse, Vec3::ONE, 0), [0.5, 0.25, 2.0]);
    assert_eq!(middle(Emitter, Vec3::ONE, 4), [0.5, 0.25, 2.0]);
    assert_eq!(middle(Metal { roughness: 0.0 }, Vec3::ZERO, 4), [0.5, 0.25, 2.0]);
}

#[test]
fn furnace_of_rough_metal_is_the_references() {
    for roughness in [0.1, 0.3, 0.6, 1.0] {
        let scene = Scene { max_bounces: 50, ..room(Metal { roughness }) };
        assert_is_the_references(&format!("roughness {roughness}"), &scene, SAMPLES);
    }
}

/// A tilted wall behind three balls, all with pictures on them, under a sky that is one.
#[test]
fn textures_on_spheres_triangles_and_sky_are_the_references() {
    for filter in [Filter::Nearest, Filter::Bilinear, Filter::Trilinear] {
        let mut rng = Rng(61);
        let textures = vec![noise(&mut rng, 7, 5, filter), noise(&mut rng, 4, 6, filter)];
        let shown = |kind, texture| Material { texture: Some(texture), ..material(kind) };
        let lamp = Material { emission: vec3(1.0, 2.0, 0.5), ..shown(Emitter, 1) };
        let wall = [vec3(-6.0, -5.0, -2.0), vec3(6.0, -4.0, -1.0), vec3(1.0, 6.0, -3.0)];
        let ball = |x: f32, turn: f32, material: u32| Sphere {
            texture_turn: turn,
            ..sphere(vec3(x, 0.2 * x, 0.0), 0.6, material)
        };
        let scene = Scene {
            materials: vec![
                shown(Diffuse, 0),
                lamp,
                // A path without red still carries light.
                Material { color: vec3(0.0, 0.8, 0.6), ..shown(Metal { roughness: 0.0 }, 1) },
            ],
            textures,
            spheres: vec![ball(-1.3, 0.15, 0), ball(0.0, 0.4, 1), ball(1.3, 0.7, 2)],
            triangles: vec![triangle(wall, 0)],
            uvs: vec![[vec2(0.1, 0.2), vec2(2.3, 0.4), vec2(0.7, 1.9)]],
            sky: Sky::Texture { texture: 0, color: vec3(1.0, 0.5, 2.0), turn: 0.7 },
            ..empty()
        };
        assert_is_the_references(&format!("{filter:?}"), &scene, SAMPLES);
    }
}

/// Few primitives and materials are looked up in tables of eight, alike at every width: a table that is too
/// short shows only here. The two skies are those of the two pipelines that have such tables.
#[test]
fn primitives_of_any_number_near_the_size_of_a_table_are_the_references() {
    for count in [1, 4, 5, 8, 9, 12] {
        let mut rng = Rng(62);
        let mut scene = empty();
        scene.camera.position = 4.0 * Vec3::Z;
        for i in 0..count {
            // Each shade is its own, and each triangle fills more of the picture than may stray.
            let color = Vec3::splat(0.1 + 0.07 * i as f32);
            scene.materials.push(Material { color, ..material(Diffuse) });
            let center = vec3((i % 4) as f32 - 1.5, (i / 4) as f32 - 1.0, 0.0);
            scene.spheres.push(sphere(center - Vec3::Z, 0.4, i));
            let vertices = [0.0, 1.0, 2.0].map(|third: f32| {
                let (sin, cos) = (third * std::f32::consts::TAU / 3.0).sin_cos();
                center + 0.5 * vec3(sin, cos, 0.3 * rng.signed() as f32)
            });
            scene.triangles.push(triangle(vertices, i));
        }
        let triangles = Scene { spheres: Vec::new(), ..scene.clone() };
        let spheres = Scene { triangles: Vec::new(), ..scene.clone() };
        let gradient = Sky::Gradient { bottom: vec3(0.2, 0.3, 0.1), top: vec3(2.0, 1.0, 3.0) };
        for (name, scene, most) in [("both", scene, 4), ("triangles", triangles, 4), ("spheres", spheres, 8)]
        {
            for sky in [Sky::Color(Vec3::ONE), gradient] {
                let scene = Scene { sky, ..scene.clone() };
                assert_is_the_references(&format!("{count} {name} under {sky:?}"), &scene, 8);
                // The test means something only where the tables are used.
                let tables = has_tables(&scene);
                let has_any = matches!(sky, Sky::Color(_)) || scene.triangles.is_empty();
                assert_eq!(tables, has_any && count <= most, "{count} {name} under {sky:?}");
            }
        }
    }
}

/// Is the scene rendered by another pipeline than if it had more primitives and materials than tables hold?
fn has_tables(scene: &Scene) -> bool {
    let needs = Features::of(scene);
    let many = Features::MANY_SPHERES.with(Features::MANY_TRIANGLES).with(Features::MANY_MATERIALS);
    pipeline_for(needs, 8).0 != pipeline_for(needs.with(many), 8).0
}
