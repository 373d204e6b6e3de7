//! The law of random numbers: samples of a pixel share none, and pixels few; they are warped into the
//! directions that the documentation promises. (Uniformity and independence: `tests/laws/sobol.rs`.)
//!
//! Seeds are fixed. Statistics are compared with their expectation in standard errors; where many are taken,
//! the allowed deviation is that of the whole family at a level of 1e-4 (Bonferroni): seldom enough to be a
//! fault if seen.

use crate::common::statistics::{allowed, chi_squared_deviation, correlation, joint};
use crate::common::*;
use octray::math::Vec3;
use octray::sampling::{random, warp};
use std::f64::consts::TAU;

#[test]
fn samples_of_a_pixel_never_share_their_numbers() {
    for pixel in [0, 1, 12_345] {
        let mut keys: Vec<u32> =
            (0..100_000).map(|sample| random::path_key::<u32>(3, pixel, sample)).collect();
        keys.sort_unstable();
        keys.dedup();
        assert_eq!(keys.len(), 100_000, "for one seed and pixel the key is a bijection of the sample");
    }
}

#[test]
fn pixels_of_a_large_picture_share_few_numbers_and_none_in_rows() {
    // 2²¹ pixels and 4 samples, spread as a key that is linear in both would repeat: it would give collisions
    // to whole pictures.
    let samples = [0u32, 1, 1_727, 2_501];
    let mut keys: Vec<(u32, u32, u32)> = samples
        .iter()
        .flat_map(|&sample| {
            (0..1 << 21).map(move |pixel| (random::path_key::<u32>(3, pixel, sample), pixel, sample))
        })
        .collect();
    keys.sort_unstable();
    let shared: Vec<_> = keys.windows(2).filter(|pair| pair[0].0 == pair[1].0).collect();
    // n² / 2³³ for n = 2²³ keys of 2³² at random; within one sample there is none: 1/4 less.
    let expected = 2f64.powi(46 - 33) * 0.75;
    assert!((shared.len() as f64 - expected).abs() < 6.0 * expected.sqrt(), "{} collisions", shared.len());
    let mut steps: Vec<u32> = shared.iter().map(|pair| pair[1].1.wrapping_sub(pair[0].1)).collect();
    steps.sort_unstable();
    let longest = steps.chunk_by(|a, b| a == b).map(<[u32]>::len).max().unwrap_or(0);
    assert!(longest <= 4, "{longest} collisions of pixels at one and the same distance");
}

fn unit(rng: &mut Rng) -> Vec3<f32> {
    Vec3::splat(rng.direction().as_vec3())
}

const DRAWS: usize = 1_000_000;

/// Counts of points of the unit square, which should be uniform: by row, by column, and by cell.
struct Spread([[usize; Self::BINS]; 3]);

impl Spread {
    const BINS: usize = 50;

    fn add(&mut self, x: f64, y: f64) {
        let bin = |x: f64, bins: usize| ((x * bins as f64) as usize).min(bins - 1);
        // 5 rows of 10 cells.
        let bins = [bin(x, Self::BINS), bin(y, Self::BINS), 10 * bin(x, 5) + bin(y, 10)];
        self.0.iter_mut().zip(bins).for_each(|(counts, bin)| counts[bin] += 1);
    }
    fn deviations(&self) -> [f64; 3] {
        self.0.map(|counts| {
            chi_squared_deviation(&counts, counts.iter().sum::<usize>() as f64 / Self::BINS as f64)
        })
    }
}

