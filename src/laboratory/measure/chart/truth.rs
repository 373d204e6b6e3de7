//! The picture that all others are held against, and how far it is from the true one itself.
//!
//! For: [`Truth`]. May import: `render`, `film`, `errors`. Must never know: files.
//!
//! It is rendered with independent numbers (where the default spreads its own) and seeds of its own, in two halves. Half their distance is the
//! standard error of their mean. At a third of the size, every pixel is the mean of 3×3 pixels: cameras look through the middle of the
//! same rectangle, and pixels are averaged over their whole area, so that is the same picture with nine times the samples.

use crate::film::{Film, Picture};
use crate::measure::errors::Errors;
use crate::render::{Renderer, Settings};
use crate::sampling::Sampler;
use crate::scene::{Camera, Scene};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// So many pixels of a frame, in width and in height, are one of the small pictures.
pub const SHRINK: u32 = 3;

/// Seeds of the halves: no seed of a measured picture.
const SEEDS: [u32; 2] = [0x7472_7574, 0x7472_7575];

/// A picture at two sizes, with what is known of its error.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    pub frame: Picture,
    pub small: Picture,
    pub quality: Quality,
}

/// How good a truth is.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quality {
    /// Samples per pixel of the frame; the small picture has [`SHRINK`]² times as many.
    pub samples: u32,
    /// Its own standard error: root mean square over pixels and channels.
    pub frame_rmse: f64,
    pub small_rmse: f64,
    /// Seconds of the budget of the run that made it.
    pub budget_s: f64,
    /// Was it read from an earlier run?
    #[serde(default)]
    pub cached: bool,
}

/// A truth in the making.
pub struct Making {
    renderers: [Renderer; 2],
    films: [Film; 2],
}

impl Making {
    /// `settings` are the default's for frames.
    pub fn new(scene: &Scene, settings: Settings, threads: usize) -> Self {
        let mut methods = settings.methods;
        methods.sampler = Sampler::Random;
        let of = |seed| Renderer::new(scene, Settings { methods, seed, threads, ..settings });
        let renderers = SEEDS.map(of);
        let films = renderers.each_ref().map(Renderer::film);
        Self { renderers, films }
    }

    /// Begins anew with another camera.
    pub fn look(&mut self, scene: &Scene, camera: &Camera, settings: &Settings) {
        for (renderer, film) in self.renderers.iter_mut().zip(&mut self.films) {
            renderer.set_view(scene, camera, settings.resolution, settings.max_bounces);
            film.clear();
        }
    }

    /// Takes samples until `end`, which is what `budget` leaves it, or until there are `most`; at least one for each half.
    pub fn until(&mut self, end: Instant, most: u32, budget: Duration) -> Truth {
        let of_half = most.div_ceil(2).max(1);
        loop {
            // Many at once spare waking threads, few at once keep the end in sight.
            let had = self.films[0].samples();
            let samples = (had / 16).clamp(1, of_half - had);
            for (renderer, film) in self.renderers.iter().zip(&mut self.films) {
                renderer.add_samples(film, samples);
            }
            if Instant::now() >= end || self.films[0].samples() >= of_half {
                let halves = self.films.each_ref().map(Film::picture);
                return Truth::of_halves(halves, self.films[0].samples(), budget);
            }
        }
    }
}

impl Truth {
    fn of_halves([a, b]: [Picture; 2], samples_of_half: u32, budget: Duration) -> Self {
        let [small_a, small_b] = [&a, &b].map(shrunk);
        let half_distance = |a: &Picture, b: &Picture| Errors::of(a, b).rmse / 2.0;
        let quality = Quality {
            samples: 2 * samples_of_half,
            frame_rmse: half_distance(&a, &b),
            small_rmse: half_distance(&small_a, &small_b),
            budget_s: budget.as_secs_f64(),
            cached: false,
        };
        Self { frame: mean(&a, &b), small: mean(&small_a, &small_b), quality }
    }

    /// From a frame that was kept.
    pub fn kept(frame: Picture, quality: Quality) -> Self {
        let small = shrunk(&frame);
        Self { frame, small, quality: Quality { cached: true, ..quality } }
    }

    /// Samples per pixel of the small picture.
    pub fn small_samples(&self) -> u32 {
        self.quality.samples * SHRINK * SHRINK
    }
}

