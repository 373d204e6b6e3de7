//! The choice between well spread and independent numbers.

use super::{random, sobol};
use crate::lane::{Bits, Lane};

/// Where a path's numbers come from: functions of (seed, pixel, sample, dimension), whichever it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Sampler {
    /// Owen-scrambled Sobol points, see [`sobol`]: less noise from the same samples.
    #[default]
    Sobol,
    /// Independent numbers, see [`random`].
    Random,
}

impl Sampler {
    /// As the command line and reports name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Sobol => "sobol",
            Self::Random => "random",
        }
    }
}

impl Sampler {
    /// What [`Numbers`] want to know of sample `sample` in the pixels with these indices (y · width + x).
    #[inline(always)]
    pub fn key<B: Bits>(self, seed: u32, pixel: B, sample: u32) -> B {
        match self {
            Self::Sobol => random::pixel_key(seed, pixel),
            Self::Random => random::path_key(seed, pixel, sample),
        }
    }
}

/// The numbers of one sample in all pixels: those from dimension `first` on, which belong to the place in the pixel or to a scattering
/// event.
#[derive(Clone, Copy, Debug)]
pub struct Numbers {
    sampler: Sampler,
    first: u32,
    /// Of [`Sampler::Sobol`]: each pair before it is scrambled.
    points: [[u32; 2]; PAIRS],
}

const PAIRS: usize = random::PER_BOUNCE as usize / 2;

impl Numbers {
    /// Numbers `first` (even) and the [`random::PER_BOUNCE`] − 1 after it of sample `sample`.
    #[inline(always)]
    pub fn new(sampler: Sampler, seed: u32, sample: u32, first: u32) -> Self {
        debug_assert!(first.is_multiple_of(2), "a pair begins at an even dimension");
        let points = match sampler {
            Sampler::Sobol => std::array::from_fn(|pair| sobol::point(seed, sample, first + 2 * pair as u32)),
            Sampler::Random => [[0; 2]; PAIRS],
        };
        Self { sampler, first, points }
    }

    /// Numbers `first` + `dimension` (even) and the next of the pixels with these keys, which are [`Sampler::key`]'s for the same seed and
    /// sample: each uniform in [0, 1), a multiple of 2⁻²⁴, never 1.
    #[inline(always)]
    pub fn pair<L: Lane>(&self, key: L::Bits, dimension: u32) -> (L, L) {
        debug_assert!(dimension.is_multiple_of(2), "a pair begins at an even dimension");
        let at = self.first + dimension;
        match self.sampler {
            Sampler::Sobol => sobol::pair(key, self.points[dimension as usize / 2], at),
            Sampler::Random => (random::uniform(key, at), random::uniform(key, at + 1)),
        }
    }

    /// Number `first` + `dimension` alone: one of its pair.
    #[inline(always)]
    pub fn one<L: Lane>(&self, key: L::Bits, dimension: u32) -> L {
        match self.sampler {
            Sampler::Sobol => {
                let (first, second) = self.pair(key, dimension & !1);
                if dimension & 1 == 0 { first } else { second }
            }
            Sampler::Random => random::uniform(key, self.first + dimension),
        }
    }
}
