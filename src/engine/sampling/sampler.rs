//! The choice among Sobol points with blue noise, Sobol points with independent pixels, and random values.

use super::blue_noise::{self, Places, Shifts, seed_offset};
use super::{dimension, random, sobol};
use crate::choice::choices;
use crate::lane::{Bits, Lane};

choices! {
    /// The source of a path's sample values. With each they are functions of (seed, pixel, sample,
    /// dimension).
    pub enum Sampler {
        /// See [`sobol`] and [`blue_noise`].
        #[default]
        Sobol = "sobol", "Owen-scrambled Sobol points, errors spread over neighbouring pixels as blue noise.";
        /// See [`sobol`]: as [`Sampler::Sobol`], with random shifts in all dimensions.
        PaddedSobol = "padded-sobol", "The same points, but the errors of neighbouring pixels are independent.";
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
            Self::Sobol | Self::PaddedSobol => random::pixel_key(seed, pixel),
            Self::Random => random::path_key(seed, pixel, sample),
        }
    }
}

/// The values of one sample index in all its dimensions asked for so far. They are the same in every pixel:
/// kept by a thread, they are computed once a sample and not once a tile.
#[derive(Clone, Debug, Default)]
pub struct SampleTable {
    /// Sampler, seed and sample.
    of: Option<(Sampler, u32, u32)>,
    /// The position in the pixel, then one scattering event after the other.
    values: Vec<SampleValues>,
}

impl SampleTable {
    /// Turns to sample `sample`.
    #[inline]
    pub fn begin(&mut self, sampler: Sampler, seed: u32, sample: u32) {
        if self.of != Some((sampler, seed, sample)) {
            self.of = Some((sampler, seed, sample));
            self.values.clear();
        }
    }
    /// The values of the position in the pixel.
    #[inline]
    pub fn pixel(&mut self) -> SampleValues {
        self.get(0)
    }
    /// The values of scattering event `bounce`, counted from 0.
    #[inline]
    pub fn bounce(&mut self, bounce: u32) -> SampleValues {
        self.get(bounce as usize + 1)
    }
    #[inline]
    fn get(&mut self, index: usize) -> SampleValues {
        if index >= self.values.len() {
            self.extend(index);
        }
        self.values[index]
    }
    #[cold]
    fn extend(&mut self, index: usize) {
        let (sampler, seed, sample) = self.of.expect("a sample has begun");
        let first = |index: usize| match index {
            0 => dimension::PIXEL,
            event => dimension::bounce(event as u32 - 1),
        };
        let values = |index| SampleValues::new(sampler, seed, sample, first(index));
        self.values.extend((self.values.len()..=index).map(values));
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
    shifts: &'static Shifts,
    seed_offset: [u32; 2],
}

const PAIRS: usize = dimension::PER_BOUNCE as usize / 2;

impl SampleValues {
    /// Of sample `sample` in the dimensions from `first` (even) on.
    #[inline(always)]
    pub fn new(sampler: Sampler, seed: u32, sample: u32, first: u32) -> Self {
        debug_assert!(first.is_multiple_of(2), "a pair begins at an even dimension");
        let points = match sampler {
            Sampler::Random => [[0; 2]; PAIRS],
            _ => std::array::from_fn(|pair| sobol::point(seed, sample, first + 2 * pair as u32)),
        };
        Self { sampler, first, points, shifts: blue_noise::shifts(), seed_offset: seed_offset(seed) }
    }

    /// The values of paths before their first bounce, in pixels at `places`.
    #[inline(always)]
    pub fn at_pixels<L: Lane>(&self, key: L::Bits, places: Places<L>) -> PacketValues<'_, L> {
        debug_assert!(self.first < dimension::bounce(1), "the position in the pixel or the first event");
        PacketValues { values: self, key, places: Some(places) }
    }

    /// The values of paths after their first bounce.
    #[inline(always)]
    pub fn at_keys<L: Lane>(&self, key: L::Bits) -> PacketValues<'_, L> {
        debug_assert!(self.first >= dimension::bounce(1), "a later event than the first");
        PacketValues { values: self, key, places: None }
    }
}

/// The values of a packet of paths: those of [`SampleValues`] in their pixels.
#[derive(Clone, Copy, Debug)]
pub struct PacketValues<'a, L: Lane> {
    values: &'a SampleValues,
    /// From [`Sampler::key`] with the same seed and sample.
    key: L::Bits,
    /// Before the first bounce, where neighbours' shifts spread ([`blue_noise`]). Later, paths of neighbours
    /// are too different to gain from it.
    places: Option<Places<L>>,
}

impl<L: Lane> PacketValues<'_, L> {
    /// The values in dimensions `first` + `dimension` (even) and the next: each uniform in [0, 1), a multiple
    /// of 2⁻²⁴, never 1.
    #[inline(always)]
    pub fn get_2d(&self, dimension: u32) -> (L, L) {
        debug_assert!(dimension.is_multiple_of(2), "a pair begins at an even dimension");
        let at = self.values.first + dimension;
        match self.values.sampler {
            Sampler::Random => (random::uniform(self.key, at), random::uniform(self.key, at + 1)),
            sampler => {
                let shift = match self.places {
                    Some(places) if sampler == Sampler::Sobol => {
                        places.shift(self.values.shifts, self.values.seed_offset, at)
                    }
                    _ => sobol::shift(self.key, at),
                };
                sobol::shifted(self.values.points[dimension as usize / 2], shift)
            }
        }
    }

    /// The value in dimension `first` + `dimension`: one of its pair.
    #[inline(always)]
    pub fn get_1d(&self, dimension: u32) -> L {
        match self.values.sampler {
            Sampler::Random => random::uniform(self.key, self.values.first + dimension),
            _ => {
                let (first, second) = self.get_2d(dimension & !1);
                if dimension & 1 == 0 { first } else { second }
            }
        }
    }
}
