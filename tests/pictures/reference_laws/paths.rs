//! Whole paths: furnaces, closed forms, and integrals by quadrature.

use super::scenes::{ball, empty, one_pixel, wall};
use crate::common::statistics::mean_and_error;
use crate::common::*;
use octray::sampling::{PixelCoordinates, SampleValues, dimension, warp};
use std::f64::consts::PI;

/// Mean of the red channel and its standard error over the one pixel's first `samples` paths.
fn mean(judge: &Reference, max_bounces: u32, samples: u32) -> (f64, f64) {
    let values: Vec<f64> = (0..samples).map(|s| judge.path(one_pixel(max_bounces), 0, 0, s)[0]).collect();
    mean_and_error(&values)
}

/// The integral of f over the hemisphere around +z, by the midpoint rule in cos θ and φ.
fn over_hemisphere(f: impl Fn(DVec3) -> f64) -> f64 {
    let (rows, columns) = (1000, 1000);
    let mut sum = 0.0;
    for row in 0..rows {
        let z = (f64::from(row) + 0.5) / f64::from(rows);
        for column in 0..columns {
            let phi = 2.0 * PI * (f64::from(column) + 0.5) / f64::from(columns);
            let r = (1.0 - z * z).sqrt();
            sum += f(dvec3(r * phi.cos(), r * phi.sin(), z));
        }
    }
    sum * 2.0 * PI / (f64::from(rows) * f64::from(columns))
}

/// Both are seen everywhere, the outline of a ball too.
fn wide(scene: Scene) -> Scene {
    Scene { camera: Camera { vertical_fov: 30.0, ..scene.camera }, ..scene }
}

#[test]
fn white_furnace_is_white_where_nothing_is_absorbed() {
    for kind in [Diffuse, Metal { roughness: 0.0 }, Glass { ior: 1.5 }, Glass { ior: 1.0 }] {
        // A single sheet of glass leads into glass without end, so there is no furnace of it.
        let walls = (!matches!(kind, Glass { .. })).then(|| wide(wall(kind)));
        for scene in walls.into_iter().chain([wide(ball(kind))]) {
            let judge = Reference::new(&scene);
            for sample in 0..5000 {
                let value = judge.path(one_pixel(100), 0, 0, sample);
                let white = value.iter().all(|channel| (channel - 1.0).abs() < 1e-12);
                assert!(white, "{kind:?}, sample {sample}: {value:?}");
            }
        }
    }
}

#[test]
fn white_furnace_never_exceeds_one_where_something_is_absorbed() {
    for kind in [0.05, 0.3, 1.0].map(|roughness| FuzzyMirror { roughness }) {
        for scene in [wide(ball(kind)), wide(wall(kind))] {
            let judge = Reference::new(&scene);
            let values: Vec<f64> = (0..5000).map(|s| judge.path(one_pixel(100), 0, 0, s)[0]).collect();
            assert!(values.iter().all(|value| (0.0..=1.0 + 1e-12).contains(value)), "{kind:?}");
            assert!(values.iter().sum::<f64>() > 0.25 * 5000.0, "{kind:?} reflects");
        }
    }
}

#[test]
fn path_ends_after_its_last_event() {
    let scene = |kind| Scene { sky: Sky::Color(Vec3::ONE), ..ball(kind) };
    assert_eq!(Reference::new(&scene(Diffuse)).path(one_pixel(0), 0, 0, 0), [0.0; 3]);
    assert_eq!(Reference::new(&scene(Diffuse)).path(one_pixel(1), 0, 0, 0), [1.0; 3]);
    assert_eq!(Reference::new(&empty()).path(one_pixel(0), 0, 0, 0), [1.0; 3]);
    let lit = Scene { materials: vec![emitter(vec3(2.0, 3.0, 4.0))], ..ball(Emitter) };
    for max_bounces in [0, 9] {
        assert_eq!(Reference::new(&lit).path(one_pixel(max_bounces), 0, 0, 0), [2.0, 3.0, 4.0]);
    }
    let mut glows = ball(Diffuse);
    glows.materials[0].emission = Vec3::splat(0.5);
    glows.materials[0].color = Vec3::splat(0.25);
    assert_eq!(Reference::new(&glows).path(one_pixel(3), 0, 0, 0), [0.75; 3], "own light and the sky's");
}

