//! Frames per second: SIMD beside scalar, in alternation.

use super::statistics::Times;
use crate::film::Film;
use crate::render::{PipelineChoice, Renderer, Settings};
use crate::scene::Scene;
use serde::Serialize;
use std::time::{Duration, Instant};

/// One engine to time: a width and a number of threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Engine {
    /// 1 or 8.
    pub lanes: usize,
    pub threads: usize,
}

/// How long to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// So many frames per engine.
    Frames(u32),
    /// At least 50 frames per engine, and on until this time has passed for all engines together; where frames take so long that ten
    /// times this time passes first, fewer, but at least 3.
    Time(Duration),
}

/// What one engine reached on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    pub scene: String,
    pub width: u32,
    pub height: u32,
    pub max_bounces: u32,
    /// `simd` or `scalar`.
    pub engine: &'static str,
    pub lanes: usize,
    pub threads: usize,
    pub frames: usize,
    /// Frames of one sample per pixel per second; presentation and file output excluded.
    pub fps_median: f64,
    /// The rate that 99 % of the frames reach.
    pub fps_low_1_percent: f64,
    /// The rate that 10 % and 90 % of the frames reach: the spread.
    pub fps_spread: [f64; 2],
    /// Rays (closest-hit or any-hit queries of active lanes) over wall time of the median frame, in millions a second.
    pub mrays_per_s: f64,
    pub rays_per_frame: f64,
    pub needs: Vec<&'static str>,
    /// `needed` or `general`.
    pub pipeline: &'static str,
}

/// How long an engine is timed before the next one has its turn: short beside the drift of a machine's clock, long beside the time that
/// sleeping threads take to wake up.
const TURN: Duration = Duration::from_millis(50);
/// Fewest frames behind a median, and fewest where frames are so slow that patience ends.
const FEWEST_FRAMES: usize = 50;
const FEWEST_SLOW_FRAMES: usize = 3;
/// So many times the measuring time, patience ends.
const PATIENCE: u32 = 10;
/// Frames before timing starts, or as many as this time holds: caches and branch predictors fill, clocks rise.
const WARM_UP: u32 = 5;
const WARM_UP_TIME: Duration = Duration::from_millis(200);

struct Run {
    engine: Engine,
    renderer: Renderer,
    film: Film,
    seconds: Vec<f64>,
}

impl Run {
    /// Times frames until the turn is over, at least one and at most `frames`.
    fn turn(&mut self, frames: usize) {
        let Self { renderer, film, seconds, .. } = self;
        renderer.on_threads(|| {
            let turn = Instant::now();
            for _ in 0..frames {
                let start = Instant::now();
                renderer.add_samples(film, 1);
                seconds.push(start.elapsed().as_secs_f64());
                if turn.elapsed() >= TURN {
                    break;
                }
            }
        });
    }
}

/// Times the engines on a scene, in alternation, after a warm-up. `settings` holds for all but lanes and threads.
pub fn bench(scene: &Scene, settings: Settings, engines: &[Engine], effort: Effort) -> Vec<Measurement> {
    let mut runs: Vec<Run> = engines
        .iter()
        .map(|&engine| {
            let Engine { lanes, threads } = engine;
            let renderer = Renderer::new(scene, Settings { lanes, threads, ..settings });
            let (mut film, start) = (renderer.film(), Instant::now());
            while film.samples() < WARM_UP && start.elapsed() < WARM_UP_TIME {
                renderer.add_samples(&mut film, 1);
            }
            Run { engine, film: renderer.film(), renderer, seconds: Vec::new() }
        })
        .collect();
    let start = Instant::now();
    let enough = |run: &Run| match effort {
        Effort::Frames(frames) => run.seconds.len() >= frames as usize,
        Effort::Time(time) => {
            let (frames, passed) = (run.seconds.len(), start.elapsed());
            (frames >= FEWEST_FRAMES && passed >= time)
                || (frames >= FEWEST_SLOW_FRAMES && passed >= time * PATIENCE)
        }
    };
    while !runs.iter().all(&enough) {
        for run in &mut runs {
            let left = match effort {
                Effort::Frames(frames) => (frames as usize).saturating_sub(run.seconds.len()),
                Effort::Time(_) => usize::MAX,
            };
            run.turn(left);
        }
    }
    runs.into_iter().map(|run| measurement(scene, &run)).collect()
}

fn measurement(scene: &Scene, run: &Run) -> Measurement {
    let times = Times::new(run.seconds.clone());
    let settings = run.renderer.settings();
    let rays_per_frame = run.film.rays() as f64 / f64::from(run.film.samples());
    Measurement {
        scene: scene.name.clone(),
        width: settings.resolution[0],
        height: settings.resolution[1],
        max_bounces: settings.max_bounces,
        engine: if run.engine.lanes == 1 { "scalar" } else { "simd" },
        lanes: run.engine.lanes,
        threads: run.engine.threads,
        frames: times.count(),
        fps_median: 1.0 / times.median(),
        fps_low_1_percent: 1.0 / times.quantile(0.99),
        fps_spread: [1.0 / times.quantile(0.9), 1.0 / times.quantile(0.1)],
        mrays_per_s: rays_per_frame / times.median() / 1e6,
        rays_per_frame,
        needs: run.renderer.needs().names(),
        pipeline: match settings.pipeline {
            PipelineChoice::Needed => "needed",
            PipelineChoice::General => "general",
        },
    }
}
