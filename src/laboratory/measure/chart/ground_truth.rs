//! The ground truth: the converged picture with which all others are compared, and its own standard error.
//!
//! It is rendered with independent random numbers (the default's are low-discrepancy) and its own seeds, in
//! two halves. Half the distance of the halves is the standard error of their mean. At a third of the size,
//! every pixel is the mean of 3×3 pixels: the view is the same and pixels are averaged over their whole area,
//! so this is the same picture with nine times the samples.

use crate::film::{Film, Picture};
use crate::measure::errors::Errors;
use crate::measure::quantiles::Spread;
use crate::render::{Renderer, Settings};
use crate::sampling::Sampler;
use crate::scene::{Camera, Scene};
use serde::{Deserialize, Serialize};
use std::time::{Duration, Instant};

/// Width and height of a frame over those of the small picture.
pub const SHRINK: u32 = 3;

/// Most samples of a frame: 33 times those after half a second at a thousand frames per second. At the small
/// size there are more than [`super::pictures::GROUND_TRUTH_FACTOR`] times those of the best picture.
pub(crate) const MOST_SAMPLES: u32 = 16_384;

/// Seeds of the halves. No measured picture has them.
const SEEDS: [u32; 2] = [0x7472_7574, 0x7472_7575];

/// A picture at two sizes, with its own error.
#[derive(Clone, Debug, PartialEq)]
pub struct GroundTruth {
    /// Picture at the size of frames, linear RGB.
    pub frame: Picture,
    /// Picture of the same view at 1/[`SHRINK`] of the width and height: each pixel the mean of a square.
    pub(crate) small: Picture,
    /// Its samples and its own error.
    pub info: GroundTruthInfo,
}

/// Samples and standard error of a ground truth; `octray chart` keeps it in a file beside the picture.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GroundTruthInfo {
    /// Samples per pixel of the frame; the small picture has [`SHRINK`]² times as many.
    pub samples: u32,
    /// Standard error of the frame: root mean square over pixels and channels.
    pub frame_rmse: f64,
    /// Standard error of the small picture.
    pub small_rmse: f64,
    /// Time budget, in seconds, of the run that rendered it.
    pub budget_s: f64,
    /// Whether it was read from an earlier run.
    #[serde(default)]
    pub cached: bool,
}

impl GroundTruthInfo {
    /// Tests whether a ground truth of an earlier run is good enough for a run with this budget. One from a
    /// run with much less time would limit the samples of all pictures.
    pub fn is_enough_for(&self, budget: Duration) -> bool {
        self.samples >= MOST_SAMPLES || self.budget_s >= 0.5 * budget.as_secs_f64()
    }
}

/// Renders a ground truth.
pub(crate) struct GroundTruthRenderer {
    renderers: [Renderer; 2],
    films: [Film; 2],
}

impl GroundTruthRenderer {
    /// Prepares the two halves. `settings` are those of frames.
    pub fn new(scene: &Scene, settings: Settings, threads: usize) -> Self {
        let mut methods = settings.methods;
        methods.sampler = Sampler::Random;
        let of = |seed| Renderer::new(scene, Settings { methods, seed, threads, ..settings });
        let renderers = SEEDS.map(of);
        let films = renderers.each_ref().map(Renderer::film);
        Self { renderers, films }
    }

    /// Starts again with another camera.
    pub fn set_camera(&mut self, camera: &Camera, settings: &Settings) {
        for (renderer, film) in self.renderers.iter_mut().zip(&mut self.films) {
            renderer.set_view(camera, settings.resolution, settings.max_bounces);
            film.clear();
        }
    }

    /// Takes samples until `end` or up to `most`, at least one for each half. `budget` is only recorded.
    pub fn render_until(&mut self, end: Instant, most: u32, budget: Duration) -> GroundTruth {
        let of_half = most.div_ceil(2).max(1);
        loop {
            // Large batches wake threads less often, small ones overrun `end` less.
            let had = self.films[0].samples();
            let samples = (had / 16).clamp(1, of_half - had);
            for (renderer, film) in self.renderers.iter().zip(&mut self.films) {
                renderer.add_samples(film, samples);
            }
            if Instant::now() >= end || self.films[0].samples() >= of_half {
                let halves = self.films.each_ref().map(Film::picture);
                return GroundTruth::of_halves(halves, self.films[0].samples(), budget);
            }
        }
    }
}

#[cfg(test)]
impl GroundTruthRenderer {
    /// Renders so many samples, without a time limit.
    pub fn render(&mut self, samples: u32) -> GroundTruth {
        let hour = Duration::from_secs(3_600);
        self.render_until(Instant::now() + hour, samples, hour)
    }
}

impl GroundTruth {
    fn of_halves([a, b]: [Picture; 2], samples_of_half: u32, budget: Duration) -> Self {
        let [small_a, small_b] = [&a, &b].map(shrunk);
        let half_distance = |a: &Picture, b: &Picture| Errors::of(a, b).rmse / 2.0;
        let info = GroundTruthInfo {
            samples: 2 * samples_of_half,
            frame_rmse: half_distance(&a, &b),
            small_rmse: half_distance(&small_a, &small_b),
            budget_s: budget.as_secs_f64(),
            cached: false,
        };
        Self { frame: mean(&a, &b), small: mean(&small_a, &small_b), info }
    }