#[test]
fn lambert_under_a_gradient_is_its_irradiance() {
    let sky = |y: f64| 0.25 + (2.0 - 0.25) * 0.5 * (y + 1.0);
    for position in [Vec3::Z * 5.0, vec3(1.0, 4.0, 2.0), vec3(0.5, -3.0, -4.0)] {
        let scene = ball(Diffuse);
        let judge = Reference::new(&Scene {
            camera: Camera { position, ..scene.camera },
            sky: Sky::Gradient { bottom: Vec3::splat(0.25), top: Vec3::splat(2.0) },
            ..scene
        });
        // The eye looks straight down on the point whose normal is the eye's own direction.
        let n = position.as_dvec3().normalize();
        let tangent = n.any_orthonormal_vector();
        let world = |w: DVec3| tangent * w.x + n.cross(tangent) * w.y + n * w.z;
        let expected = over_hemisphere(|w| sky(world(w).y) * w.z / PI);
        assert!((expected - sky(2.0 / 3.0 * n.y)).abs() < 1e-5, "the quadrature against the closed form");
        let (found, error) = mean(&judge, 4, 40_000);
        assert!((found - expected).abs() < 4.0 * error, "{found} ± {error}, expected {expected}");
    }
}

/// The lobe of GGX by its textbook equations (Walter et al., EGSR 2007, with height-correlated masking),
/// which the sampler never evaluates, integrated against a sky that tells directions apart, and over what
/// they give under a white sky: all light is returned.
#[test]
fn metal_under_a_gradient_is_the_integral_of_its_lobe() {
    let sky = |w: DVec3| 0.5 * (w.y + 1.0);
    for (roughness, height) in [(0.5f32, 3.0f32), (0.7, 0.0), (0.7, 12.0), (1.0, 6.0)] {
        let scene = wall(Metal { roughness });
        let position = vec3(0.0, height, 5.0);
        let judge = Reference::new(&Scene {
            camera: Camera { position, ..scene.camera },
            sky: Sky::Gradient { bottom: Vec3::ZERO, top: Vec3::ONE },
            ..scene
        });
        let alpha2 = f64::from(roughness).powi(4);
        let wo = position.as_dvec3().normalize();
        let lambda = |w: DVec3| 0.5 * ((1.0 + alpha2 * (1.0 / (w.z * w.z) - 1.0)).sqrt() - 1.0);
        let lobe = |wi: DVec3| {
            let h = (wo + wi).normalize();
            let d = alpha2 / (PI * (h.z * h.z * (alpha2 - 1.0) + 1.0).powi(2));
            d / (1.0 + lambda(wo) + lambda(wi)) / (4.0 * wo.z)
        };
        let expected = over_hemisphere(|wi| sky(wi) * lobe(wi)) / over_hemisphere(lobe);
        let (found, error) = mean(&judge, 4, 40_000);
        let told = format!("{roughness}, eye at {height}: {found} ± {error}, expected {expected}");
        // The model's fit of the albedo is off by up to 0.5 %.
        assert!((found / expected - 1.0).abs() < 4.0 * error / expected + 0.005, "{told}");
    }
}

/// (1 − F)² of the paths go straight through; the compression of radiance cancels.
#[test]
fn glass_ball_lets_its_centred_ray_straight_through() {
    for ior in [1.33f32, 1.5, 2.4, 0.75] {
        let scene = ball(Glass { ior });
        let mut behind = sphere(Vec3::Z * -9.0, 1.0, 0);
        behind.material = 1;
        let judge = Reference::new(&Scene {
            sky: Sky::Color(Vec3::ZERO),
            materials: vec![scene.materials[0].clone(), emitter(Vec3::ONE)],
            spheres: vec![scene.spheres[0], behind],
            ..scene
        });
        let n = f64::from(ior);
        let reflected = ((n - 1.0) / (n + 1.0)).powi(2);
        let expected = (1.0 - reflected).powi(2);
        let samples = 40_000;
        for sample in 0..samples {
            let value = judge.path(one_pixel(2), 0, 0, sample)[0];
            assert!(value == 0.0 || (value - 1.0).abs() < 1e-12, "{value}");
        }
        let (found, error) = mean(&judge, 2, samples);
        assert!((found - expected).abs() < 4.0 * error, "{found} ± {error}, expected {expected}");
    }
}

