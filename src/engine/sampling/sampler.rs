//! Chooses among Sobol points with blue noise, padded Sobol points, and random values.

use super::blue_noise::{self, PixelCoordinates, Shifts, seed_offset};
use super::{dimension, random, sobol};
use crate::choice::choices;
use crate::lane::{Bits, Lane};

choices! {
    /// The source of a path's sample values, which are functions of (seed, pixel, sample, dimension).
    pub enum Sampler {
        /// See [`sobol`] and [`blue_noise`].
        #[default]
        Sobol = "sobol", "Owen-scrambled Sobol points, errors spread over neighbouring pixels as blue noise.";
        /// See [`sobol`]: like [`Sampler::Sobol`], with random shifts in all dimensions.
        PaddedSobol = "padded-sobol", "The same points, but the errors of neighbouring pixels are independent.";
        /// See [`random`].
        Random = "random", "Independent random numbers.";
    }
}

impl Sampler {
    /// Returns the keys of sample `sample` in the pixels with these indices (y · width + x), for
    /// [`SampleValues`].
    #[inline(always)]
    pub fn key<B: Bits>(self, seed: u32, pixel: B, sample: u32) -> B {
        match self {
            Self::Sobol | Self::PaddedSobol => random::pixel_key(seed, pixel),
            Self::Random => random::path_key(seed, pixel, sample),
        }
    }
}

/// The values of the latest samples, which are the same in every pixel. Each thread keeps a table, so values
/// are computed once per sample and not once per tile, in stills too, where a tile takes many samples.
#[derive(Clone, Debug, Default)]
pub struct SampleTable {
    /// The sampler, the seed, and the number of scattering events of a path.
    of: Option<(Sampler, u32, u32)>,
    /// The sample of each row.
    samples: Vec<Option<u32>>,
    /// Rows of values: the position in the pixel, then one scattering event after the other.
    values: Vec<SampleValues>,
    /// The index at which the current sample's row begins.
    begin: usize,
}

impl SampleTable {
    /// The largest number of samples that are kept: more than a tile takes in a tenth of a second of all but
    /// the simplest pictures.
    const MAX_SAMPLES: usize = 256;
    /// The largest number of values that are kept if paths are long: 112 KiB.
    const MAX_VALUES: usize = 2048;

    /// Selects sample `sample` of paths with up to `events` scattering events; computes missing values.
    #[inline]
    pub fn begin(&mut self, sampler: Sampler, seed: u32, sample: u32, events: u32) {
        let width = events as usize + 1;
        if self.of != Some((sampler, seed, events)) {
            self.of = Some((sampler, seed, events));
            let rows = (Self::MAX_VALUES / width).clamp(1, Self::MAX_SAMPLES);
            self.samples.clear();
            self.samples.resize(rows, None);
            let placeholder = SampleValues::new(sampler, seed, sample, dimension::PIXEL);
            self.values.resize(rows * width, placeholder);
        }
        let row = sample as usize % self.samples.len();
        self.begin = row * width;
        if self.samples[row] != Some(sample) {
            self.samples[row] = Some(sample);
            let firsts = std::iter::once(dimension::PIXEL).chain((0..events).map(dimension::bounce));
            for (value, first) in self.values[self.begin..][..width].iter_mut().zip(firsts) {
                *value = SampleValues::new(sampler, seed, sample, first);
            }
        }
    }
    /// Returns the number of the current sample.
    pub fn sample(&self) -> u32 {
        let (_, _, events) = self.of.expect("a sample has begun");
        self.samples[self.begin / (events as usize + 1)].expect("a sample has begun")
    }
    /// Returns the values of the position in the pixel.
    #[inline]
    pub fn pixel(&self) -> SampleValues {
        self.values[self.begin]
    }
    /// Returns the values of scattering event `bounce`, counted from 0 and below the number of events.
    #[inline]
    pub fn bounce(&self, bounce: u32) -> SampleValues {
        self.values[self.begin + 1 + bounce as usize]
    }
}

/// The values of one sample index in all pixels, in the [`dimension::PER_BOUNCE`] dimensions from `first` on,
/// which are the position in the pixel or one scattering event.
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
    /// Computes the values of sample `sample` in the dimensions from `first` (even) on.
    #[inline(always)]
    pub fn new(sampler: Sampler, seed: u32, sample: u32, first: u32) -> Self {
        debug_assert!(first.is_multiple_of(2), "a pair begins at an even dimension");
        let points = match sampler {
            Sampler::Random => [[0; 2]; PAIRS],
            _ => std::array::from_fn(|pair| sobol::point(seed, sample, first + 2 * pair as u32)),
        };
        Self { sampler, first, points, shifts: blue_noise::shifts(), seed_offset: seed_offset(seed) }
    }

    /// Returns the values of paths before their first bounce, in pixels at `places`.
    #[inline(always)]
    pub fn at_pixels<L: Lane>(&self, key: L::Bits, places: PixelCoordinates<L>) -> PacketValues<'_, L> {
        debug_assert!(self.first < dimension::bounce(1), "the position in the pixel or the first event");
        PacketValues { values: self, key, places: Some(places) }
    }

    /// Returns the values of paths after their first bounce.
    #[inline(always)]
    pub fn at_keys<L: Lane>(&self, key: L::Bits) -> PacketValues<'_, L> {
        debug_assert!(self.first >= dimension::bounce(1), "a later event than the first");
        PacketValues { values: self, key, places: None }
    }
}

/// The values of a packet of paths: [`SampleValues`] in their pixels.
#[derive(Clone, Copy, Debug)]
pub struct PacketValues<'a, L: Lane> {
    values: &'a SampleValues,
    /// The key from [`Sampler::key`] with the same seed and sample.
    key: L::Bits,
    /// The pixels of paths before the first bounce, where neighbours' shifts spread ([`blue_noise`]). Later,
    /// paths of neighbours are too different to gain from it.
    places: Option<PixelCoordinates<L>>,
}

impl<L: Lane> PacketValues<'_, L> {
    /// Returns the values in dimensions `first` + `dimension` (even) and the next: each uniform in [0, 1), a
    /// multiple of 2⁻²⁴, never 1.
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

    /// Returns the value in dimension `first` + `dimension`: one of its pair.
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
        // The numbers of events; with the largest, one row is left.
        for (sampler, seed, events) in [
            (Sampler::Sobol, 0, 3),
            (Sampler::Sobol, 7, 3),
            (Sampler::Random, 7, 10),
            (Sampler::Sobol, 0, 3000),
            (Sampler::Sobol, 0, 3),
        ] {
            for sample in samples {
                table.begin(sampler, seed, sample, events);
                let of = |first| parts(SampleValues::new(sampler, seed, sample, first));
                assert_eq!(parts(table.pixel()), of(dimension::PIXEL), "sample {sample}");
                for bounce in [0, events - 1] {
                    assert_eq!(parts(table.bounce(bounce)), of(dimension::bounce(bounce)), "sample {sample}");
                }
            }
        }
    }
}
