//! Error and time of the display filters on frames of a few samples.

use super::ground_truth::GroundTruth;
use crate::display::{Blur, Denoiser, Fxaa, Samples};
use crate::film::Picture;
use crate::integrate::aovs::Aovs;
use crate::integrate::edge_aovs::DenoiserAovs;
use crate::measure::cores::Reliability;
use crate::measure::errors::Errors;
use crate::measure::flip::Flip;
use crate::measure::quantiles::{Rounds, Spread};
use crate::measure::timed::time_on_cores;
use crate::render::{Renderer, Settings};
use crate::scene::Scene;
use crate::tone::Tone;
use serde::Serialize;
use std::time::Instant;

/// Samples of the pictures.
pub(crate) const SAMPLES: [u32; 3] = [1, 4, 16];
/// The filters; the first is none.
pub const FILTERS: [&str; 4] = ["as it is", "blurred", "FXAA", "denoised"];
/// Most seeds behind a median.
const MOST_SEEDS: usize = 8;
/// Fewest seeds of times that are relied on.
const FEWEST_SEEDS: usize = 3;

/// One filter on pictures of one number of samples.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FilterResult {
    /// One of [`FILTERS`].
    pub filter: &'static str,
    /// Samples per pixel of the unfiltered picture.
    pub samples: u32,
    /// Worker threads.
    pub threads: usize,
    /// Pictures behind each median.
    pub seeds: usize,
    /// Against the ground truth, without the part of its own error; null where that is larger, so this is
    /// unknown.
    pub rmse: Option<Spread>,
    /// Mean FLIP of the displayed picture; includes the ground truth's own noise.
    pub flip: Spread,
    /// Time to render the samples, in milliseconds.
    pub frame_ms: Spread,
    /// Time to filter them, in milliseconds. The denoiser's AOVs are rendered anew, as when the camera moves.
    pub filter_ms: Spread,
    /// Reliability of the times.
    #[serde(flatten)]
    pub reliability: Reliability,
}

/// Measurements of one filter and number of samples, by seed.
#[derive(Default)]
struct BySeed {
    rmse: Vec<f64>,
    flip: Vec<f64>,
    frame_ms: Vec<f64>,
    filter_ms: Vec<f64>,
    turns: Vec<Reliability>,
}

/// Filters frames of as many seeds as the time allows, at least one. `settings` are those of frames.
pub(crate) fn measure(
    scene: &Scene,
    settings: Settings,
    ground_truth: &GroundTruth,
    threads: usize,
    end: Instant,
) -> Vec<FilterResult> {
    let mut renderer = Renderer::new(scene, Settings { threads, ..settings });
    let mut film = renderer.film();
    let flip = Flip::of(&ground_truth.frame);
    let mut filters = Filters::default();
    // Caches fill, threads wake up, filters allocate.
    renderer.add_samples(&mut film, 1);
    for filter in FILTERS {
        filters.apply(filter, &film.picture(), 1, &renderer);
    }

    let mut taken: Vec<BySeed> = (0..SAMPLES.len() * FILTERS.len()).map(|_| BySeed::default()).collect();
    for round in Rounds::within(end, 1, MOST_SEEDS) {
        renderer.set_seed(round as u32 + 1);
        film.clear();
        let mut frame_ms = 0.0;
        for (samples, of_samples) in SAMPLES.into_iter().zip(taken.chunks_mut(FILTERS.len())) {
            let more = samples - film.samples();
            // Untimed: the filters have just used the caches.
            renderer.add_samples(&mut renderer.film(), 1);
            let ((), rendering_ms, of_frame) =
                time_on_cores(&renderer, || renderer.add_samples(&mut film, more));
            frame_ms += rendering_ms;
            let (picture, renderer) = (&film.picture(), &renderer);
            for (filter, taken) in FILTERS.into_iter().zip(of_samples) {
                let filters = &mut filters;
                let (shown, filter_ms, load) =
                    time_on_cores(renderer, move || filters.apply(filter, picture, samples, renderer));
                taken.turns.extend([of_frame, load]);
                taken.filter_ms.push(filter_ms);
                taken.frame_ms.push(frame_ms);
                taken.rmse.push(Errors::of(shown, &ground_truth.frame).rmse);
                taken.flip.push(flip.against(shown));
            }
        }
    }
    let shown = |(number, taken): (usize, &BySeed)| FilterResult {
        filter: FILTERS[number % FILTERS.len()],
        samples: SAMPLES[number / FILTERS.len()],
        threads,
        seeds: taken.rmse.len(),
        rmse: ground_truth.corrected_rmse(taken.rmse.iter().copied()),
        flip: Spread::of(taken.flip.iter().copied()),
        frame_ms: Spread::of(taken.frame_ms.iter().copied()),
        filter_ms: Spread::of(taken.filter_ms.iter().copied()),
        reliability: Reliability::of(&taken.turns, taken.rmse.len() >= FEWEST_SEEDS),
    };
    taken.iter().enumerate().map(shown).collect()
}

/// All filters, with their buffers.
#[derive(Default)]
struct Filters {
    aovs: Aovs,
    denoiser_aovs: DenoiserAovs,
    blur: Blur,
    fxaa: Fxaa,
    denoiser: Denoiser,
}

impl Filters {
    fn apply<'a>(
        &'a mut self,
        filter: &str,
        picture: &'a Picture,
        samples: u32,
        renderer: &Renderer,
    ) -> &'a Picture {
        let Self { aovs, denoiser_aovs, blur, fxaa, denoiser } = self;
        renderer.on_threads(|| match filter {
            "blurred" => blur.filter(picture),
            "FXAA" => fxaa.filter(picture, &Tone::default()),
            "denoised" => {
                renderer.aovs_into(aovs);
                renderer.denoiser_aovs_into(aovs, denoiser_aovs);
                denoiser.filter(picture, Samples::Same(samples), denoiser_aovs)
            }
            _ => picture,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::super::ground_truth::GroundTruthRenderer;
    use super::*;

    #[test]
    fn every_filter_is_measured_and_the_denoiser_lowers_the_error() {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let settings = Settings { resolution: [96, 54], ..Settings::of(&scene) };
        let ground_truth = GroundTruthRenderer::new(&scene, settings, 1).render(400);
        let all = measure(&scene, settings, &ground_truth, 1, Instant::now());
        assert_eq!(all.len(), SAMPLES.len() * FILTERS.len());
        let of =
            |filter, samples| all.iter().find(|one| (one.filter, one.samples) == (filter, samples)).unwrap();
        let error = |filter, samples| of(filter, samples).rmse.unwrap().median;
        for samples in [1, 4] {
            assert!(error("denoised", samples) < 0.8 * error("as it is", samples), "{samples}");
        }
        assert!(error("blurred", 1) < error("as it is", 1));
        assert!(of("denoised", 16).filter_ms.median > 0.0);
        assert!(of("as it is", 16).frame_ms.median > of("as it is", 1).frame_ms.median);
    }
}
