//! The law of sample values. Of both samplers: each point is uniform; pixels, pairs and seeds have nothing in
//! common. Of Sobol points: nets in every pixel and pair of dimensions; errors of integrals as small as a
//! true Owen scrambling makes them.
//!
//! Seeds are fixed; tolerances are standard errors, as in `tests/laws/sampling_laws.rs`. Bits at width 1 and
//! 8 are compared by `tests/laws/lane_parity.rs`.

use crate::common::statistics::{allowed, assert_all_within, chi_squared_deviation, correlation, joint};
use crate::common::*;
use octray::lane::lane_indices;
use octray::sampling::{PacketValues, PixelCoordinates, SampleValues, blue_noise, dimension, random};
use std::f64::consts::FRAC_PI_4;

type Point = [f64; 2];

fn point(sampler: Sampler, seed: u32, pixel: u32, sample: u32, dimension: u32) -> Point {
    let key = sampler.key::<u32>(seed, pixel, sample);
    let values = SampleValues::new(sampler, seed, sample, dimension);
    let (x, y) = in_pixel(&values, key, pixel, dimension).get_2d(0);
    [f64::from(x), f64::from(y)]
}

/// The values of a pixel of a picture [`WIDTH`] pixels wide, before or after the first bounce.
fn in_pixel(values: &SampleValues, key: u32, pixel: u32, dimension: u32) -> PacketValues<'_, f32> {
    if is_shared(Sampler::Sobol, dimension) {
        values.at_pixels(key, PixelCoordinates::Block { x: pixel % WIDTH, y: pixel / WIDTH })
    } else {
        values.at_keys(key)
    }
}

/// Tests whether neighbours share a net in this dimension: their errors depend on each other, as they should.
fn is_shared(sampler: Sampler, dimension: u32) -> bool {
    sampler == Sampler::Sobol && dimension < dimension::bounce(1)
}

/// The samplers, each with the dimensions in which neighbours share no net.
fn independent_pairs() -> impl Iterator<Item = (Sampler, u32)> {
    let all =
        [Sampler::Sobol, Sampler::Random].into_iter().flat_map(|sampler| pairs().map(move |d| (sampler, d)));
    all.filter(|&(sampler, dimension)| !is_shared(sampler, dimension))
}

/// The first points of one pixel: all pixels of a seed share what lies behind their points, and its luck.
fn points(sampler: Sampler, seed: u32, dimension: u32, count: u32) -> Vec<Point> {
    (0..count).map(|sample| point(sampler, seed, 9, sample, dimension)).collect()
}

/// Where pairs begin: in the pixel, and those of some scattering events.
fn pairs() -> impl Iterator<Item = u32> + Clone {
    let event = |bounce| {
        [dimension::LOBE, dimension::DIRECTION, dimension::LIGHT_POINT]
            .map(|of| dimension::bounce(bounce) + of)
    };
    [dimension::PIXEL].into_iter().chain([0, 1, 5].into_iter().flat_map(event))
}

/// Is there one point of these 2ᵏ in every box of area 2⁻ᵏ that halvings of the square make?
fn is_net(points: &[Point]) -> bool {
    let k = points.len().ilog2();
    (0..=k).all(|along_x| {
        let (columns, rows) = (1 << along_x, 1 << (k - along_x));
        let mut taken = vec![false; points.len()];
        points.iter().all(|[x, y]| {
            let cell = (x * f64::from(columns)) as usize * rows as usize + (y * f64::from(rows)) as usize;
            !std::mem::replace(&mut taken[cell], true)
        })
    })
}

/// The textbook: Sobol's matrices column by column, and Owen's scrambling digit by digit, each flip drawn for
/// itself.
mod textbook {
    use super::{Point, Rng};

