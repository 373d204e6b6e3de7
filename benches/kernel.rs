//! The kernels alone: every way to intersect spheres and triangles, at both widths, as the time of one test of one ray
//! against one primitive; and the numbers of both samplers, as the time of a pair for one path.
//!
//! Rays come in packets of neighbours, as cameras and mirrors make them; most tests miss, as they do in scenes. Every
//! lane's answer is used. Before a method is timed, its hits are counted: the same at both widths, and as many as stated. No ray passes
//! within 1e-6 of an edge, so that rounding decides nothing: the counts are those of double precision.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput};
use glam::Vec3 as Point;
use octray::kernel::ray_sphere::{self, SphereMethod};
use octray::kernel::ray_triangle::{self, TriangleMethod};
use octray::lane::{Bits, F32x8, Lane, Mask};
use octray::math::{Ray, Vec3};
use octray::sampling::{Numbers, Sampler};
use std::hint::black_box;
use std::time::Duration;

/// Rays: 64 packets of eight.
const RAYS: usize = 512;
/// Primitives of each kind: what a small scene holds; all of them stay in the first-level cache.
const PRIMITIVES: usize = 64;
const TESTS: u64 = (RAYS * PRIMITIVES) as u64;
/// Samples for which each ray's path draws a pair of numbers.
const SAMPLES: u32 = 64;
const PAIRS: u64 = RAYS as u64 * SAMPLES as u64;

fn main() {
    let mut criterion = Criterion::default()
        .sample_size(30)
        .warm_up_time(Duration::from_millis(300))
        .measurement_time(Duration::from_millis(800))
        .configure_from_args();

    let mut group = criterion.benchmark_group("ray_sphere");
    group.throughput(Throughput::Elements(TESTS));
    spheres::<ray_sphere::Robust>(&mut group, "robust", 832);
    spheres::<ray_sphere::RobustAnyLength>(&mut group, "robust-any-length", 832);
    spheres::<ray_sphere::Naive>(&mut group, "naive", 832);
    group.finish();

    let mut group = criterion.benchmark_group("ray_triangle");
    group.throughput(Throughput::Elements(TESTS));
    triangles::<ray_triangle::Woop>(&mut group, "woop", 519);
    triangles::<ray_triangle::WoopContracted>(&mut group, "woop-contracted", 519);
    triangles::<ray_triangle::MollerTrumbore>(&mut group, "moller-trumbore", 519);
    triangles::<ray_triangle::BaldwinWeber>(&mut group, "baldwin-weber", 519);
    triangles::<ray_triangle::Plucker>(&mut group, "plucker", 519);
    group.finish();

    let mut group = criterion.benchmark_group("sampler");
    group.throughput(Throughput::Elements(PAIRS));
    pairs(&mut group, "sobol", Sampler::Sobol);
    pairs(&mut group, "random", Sampler::Random);
    group.finish();

    criterion.final_summary();
}

/// What all tests of a set found.
#[derive(Clone, Copy, Debug)]
struct Found {
    hits: usize,
    /// Sum of t over the hits.
    distance: f32,
}

fn spheres<S: SphereMethod>(group: &mut BenchmarkGroup<WallTime>, method: &str, expected_hits: usize) {
    let scene: Vec<(Point, f32)> = (0..PRIMITIVES as u32).map(sphere).collect();
    let (wide, single) = (rays::<F32x8>(), rays::<f32>());
    let simd = || all_spheres::<F32x8, S>(black_box(&wide), black_box(&scene));
    let scalar = || all_spheres::<f32, S>(black_box(&single), black_box(&scene));
    measure(group, method, expected_hits, simd, scalar);
}

fn triangles<T: TriangleMethod>(group: &mut BenchmarkGroup<WallTime>, method: &str, expected_hits: usize) {
    let scene: Vec<T::Stored> = (0..PRIMITIVES as u32).map(triangle).map(T::store).collect();
    let (wide, single) = (rays::<F32x8>(), rays::<f32>());
    let simd = || all_triangles::<F32x8, T>(black_box(&wide), black_box(&scene));
    let scalar = || all_triangles::<f32, T>(black_box(&single), black_box(&scene));
    measure(group, method, expected_hits, simd, scalar);
}

/// Checks what both widths find, then times them.
///
/// # Panics
/// If the hits are not those expected.
fn measure(
    group: &mut BenchmarkGroup<WallTime>,
    method: &str,
    expected_hits: usize,
    simd: impl Fn() -> Found,
    scalar: impl Fn() -> Found,
) {
    let (of_simd, of_scalar) = (simd(), scalar());
    assert_eq!(of_simd.hits, of_scalar.hits, "{method}: SIMD and scalar hit differently");
    assert_eq!(of_simd.hits, expected_hits, "{method}: hits found, and hits expected of {TESTS} tests");
    // The sums differ by their order alone.
    let difference = (of_simd.distance - of_scalar.distance).abs();
    assert!(difference <= 1e-4 * of_scalar.distance, "{method}: {of_simd:?}, {of_scalar:?}");
    group.bench_function(format!("{method}/simd"), |bencher| bencher.iter(&simd));
    group.bench_function(format!("{method}/scalar"), |bencher| bencher.iter(&scalar));
}

