//! What filters between film and window bring, and what they take: one frame of a few samples, shown in several ways.
//!
//! For: [`measure`]. May import: `display`, `truth`, `errors`, `flip`. Must never know: how it is drawn.

use super::pictures::Spread;
use super::truth::{Truth, corrected};
use crate::display::{Blur, Denoiser, Fxaa, Samples};
use crate::film::Picture;
use crate::integrate::aovs::Aovs;
use crate::measure::errors::Errors;
use crate::measure::flip::Flip;
use crate::render::{Renderer, Settings};
use crate::scene::Scene;
use crate::tone::Tone;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Samples of the pictures.
pub const SAMPLES: [u32; 3] = [1, 4, 16];
/// The ways to show them, the first as they are.
pub const WAYS: [&str; 4] = ["as it is", "blurred", "FXAA", "denoised"];
/// Most seeds behind a median.
const MOST_SEEDS: u32 = 8;

/// Pictures of so many samples, shown in one way.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Shown {
    pub way: &'static str,
    pub samples: u32,
    pub threads: usize,
    pub seeds: usize,
    /// Against the truth, whose own error is taken out; null where what is left is smaller than that, and so not known.
    pub rmse: Option<Spread>,
    /// Mean FLIP of the displayed picture; the truth's own noise is in it.
    pub flip: Spread,
    /// To take the samples, and then to show them; the denoiser's guides are made anew, as they are when a camera moves.
    pub frame_ms: Spread,
    pub filter_ms: Spread,
}

/// What was found for one way and number of samples, by seed.
#[derive(Default)]
struct Taken {
    rmse: Vec<f64>,
    flip: Vec<f64>,
    frame_ms: Vec<f64>,
    filter_ms: Vec<f64>,
}

/// Shows frames of as many seeds as the time allows, at least one. `settings` are those of frames.
pub fn measure(scene: &Scene, settings: Settings, truth: &Truth, threads: usize, end: Instant) -> Vec<Shown> {
    let mut renderer = Renderer::new(scene, Settings { threads, ..settings });
    let mut film = renderer.film();
    let flip = Flip::of(&truth.frame);
    let mut filters = Filters::default();
    // Caches fill, threads wake up, filters take their memory.
    renderer.add_samples(&mut film, 1);
    for way in WAYS {
        filters.show(way, &film.picture(), 1, &renderer);
    }

    let mut taken: Vec<Taken> = (0..SAMPLES.len() * WAYS.len()).map(|_| Taken::default()).collect();
    let mut last = Duration::ZERO;
    for seed in 1..=MOST_SEEDS {
        if seed > 1 && Instant::now() + last > end {
            break;
        }
        let start = Instant::now();
        renderer.set_seed(seed);
        film.clear();
        let mut frame = Duration::ZERO;
        for (samples, of_samples) in SAMPLES.into_iter().zip(taken.chunks_mut(WAYS.len())) {
            let more = samples - film.samples();
            let start = Instant::now();
            renderer.add_samples(&mut film, more);
            frame += start.elapsed();
            let picture = film.picture();
            for (way, taken) in WAYS.into_iter().zip(of_samples) {
                let start = Instant::now();
                let shown = filters.show(way, &picture, samples, &renderer);
                taken.filter_ms.push(1e3 * start.elapsed().as_secs_f64());
                taken.frame_ms.push(1e3 * frame.as_secs_f64());
                let rmse = Errors::of(shown, &truth.frame).rmse;
                taken.rmse.push(corrected(rmse, truth.quality.frame_rmse));
                taken.flip.push(flip.against(shown));
            }
        }
        last = start.elapsed();
    }
    let known = |rmse: &[f64]| rmse.iter().all(|&error| error >= truth.quality.frame_rmse);
    let shown = |(number, taken): (usize, &Taken)| Shown {
        way: WAYS[number % WAYS.len()],
        samples: SAMPLES[number / WAYS.len()],
        threads,
        seeds: taken.rmse.len(),
        rmse: known(&taken.rmse).then(|| Spread::of(&taken.rmse)),
        flip: Spread::of(&taken.flip),
        frame_ms: Spread::of(&taken.frame_ms),
        filter_ms: Spread::of(&taken.filter_ms),
    };
    taken.iter().enumerate().map(shown).collect()
}

/// All of them, with their memory.
#[derive(Default)]
struct Filters {
    guides: Aovs,
    blur: Blur,
    fxaa: Fxaa,
    denoiser: Denoiser,
}

impl Filters {
    fn show<'a>(
        &'a mut self,
        way: &str,
        picture: &'a Picture,
        samples: u32,
        renderer: &Renderer,
    ) -> &'a Picture {
        let Self { guides, blur, fxaa, denoiser } = self;
        renderer.on_threads(|| match way {
            "blurred" => blur.filter(picture),
            "FXAA" => fxaa.filter(picture, &Tone::default()),
            "denoised" => {
                renderer.aovs_into(guides);
                denoiser.filter(picture, Samples::Same(samples), guides)
            }
            _ => picture,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::truth::Making;
    use super::*;

    #[test]
    fn every_way_is_shown_and_the_denoiser_lowers_the_error() {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let settings = Settings { resolution: [96, 54], ..Settings::of(&scene) };
        let second = Duration::from_secs(2);
        let truth = Making::new(&scene, settings, 1).until(Instant::now() + second, 400, second);
        let all = measure(&scene, settings, &truth, 1, Instant::now() + second);
        assert_eq!(all.len(), SAMPLES.len() * WAYS.len());
        let of =
            |way, samples| all.iter().find(|shown| (shown.way, shown.samples) == (way, samples)).unwrap();
        let error = |way, samples| of(way, samples).rmse.unwrap().median;
        for samples in [1, 4] {
            assert!(error("denoised", samples) < 0.8 * error("as it is", samples), "{samples}");
        }
        assert!(error("blurred", 1) < error("as it is", 1));
        assert!(of("denoised", 16).filter_ms.median > of("as it is", 16).filter_ms.median);
        assert!(of("as it is", 16).frame_ms.median > of("as it is", 1).frame_ms.median);
    }
}