    /// Flips each digit of the fraction `x` / 2³² by a bit that is drawn for the digits before it.
    fn scramble(x: u32, seed: u64) -> u32 {
        (0..32).fold(0, |scrambled, digit| {
            let before = u64::from(x) >> (32 - digit);
            let place = (before << 6 | digit).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            let flip = Rng((seed ^ place ^ place >> 29) | 1).bits() >> 31;
            scrambled << 1 | (x >> (31 - digit) & 1 ^ flip)
        })
    }

    pub fn points(rng: &mut Rng, count: u32) -> Vec<Point> {
        // Direction numbers: of the first dimension single digits, of the second those of the polynomial x +
        // 1.
        let mut columns = [[1u32 << 31; 2]; 32];
        for j in 1..32 {
            columns[j] = [columns[j - 1][0] >> 1, columns[j - 1][1] ^ columns[j - 1][1] >> 1];
        }
        let [order, along_x, along_y] =
            std::array::from_fn(|_| u64::from(rng.bits()) << 32 | u64::from(rng.bits()));
        let point = |sample| {
            let index = scramble(sample, order);
            let chosen = (0..32).filter(|j| index >> j & 1 == 1).map(|j| columns[j as usize]);
            let [x, y] = chosen.fold([0; 2], |[x, y], [a, b]| [x ^ a, y ^ b]);
            [scramble(x, along_x), scramble(y, along_y)].map(|x| f64::from(x) / 2f64.powi(32))
        };
        (0..count).map(point).collect()
    }
}

#[test]
fn prefixes_and_blocks_of_samples_are_nets_in_every_pixel_and_pair() {
    for seed in [0, 1, 0xffff_ffff] {
        for pixel in [0, 1, 2, 239, 240, 12_345, u32::MAX] {
            for dimension in pairs() {
                for start in [0, 1024 * 77_777, u32::MAX - 1023] {
                    let points: Vec<Point> =
                        (0..1024).map(|s| point(Sampler::Sobol, seed, pixel, start + s, dimension)).collect();
                    let at = format!("seed {seed}, pixel {pixel}, dimension {dimension}, from {start} on");
                    (0..=10).for_each(|k| assert!(points.chunks_exact(1 << k).all(is_net), "{at}: k {k}"));
                }
            }
        }
    }
    // The measure itself: what the textbook says are nets, and what are none.
    let mut rng = Rng(51);
    let points = textbook::points(&mut rng, 1024);
    assert!((0..=10).all(|k| points.chunks_exact(1 << k).all(is_net)));
    assert!(!is_net(&self::points(Sampler::Random, 7, 0, 64)));
}

/// Pixels over which single samples are counted.
const PIXELS: u32 = 16_384;
const WIDTH: u32 = 240;

#[test]
fn each_sample_is_uniform_over_pixels_in_every_digit() {
    let mut deviations = Vec::new();
    for (sampler, dimension) in independent_pairs() {
        for sample in [0, 1, 6, 100, 4095] {
            let of_pixels: Vec<Point> =
                (0..PIXELS).map(|pixel| point(sampler, 3, pixel, sample, dimension)).collect();
            for axis in [0, 1] {
                let mut counts = [0; 64];
                of_pixels.iter().for_each(|point| counts[(point[axis] * 64.0) as usize] += 1);
                let at = format!("{sampler:?}, dimension {}, sample {sample}", dimension + axis as u32);
                let chi2 = chi_squared_deviation(&counts, f64::from(PIXELS) / 64.0);
                deviations.push((chi2, format!("χ² of {at}")));
                deviations.extend(bits_that_are_set(&of_pixels, axis, &at));
            }
            let both = joint(of_pixels.iter().map(|&[x, y]| (x, y)));
            let what = format!("{sampler:?}, both numbers of dimension {dimension}, sample {sample}");
            deviations.push((both, what));
        }
    }
    assert_all_within(deviations);
}