#[test]
fn cosine_hemisphere_follows_the_cosine() {
    // cos θ has the density 2 cos θ: E = 2/3, Var = 1/18, and cos² θ is uniform; so is the angle around the
    // normal.
    let mut rng = Rng(42);
    for n in [Vec3::new(0.0, 0.0, 1.0), Vec3::new(0.0, 0.0, -1.0), unit(&mut rng), unit(&mut rng)] {
        let (tangent, bitangent) = warp::orthonormal_basis(n);
        let (mut sum, mut spread) = (0.0, Spread([[0; Spread::BINS]; 3]));
        for draw in 0..DRAWS as u32 / 4 {
            let key = random::path_key::<u32>(1, draw, 0);
            let (u, v) = (random::uniform::<f32>(key, 9), random::uniform::<f32>(key, 10));
            let d = warp::sample_cosine_hemisphere(n, u, v);
            assert!((d.dot(d) - 1.0).abs() < 1e-6, "unit length");
            let cos = f64::from(d.dot(n));
            let around = f64::from(d.dot(bitangent)).atan2(f64::from(d.dot(tangent))) / TAU + 0.5;
            sum += cos;
            spread.add(cos * cos, around);
        }
        let count = (DRAWS / 4) as f64;
        let mean = (sum / count - 2.0 / 3.0) / (1.0 / 18.0 / count).sqrt();
        let deviations = [&[mean][..], &spread.deviations()].concat();
        assert!(deviations.iter().all(|deviation| deviation.abs() < allowed(16)), "{n:?}: {deviations:.1?}");
    }
}

#[test]
fn cosine_hemisphere_never_points_below_the_surface() {
    let below_one = 1.0_f32.next_down();
    let ends = [0.0, f32::MIN_POSITIVE, 1.0 / 16_777_216.0, 0.25, 0.5, 0.75, below_one];
    let mut rng = Rng(43);
    let check = |n: Vec3<f32>, u: f32, v: f32| {
        let d = warp::sample_cosine_hemisphere(n, u, v);
        let cos = d.get(0).as_dvec3().dot(n.get(0).as_dvec3());
        assert!(cos > 0.0 && d.dot(n) > 0.0, "n {n:?}, u {u}, v {v}: cosine {cos:e}");
    };
    for _ in 0..DRAWS {
        let n = unit(&mut rng);
        check(n, random::uniform(rng.bits(), 0), random::uniform(rng.bits(), 0));
    }
    for axis in [[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, -0.0]] {
        let [x, y, z] = axis;
        for (u, v) in ends.into_iter().flat_map(|u| ends.map(|v| (u, v))) {
            check(Vec3::new(x, y, z), u, v);
            check(-Vec3::new(x, y, z), u, v);
        }
    }
    // The worst draws: the point on the sphere is opposite to the normal, or all but.
    for _ in 0..DRAWS / 4 {
        let (u, v) = (random::uniform::<f32>(rng.bits(), 0), random::uniform::<f32>(rng.bits(), 0));
        let opposite = -warp::sample_uniform_sphere(u, v);
        let nudge = (rng.in_cube() * rng.scale(1e-8, 1e-2)).as_vec3();
        let n = (opposite.get(0) + nudge).normalize();
        check(Vec3::splat(n), u, v);
    }
}

#[test]
fn unit_sphere_is_uniform_and_of_unit_length() {
    let mut spread = Spread([[0; Spread::BINS]; 3]);
    let mut sum = glam::DVec3::ZERO;
    for draw in 0..DRAWS as u32 {
        let key = random::path_key::<u32>(2, draw, 0);
        let p = warp::sample_uniform_sphere(random::uniform::<f32>(key, 9), random::uniform::<f32>(key, 10))
            .get(0)
            .as_dvec3();
        assert!((p.length() - 1.0).abs() < 1e-6);
        sum += p;
        spread.add(0.5 * p.z + 0.5, p.y.atan2(p.x) / TAU + 0.5);
    }
    let count = DRAWS as f64;
    // Each coordinate is uniform in [−1, 1]: variance 1/3.
    let mut deviations: Vec<f64> = (sum / (count / 3.0).sqrt()).to_array().into();
    deviations.extend(spread.deviations());
    assert!(deviations.iter().all(|deviation| deviation.abs() < allowed(6)), "{deviations:.1?}");
    // The ends of the square.
    let below_one = 1.0_f32.next_down();
    for u in [0.0, 1.0 / 16_777_216.0, 0.5, below_one] {
        for v in [0.0, 0.25, 0.5, below_one] {
            let p = warp::sample_uniform_sphere(u, v);
            assert!((p.dot(p) - 1.0).abs() < 1e-6, "u {u}, v {v}: {p:?}");
        }
    }
}

