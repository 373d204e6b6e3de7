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
    /// What [`Sampler::pair`] wants to know of sample `sample` in the pixels with these indices (y · width + x).
    #[inline(always)]
    pub fn key<B: Bits>(self, seed: u32, pixel: B, sample: u32) -> B {
        match self {
            Self::Sobol => random::pixel_key(seed, pixel),
            Self::Random => random::path_key(seed, pixel, sample),
        }
    }

    /// Numbers `dimension` (even) and `dimension + 1` of sample `sample`, which is the sample of `key`: each uniform in [0, 1), a multiple of
    /// 2⁻²⁴, never 1.
    #[inline(always)]
    pub fn pair<L: Lane>(self, key: L::Bits, sample: u32, dimension: u32) -> (L, L) {
        debug_assert!(dimension.is_multiple_of(2), "a pair begins at an even dimension");
        match self {
            Self::Sobol => sobol::pair(key, sample, dimension),
            Self::Random => (random::uniform(key, dimension), random::uniform(key, dimension + 1)),
        }
    }

    /// Number `dimension` alone: one of its pair.
    #[inline(always)]
    pub fn one<L: Lane>(self, key: L::Bits, sample: u32, dimension: u32) -> L {
        match self {
            Self::Sobol => {
                let (first, second) = sobol::pair(key, sample, dimension & !1);
                if dimension & 1 == 0 { first } else { second }
            }
            Self::Random => random::uniform(key, dimension),
        }
    }
}

/// The numbers of one scattering event of a sample, in all its pixels.
#[derive(Clone, Copy, Debug)]
pub struct Event {
    sampler: Sampler,
    sample: u32,
    first: u32,
}

impl Event {
    /// Event number `bounce`, counted from 0.
    pub fn new(sampler: Sampler, sample: u32, bounce: u32) -> Self {
        Self { sampler, sample, first: random::bounce(bounce) }
    }
    /// Numbers `dimension` and `dimension + 1` of the event; see [`Sampler::pair`].
    #[inline(always)]
    pub fn pair<L: Lane>(self, key: L::Bits, dimension: u32) -> (L, L) {
        self.sampler.pair(key, self.sample, self.first + dimension)
    }
    /// Number `dimension` of the event alone.
    #[inline(always)]
    pub fn one<L: Lane>(self, key: L::Bits, dimension: u32) -> L {
        self.sampler.one(key, self.sample, self.first + dimension)
    }
}
