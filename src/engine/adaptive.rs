//! When a block of pixels has had samples enough.
//!
//! For: [`Target`], which says after each round how many samples each block shall have next. May import: `film`. Must never know: rays,
//! threads, clocks.
//!
//! # The error of a block
//! A block is a tile of the film. Its error is the root mean square, over its pixels, of the standard error of a pixel's luminance
//! ([`crate::film::noise`]) relative to the pixel's luminance, which here counts
//! - for no more than the block's mean: a single bright sample makes its own pixel bright, and would excuse itself;
//! - for no less than [`FLOOR`] of the picture's brightness: nobody sees a few per cent of nearly black.
//!
//! The picture's brightness is the square of the mean root of the blocks' luminance, so that a small bright lamp or sun does not
//! count for much. Relative standard errors with a floor are what Mitsuba's adaptive integrator stops at (W. Jakob, 2010, version 0.6;
//! pixel by pixel, floor 1 %), the means over blocks are those of Dammertz, Hanika, Keller, Lensch, "A Hierarchical Automatic
//! Stopping Condition for Monte Carlo Global Illumination", WSCG 2010.
//!
//! # What is promised
//! The root mean square of the errors over the picture is at most the target, and no block's is above [`WORST`] times the target. That is not
//! the same error for all blocks, which is best for the worst one alone: a block whose samples have the relative standard deviation σ and
//! that has had n of them adds σ²/n, and for a given sum of n these add up to least where n goes with σ, not with σ². So a block may have
//! the error target · √(σ / mean σ): blocks four times as hard as the mean get four times its samples and twice its error. With every block
//! at the same error the picture's is no smaller than if all pixels had had the mean number of samples.
//!
//! # Rounds
//! All blocks begin with `least` samples. After each round every block that is not done takes as many again as it has had; 16, 32, 64, …
//! keep the nets of Sobol's sequence whole. A block is done when its error is as small as it may be, and
//! - no block beside it has had more than [`STEEPEST`] times as many samples: what makes a block noisy often shines into its neighbours as well,
//!   where no sample may have found it yet;
//! - it has found light, or has looked for it with [`DARK`] samples a pixel: where all samples are black, the estimate is 0 and says nothing.
//!
//! A decision reads nothing but the film, between rounds: it is the same for any number of threads and lanes. It does depend on the tiles,
//! which are its blocks.
//!
//! # Bias
//! Who stops by his own estimate is biased in principle: samples that by chance look calm are kept, those that do not are watered down
//! (Kirk, Arvo, "Unbiased Sampling Techniques for Image Synthesis", SIGGRAPH 1991). Their remedy, deciding by samples that are then not shown,
//! costs half of all samples where counts double, more than stopping early gains; and a block that happens to find rare light would keep it as
//! bright dots. Here 256 pixels decide together, so that a pixel's own noise hardly counts. Measured, means of 12 to 24 seeds against long
//! runs: less than 2e-4 of the brightness in the scenes `three`, `thesis` and `chess` at targets from 0.1 to 0.2 (`tests/adaptive.rs` holds it below a
//! hundredth of the target), nothing above the uncertainty of 1e-3 in `spheres` and `cornell-spheres`. It shows where blocks stop before they
//! have met what is rare: a floor under a calm sky with a sixth of its light from a lamp that one path in 18,000 finds came out 2.3 % too dark at a target
//! of 0.2 and at most 2,048 samples; with one path in 1,600, 0.1 %.
//!
//! # Gain
//! Rays to the same relative error over the picture, every pixel alike over stopping early, at 240×135 and targets of 0.05 and 0.1: `chess`
//! 1.5 times as many, `three` 1.2 to 1.5, `thesis` 1.3, `spheres` 1.1, `cornell-spheres` 1.0, where all is equally hard. For the absolute error,
//! to which dark parts add little, 0.9 to 1.2 times.

use crate::film::Film;
use crate::film::TileSums;
use crate::film::noise::luminance;

/// Of the picture's brightness: pixels darker than this are judged as if they were not.
pub const FLOOR: f64 = 0.1;
/// How many times the target a block's error may be.
pub const WORST: f64 = 2.0;
/// How many times as many samples a neighbour may have.
pub const STEEPEST: u32 = 16;
/// Samples of each pixel after which a block that has found no light counts as black.
pub const DARK: u32 = 256;

/// What to reach.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// The root mean square error that the picture shall have at most.
    pub error: f64,
    /// The fewest and most samples of a pixel.
    pub least: u32,
    pub most: u32,
}

/// What is known of a block.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Block {
    pixels: usize,
    samples: u32,
    /// Mean luminance.
    luminance: f64,
    /// Infinite where nothing is known.
    error: f64,
}

/// What is to be done next.
#[derive(Clone, Debug, PartialEq)]
pub struct Round {
    /// Samples to bring each tile to, by number.
    pub goals: Vec<u32>,
    /// Samples of single pixels that the whole picture will probably take, if each block's error goes on falling with the root of
    /// its samples.
    pub forecast: u64,
}