/// Within glass of index n, radiance is n² times what it was outside; Snell's law says where it comes from. A
/// thin pane reflects as two surfaces do, white, and bends nothing.
#[test]
fn glass_wall_bends_by_snell_and_compresses_by_eta_squared() {
    let position = vec3(0.0, 3.0, 4.0);
    // Light comes from below z = 0, inside the glass, with a gradient that tells its direction.
    let judge = |kind, color| {
        let scene = wall(kind);
        Reference::new(&Scene {
            camera: Camera { position, ..scene.camera },
            sky: Sky::Gradient { bottom: Vec3::ZERO, top: Vec3::ONE },
            materials: vec![Material { color, ..material(kind) }],
            ..scene
        })
    };
    let sin_i = 0.6;
    let into_glass = 0.5 * (1.0 - sin_i / 1.5) / 2.25;
    let mirrored = 0.5 * (1.0 - sin_i);
    let (cos_i, cos_t) = (0.8, (1.0f64 - (sin_i / 1.5) * (sin_i / 1.5)).sqrt());
    let perpendicular = (cos_i - 1.5 * cos_t) / (cos_i + 1.5 * cos_t);
    let parallel = (1.5 * cos_i - cos_t) / (1.5 * cos_i + cos_t);
    let fresnel = 0.5 * (perpendicular * perpendicular + parallel * parallel);
    let both = 2.0 * fresnel / (1.0 + fresnel);
    for (kind, color, through, share) in [
        (Glass { ior: 1.5 }, 1.0, into_glass, fresnel),
        (ThinGlass { ior: 1.5 }, 0.25, 0.25 * mirrored, both),
    ] {
        let judge = judge(kind, Vec3::splat(color));
        let mut reflections = 0;
        for sample in 0..20_000 {
            let value = judge.path(one_pixel(1), 0, 0, sample)[0];
            let reflected = (value - mirrored).abs() < 1e-6;
            assert!(reflected || (value - through).abs() < 1e-6, "{kind:?}: {value}");
            reflections += u32::from(reflected);
        }
        let error = (share * (1.0 - share) / 20_000.0).sqrt();
        assert!((f64::from(reflections) / 20_000.0 - share).abs() < 4.0 * error, "{kind:?}");
    }
}

/// From inside glass at 60°: total reflection, always.
#[test]
fn glass_reflects_all_beyond_the_critical_angle() {
    let mut scene = wall(Glass { ior: 1.5 });
    scene.camera.position = vec3(0.0, 8.0, -4.0);
    scene.sky = Sky::Gradient { bottom: Vec3::ZERO, top: Vec3::ONE };
    let judge = Reference::new(&scene);
    let expected = 0.5 * (1.0 - 8.0 / 80.0f64.sqrt());
    for sample in 0..1000 {
        assert!((judge.path(one_pixel(1), 0, 0, sample)[0] - expected).abs() < 1e-6);
    }
}

