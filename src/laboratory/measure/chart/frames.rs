//! The interactive view: frames per second on all cores, and the error of the accumulated picture after a
//! given time.
//!
//! For: `measure`.

use super::configurations::Configuration;
use super::ground_truth::GroundTruth;
use crate::film::Picture;
use crate::measure::errors::Errors;
use crate::measure::flip::Flip;
use crate::measure::quantiles::{Quantiles, Rounds, Spread};
use crate::render::Renderer;
use crate::scene::Scene;
use serde::Serialize;
use std::time::Instant;

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
    /// The picture at 1/30 s, 0.2 s and 1 s.
    pub moments: Vec<Moment>,
}

/// One accumulation: the picture and its samples at each of [`MOMENTS`], and the seconds of every frame.
struct Accumulation {
    pictures: Vec<(Picture, u32)>,
    seconds: Vec<f64>,
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
    let of = |one: &Configuration| one.renderer(scene, resolution, threads);
    let mut renderers: Vec<Renderer> = configurations.iter().map(of).collect();
    let mut taken: Vec<Vec<Accumulation>> = configurations.iter().map(|_| Vec::new()).collect();
    for round in Rounds::within(end, 1, MOST_SEEDS) {
        for (renderer, taken) in renderers.iter_mut().zip(&mut taken) {
            renderer.set_seed(round as u32 + 1);
            taken.push(accumulate(renderer));
        }
    }
    let all = configurations.iter().zip(&taken);
    all.map(|(one, taken)| frames(one.name, threads, taken, ground_truth, &flip)).collect()
}

fn accumulate(renderer: &Renderer) -> Accumulation {
    // Caches fill, threads wake up.
    renderer.add_samples(&mut renderer.film(), 1);
    let mut film = renderer.film();
    let mut taken = Accumulation { pictures: Vec::new(), seconds: Vec::new() };
    // Time of rendering alone: copying the pictures does not count.
    let mut elapsed = 0.0;
    for moment in MOMENTS {
        renderer.on_threads(|| {
            while elapsed < moment {
                let start = Instant::now();
                renderer.add_samples(&mut film, 1);
                let seconds = start.elapsed().as_secs_f64();
                taken.seconds.push(seconds);
                elapsed += seconds;
            }
        });
        taken.pictures.push((film.picture(), film.samples()));
    }
    taken
}

fn frames(
    configuration: &'static str,
    threads: usize,
    taken: &[Accumulation],
    ground_truth: &GroundTruth,
    flip: &Flip,
) -> Frames {
    let rates = taken.iter().map(|one| 1.0 / Quantiles::of(one.seconds.clone()).median());
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
        moments: MOMENTS.iter().enumerate().map(moment).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::chart::ground_truth::GroundTruthInfo;

    #[test]
    fn error_of_the_ground_truth_is_subtracted() {
        let grey = |value| Picture { width: 3, height: 3, pixels: vec![[value; 3]; 9] };
        let of = |frame_rmse| {
            let info =
                GroundTruthInfo { samples: 2, frame_rmse, small_rmse: 1.0, budget_s: 1.0, cached: false };
            let ground_truth = GroundTruth::from_kept(grey(1.0), info);
            let pictures = vec![(grey(7.0), 1), (grey(6.0), 2), (grey(4.0), 5)];
            let taken = Accumulation { pictures, seconds: vec![0.5, 0.25, 0.125] };
            frames("one", 1, &[taken], &ground_truth, &Flip::of(&ground_truth.frame))
        };
        let frames = of(3.0);
        assert_eq!((frames.fps.median, frames.seeds), (4.0, 1));
        assert_eq!(
            frames.moments.iter().map(|moment| moment.samples.median).collect::<Vec<_>>(),
            [1.0, 2.0, 5.0]
        );
        let rmse = |frames: &Frames, moment: usize| frames.moments[moment].rmse.map(|rmse| rmse.median);
        assert!((rmse(&frames, 1).unwrap() - 4.0).abs() < 1e-6, "5 measured, 3 of the ground ground_truth");
        assert_eq!(rmse(&of(3.5), 2), None, "3 measured, 3.5 of the ground ground_truth");
    }
}
