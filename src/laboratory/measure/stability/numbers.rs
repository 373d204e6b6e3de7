//! Random numbers from bits, and sums of many numbers.

use super::rng::Rng;
use super::test_case::{Bound, EPSILON, FAILED, FailureCounts, TestCase, compare};
use crate::camera::Tile;
use crate::film::TileSums;
use crate::lane::NATIVE_WIDTH;
use crate::sampling::random::unit_interval;

pub(super) fn test_cases() -> Vec<TestCase> {
    vec![
        TestCase {
            name: "uniform-largest",
            title: "Numbers below 1 from 32 random bits: the largest ones",
            axis: "largest difference of 2³² and the bits",
            places: &[1.0, 16.0, 64.0, 128.0, 256.0, 1024.0, 1e5, 1e7, 4_294_967_296.0],
            failure: "the number is 1",
            error: Some("|Δ| in 2⁻²⁴"),
            source: "rounding to nearest rounds the largest numbers up",
            methods: compare(
                top,
                &[
                    ("divided", |bits| bits as f32 / 4_294_967_296.0),
                    ("divided-in-f64", |bits| (f64::from(bits) / 4_294_967_296.0) as f32),
                    ("upper-24-bits", unit_interval::<f32>),
                ],
            ),
            // Truncated, not rounded: less than one step.
            bound: |_| Bound::error(1.0),
            ..TestCase::COMMON
        },
        TestCase {
            name: "sums-long",
            title: "Sums of numbers in [0, 1)",
            axis: "numbers",
            places: &[1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8],
            failure: "off by more than a tenth",
            error: Some("|Δ| / sum"),
            source: KAHAN,
            inputs: 2,
            methods: compare(long, &[("f32", plain), ("kahan", kahan), ("f64", double), ("film", on_film)]),
            bound: |_| Bound::error(2.0 * EPSILON),
        },
        TestCase {
            name: "sums-large",
            title: "Sums of 4,096 large numbers",
            axis: "magnitude",
            places: &[1e-30, 1e-15, 1.0, 1e15, 1e30, 1e34, 1e35, 1e36, 1e38],
            failure: "off by more than a tenth, or NaN",
            error: Some("|Δ| / sum"),
            source: KAHAN,
            inputs: 200,
            methods: compare(large, &[("f32", plain), ("f64", double), ("film", on_film)]),
            // A sum above the largest f32, 3.4e38, is infinite. Scenes hold no number above 1e18.
            bound: |magnitude| if magnitude < 1e35 { Bound::error(2.0 * EPSILON) } else { Bound::NONE },
        },
        TestCase {
            name: "sums-nan",
            title: "Means of 1,000 numbers, some of which are NaN or infinite",
            axis: "share of NaN and infinities",
            places: &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5],
            failure: "the mean is not finite, or the number of discarded values is wrong",
            error: Some("|Δ| / mean of the others"),
            source: "x + NaN = NaN",
            inputs: 2_000,
            methods: compare(poisoned, &[("f32", plain), ("f64", double), ("film", on_film)]),
            bound: |_| Bound::error(2.0 * EPSILON),
        },
    ]
}

const KAHAN: &str = "Kahan, Further remarks on reducing truncation errors, CACM 8(1), 1965";

fn top(rng: &mut Rng, from_top: f64, counts: &mut FailureCounts, number: fn(u32) -> f32) {
    let bits = (4_294_967_295.0 - (rng.unit() * from_top).floor()) as u32;
    let x = number(bits);
    let error = (f64::from(x) * 16_777_216.0 - f64::from(bits) / 256.0).abs();
    counts.record_error(if x < 1.0 { error } else { FAILED });
}

/// The sum of some repetitions of a block of numbers, and how many numbers were discarded.
type Sum = fn(&[f32], usize) -> (f64, u64);

fn repeated(block: &[f32], times: usize) -> impl Iterator<Item = f32> {
    (0..times).flat_map(|_| block.iter().copied())
}

fn plain(block: &[f32], times: usize) -> (f64, u64) {
    (f64::from(repeated(block, times).sum::<f32>()), 0)
}

fn double(block: &[f32], times: usize) -> (f64, u64) {
    (repeated(block, times).map(f64::from).sum(), 0)
}

/// Carries the excess of the sum, which the next addition subtracts. The last excess is ignored.
fn kahan(block: &[f32], times: usize) -> (f64, u64) {
    let (mut sum, mut excess) = (0.0_f32, 0.0);
    for x in repeated(block, times) {
        let x = x - excess;
        let next = sum + x;
        (sum, excess) = (next, (next - sum) - x);
    }
    (f64::from(sum), 0)
}

/// Returns the film: a tile of one pixel.
fn on_film(block: &[f32], times: usize) -> (f64, u64) {
    let mut sums = TileSums::new(Tile { number: 0, x: 0, y: 0, width: 1, height: 1 });
    repeated(block, times).for_each(|x| sums.add([&[x; NATIVE_WIDTH]; 3]));
    let discarded = sums.discarded();
    (sums.mean(0)[0] * (f64::from(sums.samples) - discarded as f64), discarded)
}

/// Records the relative error of a sum; above a tenth, or NaN, a failure.
fn record_sum(counts: &mut FailureCounts, sum: f64, expected: f64) {
    let error = (sum - expected).abs() / expected;
    counts.record_error(if error <= 0.1 { error } else { FAILED });
}

/// Repeats a block of 10,000 numbers, as generating all takes too long.
fn long(rng: &mut Rng, numbers: f64, counts: &mut FailureCounts, sum: Sum) {
    const BLOCK: usize = 10_000;
    // Multiples of 2⁻²⁴ sum without error as whole numbers.
    let bits: Vec<u32> = (0..BLOCK.min(numbers as usize)).map(|_| rng.bits() >> 8).collect();
    let block: Vec<f32> = bits.iter().map(|&bits| bits as f32 / 16_777_216.0).collect();
    let times = numbers as usize / block.len();
    let expected = bits.iter().map(|&bits| u64::from(bits)).sum::<u64>() * times as u64;
    record_sum(counts, sum(&block, times).0, expected as f64 / 16_777_216.0);
}

fn large(rng: &mut Rng, magnitude: f64, counts: &mut FailureCounts, sum: Sum) {
    let numbers = [(); 4096].map(|()| (magnitude * (1.0 + rng.unit())) as f32);
    record_sum(counts, sum(&numbers, 1).0, numbers.map(f64::from).iter().sum());
}

fn poisoned(rng: &mut Rng, share: f64, counts: &mut FailureCounts, sum: Sum) {
    const INVALID: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let numbers =
        [(); 1000].map(|()| if rng.unit() < share { INVALID[rng.index(3)] } else { rng.unit() as f32 });
    let valid = numbers.into_iter().filter(|x| x.is_finite()).map(f64::from);
    let (seen, discarded) = sum(&numbers, 1);
    // The mean is that of the values that are kept.
    let kept = 1000 - discarded as usize == valid.clone().count();
    record_sum(counts, if kept { seen } else { FAILED }, valid.sum());
}
