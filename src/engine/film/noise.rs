//! Estimates the variance of a pixel's samples, and the standard error of their mean.
//!
//! # The estimate
//! For every group of four consecutive samples of a pixel, starting at a multiple of four, d is the luminance
//! of the first two minus that of the last two. For independent samples, E d² = 4 σ², and the mean of n
//! samples has the variance σ²/n: its estimate is (Σ d² / 4 groups) / n, without bias, with n / 4 degrees of
//! freedom, and exactly 0 where all samples are equal (the difference of a sum of squares and a squared sum
//! would not be).
//!
//! Low-discrepancy samples are stratified: with Owen's scrambling the points 4 k to 4 k + 3 of Sobol's
//! sequence are a net, and so are their two halves. d then holds only the error of two points, which is still
//! more than that of all n, and the estimate is conservative. Differences of even and odd samples would not
//! do, because even points all lie in one half of the pixel.

use crate::lane::{Lane, NATIVE_WIDTH, Native};

type L = Native;

/// The number of samples in a group.
pub const GROUP: u32 = 4;
/// The weights of red, green and blue in luminance. Source: ITU-R BT.709-6, 2015, section 3.
const LUMINANCE: [f32; 3] = [0.2126, 0.7152, 0.0722];

/// Returns the luminance of linear RGB.
pub fn luminance(color: [f64; 3]) -> f64 {
    color.iter().zip(LUMINANCE).map(|(channel, weight)| channel * f64::from(weight)).sum()
}

/// The variance estimates of a tile's pixels, packet by packet.
#[derive(Clone, Debug)]
pub struct Noise {
    packets: Vec<VarianceSums>,
}

#[derive(Clone, Copy, Debug)]
struct VarianceSums {
    /// The d of the current group.
    difference: L,
    /// Σ d² of complete groups, as a plain sum: four million leave three digits, and two are enough.
    squares: L,
}

impl Noise {
    /// The memory of a pixel in bytes.
    pub const BYTES_PER_PIXEL: usize = size_of::<VarianceSums>() / L::WIDTH;

    pub(super) fn new(packets: usize) -> Self {
        Self { packets: vec![VarianceSums { difference: L::zero(), squares: L::zero() }; packets] }
    }

    /// Adds sample number `sample`, counted from 0, of every pixel. Infinite and NaN samples count as black.
    pub(super) fn add(&mut self, sample: u32, [r, g, b]: [&[[f32; NATIVE_WIDTH]]; 3]) {
        let zero = L::zero();
        let weights = LUMINANCE.map(L::splat);
        let sign = L::splat(if sample % GROUP < GROUP / 2 { 1.0 } else { -1.0 });
        let whole = sample % GROUP == GROUP - 1;
        for (((sums, r), g), b) in self.packets.iter_mut().zip(r).zip(g).zip(b) {
            let [r, g, b] = [r, g, b].map(|channel| L::load(channel));
            let luminance = r.mul_add(weights[0], g.mul_add(weights[1], b * weights[2]));
            let luminance = L::select(luminance.is_finite(), luminance, zero);
            sums.difference = luminance.mul_add(sign, sums.difference);
            if whole {
                sums.squares = sums.difference.mul_add(sums.difference, sums.squares);
                sums.difference = zero;
            }
        }
    }

    /// Returns d of the current group and Σ d² of a pixel.
    pub(super) fn numbers(&self, slot: usize) -> [f32; 2] {
        let VarianceSums { difference, squares } = self.packets[slot / L::WIDTH];
        [difference, squares].map(|lanes| lanes.get(slot % L::WIDTH))
    }

    /// Sets each pixel's numbers, as [`Noise::numbers`] returns them, to `numbers(slot)`.
    pub(super) fn set(&mut self, numbers: impl Fn(usize) -> [f32; 2]) {
        for (packet, sums) in self.packets.iter_mut().enumerate() {
            let [difference, squares] =
                [0, 1].map(|which| L::from_fn(|lane| numbers(packet * L::WIDTH + lane)[which]));
            *sums = VarianceSums { difference, squares };
        }
    }

