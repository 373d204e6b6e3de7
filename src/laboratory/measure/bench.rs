//! Frames per second of SIMD and scalar renderers, in alternating rounds.
//!
//! For: [`bench()`].

use super::quantiles::Quantiles;
use super::stats::FrameStats;
use super::timed::{Ratio, TimedRenderer};
use crate::buffers::Features;
use crate::render::{PipelineChoice, Renderer, Settings};
use crate::scene::Scene;
use serde::Serialize;
use std::time::{Duration, Instant};

/// A renderer to time: a SIMD width and a number of threads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Engine {
    /// 1, 8 or 16.
    pub lanes: usize,
    /// Worker threads.
    pub threads: usize,
}

/// How long to measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effort {
    /// This many frames per engine.
    Frames(u32),
    /// At least [`FEWEST_FRAMES`] per engine, and until this time has passed for all engines together. If ten
    /// times this time passes first, fewer frames, but at least 3.
    Time(Duration),
}

/// The speed of one engine on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Measurement {
    /// Its name, as in [`Scene::name`].
    pub scene: String,
    /// Of the picture, in pixels.
    pub width: u32,
    /// Of the picture, in pixels.
    pub height: u32,
    /// Most scattering events of a path.
    pub max_bounces: u32,
    /// `simd` or `scalar`.
    pub engine: &'static str,
    /// SIMD width: 1, 8 or 16.
    pub lanes: usize,
    /// Worker threads.
    pub threads: usize,
    /// Timed frames behind the figures.
    pub frames: usize,
    /// Frames of one sample per pixel per second; presentation and file output excluded.
    pub fps_median: f64,
    /// 99 % of the frames are at least this fast.
    pub fps_low_1_percent: f64,
    /// 90 % and 10 % of the frames are at least this fast: the spread.
    pub fps_spread: [f64; 2],
    /// Rays (closest-hit or any-hit queries of active lanes) over wall time of the median frame, in millions
    /// a second.
    pub mrays_per_s: f64,
    /// Mean over the frames, of all kinds of rays.
    pub rays_per_frame: f64,
    /// The speed-up: speed over that of the scalar engine on as many threads. Of the first engine only;
    /// `None` where scalar is not timed.
    pub speedup: Option<Ratio>,
    /// Speed over that of the first engine of the same width, which has fewer threads; `None` for that
    /// engine.
    pub scaling: Option<Ratio>,
    /// Names of the features that the scene uses.
    pub needs: Vec<&'static str>,
    /// The traversal of the scene's primitives: `linear` where every one is tested.
    pub traversal: &'static str,
    /// `auto` (the smallest that has the scene's features) or `general`.
    pub pipeline: &'static str,
    /// Speed over that of the general pipeline at the same width and threads. Of the first engine only;
    /// `None` where the scene uses every feature.
    pub specialisation: Option<Ratio>,
    /// Of further frames that are not timed; on request.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stats: Option<FrameStats>,
}

/// Length of an engine's turn: short against the drift of clock rates, long against the time in which
/// sleeping threads wake up.
const TURN: Duration = Duration::from_millis(50);
/// Fewest frames behind a median, and fewest after `PATIENCE`.
pub const FEWEST_FRAMES: usize = 50;
const FEWEST_SLOW_FRAMES: usize = 3;
/// Fewest turns that a given number of frames, from this many on, is divided into: each round of them has
/// ratios of its own, and one alone has no spread.
const FEWEST_TURNS: usize = 5;
/// Time in which the slowest engine renders frames for [`FrameStats`].
const STATS_TIME: Duration = Duration::from_millis(250);
const MOST_STATS_FRAMES: f64 = 1_000.0;
/// Measuring with few frames ends after this many times the measuring time.
const PATIENCE: u32 = 10;

