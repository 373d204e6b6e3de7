//! Random numbers from bits, and sums of many numbers.

use super::methods::Method;
use super::recipe::{Bound, EPSILON, FailureCounts, Recipe};
use super::rng::Rng;
use crate::camera::Tile;
use crate::film::TileSums;
use crate::lane::NATIVE_WIDTH;
use crate::sampling::random::unit_interval;

pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "numbers-top",
        title: "Numbers below 1 from 32 random bits: the largest ones",
        axis: "largest difference of 2³² and the bits",
        places: &[1.0, 16.0, 64.0, 128.0, 256.0, 1024.0, 1e5, 1e7, 4_294_967_296.0],
        failure: "the number is 1",
        error: Some("|Δ| in 2⁻²⁴"),
        source: "rounding to nearest rounds the largest numbers up",
        cases: 100_000,
        methods: &[
            Method::other("divided", |rng, x, cases| {
                top(rng, x, cases, |bits| bits as f32 / 4_294_967_296.0)
            }),
            Method::other("divided-in-f64", |rng, x, cases| {
                top(rng, x, cases, |bits| (f64::from(bits) / 4_294_967_296.0) as f32)
            }),
            Method::default("upper-24-bits", |rng, x, cases| top(rng, x, cases, unit_interval::<f32>)),
        ],
        // Truncated, not rounded: less than one step.
        bound: |_| Bound::error(1.0),
    },
    Recipe {
        name: "sums-long",
        title: "Sums of numbers in [0, 1)",
        axis: "numbers",
        places: &[1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8],
        failure: "off by more than a tenth",
        error: Some("|Δ| / sum"),
        source: KAHAN,
        cases: 2,
        methods: &[
            Method::other("f32", long::<Plain>),
            Method::other("kahan", long::<Kahan>),
            Method::other("f64", long::<Double>),
            Method::default("film", long::<OnFilm>),
        ],
        bound: |_| Bound::error(2.0 * EPSILON),
    },
    Recipe {
        name: "sums-large",
        title: "Sums of 4,096 large numbers",
        axis: "magnitude",
        places: &[1e-30, 1e-15, 1.0, 1e15, 1e30, 1e34, 1e35, 1e36, 1e38],
        failure: "off by more than a tenth, or NaN",
        error: Some("|Δ| / sum"),
        source: KAHAN,
        cases: 200,
        methods: &[
            Method::other("f32", large::<Plain>),
            Method::other("f64", large::<Double>),
            Method::default("film", large::<OnFilm>),
        ],
        // A sum above the largest f32, 3.4e38, is infinite. Scenes hold no number above 1e18.
        bound: |magnitude| if magnitude < 1e35 { Bound::error(2.0 * EPSILON) } else { Bound::NONE },
    },
    Recipe {
        name: "sums-poisoned",
        title: "Means of 1,000 numbers, some of which are NaN or infinite",
        axis: "share of NaN and infinities",
        places: &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5],
        failure: "the mean is not finite, or the number of discarded values is wrong",
        error: Some("|Δ| / mean of the others"),
        source: "x + NaN = NaN",
        cases: 2_000,
        methods: &[
            Method::other("f32", poisoned::<Plain>),
            Method::other("f64", poisoned::<Double>),
            Method::default("film", poisoned::<OnFilm>),
        ],
        bound: |_| Bound::error(2.0 * EPSILON),
    },
];

const KAHAN: &str = "Kahan, Further remarks on reducing truncation errors, CACM 8(1), 1965";

fn top(rng: &mut Rng, from_top: f64, cases: usize, number: fn(u32) -> f32) -> FailureCounts {
    let mut counts = FailureCounts::default();
    for _ in 0..cases {
        let bits = (4_294_967_295.0 - (rng.unit() * from_top).floor()) as u32;
        match number(bits) {
            x if x < 1.0 => {
                counts.record_error((f64::from(x) * 16_777_216.0 - f64::from(bits) / 256.0).abs())
            }
            _ => counts.record(true),
        }
    }
    counts
}

/// A method of summation.
trait Sum {
    fn new() -> Self;
    fn add(&mut self, x: f32);
    fn get(&self) -> f64;
    /// Number of discarded values.
    fn discarded(&self) -> usize {
        0
    }
}

