//! The choice between Sobol and independent sample values.

use super::{dimension, random, sobol};
use crate::choice::choices;
use crate::lane::{Bits, Lane};

choices! {
    /// The source of a path's sample values. With either they are functions of (seed, pixel, sample,
    /// dimension).
    pub enum Sampler {
        /// See [`sobol`].
        #[default]
        Sobol = "sobol", "Owen-scrambled Sobol points: less noise at the same number of samples.";
        /// See [`random`].
        Random = "random", "Independent random numbers.";
    }
}

impl Sampler {
    /// The keys of sample `sample` in the pixels with these indices (y · width + x), as [`SampleValues`]
    /// takes them.
    #[inline(always)]
    pub fn key<B: Bits>(self, seed: u32, pixel: B, sample: u32) -> B {
        match self {
            Self::Sobol => random::pixel_key(seed, pixel),
            Self::Random => random::path_key(seed, pixel, sample),
        }
    }
}

/// The values of one sample index in all pixels, in the [`dimension::PER_BOUNCE`] dimensions from `first` on:
/// those of the position in the pixel or of one scattering event.
#[derive(Clone, Copy, Debug)]
pub struct SampleValues {
    sampler: Sampler,
    first: u32,
    /// The Sobol point of each pair, before the pixels' digital shift. Zeros with [`Sampler::Random`].
    points: [[u32; 2]; PAIRS],
}

const PAIRS: usize = dimension::PER_BOUNCE as usize / 2;

impl SampleValues {
    /// Of sample `sample` in the dimensions from `first` (even) on.
    #[inline(always)]
    pub fn new(sampler: Sampler, seed: u32, sample: u32, first: u32) -> Self {
        debug_assert!(first.is_multiple_of(2), "a pair begins at an even dimension");
        let points = match sampler {
            Sampler::Sobol => std::array::from_fn(|pair| sobol::point(seed, sample, first + 2 * pair as u32)),
            Sampler::Random => [[0; 2]; PAIRS],
        };
        Self { sampler, first, points }
    }

    /// The values in dimensions `first` + `dimension` (even) and the next, of the pixels with these keys:
    /// each uniform in [0, 1), a multiple of 2⁻²⁴, never 1.
    ///
    /// Domain: keys from [`Sampler::key`] with the same seed and sample.
    #[inline(always)]
    pub fn get_2d<L: Lane>(&self, key: L::Bits, dimension: u32) -> (L, L) {
        debug_assert!(dimension.is_multiple_of(2), "a pair begins at an even dimension");
        let at = self.first + dimension;
        match self.sampler {
            Sampler::Sobol => sobol::shifted(key, self.points[dimension as usize / 2], at),
            Sampler::Random => (random::uniform(key, at), random::uniform(key, at + 1)),
        }
    }

    /// The value in dimension `first` + `dimension`: one of its pair.
    #[inline(always)]
    pub fn get_1d<L: Lane>(&self, key: L::Bits, dimension: u32) -> L {
        match self.sampler {
            Sampler::Sobol => {
                let (first, second) = self.get_2d(key, dimension & !1);
                if dimension & 1 == 0 { first } else { second }
            }
            Sampler::Random => random::uniform(key, self.first + dimension),
        }
    }
}
