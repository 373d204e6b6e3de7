//! The kernels alone: every way to intersect spheres and triangles, at both widths, as the time of one test
//! of one ray against one primitive; and the numbers of both samplers, as the time of a pair for one path.
//!
//! Rays come in packets of neighbours, as cameras and mirrors make them; most tests miss, as they do in
//! scenes. Every lane's answer is used. Before a method is timed, its hits are counted: the same at both
//! widths, and as many as stated. No ray passes within 1e-6 of an edge, so that rounding decides nothing: the
//! counts are those of double precision.

use criterion::measurement::WallTime;
use criterion::{BenchmarkGroup, Criterion, Throughput};
use octray_engine::lane::{Bits, F32x8, Lane};
use octray_engine::sampling::{SampleValues, Sampler};
use octray_laboratory::measure::kernel_set::{self as set, Found, RAYS, TESTS};
use octray_laboratory::methods::{self, SphereMethod, TriangleMethod};
use std::hint::black_box;
use std::time::Duration;

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
    group.throughput(Throughput::Elements(TESTS as u64));
    spheres::<methods::Robust>(&mut group, "robust", 832);
    spheres::<methods::RobustAnyLength>(&mut group, "robust-any-length", 832);
    spheres::<methods::Naive>(&mut group, "naive", 832);
    group.finish();

    let mut group = criterion.benchmark_group("ray_triangle");
    group.throughput(Throughput::Elements(TESTS as u64));
    triangles::<methods::Woop>(&mut group, "woop", 519);
    triangles::<methods::WoopContracted>(&mut group, "woop-contracted", 519);
    triangles::<methods::MollerTrumbore>(&mut group, "moller-trumbore", 519);
    triangles::<methods::BaldwinWeber>(&mut group, "baldwin-weber", 519);
    triangles::<methods::Plucker>(&mut group, "plucker", 519);
    group.finish();

    let mut group = criterion.benchmark_group("sampler");
    group.throughput(Throughput::Elements(PAIRS));
    pairs(&mut group, "sobol", Sampler::Sobol);
    pairs(&mut group, "random", Sampler::Random);
    group.finish();

    criterion.final_summary();
}

fn spheres<S: SphereMethod>(group: &mut BenchmarkGroup<WallTime>, method: &str, expected_hits: usize) {
    let scene = set::spheres();
    let (wide, single) = (set::rays::<F32x8>(), set::rays::<f32>());
    let simd = || set::all_spheres::<F32x8, S>(black_box(&wide), black_box(&scene));
    let scalar = || set::all_spheres::<f32, S>(black_box(&single), black_box(&scene));
    measure(group, method, expected_hits, simd, scalar);
}

fn triangles<T: TriangleMethod>(group: &mut BenchmarkGroup<WallTime>, method: &str, expected_hits: usize) {
    let scene = set::triangles::<T>();
    let (wide, single) = (set::rays::<F32x8>(), set::rays::<f32>());
    let simd = || set::all_triangles::<F32x8, T>(black_box(&wide), black_box(&scene));
    let scalar = || set::all_triangles::<f32, T>(black_box(&single), black_box(&scene));
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

/// Times pairs of numbers for paths whose keys are given. Their sum must be that of uniform numbers, at both
/// widths.
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
        let numbers = SampleValues::new(sampler, 0, sample, black_box(16));
        for &key in keys {
            let (x, y) = numbers.at_keys::<L>(key).get_2d(2);
            sums = [sums[0] + x, sums[1] + y];
        }
    }
    (0..L::WIDTH).map(|lane| sums[0].get(lane) + sums[1].get(lane)).sum()
}
