//! Numbers from bits, and sums of many of them.

use super::{Bound, Dice, EPSILON, Method, Recipe, Tally};
use crate::camera::Tile;
use crate::film::TileSums;
use crate::sampling::random::unit_interval;

pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "numbers-top",
        title: "Numbers below 1 from 32 random bits, of which the largest are tried",
        axis: "2³² less the bits, at most",
        places: &[1.0, 16.0, 64.0, 128.0, 256.0, 1024.0, 1e5, 1e7, 4_294_967_296.0],
        failure: "the number is 1",
        error: Some("|Δ| in 2⁻²⁴"),
        source: "rounding to nearest, which is up for the largest",
        cases: 100_000,
        methods: &[
            Method::other("divided", |dice, x, cases| {
                top(dice, x, cases, |bits| bits as f32 / 4_294_967_296.0)
            }),
            Method::other("divided-in-f64", |dice, x, cases| {
                top(dice, x, cases, |bits| (f64::from(bits) / 4_294_967_296.0) as f32)
            }),
            Method::default("upper-24-bits", |dice, x, cases| top(dice, x, cases, unit_interval::<f32>)),
        ],
        // Cut off and not rounded: less than one step.
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
        failure: "off by more than a tenth, or no number",
        error: Some("|Δ| / sum"),
        source: KAHAN,
        cases: 200,
        methods: &[
            Method::other("f32", large::<Plain>),
            Method::other("f64", large::<Double>),
            Method::default("film", large::<OnFilm>),
        ],
        // A sum beyond single precision's 3.4e38 is infinite. Scenes hold no number above 1e18.
        bound: |magnitude| if magnitude < 1e35 { Bound::error(2.0 * EPSILON) } else { Bound::NONE },
    },
    Recipe {
        name: "sums-poisoned",
        title: "Means of 1,000 numbers, some of which are none: NaN and infinite",
        axis: "share of those that are none",
        places: &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5],
        failure: "the mean is no number, or what was left out is not what should be",
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

fn top(dice: &mut Dice, from_top: f64, cases: usize, number: fn(u32) -> f32) -> Tally {
    let mut tally = Tally::default();
    for _ in 0..cases {
        let bits = (4_294_967_295.0 - (dice.unit() * from_top).floor()) as u32;
        match number(bits) {
            x if x < 1.0 => tally.off_by((f64::from(x) * 16_777_216.0 - f64::from(bits) / 256.0).abs()),
            _ => tally.count(true),
        }
    }
    tally
}

/// A way to sum.
trait Sum {
    fn new() -> Self;
    fn add(&mut self, x: f32);
    fn get(&self) -> f64;
    /// How many numbers it left out.
    fn left_out(&self) -> usize {
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

/// The sum, and what it holds too much, which is forgotten at the end.
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

/// A tile of one pixel.
struct OnFilm(TileSums);
impl Sum for OnFilm {
    fn new() -> Self {
        Self(TileSums::new(Tile { number: 0, x: 0, y: 0, width: 1, height: 1 }))
    }
    fn add(&mut self, x: f32) {
        self.0.add([&[x; 8]; 3]);
    }
    fn get(&self) -> f64 {
        self.0.mean(0)[0] * (f64::from(self.0.samples) - self.left_out() as f64)
    }
    fn left_out(&self) -> usize {
        self.0.discarded() as usize
    }
}

/// How far off a sum is; a failure from a tenth on.
fn judge(tally: &mut Tally, sum: f64, truth: f64) {
    match (sum - truth).abs() / truth {
        error if error <= 0.1 => tally.off_by(error),
        // NaN too.
        _ => tally.count(true),
    }
}

/// Some thousand numbers again and again, so that making them takes no time.
fn long<S: Sum>(dice: &mut Dice, numbers: f64, cases: usize) -> Tally {
    const BLOCK: usize = 10_000;
    let mut tally = Tally::default();
    for _ in 0..cases {
        // Multiples of 2⁻²⁴ sum without error as whole numbers.
        let bits: Vec<u32> = (0..BLOCK.min(numbers as usize)).map(|_| dice.bits() >> 8).collect();
        let block: Vec<f32> = bits.iter().map(|&bits| bits as f32 / 16_777_216.0).collect();
        let (mut sum, times) = (S::new(), numbers as usize / block.len());
        for _ in 0..times {
            block.iter().for_each(|&x| sum.add(x));
        }
        let truth = bits.iter().map(|&bits| u64::from(bits)).sum::<u64>() * times as u64;
        judge(&mut tally, sum.get(), truth as f64 / 16_777_216.0);
    }
    tally
}

fn large<S: Sum>(dice: &mut Dice, magnitude: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    for _ in 0..cases {
        let (mut sum, mut truth) = (S::new(), 0.0);
        for _ in 0..4096 {
            let x = (magnitude * (1.0 + dice.unit())) as f32;
            sum.add(x);
            truth += f64::from(x);
        }
        judge(&mut tally, sum.get(), truth);
    }
    tally
}

fn poisoned<S: Sum>(dice: &mut Dice, share: f64, cases: usize) -> Tally {
    const NONE: [f32; 3] = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    let mut tally = Tally::default();
    for _ in 0..cases {
        let (mut sum, mut truth, mut none) = (S::new(), 0.0, 0);
        for _ in 0..1000 {
            if dice.unit() < share {
                sum.add(NONE[dice.index(3)]);
                none += 1;
            } else {
                let x = dice.unit() as f32;
                sum.add(x);
                truth += f64::from(x);
            }
        }
        // The mean is of those that were left, so both sums are over equally many.
        if sum.left_out() == none { judge(&mut tally, sum.get(), truth) } else { tally.count(true) }
    }
    tally
}
