//! Adaptive sampling: stopping criteria for blocks of pixels.
//!
//! # The error of a block
//! A block is a tile of the film. Its error is the root mean square, over its pixels, of the standard error
//! of a pixel's luminance ([`crate::film::noise`]) relative to the pixel's luminance, which is limited
//! - above, to the block's mean: otherwise a firefly would raise its pixel's mean and so lower its own
//!   relative error;
//! - below, to [`LUMINANCE_FLOOR`] times the picture's brightness: relative errors of nearly black pixels are
//!   not visible.
//!
//! The picture's brightness is the square of the mean root of the blocks' luminance, so that a small bright
//! light or sun has little influence. Relative standard errors with a floor are the stopping criterion of
//! Mitsuba's adaptive integrator (W. Jakob, 2010, version 0.6; pixel by pixel, floor 1 %), the means over
//! blocks are those of Dammertz, Hanika, Keller, Lensch, "A Hierarchical Automatic Stopping Condition for
//! Monte Carlo Global Illumination", WSCG 2010.
//!
//! # Guarantee
//! The root mean square of the errors over the picture is at most the target, and no block's error is above
//! [`MAX_BLOCK_ERROR`] times the target. Equal errors in all blocks would be best only for the worst block: a
//! block with n samples of relative standard deviation σ contributes σ²/n, and for a given sum of n these
//! contributions are smallest if n is proportional to σ, not to σ². A block may therefore have the error
//! target · √(σ / mean σ): blocks with four times the mean σ get four times its samples and twice its error.
//! If every block had the same error, the picture's would be no smaller than if all pixels had the mean
//! number of samples.
//!
//! # Rounds
//! All blocks begin with `least` samples. After each round the samples of every unfinished block are doubled;
//! 16, 32, 64, … keep the nets of Sobol's sequence whole. A block is finished when its error is within its
//! tolerance, and
//! - no neighbouring block has more than [`MAX_SAMPLE_RATIO`] times as many samples: the light paths that
//!   make a block noisy often reach its neighbours as well, where no sample may have found them yet;
//! - it has found light, or has [`BLACK_SAMPLES`] samples a pixel: if all are black, the estimate is 0 and
//!   meaningless.
//!
//! Decisions depend only on the film, between rounds: they are the same for any number of threads and lanes.
//! They do depend on the tiles, which are the blocks.
//!
//! # Bias
//! Stopping by an estimate from the same samples is biased in principle: samples that by chance have a low
//! variance are kept, those with a high one are diluted (Kirk, Arvo, "Unbiased Sampling Techniques for Image
//! Synthesis", SIGGRAPH 1991). Their remedy, to decide by samples that are then discarded, costs half of all
//! samples where counts double, more than adaptive sampling gains; and a block that happens to find rare
//! light would keep it as fireflies. Here 256 pixels decide together, so that a pixel's own noise has little
//! influence. Measured, means of 12 to 24 seeds against long runs: less than 2e-4 of the brightness in the
//! scenes `three`, `thesis` and `chess` at targets from 0.1 to 0.2 (`tests/pictures/adaptive_laws.rs` holds
//! it below a hundredth of the target), nothing above the uncertainty of 1e-3 in `spheres` and
//! `cornell-spheres`. The bias shows if blocks stop before they have found rare paths: a floor under a
//! uniform sky with a sixth of its light from a light that one path in 18,000 finds came out 2.3 % too dark
//! at a target of 0.2 and at most 2,048 samples; with one path in 1,600, 0.1 %.
//!
//! # Gain
//! Rays to the same relative error over the picture, uniform over adaptive sampling, at 240×135 and targets
//! of 0.05 and 0.1: `chess` 1.5, `three` 1.2 to 1.5, `thesis` 1.3, `spheres` 1.1, `cornell-spheres` 1.0,
//! where all blocks are equally noisy. For the absolute error, to which dark parts contribute little, 0.9 to
//! 1.2.

use crate::film::Film;
use crate::film::TileSums;
use crate::film::noise::luminance;
use serde::Serialize;

