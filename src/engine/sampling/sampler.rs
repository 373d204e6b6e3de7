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

/// The values of the latest samples. They are the same in every pixel: kept by a thread, they are computed
/// once a sample and not once a tile, in stills too, where a tile takes many samples before the next begins.
#[derive(Clone, Debug, Default)]
pub struct SampleTable {
    of: Option<(Sampler, u32)>,
    sample: u32,
    /// The sample of each row.
    samples: Vec<Option<u32>>,
    /// Rows of [`SampleTable::width`] values: the position in the pixel, then one scattering event after the
    /// other.
    values: Vec<SampleValues>,
    width: usize,
    /// Where the row of `sample` begins.
    begin: usize,
}

impl SampleTable {
    /// Most samples that are kept: more than a tile takes in a tenth of a second of all but the simplest
    /// pictures.
    const MAX_SAMPLES: usize = 256;
    /// Most values that are kept, 112 KiB, where paths are long.
    const MAX_VALUES: usize = 2048;

    /// Turns to sample `sample`.
    #[inline]
    pub fn begin(&mut self, sampler: Sampler, seed: u32, sample: u32) {
        if self.of != Some((sampler, seed)) {
            self.of = Some((sampler, seed));
            self.samples.fill(None);
        }
        self.sample = sample;
        self.find();
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
        if index >= self.width {
            self.widen(index + 1);
        }
        self.values[self.begin + index]
    }
    /// Finds the sample's row.
    #[inline]
    fn find(&mut self) {
        if self.samples.is_empty() {
            return;
        }
        let row = self.sample as usize % self.samples.len();
        self.begin = row * self.width;
        if self.samples[row] != Some(self.sample) {
            self.compute(row);
        }
    }
    #[cold]
    fn compute(&mut self, row: usize) {
        for index in 0..self.width {
            self.values[self.begin + index] = self.value(index);
        }
        self.samples[row] = Some(self.sample);
    }
    #[cold]
    fn widen(&mut self, width: usize) {
        self.width = width;
        let rows = (Self::MAX_VALUES / width).clamp(1, Self::MAX_SAMPLES);
        self.samples = vec![None; rows];
        self.values = vec![self.value(0); rows * width];
        self.find();
    }
    fn value(&self, index: usize) -> SampleValues {
        let (sampler, seed) = self.of.expect("a sample has begun");
        let first = match index {
            0 => dimension::PIXEL,
            event => dimension::bounce(event as u32 - 1),
        };
        SampleValues::new(sampler, seed, self.sample, first)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_gives_the_values_of_every_sample_in_any_order() {
        let parts = |values: SampleValues| (values.sampler, values.first, values.points, values.seed_offset);
        let mut table = SampleTable::default();
        let samples = [0, 1, 0, 255, 256, 511, 1, 257, 0, u32::MAX];
        for (round, (sampler, seed)) in
            [(Sampler::Sobol, 0), (Sampler::Sobol, 7), (Sampler::Random, 7), (Sampler::Sobol, 0)]
                .into_iter()
                .enumerate()
        {
            for sample in samples {
                table.begin(sampler, seed, sample);
                let of = |first| parts(SampleValues::new(sampler, seed, sample, first));
                assert_eq!(parts(table.pixel()), of(dimension::PIXEL), "sample {sample}");
                // Later rounds ask for longer paths, the last for as long ones as leave one row.
                for bounce in [0, [2, 5, 9, 3000][round]] {
                    assert_eq!(parts(table.bounce(bounce)), of(dimension::bounce(bounce)), "sample {sample}");
                }
            }
        }
    }
}