/// The root mean square error of a picture, given that against a truth which has one of its own; the two are independent, so their squares
/// add up. Not a number where the truth's is the larger: then nothing is known but that it is smaller.
pub fn corrected(rmse: f64, of_truth: f64) -> f64 {
    (rmse * rmse - of_truth * of_truth).sqrt()
}

fn mean(a: &Picture, b: &Picture) -> Picture {
    let both = |(a, b): (&[f32; 3], &[f32; 3])| std::array::from_fn(|c| 0.5 * (a[c] + b[c]));
    Picture { pixels: a.pixels.iter().zip(&b.pixels).map(both).collect(), ..*a }
}

/// Each pixel the mean of [`SHRINK`]².
///
/// # Panics
/// If the sides are no multiples of it.
fn shrunk(picture: &Picture) -> Picture {
    let [width, height] = [picture.width, picture.height].map(|side| {
        assert_eq!(side % SHRINK, 0, "a side of {side} pixels");
        side / SHRINK
    });
    let pixel = |(x, y): (u32, u32)| {
        let mut sums = [0.0f64; 3];
        for (dx, dy) in (0..SHRINK).flat_map(|dy| (0..SHRINK).map(move |dx| (dx, dy))) {
            let at = (y * SHRINK + dy) as usize * picture.width as usize + (x * SHRINK + dx) as usize;
            sums = std::array::from_fn(|c| sums[c] + f64::from(picture.pixels[at][c]));
        }
        sums.map(|sum| (sum / f64::from(SHRINK * SHRINK)) as f32)
    };
    let places = (0..height).flat_map(|y| (0..width).map(move |x| (x, y)));
    Picture { width, height, pixels: places.map(pixel).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn truth(samples: u32) -> Truth {
        truth_of("builtin:cornell", samples)
    }

    fn truth_of(scene: &str, samples: u32) -> Truth {
        let scene = octray_formats::scene::load(scene).unwrap();
        let settings = Settings { resolution: [48, 27], ..Settings::of(&scene) };
        let budget = Duration::from_secs(60);
        Making::new(&scene, settings, 1).until(Instant::now() + budget, samples, budget)
    }

    #[test]
    fn own_error_is_that_against_a_better_truth() {
        let (rough, fine) = (truth(16), truth(1_600));
        assert_eq!((rough.quality.samples, fine.quality.samples), (16, 1_600));
        for (rough_picture, fine_picture, rmse, of_fine) in [
            (&rough.frame, &fine.frame, rough.quality.frame_rmse, fine.quality.frame_rmse),
            (&rough.small, &fine.small, rough.quality.small_rmse, fine.quality.small_rmse),
        ] {
            let measured = corrected(Errors::of(rough_picture, fine_picture).rmse, of_fine);
            assert!((0.8..1.25).contains(&(measured / rmse)), "{measured} against {rmse}");
        }
    }

    /// In a scene in which no few pixels hold most of the noise, as those at the rim of a lamp do: one distance says little of few.
    #[test]
    fn own_error_falls_with_the_root_of_samples_as_that_of_independent_numbers() {
        let [few, many] = [16, 1_600].map(|samples| truth_of("builtin:three", samples).quality);
        for falls in [few.frame_rmse / many.frame_rmse, few.small_rmse / many.small_rmse] {
            assert!((8.5..11.5).contains(&falls), "{falls}");
        }
    }

    #[test]
    fn independent_errors_add_up_in_their_squares() {
        assert!((corrected(5.0, 3.0) - 4.0).abs() < 1e-12);
        assert!(corrected(1.0, 1.1).is_nan());
    }

    #[test]
    fn small_truth_is_what_rendering_small_gives() {
        let scene = octray_formats::scene::load("builtin:cornell").unwrap();
        let settings = Settings { resolution: [16, 9], seed: 5, ..Settings::of(&scene) };
        let renderer = Renderer::new(&scene, settings);
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 2_048);
        let truth = truth(800);
        let brightness = truth.small.pixels.iter().flatten().map(|&c| f64::from(c)).sum::<f64>() / 432.0;
        let distance = Errors::of(&film.picture(), &truth.small).rmse;
        // Noise of both, and nothing else: an eighth of a pixel's shift gives 0.05.
        assert!(distance < 0.03 * brightness.max(0.1), "{distance}, brightness {brightness}");
    }
}
