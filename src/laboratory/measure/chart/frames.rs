//! What a person at the window gets: frames per second on all cores, and the error of what has accumulated after a moment.
//!
//! For: [`measure`]. May import: `configurations`, `truth`, `errors`, `flip`. Must never know: how it is drawn.

use super::configurations::Configuration;
use super::pictures::Spread;
use super::truth::{Truth, corrected};
use crate::film::Picture;
use crate::measure::errors::Errors;
use crate::measure::flip::Flip;
use crate::measure::statistics::Quantiles;
use crate::render::{Renderer, Settings};
use crate::scene::Scene;
use serde::Serialize;
use std::time::{Duration, Instant};

/// Seconds of accumulation after which the picture is judged.
pub const MOMENTS: [f64; 3] = [1.0 / 30.0, 0.2, 1.0];
/// Most seeds, and so most times that everything is accumulated.
const MOST_SEEDS: u32 = 8;

/// What has accumulated after a moment.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Moment {
    pub after_s: f64,
    /// Samples per pixel: whole frames, the one under way at the moment included.
    pub samples: Spread,
    /// Against the truth, whose own error is taken out; null where what is left is smaller than that, and so not known.
    pub rmse: Option<Spread>,
    /// Mean FLIP of the displayed picture; the truth's own noise is in it.
    pub flip: Spread,
}

/// One configuration.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Frames {
    pub configuration: &'static str,
    pub threads: usize,
    pub seeds: usize,
    pub fps: Spread,
    pub moments: Vec<Moment>,
}

/// One accumulation: the pictures at each moment with their samples, and the seconds of every frame.
struct Accumulation {
    pictures: Vec<(Picture, u32)>,
    seconds: Vec<f64>,
}

/// Accumulates with every configuration by turns, a second each, with as many seeds as the time allows; at least one.
pub fn measure(
    scene: &Scene,
    configurations: &[Configuration],
    truth: &Truth,
    threads: usize,
    end: Instant,
) -> Vec<Frames> {
    let flip = Flip::of(&truth.frame);
    let resolution = [truth.frame.width, truth.frame.height];
    let of = |one: &Configuration| Renderer::new(scene, Settings { resolution, threads, ..one.settings });
    let mut renderers: Vec<Renderer> = configurations.iter().map(of).collect();
    let mut taken: Vec<Vec<Accumulation>> = configurations.iter().map(|_| Vec::new()).collect();
    let mut last = Duration::ZERO;
    for seed in 1..=MOST_SEEDS {
        if seed > 1 && Instant::now() + last > end {
            break;
        }
        let start = Instant::now();
        for (renderer, taken) in renderers.iter_mut().zip(&mut taken) {
            renderer.set_seed(seed);
            taken.push(accumulate(renderer));
        }
        last = start.elapsed();
    }
    let all = configurations.iter().zip(&taken);
    all.map(|(one, taken)| frames(one.name, threads, taken, truth, &flip)).collect()
}

fn accumulate(renderer: &Renderer) -> Accumulation {
    // Caches fill, threads wake up.
    renderer.add_samples(&mut renderer.film(), 1);
    let mut film = renderer.film();
    let mut taken = Accumulation { pictures: Vec::new(), seconds: Vec::new() };
    // What looking at the pictures takes is no part of the accumulation.
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
    truth: &Truth,
    flip: &Flip,
) -> Frames {
    let rates = taken.iter().map(|one| 1.0 / Quantiles::of(one.seconds.clone()).median());
    let moment = |(number, &after_s): (usize, &f64)| {
        let pictures = || taken.iter().map(|one| &one.pictures[number]);
        let rmse = |(picture, _): &(Picture, u32)| {
            corrected(Errors::of(picture, &truth.frame).rmse, truth.quality.frame_rmse)
        };
        let rmse: Vec<f64> = pictures().map(rmse).collect();
        Moment {
            after_s,
            samples: Spread::of(&pictures().map(|(_, samples)| f64::from(*samples)).collect::<Vec<_>>()),
            rmse: rmse.iter().all(|&error| error >= truth.quality.frame_rmse).then(|| Spread::of(&rmse)),
            flip: Spread::of(&pictures().map(|(picture, _)| flip.against(picture)).collect::<Vec<_>>()),
        }
    };
    Frames {
        configuration,
        threads,
        seeds: taken.len(),
        fps: Spread::of(&rates.collect::<Vec<_>>()),
        moments: MOMENTS.iter().enumerate().map(moment).collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::chart::truth::Quality;

    #[test]
    fn the_error_of_the_truth_is_taken_out() {
        let grey = |value| Picture { width: 3, height: 3, pixels: vec![[value; 3]; 9] };
        let of = |frame_rmse| {
            let quality = Quality { samples: 2, frame_rmse, small_rmse: 1.0, budget_s: 1.0, cached: false };
            let truth = Truth::kept(grey(1.0), quality);
            let pictures = vec![(grey(7.0), 1), (grey(6.0), 2), (grey(4.0), 5)];
            let taken = Accumulation { pictures, seconds: vec![0.5, 0.25, 0.125] };
            frames("one", 1, &[taken], &truth, &Flip::of(&truth.frame))
        };
        let frames = of(3.0);
        assert_eq!((frames.fps.median, frames.seeds), (4.0, 1));
        assert_eq!(
            frames.moments.iter().map(|moment| moment.samples.median).collect::<Vec<_>>(),
            [1.0, 2.0, 5.0]
        );
        let rmse = |frames: &Frames, moment: usize| frames.moments[moment].rmse.map(|rmse| rmse.median);
        assert!((rmse(&frames, 1).unwrap() - 4.0).abs() < 1e-6, "5 seen, 3 of them the truth's");
        assert_eq!(rmse(&of(3.5), 2), None, "3 seen, and the truth may be off by more");
    }
}
