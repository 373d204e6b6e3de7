//! Laws: directions keep the unit length that intersection asks for, however long the path; and no path ends
//! because it carries little.

use crate::common::*;
use glam::Quat;
use octray::buffers::Buffers;
use octray::camera::{PreparedCamera, Tile};
use octray::integrate::{Scratch, TraceContext, pipeline_for};
use octray::primitives::{PrimitiveTables, SampledAs};
use octray::scene::MAX_BOUNCES;

/// What the robust sphere test asks of a direction, and what the estimator promises.
const DOMAIN: f64 = 1e-5;

fn length(v: Vec3) -> f64 {
    v.as_dvec3().length()
}

/// A camera in a closed, tilted room, and no light lost.
fn room(kind: MaterialKind) -> Scene {
    let tilt = Quat::from_axis_angle(vec3(0.3, 0.8, 0.5).normalize(), 0.7);
    let corner = |i: usize| tilt * vec3(sign(i & 1), sign(i & 2), sign(i & 4));
    let faces = [[0, 1, 3, 2], [4, 5, 7, 6], [0, 1, 5, 4], [2, 3, 7, 6], [0, 2, 6, 4], [1, 3, 7, 5]];
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]);
    Scene {
        camera: camera(vec3(0.1, 0.2, -0.1), vec3(0.5, 0.1, 0.7), 60.0),
        materials: vec![material(Metal { roughness: 0.0 }), material(kind)],
        spheres: vec![sphere(vec3(0.2, -0.5, 0.4), 0.3, 1)],
        triangles: triangles.map(|corners| triangle(corners.map(corner), 0)).collect(),
        ..empty()
    }
}

fn sign(bit: usize) -> f32 {
    if bit == 0 { -1.0 } else { 1.0 }
}

/// The largest departure from unit length of the last segments of a tile's paths.
fn departure(scene: &Scene, max_bounces: u32, lanes: usize) -> f64 {
    let context = TraceContext {
        buffers: Buffers::new(scene),
        primitives: PrimitiveTables::new(scene, |_| SampledAs::Nothing),
        lights: Lights::default(),
        structure: Methods::default().structure(scene, &scene.geometry(), 8, &Lights::default(), None),
        camera: PreparedCamera::new(&scene.camera, [16, 16]),
        visible: Vec::new(),
        width: 16,
        max_bounces,
        seed: 1,
        sampler: octray::sampling::Sampler::default(),
    };
    let tile = Tile { number: 0, x: 0, y: 0, width: 16, height: 16 };
    let mut scratch = Scratch::new();
    let rays = pipeline_for(Features::of(scene), lanes).1(&context, &[tile], 0, &mut scratch);
    // Nothing leaves the room (but by rounding): all paths reach their last segment.
    assert!(rays > 250 * u64::from(max_bounces), "{rays}");
    let alive = (rays - 256) / u64::from(max_bounces);
    let lengths = (0..alive as usize).map(|at| length(scratch.queue.ray::<f32>(at).direction.get(0)));
    lengths.map(|length| (length - 1.0).abs()).fold(0.0, f64::max)
}

#[test]
fn directions_keep_unit_length_over_the_longest_paths() {
    for kind in [Metal { roughness: 0.0 }, Glass { ior: 1.5 }] {
        for (max_bounces, lanes) in [(7, 8), (40, 1), (1000, 8), (MAX_BOUNCES, 1)] {
            let departure = departure(&room(kind), max_bounces, lanes);
            assert!(departure < DOMAIN, "{kind:?}: {departure:e} after {max_bounces} bounces");
        }
    }
}

/// The bound of one reflection, 4 δ + 9 ε (where `integrate` says how often to mend lengths), for normals as
/// long as rounding makes them.
#[test]
fn reflection_lengthens_by_no_more_than_its_bound() {
    const EPSILON: f64 = 1.0 / 16_777_216.0;
    let mut rng = Rng(81);
    for _ in 0..200_000 {
        let n = (rng.direction() * (1.0 + 2.0 * EPSILON * rng.signed())).as_vec3();
        let mut d = rng.direction().as_vec3();
        if d.dot(n) > 0.0 {
            d = -d;
        }
        let reflected = math::Vec3::<f32>::splat(d).reflect(math::Vec3::splat(n)).get(0);
        let growth = (length(reflected) / length(d) - 1.0).abs();
        let bound = 4.0 * (length(n) - 1.0).abs() + 9.0 * EPSILON;
        assert!(growth <= bound, "{d} at {n}: {growth:e}, bound {bound:e}");
    }
}

/// Inside a ball that emits 1 and reflects a tenth, every path adds 1, 0.1, 0.01 …; and a ball that reflects
/// half a thousandth of a bright sky is as bright as 1.
#[test]
fn paths_that_carry_little_add_what_they_carry() {
    let mean_of = |scene: &Scene, max_bounces| {
        let settings = Settings { max_bounces, ..with_lights(scene, LightChoice::Off) };
        let picture = render(scene, settings, 1);
        f64::from(picture.pixels[picture.pixels.len() / 2 + 12][0])
    };
    let of = |color: f32, emission| Material { color: Vec3::splat(color), emission, ..material(Diffuse) };
    let inside =
        Scene { materials: vec![of(0.1, Vec3::ONE)], spheres: vec![sphere(Vec3::ZERO, 9.0, 0)], ..empty() };
    assert!((mean_of(&inside, 6) / 1.111_111_1 - 1.0).abs() < 1e-6, "{}", mean_of(&inside, 6));
    let dark = Scene {
        sky: Sky::Color(Vec3::splat(2000.0)),
        materials: vec![of(5e-4, Vec3::ZERO)],
        spheres: vec![sphere(Vec3::ZERO, 1.0, 0)],
        ..empty()
    };
    assert!((mean_of(&dark, 4) - 1.0).abs() < 1e-6, "{}", mean_of(&dark, 4));
}
