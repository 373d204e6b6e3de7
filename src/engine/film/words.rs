//! Converts the sums of a tile to words of 32 bits: all their bits, and the same for every packet width.
//!
//! A word holds the bits of an f32, or a u32. Words form columns of one word per pixel, in the order of
//! [`crate::camera::Tile::places`]:
//!
//! | columns | what |
//! |---|---|
//! | 3 | sums of red, green, blue |
//! | 3 | their rounding errors (`excess`) |
//! | 1, if the tile has discarded samples | discarded samples, u32 |
//! | 2, if the film estimates its variance | the difference of the current group, Σ d² ([`super::noise`]) |

use super::{CompensatedSum, L, TileSums};
use crate::lane::Lane;

/// The number of columns that every tile has.
const SUMS: usize = 6;

impl TileSums {
    /// Tests whether the tile has discarded samples, and so a column of them.
    pub fn has_discarded(&self) -> bool {
        !self.discarded.is_empty()
    }

    /// Returns the number of words of this tile, with or without a column of discarded samples.
    pub fn words(&self, discarded: bool) -> usize {
        let noise = if self.noise.is_some() { 2 } else { 0 };
        (SUMS + usize::from(discarded) + noise) * self.tile.pixels()
    }

    /// Appends the tile's words.
    pub fn words_into(&self, words: &mut Vec<u32>) {
        let slots = 0..self.tile.pixels();
        let sums = |slot: usize| &self.packets[slot / L::WIDTH];
        for channel in 0..3 {
            words.extend(slots.clone().map(|slot| sums(slot)[channel].sum.get(slot % L::WIDTH).to_bits()));
        }
        for channel in 0..3 {
            words.extend(slots.clone().map(|slot| sums(slot)[channel].excess.get(slot % L::WIDTH).to_bits()));
        }
        words.extend(&self.discarded);
        if let Some(noise) = &self.noise {
            for which in 0..2 {
                words.extend(slots.clone().map(|slot| noise.numbers(slot)[which].to_bits()));
            }
        }
    }

    /// Sets the tile to `samples` samples and to words of [`TileSums::words_into`]. The number of discarded
    /// samples is limited to the number of samples.
    ///
    /// # Panics
    /// If the number of words is not [`TileSums::words`]`(discarded)`.
    pub fn restore(&mut self, samples: u32, discarded: bool, words: &[u32]) {
        assert_eq!(words.len(), self.words(discarded));
        let pixels = self.tile.pixels();
        // Lanes behind the last pixel are padding, and never read.
        let number = |column: usize, slot: usize| match slot < pixels {
            true => f32::from_bits(words[column * pixels + slot]),
            false => 0.0,
        };
        let lanes =
            |column: usize, packet: usize| L::from_fn(|lane| number(column, packet * L::WIDTH + lane));
        for (packet, sums) in self.packets.iter_mut().enumerate() {
            for (channel, sum) in sums.iter_mut().enumerate() {
                *sum = CompensatedSum { sum: lanes(channel, packet), excess: lanes(channel + 3, packet) };
            }
        }
        self.samples = samples;
        self.discarded.clear();
        if discarded {
            let column = &words[SUMS * pixels..(SUMS + 1) * pixels];
            self.discarded.extend(column.iter().map(|&count| count.min(samples)));
        }
        let first = SUMS + usize::from(discarded);
        if let Some(noise) = &mut self.noise {
            noise.set(|slot| [number(first, slot), number(first + 1, slot)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::film::Film;

    /// Adds samples of all sizes, some of them not finite.
    fn add_samples(film: &mut Film, samples: std::ops::Range<u32>) {
        for sample in samples {
            let value = |i: u32| match (sample + i) % 61 {
                60 => f32::NAN,
                rest => (rest as f32 * 0.37 + sample as f32).exp2() * 1e-7,
            };
            let [r, g, b] =
                [1, 5, 11].map(|channel| -> Vec<f32> { (0..256).map(|i| value(i * channel)).collect() });
            film.tiles.iter_mut().for_each(|tile| tile.add([&r, &g, &b]));
        }
    }

    #[test]
    fn kept_tiles_are_the_only_ones_that_count() {
        let mut film = Film::new([40, 16], [16, 16]);
        film.keep_tiles(|number| number != 1);
        add_samples(&mut film, 0..2);
        assert_eq!((film.samples(), film.pixels(), film.pixel_samples()), (2, 384, 768));
        assert_eq!(film.mean_samples(), 2.0);
        let pixels = film.picture().pixels;
        assert!(pixels[20] == [0.0; 3] && pixels[0] != [0.0; 3] && pixels[39] != [0.0; 3]);
    }
}