fn all_spheres<L: Lane, S: SphereMethod>(rays: &[Ray<L>], spheres: &[(Point, f32)]) -> Found {
    let mut tally = Tally::new();
    for ray in rays {
        let prepared = S::prepare(ray);
        for &(center, radius2) in spheres {
            let (mask, t) =
                S::test(&prepared, Vec3::splat(center), L::splat(radius2), L::splat(f32::INFINITY));
            tally.add(mask, t);
        }
    }
    tally.found()
}

fn all_triangles<L: Lane, T: TriangleMethod>(rays: &[Ray<L>], triangles: &[T::Stored]) -> Found {
    let mut tally = Tally::new();
    for ray in rays {
        let prepared = T::prepare(ray);
        for triangle in triangles {
            let hit = T::test(&prepared, triangle, L::splat(f32::INFINITY));
            tally.add(hit.mask, hit.t);
        }
    }
    tally.found()
}

/// Times pairs of numbers for paths whose keys are given. Their sum must be that of uniform numbers, at both widths.
///
/// # Panics
/// If it is not.
fn pairs(group: &mut BenchmarkGroup<WallTime>, name: &str, sampler: Sampler) {
    let (wide, single) = (keys::<F32x8>(), keys::<f32>());
    let simd = || all_pairs::<F32x8>(sampler, black_box(&wide));
    let scalar = || all_pairs::<f32>(sampler, black_box(&single));
    for sum in [simd(), scalar()] {
        // Independent numbers repeat from sample to sample: their keys are the same.
        let standard_error = (1.0 / 12.0 / (2 * RAYS) as f32).sqrt();
        let mean = sum / (2 * PAIRS) as f32;
        assert!((mean - 0.5).abs() < 4.5 * standard_error, "{name}: numbers of mean {mean}");
    }
    group.bench_function(format!("{name}/simd"), |bencher| bencher.iter(simd));
    group.bench_function(format!("{name}/scalar"), |bencher| bencher.iter(scalar));
}

fn keys<L: Lane>() -> Vec<L::Bits> {
    let lanes = |packet: usize| L::Bits::from_fn(|lane| (packet * L::WIDTH + lane) as u32);
    (0..RAYS / L::WIDTH).map(|packet| Sampler::Sobol.key(0, lanes(packet), 0)).collect()
}

fn all_pairs<L: Lane>(sampler: Sampler, keys: &[L::Bits]) -> f32 {
    let mut sums = [L::zero(); 2];
    for sample in 0..SAMPLES {
        // A number that the compiler does not see through, as in a path.
        let numbers = Numbers::new(sampler, 0, sample, black_box(8));
        for &key in keys {
            let (x, y) = numbers.pair::<L>(key, 2);
            sums = [sums[0] + x, sums[1] + y];
        }
    }
    (0..L::WIDTH).map(|lane| sums[0].get(lane) + sums[1].get(lane)).sum()
}

/// Uses every lane of every answer.
struct Tally<L> {
    hits: usize,
    distance: L,
}

impl<L: Lane> Tally<L> {
    fn new() -> Self {
        Self { hits: 0, distance: L::zero() }
    }
    #[inline(always)]
    fn add(&mut self, mask: L::Mask, t: L) {
        self.hits += mask.count();
        self.distance = self.distance + L::select(mask, t, L::zero());
    }
    fn found(&self) -> Found {
        let distance = (0..L::WIDTH).map(|lane| self.distance.get(lane)).sum();
        Found { hits: self.hits, distance }
    }
}

/// Number `number` of item `item`, uniform in [0, 1): the same in every run, however the program makes its own (SplitMix64's mixer).
fn random(item: u32, number: u32) -> f32 {
    let mut x =
        (u64::from(item) << 32 | u64::from(number)).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x >> 40) as f32 / (1 << 24) as f32
}

/// A point in the cube [−1, 1]³, from three numbers.
fn point(item: u32, first: u32) -> Point {
    Point::from_array(std::array::from_fn(|axis| 2.0 * random(item, first + axis as u32) - 1.0))
}

/// The rays in packets: from outside through the cube of primitives, eight neighbours a packet.
fn rays<L: Lane>() -> Vec<Ray<L>> {
    let ray = |index: usize| {
        // Far above the primitives' items.
        let (packet, lane) = ((1 << 16) + (index / F32x8::WIDTH) as u32, (1 << 17) + index as u32);
        let origin = 4.0 * (point(packet, 0) + Point::splat(1e-3)).normalize();
        (origin, (point(packet, 3) + 0.05 * point(lane, 0) - origin).normalize())
    };
    (0..RAYS / L::WIDTH)
        .map(|packet| {
            let lanes = |of: &dyn Fn(usize) -> Point| {
                let component = |axis: usize| L::from_fn(|lane| of(packet * L::WIDTH + lane)[axis]);
                Vec3::new(component(0), component(1), component(2))
            };
            Ray { origin: lanes(&|index| ray(index).0), direction: lanes(&|index| ray(index).1) }
        })
        .collect()
}

/// A sphere in the cube: centre and squared radius.
fn sphere(index: u32) -> (Point, f32) {
    let radius = 0.05 + 0.25 * random(index, 3);
    (point(index, 0), radius * radius)
}

/// A triangle in the cube.
fn triangle(index: u32) -> [Point; 3] {
    let center = point(index, 0);
    [3, 6, 9].map(|first| center + 0.5 * point(index, first))
}