/// The deviations of each bit of one of the two numbers of some points from half of the time.
fn bits_that_are_set(points: &[Point], axis: usize, of: &str) -> Vec<(f64, String)> {
    let mut set = [0u32; 24];
    for point in points {
        let integer = (point[axis] * 16_777_216.0) as u32;
        set.iter_mut().enumerate().for_each(|(bit, set)| *set += integer >> bit & 1);
    }
    let n = points.len() as f64;
    let off = |(bit, set)| ((f64::from(set) - 0.5 * n) / (0.25 * n).sqrt(), format!("bit {bit} of {of}"));
    set.into_iter().enumerate().map(off).collect()
}

#[test]
fn pixels_pairs_and_seeds_have_nothing_in_common() {
    let mut deviations = Vec::new();
    let mut check = |what: String, of: &dyn Fn(u32) -> (f64, f64)| {
        deviations.push((correlation((0..PIXELS).map(of)), format!("correlation of {what}")));
        deviations.push((joint((0..PIXELS).map(of)), format!("joint distribution of {what}")));
    };
    for sampler in [Sampler::Sobol, Sampler::Random] {
        let number = |seed: u32, pixel: u32, sample: u32, dimension: u32| {
            point(sampler, seed, pixel, sample, dimension & !1)[(dimension & 1) as usize]
        };
        let used: Vec<u32> = pairs().flat_map(|first| [first, first + 1]).collect();
        for (i, &d) in used.iter().enumerate() {
            // The same sample of neighbours, and the next sample: frames of one sample each, shown one after
            // the other.
            for (s, t) in [(0, 0), (5, 5), (0, 1), (5, 6), (6, 14)] {
                if is_shared(sampler, d) {
                    continue;
                }
                let at = format!("{sampler:?}, dimension {d}, samples {s} and {t}");
                check(format!("{at}, in a row"), &|p| (number(5, p, s, d), number(5, p + 1, t, d)));
                check(format!("{at}, in a column"), &|p| (number(5, p, s, d), number(5, p + WIDTH, t, d)));
                check(format!("{at}, of successive seeds"), &|p| (number(5, p, s, d), number(6, p, t, d)));
                // The samples of a pixel are a net of Sobol points.
                if sampler == Sampler::Random && s != t {
                    check(format!("{at}, of a pixel"), &|p| (number(5, p, s, d), number(5, p, t, d)));
                }
            }
            for &e in &used[i + 1..] {
                // Those of one net: `pairs_of_a_block_of_pixels_meet_as_independent_orders_do`.
                if !(is_shared(sampler, d) && is_shared(sampler, e)) {
                    let what = format!("{sampler:?}, dimensions {d} and {e}");
                    check(what, &|p| (number(5, p, 3, d), number(5, p, 3, e)));
                }
            }
        }
    }
    assert_all_within(deviations);
}

