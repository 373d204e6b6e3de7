//! The interactive view: frames per second on all cores, and the error of the picture after a given time.

use super::configurations::Configuration;
use super::ground_truth::GroundTruth;
use crate::film::Picture;
use crate::measure::bench::FEWEST_FRAMES;
use crate::measure::cores::Reliability;
use crate::measure::errors::Errors;
use crate::measure::flip::Flip;
use crate::measure::quantiles::{Quantiles, Rounds, Spread};
use crate::measure::timed::{TimedRenderer, Times};
use crate::scene::Scene;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Seconds of accumulation after which the error is measured.
pub(crate) const MOMENTS: [f64; 3] = [1.0 / 30.0, 0.2, 1.0];
/// Most seeds, and so most accumulations of each configuration.
const MOST_SEEDS: usize = 8;

/// The accumulated picture after a time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moment {
    /// Seconds of rendering since the film was empty; copying pictures does not count.
    pub after_s: f64,
    /// Samples per pixel: whole frames, including the one that is being rendered at that time.
    pub samples: Spread,
    /// Against the ground truth, without the part of its own error; null where that is larger, so this is
    /// unknown.
    pub rmse: Option<Spread>,
    /// Mean FLIP of the displayed picture; includes the ground truth's own noise.
    pub flip: Spread,
}

/// The frames of one configuration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Frames {
    /// Its name.
    pub configuration: &'static str,
    /// Worker threads.
    pub threads: usize,
    /// Accumulations behind each median.
    pub seeds: usize,
    /// Frames of one sample per pixel per second: each accumulation's median frame.
    pub fps: Spread,
    /// Reliability of `fps`.
    #[serde(flatten)]
    pub reliability: Reliability,
    /// The picture at 1/30 s, 0.2 s and 1 s.
    pub moments: Vec<Moment>,
}

/// One accumulation: the picture and its samples at each of [`MOMENTS`], and the times of every frame.
struct Accumulation {
    pictures: Vec<(Picture, u32)>,
    times: Times,
}

/// Accumulates for a second with every configuration in each round. A round is a seed; at least one, and as
/// many as the time allows.
pub(crate) fn measure(
    scene: &Scene,
    configurations: &[Configuration],
    ground_truth: &GroundTruth,
    threads: usize,
    end: Instant,
) -> Vec<Frames> {
    let flip = Flip::of(&ground_truth.frame);
    let resolution = [ground_truth.frame.width, ground_truth.frame.height];
    let of = |one: &Configuration| TimedRenderer::new(one.renderer(scene, resolution, threads));
    let mut renderers: Vec<TimedRenderer> = configurations.iter().map(of).collect();
    let mut taken: Vec<Vec<Accumulation>> = configurations.iter().map(|_| Vec::new()).collect();
    for round in Rounds::within(end, 1, MOST_SEEDS) {
        for (renderer, taken) in renderers.iter_mut().zip(&mut taken) {
            renderer.renderer.set_seed(round as u32 + 1);
            taken.push(accumulate(renderer));
        }
    }
    let all = configurations.iter().zip(&taken);
    all.map(|(one, taken)| frames(one.name, threads, taken, ground_truth, &flip)).collect()
}

fn accumulate(timed: &mut TimedRenderer) -> Accumulation {
    timed.restart();
    let mut pictures = Vec::new();
    for moment in MOMENTS {
        // Time of rendering alone: copying the pictures does not count.
        let left = moment - timed.times.seconds.iter().sum::<f64>();
        if left > 0.0 {
            timed.turn(usize::MAX, Duration::from_secs_f64(left));
        }
        pictures.push((timed.film.picture(), timed.film.samples()));
    }
    Accumulation { pictures, times: std::mem::take(&mut timed.times) }
}

fn frames(
    configuration: &'static str,
    threads: usize,
    taken: &[Accumulation],
    ground_truth: &GroundTruth,
    flip: &Flip,
) -> Frames {
    let rates = taken.iter().map(|one| 1.0 / Quantiles::of(one.times.seconds.clone()).median());
    let moment = |(number, &after_s): (usize, &f64)| {
        let pictures = || taken.iter().map(|one| &one.pictures[number]);
        Moment {
            after_s,
            samples: Spread::of(pictures().map(|(_, samples)| f64::from(*samples))),
            rmse: ground_truth
                .corrected_rmse(pictures().map(|(picture, _)| Errors::of(picture, &ground_truth.frame).rmse)),
            flip: Spread::of(pictures().map(|(picture, _)| flip.against(picture))),
        }
    };
    Frames {
        configuration,
        threads,
        seeds: taken.len(),
        fps: Spread::of(rates),
        reliability: taken
            .iter()
            .map(|one| one.times.reliability(FEWEST_FRAMES))
            .reduce(|one, other| one.worse(&other))
            .expect("at least one accumulation"),
        moments: MOMENTS.iter().enumerate().map(moment).collect(),
    }
}
