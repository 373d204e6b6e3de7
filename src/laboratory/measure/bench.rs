//! Frames per second of SIMD and scalar renderers, in alternating rounds.

use super::cores::Reliability;
use super::quantiles::Quantiles;
use super::stats::FrameStats;
use super::timed::{Ratio, TimedRenderer, Times};
use crate::buffers::Features;
use crate::methods;
use crate::render::{PipelineChoice, Settings};
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

/// Settings, which hold for all but lanes and threads, and the engines that are timed with them.
pub type Configuration = (Settings, Vec<Engine>);

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
#[derive(Clone, Debug, Default, Serialize)]
pub struct Measurement {
    /// Its name, as in [`Scene::name`].
    pub scene: String,
    /// Width of the picture in pixels.
    pub width: u32,
    /// Height of the picture in pixels.
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
    /// Mean number of rays of a frame, of all kinds.
    pub rays_per_frame: f64,
    /// How far these figures can be relied on.
    #[serde(flatten)]
    pub reliability: Reliability,
    /// The speed-up: speed over that of the scalar engine on as many threads; `None` where that is not timed,
    /// and for itself.
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
    /// Speed over that of the second configuration, if there is one: of its engine at the same place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over_second: Option<Ratio>,
    /// Figures of further frames that are not timed; on request.
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

/// Times the engines of one or two configurations on a scene, after a warm-up, in rounds of which every
/// other is in reverse order: A B B A. Returns the measurements by configuration; an engine of the first has
/// a ratio to that of the second at the same place. With `stats`, each engine then renders further frames
/// that are not timed.
pub fn bench(
    scene: &Scene,
    configurations: &[Configuration],
    effort: Effort,
    stats: bool,
) -> Vec<Vec<Measurement>> {
    let timed = |settings: Settings, engines: &[Engine]| -> Vec<TimedRenderer> {
        let of = |&Engine { lanes, threads }: &Engine| Settings { lanes, threads, ..settings };
        engines.iter().map(|engine| TimedRenderer::new(methods::renderer(scene, of(engine)))).collect()
    };
    let mut runs: Vec<_> =
        configurations.iter().map(|(settings, engines)| timed(*settings, engines)).collect();
    // The first engine once more with the general pipeline, if the scene's own is another.
    if runs[0].first().is_some_and(|first| first.renderer.features() != Features::ALL) {
        let (settings, engines) = &configurations[0];
        runs.push(timed(Settings { pipeline: PipelineChoice::General, ..*settings }, &engines[..1]));
    }
    let places = |number: usize| (0..runs[number].len()).map(move |place| (place, number));
    let mut order: Vec<(usize, usize)> = (0..runs.len()).flat_map(places).collect();
    order.sort_unstable();
    let start = Instant::now();
    let enough = |times: &Times| match effort {
        Effort::Frames(frames) => times.seconds.len() >= frames as usize,
        Effort::Time(time) => {
            let (frames, passed) = (times.seconds.len(), start.elapsed());
            (frames >= FEWEST_FRAMES && passed >= time)
                || (frames >= FEWEST_SLOW_FRAMES && passed >= time * PATIENCE)
        }
    };
    while !runs.iter().flatten().all(|run| enough(&run.times)) {
        for &(place, number) in &order {
            let run = &mut runs[number][place];
            let left = match effort {
                Effort::Frames(frames) => {
                    let (frames, done) = (frames as usize, run.times.seconds.len());
                    frames.saturating_sub(done).min((frames / FEWEST_TURNS).max(1))
                }
                Effort::Time(_) => usize::MAX,
            };
            run.turn(left, TURN);
        }
        order.reverse();
    }
    // All engines count the same frames, so that they trace the same rays.
    let median = |run: &TimedRenderer| Quantiles::of(run.times.seconds.clone()).median();
    let slowest = runs.iter().flatten().map(median).fold(0.0, f64::max);
    let frames = (STATS_TIME.as_secs_f64() / slowest).clamp(1.0, MOST_STATS_FRAMES) as u32;
    let times =
        |number: usize| runs.iter().skip(number).take(1).flatten().map(|run| &run.times).collect::<Vec<_>>();
    let measured = |(number, (_, engines)): (usize, &Configuration)| {
        let general = times(configurations.len()).first().copied().filter(|_| number == 0);
        let second = if configurations.len() > number + 1 { times(number + 1) } else { Vec::new() };
        let of_run = |(run, ratios)| measurement(scene, run, ratios, stats.then(|| frame_stats(run, frames)));
        runs[number].iter().zip(ratios(engines, &times(number), general, &second)).map(of_run).collect()
    };
    configurations.iter().enumerate().map(measured).collect()
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

/// Speed-up, scaling, specialisation, and the ratio to the second configuration.
type Ratios = [Option<Ratio>; 4];

/// Returns the ratios of the engines of a configuration, each with its times. `general` are those of the
/// first engine with the general pipeline, `second` those of the second configuration by place.
fn ratios(engines: &[Engine], times: &[&Times], general: Option<&Times>, second: &[&Times]) -> Vec<Ratios> {
    let ratios = |(place, &Engine { lanes, threads }): (usize, &Engine)| {
        let over =
            |wanted: &dyn Fn(&Engine) -> bool| engines.iter().position(wanted).map(|other| times[other]);
        [
            over(&|other| lanes != 1 && (other.lanes, other.threads) == (1, threads)),
            over(&|other| other.lanes == lanes && other.threads < threads),
            general.filter(|_| place == 0),
            second.get(place).copied(),
        ]
        .map(|other| Ratio::of(times[place], other?))
    };
    engines.iter().enumerate().map(ratios).collect()
}

fn measurement(
    scene: &Scene,
    timed: &TimedRenderer,
    ratios: Ratios,
    stats: Option<FrameStats>,
) -> Measurement {
    let TimedRenderer { renderer, film, times } = timed;
    let [speedup, scaling, specialisation, over_second] = ratios;
    let reliability = times.reliability(FEWEST_FRAMES);
    let times = Quantiles::of(times.seconds.clone());
    let settings = renderer.settings();
    let Settings { lanes, threads, .. } = *settings;
    let rays_per_frame = film.rays() as f64 / f64::from(film.samples());
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
        reliability,
        speedup,
        scaling,
        needs: renderer.needs().names(),
        traversal: settings.methods.traversal_name(scene, lanes),
        pipeline: settings.pipeline.name(),
        specialisation,
        over_second,
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
        let mut timed = TimedRenderer::new(methods::renderer(&scene, settings));
        timed.turn(1, TURN);
        timed.times = Times::known(&(1..=100).map(f64::from).collect::<Vec<_>>());
        let found = measurement(&scene, &timed, [None; 4], None);
        assert_eq!((found.frames, found.engine), (100, "simd"));
        assert_eq!((found.fps_median, found.fps_low_1_percent), (1.0 / 50.5, 1.0 / 99.0));
        assert_eq!(found.fps_spread, [1.0 / 90.0, 1.0 / 10.0]);
        assert_eq!(found.reliability, Reliability { reliable: true, pinned: true, taken: Some(0.0) });
    }

    #[test]
    fn ratios_are_those_of_known_turns_over_scalar_one_thread_all_features_and_the_second_configuration() {
        let engines = [(16, 1), (8, 1), (1, 1), (16, 2)].map(|(lanes, threads)| Engine { lanes, threads });
        let times = [1.0, 2.0, 10.0, 0.5].map(|seconds| Times::known(&[seconds; 3]));
        let [general, second] = [1.25, 4.0].map(|seconds| Times::known(&[seconds; 3]));
        let found = ratios(&engines, &times.each_ref(), Some(&general), &[&second]);
        let medians = found.iter().map(|ratios| ratios.map(|ratio| ratio.map(|ratio| ratio.median)));
        let first = [Some(10.0), None, Some(1.25), Some(4.0)];
        let others = [[Some(5.0), None, None, None], [None; 4], [None, Some(2.0), None, None]];
        assert_eq!(medians.collect::<Vec<_>>(), [&[first][..], &others].concat());
    }
}