/// A function on the square: its name, itself, its integral.
type Integrand = (&'static str, fn(Point) -> f64, f64);

const FUNCTIONS: [Integrand; 3] = [
    ("smooth", |[x, y]| (-x * x - y * y).exp(), 0.557_746_285_351_034_2),
    ("disc", |[x, y]| f64::from(u8::from(x * x + y * y < 1.0)), FRAC_PI_4),
    ("edge", |[x, y]| f64::from(u8::from(x + 0.37 * y < 0.6)), 0.415),
];

/// Mean and mean square of the error of a mean over the points of each of `pixels` pixels.
fn errors(
    pixels: u32,
    f: fn(Point) -> f64,
    integral: f64,
    mut points: impl FnMut(u32) -> Vec<Point>,
) -> [f64; 2] {
    let mut sums = [0.0; 2];
    for pixel in 0..pixels {
        let points = points(pixel);
        let error = points.iter().map(|&point| f(point)).sum::<f64>() / points.len() as f64 - integral;
        sums[0] += error;
        sums[1] += error * error;
    }
    sums.map(|sum| sum / f64::from(pixels))
}

#[test]
fn integrals_are_as_good_as_a_true_owen_scrambling_makes_them() {
    const PIXELS: u32 = 4000;
    let mut rng = Rng(52);
    // Least gains. Measured with the textbook's points and 20,000 pixels: 8.8, 2.6, 3.9; 155, 3.6, 7.1; 2020,
    // 7.8, 14; 28,600, 15, 29.
    for (count, least) in [
        (11, [7.0, 2.1, 2.1]),
        (16, [120.0, 3.0, 5.7]),
        (64, [1600.0, 6.3, 11.0]),
        (256, [22_000.0, 12.0, 23.0]),
    ] {
        let of_textbook: Vec<Vec<Point>> =
            (0..PIXELS / 2).map(|_| textbook::points(&mut rng, count)).collect();
        for ((name, f, integral), least) in FUNCTIONS.into_iter().zip(least) {
            let of = |sampler| errors(PIXELS, f, integral, |seed| points(sampler, seed, 10, count));
            let (sobol, random) = (of(Sampler::Sobol), of(Sampler::Random));
            let textbook = errors(PIXELS / 2, f, integral, |pixel| of_textbook[pixel as usize].clone());
            let bias = sobol[0] / (sobol[1] / f64::from(PIXELS)).sqrt();
            let (gain, loss) = (random[1] / sobol[1], sobol[1] / textbook[1]);
            let what = format!("{name}, {count} samples");
            assert!(bias.abs() < allowed(12), "{what}: biased by {bias:.1} standard errors");
            assert!(gain > least, "{what}: variance only {gain:.1} times below random");
            // Of two mean squares of normal errors: standard error √(2/4000 + 2/2000) = 0.039.
            assert!((loss - 1.0).abs() < 0.16, "{what}: {loss:.2} of the textbook's variance");
        }
    }
}

#[test]
fn whatever_the_seed_errors_of_pixels_have_no_bias_and_nothing_in_common() {
    const PIXELS: u32 = 4096;
    let dimension = dimension::bounce(1) + dimension::DIRECTION;
    let mut deviations = Vec::new();
    for seed in 0..8 {
        for (name, f, integral) in FUNCTIONS {
            let mean = |pixel: u32| {
                let points = (0..16).map(|sample| point(Sampler::Sobol, seed, pixel, sample, dimension));
                points.map(f).sum::<f64>() / 16.0 - integral
            };
            let errors: Vec<f64> = (0..PIXELS).map(mean).collect();
            let square = errors.iter().map(|error| error * error).sum::<f64>() / f64::from(PIXELS);
            let bias = errors.iter().sum::<f64>() / (f64::from(PIXELS) * square).sqrt();
            deviations.push((bias, format!("{name}, seed {seed}: mean error")));
            for step in [1, 2, WIDTH as usize] {
                let product = errors.iter().zip(&errors[step..]).map(|(a, b)| a * b).sum::<f64>();
                let what = format!("{name}, seed {seed}: errors of pixels {step} apart");
                deviations.push((product / (f64::from(PIXELS).sqrt() * square), what));
            }
        }
    }
    assert_all_within(deviations);
}

/// The point of the pixel at (x, y) in a dimension before the first bounce.
fn shared_point(seed: u32, [x, y]: [u32; 2], sample: u32, dimension: u32) -> Point {
    let values = SampleValues::new(Sampler::Sobol, seed, sample, dimension);
    let (x, y) = values.at_pixels::<f32>(0, PixelCoordinates::Block { x, y }).get_2d(0);
    [f64::from(x), f64::from(y)]
}

#[test]
fn shifts_of_a_block_are_those_of_its_pixels() {
    fn check<L: Lane>() {
        let lanes = lane_indices::<L>();
        let (column, row) = (lanes & L::Bits::splat(3), lanes.shr(2));
        for (x, y) in (0..132).flat_map(|y| (0..132).step_by(4).map(move |x| (x, y))) {
            for dimension in shared_pairs() {
                let values = SampleValues::new(Sampler::Sobol, 77, 5, dimension);
                let of = |places| {
                    let (first, second) = values.at_pixels::<L>(L::Bits::splat(0), places).get_2d(0);
                    (0..L::WIDTH).map(|lane| [first.get(lane), second.get(lane)]).collect::<Vec<_>>()
                };
                let from = |first: u32, steps: L::Bits| L::Bits::splat(first).wrapping_add(steps);
                let any = PixelCoordinates::Any { x: from(x, column), y: from(y, row) };
                assert_eq!(of(PixelCoordinates::Block { x, y }), of(any), "block at ({x}, {y}), {dimension}");
            }
        }
    }
    check::<f32>();
    check::<F32x8>();
    check::<F32x16>();
}

fn shared_pairs() -> impl Iterator<Item = u32> {
    pairs().filter(|&dimension| is_shared(Sampler::Sobol, dimension))
}

/// The corner of a block of the Z-order curve in a dimension: with the offsets of pair and seed taken back.
fn block_corner(seed: u32, dimension: u32, [x, y]: [u32; 2]) -> [u32; 2] {
    let [pair, seed] = [blue_noise::offset(dimension), blue_noise::seed_offset(seed)];
    let back = |at: u32, by: u32| (at + 4 * blue_noise::SIZE - by) % blue_noise::SIZE;
    [back(x, pair[0] + seed[0]), back(y, pair[1] + seed[1])]
}

#[test]
fn blocks_of_pixels_share_a_net_before_the_first_bounce() {
    for dimension in shared_pairs() {
        for (seed, sample) in [(0, 0), (1, 1), (77, 6), (u32::MAX, 1000)] {
            for k in 0..=6 {
                let side = 1 << k;
                for block in [[0, 0], [blue_noise::SIZE - side, 0], [64 - side, 64]] {
                    let [left, top] = block_corner(seed, dimension, block);
                    let pixels = (0..side * side).map(|i| [left + i % side, top + i / side]);
                    let points: Vec<Point> =
                        pixels.map(|pixel| shared_point(seed, pixel, sample, dimension)).collect();
                    let at = format!("dimension {dimension}, sample {sample}, block {block:?} of {side}");
                    assert!(is_net(&points), "{at}");
                }
            }
        }
    }
}

#[test]
fn pairs_of_a_block_of_pixels_meet_as_independent_orders_do() {
    // A number of one pair against a number of another on a 4 × 4 grid: the sum of squares of (count − 4),
    // over 64, is 15/16 for independent numbers. Pairs that read the same part of the table give 3.
    const SEEDS: u32 = 1000;
    let shared: Vec<u32> = shared_pairs().collect();
    for (i, &d) in shared.iter().enumerate() {
        for &e in &shared[i + 1..] {
            for axes in 0..4 {
                let of_seed = |seed: u32| {
                    let mut cells = [0.0f64; 16];
                    for pixel in (0..64).map(|i| [seed / 32 * 8 % 240 + i % 8, seed % 32 * 8 + i / 8]) {
                        let [a, b] = [d, e].map(|of| shared_point(seed, pixel, 3, of));
                        cells[(a[axes & 1] * 4.0) as usize * 4 + (b[axes >> 1] * 4.0) as usize] += 1.0;
                    }
                    cells.iter().map(|cell| (cell - 4.0).powi(2)).sum::<f64>() / 64.0
                };
                let mean = (0..SEEDS).map(of_seed).sum::<f64>() / f64::from(SEEDS);
                assert!((0.5..1.1).contains(&mean), "dimensions {d} and {e}, axes {axes}: {mean:.2}");
            }
        }
    }
}

#[test]
fn errors_of_neighbours_cancel_before_the_first_bounce() {
    // The error of the mean over 4 × 4 pixels against that of independent pixels: its variance.
    const SEEDS: u32 = 400;
    for (samples, least) in [(1, [200.0, 6.0]), (2, [60.0, 2.5]), (4, [20.0, 2.2]), (16, [2.0, 1.2])] {
        for ((name, f, integral), least) in [FUNCTIONS[0], FUNCTIONS[2]].into_iter().zip(least) {
            let [mut of_pixels, mut of_blocks] = [0.0; 2];
            for seed in 0..SEEDS {
                let [left, top] = block_corner(seed, 10, [seed % 32 * 4, seed / 32 * 4]);
                let error = |i: u32| {
                    let pixel = [left + i % 4, top + i / 4];
                    let points = (0..samples).map(|sample| shared_point(seed, pixel, sample, 10));
                    points.map(f).sum::<f64>() / f64::from(samples) - integral
                };
                let errors: Vec<f64> = (0..16).map(error).collect();
                of_pixels += errors.iter().map(|error| error * error).sum::<f64>() / 16.0;
                of_blocks += (errors.iter().sum::<f64>() / 16.0).powi(2);
            }
            let gain = of_pixels / 16.0 / of_blocks;
            assert!(gain > least, "{name}, {samples} samples: variance {gain:.1} times below independent");
        }
    }
}

#[test]
fn numbers_are_multiples_of_two_to_the_minus_24_below_one() {
    let mut rng = Rng(53);
    for sampler in [Sampler::Sobol, Sampler::Random] {
        let mut largest = 0.0_f32;
        for _ in 0..2_000_000 {
            let (key, sample, dimension) = (rng.bits(), rng.bits(), rng.bits() >> 20 & !1);
            let values = SampleValues::new(sampler, 7, sample, dimension);
            let (x, y) = in_pixel(&values, key, key, dimension).get_2d(0);
            for x in [x, y] {
                assert!((0.0..1.0).contains(&x) && (x * 16_777_216.0).fract() == 0.0, "{sampler:?}: {x}");
                largest = largest.max(x);
            }
        }
        assert!(largest > 0.999_999, "{sampler:?}: the upper end is reached");
    }
}

#[test]
fn one_number_is_half_of_its_pair() {
    assert_eq!(Sampler::default(), Sampler::Sobol);
    let mut rng = Rng(54);
    for _ in 0..10_000 {
        let (seed, pixel, sample, dimension) = (rng.bits(), rng.bits(), rng.bits(), rng.bits() >> 24 & !7);
        for sampler in [Sampler::Sobol, Sampler::Random] {
            let key = sampler.key::<u32>(seed, pixel, sample);
            let numbers = SampleValues::new(sampler, seed, sample, dimension);
            let numbers = in_pixel(&numbers, key, pixel, dimension);
            for pair in [0, 2, 4, 6] {
                let of_pair = SampleValues::new(sampler, seed, sample, dimension + pair);
                let of_itself = in_pixel(&of_pair, key, pixel, dimension).get_2d(0);
                assert_eq!(numbers.get_2d(pair), of_itself, "{sampler:?}");
                let one = |dimension: u32| numbers.get_1d(dimension);
                assert_eq!((one(pair), one(pair + 1)), of_itself, "{sampler:?}");
            }
        }
        let key = random::path_key::<u32>(seed, pixel, sample);
        assert_eq!(Sampler::Random.key::<u32>(seed, pixel, sample), key);
        let numbers = SampleValues::new(Sampler::Random, seed, sample, dimension);
        let second = in_pixel(&numbers, key, pixel, dimension).get_1d(1);
        assert_eq!(second, random::uniform::<f32>(key, dimension + 1));
    }
}

#[test]
fn the_layout_gives_every_use_numbers_of_its_own_and_pairs_begin_at_even_ones() {
    for pair in pairs() {
        assert!(pair.is_multiple_of(2), "{pair}");
    }
    assert_eq!(dimension::LIGHT, dimension::LOBE + 1, "two choices share a pair");
    let mut used = vec![dimension::PIXEL, dimension::PIXEL + 1];
    for bounce in 0..3 {
        let choices = [dimension::LOBE, dimension::LIGHT];
        let points = [dimension::DIRECTION, dimension::LIGHT_POINT].map(|of| [of, of + 1]);
        let event = choices.into_iter().chain(points.into_iter().flatten());
        used.extend(event.map(|of| dimension::bounce(bounce) + of));
    }
    assert!(used.is_sorted_by(|a, b| a < b), "{used:?}");
}