/// Times the engines on a scene in alternating rounds, after a warm-up. `settings` holds for all but lanes
/// and threads. With `stats`, each engine then renders further frames that are not timed.
pub fn bench(
    scene: &Scene,
    settings: Settings,
    engines: &[Engine],
    effort: Effort,
    stats: bool,
) -> Vec<Measurement> {
    let of = |&Engine { lanes, threads }: &Engine, pipeline| {
        TimedRenderer::new(Renderer::new(scene, Settings { lanes, threads, pipeline, ..settings }))
    };
    let mut runs: Vec<TimedRenderer> = engines.iter().map(|engine| of(engine, settings.pipeline)).collect();
    // The first engine once more with the general pipeline, if the scene's own is another.
    let is_special = runs.first().is_some_and(|first| first.renderer.features() != Features::ALL);
    let mut general = is_special.then(|| of(&engines[0], PipelineChoice::General));
    let start = Instant::now();
    let enough = |run: &TimedRenderer| match effort {
        Effort::Frames(frames) => run.seconds.len() >= frames as usize,
        Effort::Time(time) => {
            let (frames, passed) = (run.seconds.len(), start.elapsed());
            (frames >= FEWEST_FRAMES && passed >= time)
                || (frames >= FEWEST_SLOW_FRAMES && passed >= time * PATIENCE)
        }
    };
    while !runs.iter().all(&enough) {
        for run in runs.iter_mut().chain(&mut general) {
            let left = match effort {
                Effort::Frames(frames) => {
                    let (frames, done) = (frames as usize, run.seconds.len());
                    frames.saturating_sub(done).min((frames / FEWEST_TURNS).max(1))
                }
                Effort::Time(_) => usize::MAX,
            };
            run.turn(left, TURN);
        }
    }
    // The same frames for all engines, so that they trace the same rays.
    let median = |run: &TimedRenderer| Quantiles::of(run.seconds.clone()).median();
    let slowest = runs.iter().map(median).fold(0.0, f64::max);
    let frames = (STATS_TIME.as_secs_f64() / slowest).clamp(1.0, MOST_STATS_FRAMES) as u32;
    // Taken by the first run.
    let mut general = general.as_ref();
    let of_run = |run| {
        let stats = stats.then(|| frame_stats(run, frames));
        measurement(scene, run, &runs, general.take(), stats)
    };
    runs.iter().map(of_run).collect()
}

/// Statistics of the picture's first `frames` frames, rendered anew.
fn frame_stats(TimedRenderer { renderer, .. }: &TimedRenderer, frames: u32) -> FrameStats {
    let mut film = renderer.film();
    renderer.start_stats();
    renderer.on_threads(|| {
        for _ in 0..frames {
            renderer.add_samples(&mut film, 1);
        }
    });
    let Settings { lanes, threads, .. } = *renderer.settings();
    FrameStats::of(&renderer.take_stats(), lanes, threads, film.samples())
}

fn measurement(
    scene: &Scene,
    run: &TimedRenderer,
    runs: &[TimedRenderer],
    general: Option<&TimedRenderer>,
    stats: Option<FrameStats>,
) -> Measurement {
    let TimedRenderer { renderer, film, seconds, .. } = run;
    let times = Quantiles::of(seconds.clone());
    let settings = renderer.settings();
    let Settings { lanes, threads, .. } = *settings;
    let rays_per_frame = film.rays() as f64 / f64::from(film.samples());
    let is_first = runs.first().is_some_and(|first| std::ptr::eq(first, run));
    let over = |wanted: &dyn Fn(&Settings) -> bool| {
        let other = runs.iter().find(|other| wanted(other.renderer.settings()));
        other.and_then(|other| Ratio::of(run, other))
    };
    Measurement {
        scene: scene.name.clone(),
        width: settings.resolution[0],
        height: settings.resolution[1],
        max_bounces: settings.max_bounces,
        engine: if lanes == 1 { "scalar" } else { "simd" },
        lanes,
        threads,
        frames: times.count(),
        fps_median: 1.0 / times.median(),
        fps_low_1_percent: 1.0 / times.at(0.99),
        fps_spread: [1.0 / times.at(0.9), 1.0 / times.at(0.1)],
        mrays_per_s: rays_per_frame / times.median() / 1e6,
        rays_per_frame,
        speedup: over(&|other| is_first && lanes != 1 && (other.lanes, other.threads) == (1, threads)),
        scaling: over(&|other| other.lanes == lanes && other.threads < threads),
        needs: renderer.needs().names(),
        traversal: settings.methods.traversal_name(scene, lanes),
        pipeline: settings.pipeline.name(),
        specialisation: general.and_then(|general| Ratio::of(run, general)),
        stats,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn measurement_gives_the_median_the_1_percent_low_and_the_spread_of_its_frames() {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let settings = Settings { resolution: [8, 8], lanes: 8, ..Settings::of(&scene) };
        let mut timed = TimedRenderer::new(Renderer::new(&scene, settings));
        timed.turn(1, TURN);
        timed.seconds = (1..=100).map(f64::from).collect();
        let found = measurement(&scene, &timed, &[], None, None);
        assert_eq!((found.frames, found.engine), (100, "simd"));
        assert_eq!((found.fps_median, found.fps_low_1_percent), (1.0 / 50.5, 1.0 / 99.0));
        assert_eq!(found.fps_spread, [1.0 / 90.0, 1.0 / 10.0]);
        let others = (found.speedup, found.scaling, found.specialisation);
        assert_eq!(others, (None, None, None), "nothing else was timed");
    }
}
