//! Stores sums of linear radiance, each pixel's samples in a fixed order.
//!
//! Sums are compensated: a plain f32 sum is off by 5e-6 after a million samples and stalls at 2²⁴ of them.
//! The variance of samples ([`mod@noise`]) is estimated only in films that are made for it. A tile's sums are
//! read and set again by [`TileSums::words_into`] and [`TileSums::restore`], for checkpoints.

pub mod noise;
mod words;

use crate::camera::Tile;
use crate::lane::{Lane, Mask, NATIVE_WIDTH, Native};
use noise::Noise;

/// The lanes of sums, which are the same at any width.
type L = Native;

/// A picture in linear RGB, before tone mapping: the mean of a film.
pub type Picture = Map<[f32; 3]>;

/// A value for each pixel, row by row from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map<T> {
    /// The number of pixels in a row.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
    /// The `width · height` values.
    pub pixels: Vec<T>,
}

impl<T: Clone + Default> Map<T> {
    /// Changes the size; allocates only if the map grows. The values are unspecified afterwards.
    pub fn resize(&mut self, [width, height]: [u32; 2]) {
        (self.width, self.height) = (width, height);
        self.pixels.resize(width as usize * height as usize, T::default());
    }
}

impl Picture {
    /// Returns the 64-bit FNV-1a hash of the picture: of its width and height (u32), then of the red, green
    /// and blue of each pixel (f32), row by row from the top, all as little-endian bytes. Equal bits give
    /// equal hashes on any machine. An EXR file of the picture holds the same numbers.
    ///
    /// Source: G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, "The FNV Non-Cryptographic Hash Algorithm".
    pub fn hash(&self) -> u64 {
        const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
        const PRIME: u64 = 0x0000_0100_0000_01b3;
        let pixels = self.pixels.as_flattened().iter().map(|channel| channel.to_bits());
        let bytes = [self.width, self.height].into_iter().chain(pixels).flat_map(u32::to_le_bytes);
        bytes.fold(OFFSET_BASIS, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
    }
}

/// The running sums of a picture, created by [`crate::render::Renderer::film`].
#[derive(Clone, Debug)]
pub struct Film {
    resolution: [u32; 2],
    pub(crate) tiles: Vec<TileSums>,
    pub(crate) rays: u64,
}

/// The sums of one tile's pixels, in the order of [`Tile::places`].
#[derive(Clone, Debug)]
pub struct TileSums {
    /// The pixels of the tile.
    pub tile: Tile,
    /// The number of samples that every pixel of the tile has.
    pub samples: u32,
    /// Red, green and blue of each packet of pixels, the last one padded.
    packets: Vec<[CompensatedSum; 3]>,
    /// The number of discarded samples of each pixel; empty as long as there are none.
    discarded: Vec<u32>,
    /// The variance estimate, in films made by [`crate::render::Renderer::film_with_noise`].
    pub noise: Option<Noise>,
}

/// Compensated f32 sums: as accurate as f64 in the same space, at the full width of the lanes.
///
/// Error: ≤ 2 ε of the sum of magnitudes, for any number of samples. Source: Kahan, "Further remarks on
/// reducing truncation errors", CACM 8(1), 1965.
#[derive(Clone, Copy, Debug)]
struct CompensatedSum {
    sum: L,
    /// The rounding error of `sum`: the true sum is `sum` − `excess`.
    excess: L,
}

impl CompensatedSum {
    const ZERO: Self = Self { sum: L::ZERO, excess: L::ZERO };

    #[inline(always)]
    fn add(&mut self, value: L) {
        let value = value - self.excess;
        let sum = self.sum + value;
        self.excess = (sum - self.sum) - value;
        self.sum = sum;
    }
    fn get(&self, lane: usize) -> f64 {
        f64::from(self.sum.get(lane)) - f64::from(self.excess.get(lane))
    }
}

impl TileSums {
    /// Creates black sums.
    pub fn new(tile: Tile) -> Self {
        let packets = vec![[CompensatedSum::ZERO; 3]; tile.pixels().div_ceil(L::WIDTH)];
        Self { tile, samples: 0, packets, discarded: Vec::new(), noise: None }
    }

    fn clear(&mut self) {
        self.packets.fill([CompensatedSum::ZERO; 3]);
        self.samples = 0;
        self.discarded.clear();
        if let Some(noise) = &mut self.noise {
            *noise = Noise::new(self.packets.len());
        }
    }