impl Round {
    /// As many samples for every pixel; none if all have had them.
    pub fn equal(film: &Film, samples: u32) -> Option<Self> {
        let [width, height] = film.resolution().map(u64::from);
        let goals = vec![samples; film.tiles.len()];
        (film.samples() < samples).then_some(Self { goals, forecast: width * height * u64::from(samples) })
    }
    /// The most samples that a tile lacks, and the pixels of all tiles that lack some.
    pub fn missing(&self, film: &Film) -> (u32, u64) {
        let lacking = film.tiles.iter().zip(&self.goals).filter(|(tile, goal)| tile.samples < **goal);
        lacking.fold((0, 0), |(most, pixels), (tile, goal)| {
            (most.max(goal - tile.samples), pixels + tile.tile.pixels() as u64)
        })
    }
}

/// How noisy a film's picture is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reached {
    /// The root mean square of the blocks' errors over the picture, and the largest error of a block; infinite where nothing is known.
    pub rms: f64,
    pub largest: f64,
}

impl Reached {
    /// What a film has reached.
    ///
    /// # Panics
    /// If the film does not sum noise: see [`crate::render::Renderer::film_with_noise`].
    pub fn of(film: &Film) -> Self {
        Self::all(&blocks(film))
    }
    fn all(blocks: &[Block]) -> Self {
        let squares = mean(blocks, |block| block.error.powi(2));
        Self { rms: squares.sqrt(), largest: blocks.iter().map(|block| block.error).fold(0.0, f64::max) }
    }
}

impl Block {
    /// The relative standard deviation of single samples.
    fn deviation(&self) -> f64 {
        self.error * f64::from(self.samples).sqrt()
    }
}

/// The mean over the pixels of a picture.
fn mean(blocks: &[Block], of: impl Fn(&Block) -> f64) -> f64 {
    let (mut sum, mut pixels) = (0.0, 0.0);
    for block in blocks {
        sum += block.pixels as f64 * of(block);
        pixels += block.pixels as f64;
    }
    sum / pixels
}

impl Target {
    /// Is it reached?
    pub fn met(&self, reached: &Reached) -> bool {
        reached.rms <= self.error && reached.largest <= WORST * self.error
    }

    /// The next round; none if no block needs one, or may have more samples.
    ///
    /// # Panics
    /// As [`Reached::of`].
    pub fn next(&self, film: &Film) -> Option<Round> {
        let blocks = blocks(film);
        let columns = film.tiles.iter().take_while(|tile| tile.tile.y == 0).count();
        let enough = Reached::all(&blocks).rms <= self.error;
        let known = |block: &Block| if block.error.is_finite() { block.deviation() } else { 0.0 };
        let deviation = mean(&blocks, known);
        let mut round = Round { goals: Vec::with_capacity(blocks.len()), forecast: 0 };
        let mut more = false;
        for (at, block) in blocks.iter().enumerate() {
            // Where all samples are equal, 0 / 0: no error is none too many.
            let share = (block.deviation() / deviation).sqrt().min(WORST);
            let tolerance = self.error * if enough || share.is_nan() { WORST } else { share };
            let goal = self.goal(&blocks, columns, at, tolerance);
            more |= goal > block.samples;
            let still = f64::from(block.samples) * (block.error / tolerance).powi(2);
            let still = if goal > block.samples && still.is_finite() { still as u32 } else { goal };
            round.forecast += block.pixels as u64 * u64::from(still.clamp(goal, self.most.max(goal)));
            round.goals.push(goal);
        }
        more.then_some(round)
    }

    /// Samples that a block shall have next: as many as it has had if it is done.
    fn goal(&self, blocks: &[Block], columns: usize, at: usize, tolerance: f64) -> u32 {
        let Block { samples, luminance, error, .. } = blocks[at];
        let least = self.least.min(self.most);
        if samples < least {
            return least;
        }
        let beside = |at: usize, count: usize| at.saturating_sub(1)..(at + 2).min(count);
        let (x, y) = (at % columns, at / columns);
        let mut around =
            beside(y, blocks.len() / columns).flat_map(|y| beside(x, columns).map(move |x| y * columns + x));
        let steep = around.any(|other| blocks[other].samples > samples.saturating_mul(STEEPEST));
        let dark = luminance == 0.0 && samples < DARK;
        let done = error <= tolerance && !steep && !dark;
        if done { samples } else { samples.saturating_mul(2).min(self.most).max(samples) }
    }
}

fn blocks(film: &Film) -> Vec<Block> {
    let luminances: Vec<f64> = film.tiles.iter().map(mean_luminance).collect();
    let floor = FLOOR * brightness(film, &luminances);
    film.tiles.iter().zip(luminances).map(|(tile, luminance)| block(tile, luminance, floor)).collect()
}

fn mean_luminance(tile: &TileSums) -> f64 {
    let pixels = tile.tile.pixels();
    (0..pixels).map(|slot| luminance(tile.mean(slot))).sum::<f64>() / pixels as f64
}

/// The square of the mean root of the blocks' luminance.
fn brightness(film: &Film, luminances: &[f64]) -> f64 {
    let tiles = film.tiles.iter().zip(luminances);
    let roots = tiles.map(|(tile, luminance)| tile.tile.pixels() as f64 * luminance.max(0.0).sqrt());
    let [width, height] = film.resolution().map(f64::from);
    (roots.sum::<f64>() / (width * height)).powi(2)
}

/// `mean`: the tile's [`mean_luminance`].
fn block(tile: &TileSums, mean: f64, floor: f64) -> Block {
    let noise = tile.noise.as_ref().expect("the film was made to sum noise");
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