/// Judge and judged must draw the same numbers for the same things: here against the estimator's warps in
/// f32.
#[test]
fn path_follows_the_directions_of_the_estimator() {
    let mut scene = ball(Diffuse);
    scene.camera.position = vec3(1.0, 2.0, 3.0);
    scene.sky = Sky::Gradient { bottom: Vec3::ZERO, top: Vec3::ONE };
    let n = scene.camera.position.normalize();
    let lane = |v: Vec3| octray::math::Vec3::<f32>::new(v.x, v.y, v.z);
    let mut lobe = scene.clone();
    lobe.materials[0].kind = FuzzyMirror { roughness: 2.0 };
    let (diffuse, fuzzy) = (Reference::new(&scene), Reference::new(&lobe));
    for (sampler, sample) in (0..500).flat_map(|sample| [(Sampler::Sobol, sample), (Sampler::Random, sample)])
    {
        let settings = PathSettings { resolution: [5, 3], max_bounces: 1, seed: 11, sampler };
        let key = sampler.key::<u32>(11, 2 * 5 + 4, sample);
        let numbers = SampleValues::new(sampler, 11, sample, dimension::bounce(0));
        let (u, v) = numbers
            .at_pixels(key, PixelCoordinates::<f32>::Block { x: 4, y: 2 })
            .get_2d(dimension::DIRECTION);
        let d = warp::sample_cosine_hemisphere(lane(n), u, v);
        let found = diffuse.path(settings, 4, 2, sample)[0];
        // The estimator's sine and cosine are off by up to 8e-7, on a vector of length 2 cos θ before it is
        // normalised.
        let allowed = 1e-6 / f64::from(vec3(d.x, d.y, d.z).dot(n)) + 2e-6;
        assert!((found - 0.5 * (f64::from(d.y) + 1.0)).abs() < allowed, "sample {sample}: {d:?}, {found}");

        let s = warp::sample_uniform_sphere(u, v);
        let w = n + vec3(s.x, s.y, s.z) * 2.0;
        let found = fuzzy.path(settings, 4, 2, sample)[0];
        let expected = if w.dot(n) > 0.0 { 0.5 * (w.normalize().y + 1.0) } else { 0.0 };
        let near = (found - f64::from(expected)).abs() < 1e-5;
        assert!(near || w.dot(n).abs() < 1e-5, "sample {sample}: {w}, {found}");
    }
}

#[test]
fn mirrors_and_colours_multiply_along_a_path() {
    // Two facing mirrors under a white sky: in at 45°, off one, off the other, away.
    let mut scene = empty();
    let mirror = Material { color: vec3(0.5, 0.25, 1.0), ..material(Metal { roughness: 0.0 }) };
    scene.materials = vec![mirror];
    let wall = |z: f32| [vec3(-9.0, -3.0, z), vec3(9.0, -3.0, z), vec3(0.0, 2.5, z)];
    scene.triangles = vec![triangle(wall(0.0), 0), triangle(wall(2.0), 0)];
    scene.camera = Camera { position: vec3(0.0, -2.0, 1.0), look_at: vec3(0.0, -1.0, 0.0), ..scene.camera };
    // It meets the walls at y = −1 and y = 1, and passes above the first at y = 3.
    let judge = Reference::new(&scene);
    let [r, g, b] = judge.path(one_pixel(8), 0, 0, 0);
    assert!((r - 0.25).abs() < 1e-12 && (g - 0.0625).abs() < 1e-12 && b == 1.0, "{r} {g} {b}");
}

#[test]
fn camera_rays_span_the_field_of_view() {
    let mut scene = empty();
    scene.camera.vertical_fov = 90.0;
    let judge = Reference::new(&scene);
    let (origin, upper_left) = judge.camera_ray([200, 100], [0.0; 2], [0.5; 2]);
    assert_eq!(origin, DVec3::Z * 5.0);
    assert!(upper_left.distance(dvec3(-2.0, 1.0, -1.0).normalize()) < 1e-12, "{upper_left}");
    let (_, centre) = judge.camera_ray([200, 100], [100.0, 50.0], [0.5; 2]);
    assert!(centre.distance(-DVec3::Z) < 1e-12);
}

#[test]
fn pixel_is_the_average_of_its_paths() {
    let judge = Reference::new(&wide(ball(FuzzyMirror { roughness: 1.0 })));
    let settings = PathSettings { resolution: [4, 3], max_bounces: 3, seed: 1, sampler: Default::default() };
    let sum: f64 = (0..10).map(|sample| judge.path(settings, 1, 2, sample)[1]).sum();
    assert_eq!(judge.pixel(settings, 1, 2, 10)[1], sum / 10.0);
    assert_eq!(judge.pixel(settings, 1, 2, 0), [0.0; 3]);
}