#[test]
fn basis_is_orthonormal_and_right_handed_for_every_normal() {
    let check = |n: Vec3<f32>| {
        let (tangent, bitangent) = warp::orthonormal_basis(n);
        let [t, b, n64] = [tangent, bitangent, n].map(|v| v.get(0).as_dvec3());
        let products = [t.dot(b), t.dot(n64), b.dot(n64)];
        let errors =
            [&products[..], &[t.length() - 1.0, b.length() - 1.0, (t.cross(b) - n64).length()]].concat();
        let error = errors.iter().fold(0.0_f64, |worst, error| worst.max(error.abs()));
        assert!(error < 1e-6, "n {n:?}: {errors:?}");
    };
    for z in [1.0, -1.0] {
        for zero in [[0.0, 0.0], [-0.0, 0.0], [0.0, -0.0], [-0.0, -0.0]] {
            check(Vec3::new(zero[0], zero[1], z));
            check(Vec3::new(zero[0], z, zero[1]));
            check(Vec3::new(z, zero[0], zero[1]));
        }
    }
    let mut rng = Rng(44);
    for _ in 0..DRAWS / 4 {
        check(unit(&mut rng));
        // Around the seam z = 0 and around the poles.
        let flat = glam::DVec3::new(rng.signed(), rng.signed(), rng.signed() * rng.scale(1e-30, 1e-2));
        if flat.length() > 0.1 {
            check(Vec3::splat(flat.normalize().as_vec3()));
        }
        let tilt = rng.scale(1e-12, 1e-1);
        let polar = glam::DVec3::new(tilt * rng.signed(), tilt * rng.signed(), [1.0, -1.0][rng.index(2)]);
        check(Vec3::splat(polar.normalize().as_vec3()));
    }
}

/// The azimuths of a path's light point, and azimuth and elevation of the direction that it goes on in: on a
/// floor below a lamp, in a dark ball.
#[test]
fn light_points_are_independent_of_scattered_directions() {
    let mut scene = floor(glam::Vec3::ZERO, 1.0);
    scene.materials.extend([lamp(1.0), Material { color: glam::Vec3::ZERO, ..material(Diffuse) }]);
    scene.spheres = vec![sphere(vec3(0.0, 4.0, 0.0), 1.0, 1), sphere(glam::Vec3::ZERO, 50.0, 2)];
    let methods = Methods { sampler: Sampler::Random, ..Methods::default() };
    let mut renderer = Renderer::new(&scene, Settings { methods, ..Settings::of(&scene) });
    let azimuth = |[x, _, z]: [f64; 3]| (z.atan2(x) / TAU + 0.5).min(1.0 - 1e-9);
    let (mut azimuths, mut elevations) = (Vec::new(), Vec::new());
    for (sample, (x, y)) in (0..64).flat_map(|sample| places([8, 8]).map(move |place| (sample, place))) {
        let path = renderer.path([x, y], sample);
        let [at, end] = [path[0].point, path[1].point].map(|point| Vec3::<f32>::splat(point.into()).get(0));
        let way = (end - at).as_dvec3().normalize();
        let light = azimuth(path[0].light_direction.expect("the lamp is seen").map(f64::from));
        azimuths.push((light, azimuth(way.to_array())));
        elevations.push((light, (way.y * way.y).min(1.0 - 1e-9)));
    }
    for pairs in [azimuths, elevations] {
        let found = [correlation(pairs.iter().copied()), joint(pairs.iter().copied())];
        assert!(found.iter().all(|deviation| deviation.abs() < allowed(4)), "{found:?} standard errors");
    }
}
