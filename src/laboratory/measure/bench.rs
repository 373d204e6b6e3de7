//! Frames per second: SIMD beside scalar, in alternation.
//!
//! For: [`bench()`]. May import: `turns`, `statistics`, and what they may. Must never know: how figures are shown.

use super::statistics::Quantiles;
use super::stats::FrameStats;
use super::turns::{Ratio, Timed};
use crate::buffers::Features;
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
    /// How many times as fast as the scalar engine on as many threads; `None` for that engine itself and where it was not timed.
    pub speedup: Option<Ratio>,
    /// How many times as fast as the first engine of the same width, which had fewer threads; `None` for that engine itself.
    pub scaling: Option<Ratio>,
    pub needs: Vec<&'static str>,
    /// `needed` or `general`.
    pub pipeline: &'static str,
    /// How many times as fast as the pipeline with every feature at the same width and threads. Measured of the first engine; `None` where
    /// that is the scene's own.
    pub gain: Option<Ratio>,
    /// Of frames that were not timed, where [`FrameStats`] were asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stats: Option<FrameStats>,
}

/// How long an engine is timed before the next one has its turn: short beside the drift of a machine's clock, long beside the time that
/// sleeping threads take to wake up.
const TURN: Duration = Duration::from_millis(50);
/// Fewest frames behind a median, and fewest where frames are so slow that patience ends.
pub const FEWEST_FRAMES: usize = 50;
const FEWEST_SLOW_FRAMES: usize = 3;
/// So long the slowest engine renders frames for [`FrameStats`].
const STATS_TIME: Duration = Duration::from_millis(250);
const MOST_STATS_FRAMES: f64 = 1_000.0;
/// So many times the measuring time, patience ends.
const PATIENCE: u32 = 10;
struct Run {
    engine: Engine,
    timed: Timed,
    /// The same with every feature, if that is another pipeline and asked for.
    general: Option<Timed>,
}

impl Run {
    fn new(scene: &Scene, settings: Settings, engine: Engine, against_general: bool) -> Self {
        let Engine { lanes, threads } = engine;
        let of = |pipeline| Renderer::new(scene, Settings { lanes, threads, pipeline, ..settings });
        let renderer = of(settings.pipeline);
        let against_general = against_general && renderer.features() != Features::ALL;
        let general = against_general.then(|| Timed::new(of(PipelineChoice::General)));
        Self { engine, timed: Timed::new(renderer), general }
    }
    fn turn(&mut self, frames: usize) {
        self.timed.turn(frames, TURN);
        if let Some(general) = &mut self.general {
            general.turn(frames, TURN);
        }
    }
}

/// Times the engines on a scene, in alternation, after a warm-up. `settings` holds for all but lanes and threads. With `stats`, each
/// engine then renders some more frames that are not timed.
pub fn bench(
    scene: &Scene,
    settings: Settings,
    engines: &[Engine],
    effort: Effort,
    stats: bool,
) -> Vec<Measurement> {
    let engines = engines.iter().enumerate();
    let mut runs: Vec<Run> =
        engines.map(|(number, &engine)| Run::new(scene, settings, engine, number == 0)).collect();
    let start = Instant::now();
    let enough = |run: &Run| match effort {
        Effort::Frames(frames) => run.timed.seconds.len() >= frames as usize,
        Effort::Time(time) => {
            let (frames, passed) = (run.timed.seconds.len(), start.elapsed());
            (frames >= FEWEST_FRAMES && passed >= time)
                || (frames >= FEWEST_SLOW_FRAMES && passed >= time * PATIENCE)
        }
    };
    while !runs.iter().all(&enough) {
        for run in &mut runs {
            let left = match effort {
                Effort::Frames(frames) => (frames as usize).saturating_sub(run.timed.seconds.len()),
                Effort::Time(_) => usize::MAX,
            };
            run.turn(left);
        }
    }
    // The same frames for all, so that they trace the same rays.
    let median = |run: &Run| Quantiles::of(run.timed.seconds.clone()).median();
    let slowest = runs.iter().map(median).fold(0.0, f64::max);
    let frames = (STATS_TIME.as_secs_f64() / slowest).clamp(1.0, MOST_STATS_FRAMES) as u32;
    let with_stats = |run: &Run| Measurement {
        stats: stats.then(|| frame_stats(run, frames)),
        ..measurement(scene, run, &runs)
    };
    runs.iter().map(with_stats).collect()
}

/// Renders so many frames of their own, the first ones of the picture.
fn frame_stats(run: &Run, frames: u32) -> FrameStats {
    let Run { engine: Engine { lanes, threads }, timed: Timed { renderer, .. }, .. } = run;
    let mut film = renderer.film();
    renderer.start_stats();
    renderer.on_threads(|| {
        for _ in 0..frames {
            renderer.add_samples(&mut film, 1);
        }
    });
    FrameStats::of(&renderer.take_stats(), *lanes, *threads, film.samples())
}

fn measurement(scene: &Scene, run: &Run, runs: &[Run]) -> Measurement {
    let Run { engine, timed: Timed { renderer, film, seconds, .. }, general } = run;
    let times = Quantiles::of(seconds.clone());
    let settings = renderer.settings();
    let rays_per_frame = film.rays() as f64 / f64::from(film.samples());
    let ratio_to = |other: &Run| Ratio::of(&run.timed, &other.timed);
    let scalar = Engine { lanes: 1, ..*engine };
    let first = runs.iter().find(|other| other.engine.lanes == engine.lanes);
    Measurement {
        scene: scene.name.clone(),
        width: settings.resolution[0],
        height: settings.resolution[1],
        max_bounces: settings.max_bounces,
        engine: if engine.lanes == 1 { "scalar" } else { "simd" },
        lanes: engine.lanes,
        threads: engine.threads,
        frames: times.count(),
        fps_median: 1.0 / times.median(),
        fps_low_1_percent: 1.0 / times.at(0.99),
        fps_spread: [1.0 / times.at(0.9), 1.0 / times.at(0.1)],
        mrays_per_s: rays_per_frame / times.median() / 1e6,
        rays_per_frame,
        speedup: runs.iter().find(|other| *engine != scalar && other.engine == scalar).and_then(ratio_to),
        scaling: first.filter(|first| first.engine.threads < engine.threads).and_then(ratio_to),
        needs: renderer.needs().names(),
        pipeline: match settings.pipeline {
            PipelineChoice::Needed => "needed",
            PipelineChoice::General => "general",
        },
        gain: general.as_ref().and_then(|general| Ratio::of(&run.timed, general)),
        stats: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measurement_gives_the_median_the_1_percent_low_and_the_spread_of_its_frames() {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let settings = Settings { resolution: [8, 8], ..Settings::of(&scene) };
        let mut timed = Timed::new(Renderer::new(&scene, settings));
        timed.turn(1, TURN);
        timed.seconds = (1..=100).map(f64::from).collect();
        let run = Run { engine: Engine { lanes: 8, threads: 1 }, timed, general: None };
        let found = measurement(&scene, &run, &[]);
        assert_eq!((found.frames, found.engine), (100, "simd"));
        assert_eq!((found.fps_median, found.fps_low_1_percent), (1.0 / 50.5, 1.0 / 99.0));
        assert_eq!(found.fps_spread, [1.0 / 90.0, 1.0 / 10.0]);
        let others = (found.speedup, found.scaling, found.gain);
        assert_eq!(others, (None, None, None), "nothing else was timed");
    }
}