    /// Adds one sample of every pixel: red, green and blue, each padded to whole packets. A sample with a NaN
    /// or infinite channel is discarded and counted.
    pub fn add(&mut self, radiance: [&[f32]; 3]) {
        let channels = radiance.map(|channel| channel.as_chunks::<{ NATIVE_WIDTH }>().0);
        let [r, g, b] = channels.map(|channel| &channel[..self.packets.len()]);
        let packets = self.packets.iter_mut().zip(r).zip(g).zip(b);
        for (packet, (((sums, r), g), b)) in packets.enumerate() {
            // Not arrays: sixteen lanes would go through memory in halves.
            let (mut r, mut g, mut b) = (L::load(r), L::load(g), L::load(b));
            // x · 0 is 0 for every finite x, and NaN otherwise.
            let zero = L::zero();
            let finite = r.mul_add(zero, g.mul_add(zero, b * zero)).eq(zero);
            if !finite.all() {
                count_discarded(&mut self.discarded, self.tile.pixels(), packet, finite);
                (r, g, b) = (r.only(finite), g.only(finite), b.only(finite));
            }
            let [red, green, blue] = sums;
            red.add(r);
            green.add(g);
            blue.add(b);
        }
        if let Some(noise) = &mut self.noise {
            noise.add(self.samples, channels);
        }
        self.samples += 1;
    }

    /// Returns the number of samples discarded because they were not finite.
    pub fn discarded(&self) -> u64 {
        self.discarded.iter().map(|&count| u64::from(count)).sum()
    }

    /// Returns the mean of a pixel's finite samples; black before the first one.
    pub fn mean(&self, slot: usize) -> [f64; 3] {
        let count = self.samples - self.discarded.get(slot).unwrap_or(&0);
        let scale = 1.0 / f64::from(count.max(1));
        let (packet, lane) = (slot / L::WIDTH, slot % L::WIDTH);
        std::array::from_fn(|c| self.packets[packet][c].get(lane) * scale)
    }
}

/// Counts the pixels of a packet whose sample is not finite. Not inlined: it is rare, and would take
/// registers from the loop.
#[cold]
#[inline(never)]
fn count_discarded(discarded: &mut Vec<u32>, pixels: usize, packet: usize, finite: <L as Lane>::Mask) {
    discarded.resize(pixels, 0);
    let lanes = discarded[packet * L::WIDTH..].iter_mut().take(L::WIDTH);
    lanes.enumerate().for_each(|(lane, count)| *count += (!finite.bitmask() >> lane) & 1);
}

impl Film {
    /// The memory of a pixel in bytes while the film's picture is computed: its sums, its share of a tile's
    /// other memory, and its pixel of the picture. Measured: 37 of the program's 38 bytes at 8000×8000.
    pub const BYTES_PER_PIXEL: usize = 3 * size_of::<CompensatedSum>() / L::WIDTH + 1 + size_of::<[f32; 3]>();

    /// Creates an empty film, divided into tiles of at most `tile_size` pixels in width and height.
    pub fn new(resolution: [u32; 2], tile_size: [u32; 2]) -> Self {
        Self::of_tiles(resolution, tile_size, |_| true)
    }

    /// Creates a film of the tiles whose number `keep` accepts, with memory for no others.
    pub fn of_tiles(resolution: [u32; 2], tile_size: [u32; 2], keep: impl Fn(usize) -> bool) -> Self {
        let tiles = Tile::cover(resolution, tile_size).filter(|tile| keep(tile.number));
        Self { resolution, tiles: tiles.map(TileSums::new).collect(), rays: 0 }
    }

    /// Adds variance estimation to the film, which takes [`Noise::BYTES_PER_PIXEL`] more.
    pub fn with_noise(mut self) -> Self {
        self.tiles.iter_mut().for_each(|tile| tile.noise = Some(Noise::new(tile.packets.len())));
        self
    }

    /// Keeps the tiles whose number `keep` accepts and drops the others: a shard of a picture. Pixels of
    /// dropped tiles are black in [`Film::picture`] and count in no other figure.
    pub fn keep_tiles(&mut self, keep: impl Fn(usize) -> bool) {
        self.tiles.retain(|sums| keep(sums.tile.number));
    }

    /// Empties the film and keeps its memory.
    pub fn clear(&mut self) {
        self.tiles.iter_mut().for_each(TileSums::clear);
        self.rays = 0;
    }