    /// Builds a ground truth from the frame of an earlier run.
    pub fn from_kept(frame: Picture, info: GroundTruthInfo) -> Self {
        let small = shrunk(&frame);
        Self { frame, small, info: GroundTruthInfo { cached: true, ..info } }
    }

    /// Returns the samples per pixel of the small picture.
    pub(crate) fn small_samples(&self) -> u32 {
        self.info.samples * SHRINK * SHRINK
    }

    /// Returns the errors of several pictures against this frame, each corrected; `None` where one is below
    /// the frame's own.
    pub(crate) fn corrected_rmse(&self, rmse: impl IntoIterator<Item = f64>) -> Option<Spread> {
        let own = self.info.frame_rmse;
        let corrected: Vec<f64> = rmse.into_iter().map(|rmse| corrected(rmse, own)).collect();
        corrected.iter().all(|&error| error >= own).then(|| Spread::of(corrected))
    }
}

/// Returns the root mean square error of a picture without the part of the ground truth's own error; the two
/// are independent, so their squares add up. NaN where the ground truth's is larger: the picture's error is
/// then unknown, but smaller.
pub(crate) fn corrected(rmse: f64, of_ground_truth: f64) -> f64 {
    (rmse * rmse - of_ground_truth * of_ground_truth).sqrt()
}

fn mean(a: &Picture, b: &Picture) -> Picture {
    let both = |(a, b): (&[f32; 3], &[f32; 3])| std::array::from_fn(|c| 0.5 * (a[c] + b[c]));
    Picture { pixels: a.pixels.iter().zip(&b.pixels).map(both).collect(), ..*a }
}

/// Returns the small picture: each pixel the mean of [`SHRINK`]² pixels.
///
/// # Panics
/// If a side is no multiple of [`SHRINK`].
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

    #[test]
    fn ground_truth_of_a_run_with_much_less_time_is_not_enough() {
        let kept = |samples| GroundTruthInfo { samples, budget_s: 20.0, ..GroundTruthInfo::default() };
        let is_enough = |samples, seconds| kept(samples).is_enough_for(Duration::from_secs(seconds));
        assert!(is_enough(100, 30) && !is_enough(100, 50));
        assert!(is_enough(MOST_SAMPLES, 5000), "there is none better");
    }

    fn cornell(samples: u32) -> GroundTruth {
        let scene = octray_formats::scene::load("builtin:cornell").unwrap();
        let settings = Settings { resolution: [48, 27], ..Settings::of(&scene) };
        GroundTruthRenderer::new(&scene, settings, 1).render(samples)
    }

    #[test]
    fn own_error_is_that_against_a_better_ground_truth() {
        let (rough, fine) = (cornell(16), cornell(1_600));
        assert_eq!((rough.info.samples, fine.info.samples), (16, 1_600));
        for (rough_picture, fine_picture, rmse, of_fine) in [
            (&rough.frame, &fine.frame, rough.info.frame_rmse, fine.info.frame_rmse),
            (&rough.small, &fine.small, rough.info.small_rmse, fine.info.small_rmse),
        ] {
            let measured = corrected(Errors::of(rough_picture, fine_picture).rmse, of_fine);
            assert!((0.8..1.25).contains(&(measured / rmse)), "{measured} against {rmse}");
        }
    }

    #[test]
    fn own_error_is_subtracted_and_what_is_below_it_is_unknown() {
        let info = GroundTruthInfo { frame_rmse: 3.0, ..cornell(16).info };
        let kept = GroundTruth::from_kept(Picture { width: 3, height: 3, pixels: vec![[1.0; 3]; 9] }, info);
        assert!((kept.corrected_rmse([5.0]).unwrap().median - 4.0).abs() < 1e-12);
        assert_eq!(kept.corrected_rmse([5.0, 4.0]), None, "2.6 is below 3");
        assert_eq!(kept.corrected_rmse([2.9]), None);
    }

    #[test]
    fn small_ground_truth_equals_a_small_render() {
        let scene = octray_formats::scene::load("builtin:cornell").unwrap();
        let settings = Settings { resolution: [16, 9], seed: 5, ..Settings::of(&scene) };
        let renderer = Renderer::new(&scene, settings);
        let mut film = renderer.film();
        renderer.add_samples(&mut film, 2_048);
        let truth = cornell(800);
        let brightness = truth.small.pixels.iter().flatten().map(|&c| f64::from(c)).sum::<f64>() / 432.0;
        let distance = Errors::of(&film.picture(), &truth.small).rmse;
        // Only the noise of both: a shift by an eighth of a pixel gives 0.05.
        assert!(distance < 0.03 * brightness.max(0.1), "{distance}, brightness {brightness}");
    }
}