    /// Returns the estimated variance of a pixel's mean luminance after `samples` samples; infinite before
    /// the first complete group.
    pub(crate) fn variance_of_mean(&self, slot: usize, samples: u32) -> f64 {
        let squares = f64::from(self.packets[slot / L::WIDTH].squares.get(slot % L::WIDTH));
        let groups = samples / GROUP;
        if groups == 0 {
            return f64::INFINITY;
        }
        squares / (f64::from(GROUP) * f64::from(groups) * f64::from(samples))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the estimate for a pixel whose sample i is grey of the brightness `value(i)`.
    fn estimate(samples: u32, value: impl Fn(u32) -> f32) -> f64 {
        let mut noise = Noise::new(1);
        (0..samples).for_each(|sample| noise.add(sample, [&[[value(sample); NATIVE_WIDTH]]; 3]));
        noise.variance_of_mean(5, samples)
    }

    /// Returns a number that is uniform in [0, 1).
    fn uniform(i: u32) -> f32 {
        (crate::sampling::random::mix_bits(i) >> 8) as f32 / 16_777_216.0
    }

    #[test]
    fn variance_of_mean_is_right_for_independent_samples() {
        for samples in [16, 1024, 1027] {
            // Uniform samples have the variance 1/12. 1000 pixels of n/4 groups: of d², σ(d²) ≤ √2 E d².
            let pixels = 1000;
            let mean = (0..pixels).map(|pixel| estimate(samples, |i| uniform(pixel * 2048 + i))).sum::<f64>()
                / f64::from(pixels);
            let truth = 1.0 / 12.0 / f64::from(samples);
            let tolerance = 4.0 * (2.0 / f64::from(pixels * samples / GROUP)).sqrt();
            assert!((mean / truth - 1.0).abs() < tolerance, "{samples}: {mean} for {truth}");
        }
    }

    #[test]
    fn variance_of_mean_is_none_where_samples_are_equal_and_unknown_before_four() {
        assert_eq!(estimate(4096, |_| 0.1), 0.0);
        assert_eq!(estimate(3, |_| 0.1), f64::INFINITY);
        assert_eq!(estimate(4, |_| 0.1), 0.0);
        assert_eq!(estimate(4, |i| if i == 2 { f32::NAN } else { 0.0 }), 0.0, "left out");
        assert!(estimate(4, |i| if i == 2 { 1.0 } else { 0.0 }) > 0.0);
    }

    #[test]
    fn variance_of_mean_errs_to_the_safe_side_for_nets() {
        // An edge and a slope across the pixel, met by van der Corput's sequence, Sobol's first dimension,
        // shifted by digits.
        let functions: [fn(f32) -> f32; 2] = [|x| x, |x| f32::from(x < 0.3)];
        for (value, truth) in functions.into_iter().zip([0.5, 0.3f64]) {
            for samples in [16, 64, 256] {
                let pixels = 200;
                let (mut estimated, mut true_square) = (0.0, 0.0);
                for pixel in 0..pixels {
                    let shift = crate::sampling::random::mix_bits(pixel + 7u32);
                    let sample = |i: u32| value(((i.reverse_bits() ^ shift) >> 8) as f32 / 16_777_216.0);
                    estimated += estimate(samples, sample);
                    let mean = (0..samples).map(|i| f64::from(sample(i))).sum::<f64>() / f64::from(samples);
                    true_square += (mean - truth).powi(2);
                }
                let independent = truth * (1.0 - truth) / f64::from(samples) * f64::from(pixels);
                assert!(estimated > true_square, "{samples}: {estimated} for {true_square}");
                assert!(estimated < 1.5 * independent, "{samples}: not even what chance would do");
            }
        }
    }
}