/// The lower limit of a pixel's luminance in its relative error, as a share of the picture's brightness.
pub const LUMINANCE_FLOOR: f64 = 0.1;
/// The largest error of a block, as a multiple of the target.
pub const MAX_BLOCK_ERROR: f64 = 2.0;
/// The largest ratio of samples between neighbouring blocks that lets the lower one finish.
pub const MAX_SAMPLE_RATIO: u32 = 16;
/// A block without light counts as black from this number of samples of each pixel on.
pub const BLACK_SAMPLES: u32 = 256;

/// The target of adaptive sampling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The largest root mean square error of the picture.
    pub error: f64,
    /// The smallest number of samples of a pixel.
    pub least: u32,
    /// The largest number of samples of a pixel.
    pub most: u32,
}

/// The statistics of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Block {
    pixels: usize,
    samples: u32,
    /// The mean luminance.
    luminance: f64,
    /// The error, infinite before the first estimate.
    error: f64,
}

/// The samples to take next.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    /// The number of samples that each tile shall have, by tile number; unspecified for tiles outside the
    /// film.
    pub goals: Vec<u32>,
    /// The expected number of samples of the whole picture, if each block's error falls with the square root
    /// of its number of samples.
    pub forecast: u64,
}

impl Round {
    /// Returns the round after which every pixel has `samples` samples; `None` if all have them.
    pub fn equal(film: &Film, samples: u32) -> Option<Self> {
        let numbers = film.tiles.last().map_or(0, |tile| tile.tile.number + 1);
        let forecast = film.pixels() * u64::from(samples);
        (film.samples() < samples).then_some(Self { goals: vec![samples; numbers], forecast })
    }
    /// Returns the largest number of samples that a tile lacks, and the pixels of all tiles that lack some.
    pub fn missing(&self, film: &Film) -> (u32, u64) {
        let goals = film.tiles.iter().map(|tile| (tile, self.goals[tile.tile.number]));
        let lacking = goals.filter(|(tile, goal)| tile.samples < *goal);
        lacking.fold((0, 0), |(most, pixels), (tile, goal)| {
            (most.max(goal - tile.samples), pixels + tile.tile.pixels() as u64)
        })
    }
}

/// The estimated error of a film's picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ErrorEstimate {
    /// The root mean square of the blocks' errors over the picture; infinite before the first estimate.
    pub rms: f64,
    /// The largest error of a block; infinite before the first estimate.
    pub largest: f64,
}

impl ErrorEstimate {
    /// Estimates a film's error.
    ///
    /// # Panics
    /// If the film does not estimate its variance: see [`crate::render::Renderer::film_with_noise`].
    pub fn of(film: &Film) -> Self {
        Self::all(&blocks(film))
    }
    fn all(blocks: &[Block]) -> Self {
        let squares = mean(blocks, |block| block.error.powi(2));
        Self { rms: squares.sqrt(), largest: blocks.iter().map(|block| block.error).fold(0.0, f64::max) }
    }
}

impl Block {
    /// Returns the relative standard deviation of single samples.
    fn deviation(&self) -> f64 {
        self.error * f64::from(self.samples).sqrt()
    }
}

/// Returns the mean over the pixels of a picture.
fn mean(blocks: &[Block], of: impl Fn(&Block) -> f64) -> f64 {
    let (mut sum, mut pixels) = (0.0, 0.0);
    for block in blocks {
        sum += block.pixels as f64 * of(block);
        pixels += block.pixels as f64;
    }
    sum / pixels
}

impl Target {
    /// Tests whether the error is within the target.
    pub fn met(&self, error: &ErrorEstimate) -> bool {
        error.rms <= self.error && error.largest <= MAX_BLOCK_ERROR * self.error
    }