struct Plain(f32);
impl Sum for Plain {
    fn new() -> Self {
        Self(0.0)
    }
    fn add(&mut self, x: f32) {
        self.0 += x;
    }
    fn get(&self) -> f64 {
        f64::from(self.0)
    }
}

struct Double(f64);
impl Sum for Double {
    fn new() -> Self {
        Self(0.0)
    }
    fn add(&mut self, x: f32) {
        self.0 += f64::from(x);
    }
    fn get(&self) -> f64 {
        self.0
    }
}

/// The sum, and its excess, which the next addition subtracts. The last excess is ignored.
struct Kahan(f32, f32);
impl Sum for Kahan {
    fn new() -> Self {
        Self(0.0, 0.0)
    }
    fn add(&mut self, x: f32) {
        let x = x - self.1;
        let sum = self.0 + x;
        self.1 = (sum - self.0) - x;
        self.0 = sum;
    }
    fn get(&self) -> f64 {
        f64::from(self.0)
    }
}

/// The film: a tile of one pixel.
struct OnFilm(TileSums);
impl Sum for OnFilm {
    fn new() -> Self {
        Self(TileSums::new(Tile { number: 0, x: 0, y: 0, width: 1, height: 1 }))
    }
    fn add(&mut self, x: f32) {
        self.0.add([&[x; NATIVE_WIDTH]; 3]);
    }
    fn get(&self) -> f64 {
        self.0.mean(0)[0] * (f64::from(self.0.samples) - self.discarded() as f64)
    }
    fn discarded(&self) -> usize {
        self.0.discarded() as usize
    }
}

/// Records the relative error of a sum; above a tenth, a failure.
fn record_sum(counts: &mut FailureCounts, sum: f64, expected: f64) {
    match (sum - expected).abs() / expected {
        error if error <= 0.1 => counts.record_error(error),
        // Also NaN.
        _ => counts.record(true),
    }
}

/// Repeats a block of 10,000 numbers, as generating all takes too long.
fn long<S: Sum>(rng: &mut Rng, numbers: f64, cases: usize) -> FailureCounts {
    const BLOCK: usize = 10_000;
    let mut counts = FailureCounts::default();
    for _ in 0..cases {
        // Multiples of 2⁻²⁴ sum without error as whole numbers.
        let bits: Vec<u32> = (0..BLOCK.min(numbers as usize)).map(|_| rng.bits() >> 8).collect();
        let block: Vec<f32> = bits.iter().map(|&bits| bits as f32 / 16_777_216.0).collect();
        let (mut sum, times) = (S::new(), numbers as usize / block.len());
        for _ in 0..times {
            block.iter().for_each(|&x| sum.add(x));
        }
        let expected = bits.iter().map(|&bits| u64::from(bits)).sum::<u64>() * times as u64;
        record_sum(&mut counts, sum.get(), expected as f64 / 16_777_216.0);
    }
    counts
}

fn large<S: Sum>(rng: &mut Rng, magnitude: f64, cases: usize) -> FailureCounts {
    let mut counts = FailureCounts::default();
    for _ in 0..cases {
        let (mut sum, mut expected) = (S::new(), 0.0);
        for _ in 0..4096 {
            let x = (magnitude * (1.0 + rng.unit())) as f32;
            sum.add(x);
            expected += f64::from(x);
        }
        record_sum(&mut counts, sum.get(), expected);
    }
    counts
}

fn poisoned<S: Sum>(rng: &mut Rng, share: f64, cases: usize) -> FailureCounts {
    const INVALID: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let mut counts = FailureCounts::default();
    for _ in 0..cases {
        let (mut sum, mut expected, mut invalid) = (S::new(), 0.0, 0);
        for _ in 0..1000 {
            if rng.unit() < share {
                sum.add(INVALID[rng.index(3)]);
                invalid += 1;
            } else {
                let x = rng.unit() as f32;
                sum.add(x);
                expected += f64::from(x);
            }
        }
        // The mean is that of the values that are kept.
        if sum.discarded() == invalid {
            record_sum(&mut counts, sum.get(), expected)
        } else {
            counts.record(true)
        }
    }
    counts
}