    /// Returns the width and height in pixels.
    pub fn resolution(&self) -> [u32; 2] {
        self.resolution
    }
    /// Returns the sums of the tiles, in ascending order of the tiles' numbers.
    pub fn tiles(&self) -> &[TileSums] {
        &self.tiles
    }
    /// Returns the sums of the tiles, to restore them.
    pub fn tiles_mut(&mut self) -> &mut [TileSums] {
        &mut self.tiles
    }
    /// Returns the number of pixels of all tiles.
    pub fn pixels(&self) -> u64 {
        self.tiles.iter().map(|tile| tile.tile.pixels() as u64).sum()
    }
    /// Returns the number of samples that every pixel has, discarded ones included.
    pub fn samples(&self) -> u32 {
        self.tiles.iter().map(|tile| tile.samples).min().unwrap_or(0)
    }
    /// Returns the largest number of samples of a pixel: above [`Film::samples`] after cancellation or
    /// adaptive sampling.
    pub fn most_samples(&self) -> u32 {
        self.tiles.iter().map(|tile| tile.samples).max().unwrap_or(0)
    }
    /// Returns the number of samples summed over all pixels.
    pub fn pixel_samples(&self) -> u64 {
        self.tiles.iter().map(|tile| tile.tile.pixels() as u64 * u64::from(tile.samples)).sum()
    }
    /// Returns the mean number of samples of a pixel.
    pub fn mean_samples(&self) -> f64 {
        self.pixel_samples() as f64 / self.pixels().max(1) as f64
    }
    /// Returns the number of pixels with at least one sample.
    pub fn pixels_begun(&self) -> u64 {
        self.tiles.iter().filter(|tile| tile.samples > 0).map(|tile| tile.tile.pixels() as u64).sum()
    }
    /// Returns the number of rays traced so far: closest-hit or any-hit queries of active lanes.
    pub fn rays(&self) -> u64 {
        self.rays
    }
    /// Counts rays that were traced elsewhere, for sums that were restored.
    pub fn add_rays(&mut self, rays: u64) {
        self.rays = self.rays.saturating_add(rays);
    }
    /// Returns the number of samples discarded because they were not finite. More than 0 means a bug.
    pub fn discarded(&self) -> u64 {
        self.tiles.iter().map(TileSums::discarded).sum()
    }
    /// Returns the mean of each pixel's finite samples, however many other pixels have; black before the
    /// first one.
    pub fn picture(&self) -> Picture {
        let mut picture = Picture::default();
        self.picture_into(&mut picture);
        picture
    }
    /// Writes [`Film::picture`] into an existing picture; allocates only if it grows.
    pub fn picture_into(&self, picture: &mut Picture) {
        self.fill(picture, |tile, slot| tile.mean(slot).map(|channel| channel as f32));
    }
    /// Returns the number of samples of each pixel, in all three channels.
    pub fn counts(&self) -> Picture {
        let mut picture = Picture::default();
        self.fill(&mut picture, |tile, _| [tile.samples as f32; 3]);
        picture
    }

    /// Sets every pixel of the picture to `pixel(tile, slot)`.
    fn fill(&self, picture: &mut Picture, pixel: impl Fn(&TileSums, usize) -> [f32; 3]) {
        let [width, _] = self.resolution;
        picture.resize(self.resolution);
        let pixels = &mut picture.pixels;
        if self.pixels() < pixels.len() as u64 {
            pixels.fill([0.0; 3]);
        }
        for sums in &self.tiles {
            let tile = sums.tile;
            tile.places().enumerate().for_each(|(slot, [x, y])| {
                pixels[y as usize * width as usize + x as usize] = pixel(sums, slot);
            });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hash_is_fnv_1a_of_the_documented_bytes() {
        // Without pixels, the hash of eight zero bytes, computed by a program in another language.
        assert_eq!(Picture::default().hash(), 0xa8c7_f832_281a_39c5);
        let picture = Picture { width: 1, height: 1, pixels: vec![[1.0, -0.0, 0.5]] };
        assert_eq!(picture.hash(), 0x621e_7a67_bada_ad05);
    }

    fn sums(pixels: u32) -> TileSums {
        TileSums::new(Tile { number: 0, x: 0, y: 0, width: pixels, height: 1 })
    }

    #[test]
    fn sums_of_a_million_samples_stay_accurate() {
        let mut sums = sums(16);
        let (samples, value) = (1_000_000, 0.1f32);
        for _ in 0..samples {
            sums.add([&[value; 16], &[1.0; 16], &[0.3; 16]]);
        }
        let truth = f64::from(value) * f64::from(samples);
        let error = (sums.packets[0][0].get(3) - truth).abs() / truth;
        // A plain f32 sum is off by 9e-3 here, and a compensated one whose excess is forgotten at the end by
        // up to 6e-8.
        assert!(error < 1e-9, "relative error {error:e}");
        assert_eq!(sums.packets[0][1].get(7), f64::from(samples));
    }

    #[test]
    fn film_discards_samples_that_are_not_finite_and_counts_them() {
        let mut film = Film::new([9, 1], [16, 16]);
        let mut red = [0.5; 16];
        film.tiles[0].add([&red, &[0.25; 16], &[1.0; 16]]);
        // From the tenth on, elements are padding and must not count.
        (red[2], red[8], red[9]) = (f32::NAN, f32::INFINITY, f32::NAN);
        film.tiles[0].add([&red, &[0.75; 16], &[1.0; 16]]);
        assert_eq!(film.discarded(), 2);
        let pixels = film.picture().pixels;
        assert_eq!(pixels[0], [0.5, 0.5, 1.0]);
        assert_eq!(pixels[2], [0.5, 0.25, 1.0], "the finite sample alone");
        assert_eq!(pixels[8], [0.5, 0.25, 1.0], "the finite sample alone");
    }
}