    /// Returns the next round; `None` if every block is finished or has the largest number of samples.
    ///
    /// # Panics
    /// If the film does not estimate its variance: see [`ErrorEstimate::of`].
    pub fn next(&self, film: &Film) -> Option<Round> {
        let blocks = blocks(film);
        let columns = film.tiles.iter().take_while(|tile| tile.tile.y == 0).count();
        let enough = ErrorEstimate::all(&blocks).rms <= self.error;
        let known = |block: &Block| if block.error.is_finite() { block.deviation() } else { 0.0 };
        let deviation = mean(&blocks, known);
        let mut round = Round { goals: Vec::with_capacity(blocks.len()), forecast: 0 };
        let mut more = false;
        for (at, block) in blocks.iter().enumerate() {
            // If all samples are equal, this is 0 / 0: any tolerance is met.
            let share = (block.deviation() / deviation).sqrt().min(MAX_BLOCK_ERROR);
            let tolerance = self.error * if enough || share.is_nan() { MAX_BLOCK_ERROR } else { share };
            let goal = self.goal(&blocks, columns, at, tolerance);
            more |= goal > block.samples;
            let expected = f64::from(block.samples) * (block.error / tolerance).powi(2);
            let expected = if goal > block.samples && expected.is_finite() { expected as u32 } else { goal };
            round.forecast += block.pixels as u64 * u64::from(expected.clamp(goal, self.most.max(goal)));
            round.goals.push(goal);
        }
        more.then_some(round)
    }

    /// Returns the number of samples that a block shall have next: the present one if it is finished.
    fn goal(&self, blocks: &[Block], columns: usize, at: usize, tolerance: f64) -> u32 {
        let Block { samples, luminance, error, .. } = blocks[at];
        let least = self.least.min(self.most);
        if samples < least {
            return least;
        }
        let neighbours = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
        let (x, y) = (at % columns, at / columns);
        let mut around = neighbours(y, blocks.len() / columns)
            .flat_map(|y| neighbours(x, columns).map(move |x| y * columns + x));
        let far_fewer = around.any(|other| blocks[other].samples > samples.saturating_mul(MAX_SAMPLE_RATIO));
        let black = luminance == 0.0 && samples < BLACK_SAMPLES;
        let done = error <= tolerance && !far_fewer && !black;
        if done { samples } else { samples.saturating_mul(2).min(self.most).max(samples) }
    }
}

fn blocks(film: &Film) -> Vec<Block> {
    let luminances: Vec<f64> = film.tiles.iter().map(mean_luminance).collect();
    let floor = LUMINANCE_FLOOR * brightness(film, &luminances);
    film.tiles.iter().zip(luminances).map(|(tile, luminance)| block(tile, luminance, floor)).collect()
}

fn mean_luminance(tile: &TileSums) -> f64 {
    let pixels = tile.tile.pixels();
    (0..pixels).map(|slot| luminance(tile.mean(slot))).sum::<f64>() / pixels as f64
}

/// Returns the square of the mean root of the blocks' luminance.
fn brightness(film: &Film, luminances: &[f64]) -> f64 {
    let tiles = film.tiles.iter().zip(luminances);
    let roots = tiles.map(|(tile, luminance)| tile.tile.pixels() as f64 * luminance.max(0.0).sqrt());
    let [width, height] = film.resolution().map(f64::from);
    (roots.sum::<f64>() / (width * height)).powi(2)
}

/// Returns the statistics of a tile whose [`mean_luminance`] is `mean`.
fn block(tile: &TileSums, mean: f64, floor: f64) -> Block {
    let noise = tile.noise.as_ref().expect("the film estimates its variance");
    let pixels = tile.tile.pixels();
    let squares = (0..pixels).map(|slot| {
        let variance = noise.variance_of_mean(slot, tile.samples);
        let against = luminance(tile.mean(slot)).min(mean).max(floor);
        if variance == 0.0 { 0.0 } else { variance / against.powi(2) }
    });
    let error = (squares.sum::<f64>() / pixels as f64).sqrt();
    Block {
        pixels,
        samples: tile.samples,
        luminance: mean,
        error: if error.is_nan() { f64::INFINITY } else { error },
    }
}
