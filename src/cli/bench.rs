//! `octray bench`: frames per second, SIMD beside scalar.

use super::CHECK_FAILED;
use super::error::CliError;
use super::memory;
use super::options::BenchOptions;
use super::scenes;
use super::stats;
use super::terminal::{self, figure};
use crate::machine::{self, Machine};
use crate::measure::bench::{Effort, Engine, FEWEST_FRAMES, Measurement, bench};
use crate::measure::compare::{BYTES_PER_PIXEL as COMPARE_BYTES_PER_PIXEL, Comparison, compare};
use crate::measure::timed::Ratio;

use crate::render::{Renderer, Settings};
use crate::scene::Scene;
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::fmt::Write;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Measuring time of a scene, all engines together; the eight built-in ones take half a minute with all that is around it.
const PER_SCENE: Duration = Duration::from_secs(2);

/// A 1 % low below this share of the median means that something else took the processor away.
const BUSY: f64 = 0.6;

/// The JSON report.
#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    machine: Machine,
    /// From the start of the command to the end of its first frame.
    first_frame_ms: f64,
    results: Vec<Measurement>,
    /// One sample of each scene: SIMD against scalar and against the f64 reference. No speed without its accuracy.
    accuracy: Vec<Comparison>,
}

/// Runs the command.
pub fn run(options: BenchOptions) -> Result<ExitCode, CliError> {
    let start = Instant::now();
    if cfg!(debug_assertions) {
        terminal::warn("this is a debug build: its figures say nothing. Use cargo run --release -- bench.");
    }
    let engines = engines(&options);
    let mut report = Report {
        schema: "octray-bench-1",
        machine: Machine::current(),
        first_frame_ms: 0.0,
        results: Vec::new(),
        accuracy: Vec::new(),
    };
    memory::check(options.size, COMPARE_BYTES_PER_PIXEL)?;
    let mut failed = false;
    for (index, spec) in scenes::asked_for(&options.scenes)?.iter().enumerate() {
        let scene = scenes::load(spec)?;
        for warning in &scene.warnings {
            terminal::warn(warning);
        }
        let settings = settings(&scene, &options);
        if index == 0 {
            report.first_frame_ms = first_frame(&scene, settings, start);
            if !options.json {
                terminal::print(&heading(&report, &settings))?;
            }
        }
        let effort = options.frames.map_or(Effort::Time(PER_SCENE), Effort::Frames);
        let results = bench(&scene, settings, &engines, effort, options.stats);
        let accuracy = compare(&scene, settings, 1);
        failed |= accuracy.failed(settings.methods);
        if !options.json {
            terminal::print(&row(&results, &accuracy))?;
        }
        report.results.extend(results);
        report.accuracy.push(accuracy);
    }
    if options.json {
        terminal::print_json(&report)?;
    } else {
        terminal::print(&meaning(&report))?;
        if options.stats {
            terminal::print(&stats_of(&report.results))?;
        }
    }
    if let Some(sentence) = busy(&report.results) {
        terminal::warn(&sentence);
    }
    Ok(if failed { ExitCode::from(CHECK_FAILED) } else { ExitCode::SUCCESS })
}

fn engines(options: &BenchOptions) -> Vec<Engine> {
    let threads = options.threads.unwrap_or(1);
    let mut engines = vec![Engine { lanes: 8, threads }, Engine { lanes: 1, threads }];
    if options.threads.is_none() && machine::cores() > 1 {
        engines.push(Engine { lanes: 8, threads: machine::cores() });
    }
    engines.retain(|engine| options.lanes.is_none_or(|lanes| lanes == engine.lanes));
    engines
}

fn settings(scene: &Scene, options: &BenchOptions) -> Settings {
    Settings {
        resolution: options.size,
        max_bounces: options.bounces,
        seed: options.seed,
        methods: options.methods.of(scene),
        pipeline: options.pipeline,
        ..Settings::of(scene)
    }
}

/// Milliseconds from `start` to the end of a first frame.
fn first_frame(scene: &Scene, settings: Settings, start: Instant) -> f64 {
    let renderer = Renderer::new(scene, settings);
    renderer.add_samples(&mut renderer.film(), 1);
    start.elapsed().as_secs_f64() * 1e3
}

fn heading(report: &Report, settings: &Settings) -> String {
    let [width, height] = settings.resolution;
    format!(
        "{}\n\
         {width}×{height}, 1 sample a frame, up to {}\n\
         fps: median (1 % low); speed-up, scaling and gain: median of the rounds (10 to 90 % of them)\n\n\
         {:<24}{:>16}{:>16}{:>18}{:>16}{:>18}{:>18}{:>8}{:>9}{:>9}\n",
        report.machine,
        counted(settings.max_bounces, "bounce", "bounces"),
        "scene",
        "SIMD",
        "scalar",
        "speed-up",
        "all cores",
        "scaling",
        "gain of needs",
        "Mray/s",
        "pixels≠",
        "hits≠"
    )
}

/// A scene's row: what was not measured stays empty.
fn row(results: &[Measurement], accuracy: &Comparison) -> String {
    let first = &results[0];
    let simd = results.iter().find(|result| result.engine == "simd");
    let scalar = results.iter().find(|result| result.engine == "scalar");
    let all = results.iter().skip(1).find(|result| result.engine == "simd");
    let fps = |result: Option<&Measurement>| {
        result.map_or(String::new(), |result| {
            format!("{} ({})", figure(result.fps_median, 0), figure(result.fps_low_1_percent, 0))
        })
    };
    let ratio = |of: fn(&Measurement) -> Option<Ratio>| {
        results.iter().find_map(of).map_or(String::new(), |ratio| shown(ratio.median, ratio.spread))
    };
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{:<24}{:>16}{:>16}{:>18}{:>16}{:>18}{:>18}{:>8}{:>9}{:>9}",
        first.scene,
        fps(simd),
        fps(scalar),
        ratio(|result| result.speedup),
        fps(all),
        ratio(|result| result.scaling),
        ratio(|result| result.gain),
        figure(first.mrays_per_s, 1),
        grouped(accuracy.mismatched_pixels),
        grouped(accuracy.reference.mismatched_hits),
    );
    text
}

/// A ratio and its spread.
pub(super) fn shown(median: f64, [low, high]: [f64; 2]) -> String {
    format!("{median:.2}× ({low:.1}–{high:.1})")
}

/// The sentence about the engine that was held up most, if one was. Below [`FEWEST_FRAMES`] the 1 % low is the slowest frame, whatever slowed
/// it.
fn busy(results: &[Measurement]) -> Option<String> {
    let share = |result: &Measurement| result.fps_low_1_percent / result.fps_median;
    let timed = results.iter().filter(|result| result.frames >= FEWEST_FRAMES);
    let worst = timed.min_by(|a, b| share(a).total_cmp(&share(b))).filter(|worst| share(worst) < BUSY)?;
    let Measurement { scene, engine, threads, .. } = worst;
    let threads = counted(threads, "thread", "threads");
    Some(format!(
        "the machine is busy: the 1 % low of {scene} ({engine}, {threads}) is {:.0} % of its median; end other programs, or \
         trust the speed-ups alone.",
        100.0 * share(worst)
    ))
}

/// A table a scene, a column an engine, and what the tables mean.
fn stats_of(results: &[Measurement]) -> String {
    let tables = results.chunk_by(|a, b| a.scene == b.scene).map(|of_scene| {
        let columns: Vec<_> = of_scene.iter().filter_map(|result| result.stats.as_ref()).collect();
        stats::frames(&of_scene[0].scene, &columns)
    });
    tables.collect::<String>() + &stats::meaning_of_frames()
}

/// What the table says, in a line.
fn meaning(report: &Report) -> String {
    let pixels: usize = report.accuracy.iter().map(|accuracy| accuracy.mismatched_pixels).sum();
    let hits: usize = report.accuracy.iter().map(|accuracy| accuracy.reference.mismatched_hits).sum();
    let ratios = report.results.iter().filter_map(|result| Some(result.speedup?.median));
    let ratios: Vec<f64> = ratios.collect();
    let speed = match (ratios.iter().copied().reduce(f64::min), ratios.iter().copied().reduce(f64::max)) {
        (Some(least), Some(most)) if ratios.len() > 1 => {
            format!("eight lanes are {least:.1} to {most:.1} times as fast as one")
        }
        (Some(ratio), _) => format!("eight lanes are {ratio:.1} times as fast as one"),
        _ => "one width was timed".into(),
    };
    let same = if pixels == 0 {
        "the pictures of both are the same, bit by bit".into()
    } else {
        counted(pixels, "PIXEL DIFFERS", "PIXELS DIFFER")
    };
    let right = if hits == 0 {
        "every primary hit is right by the f64 reference".into()
    } else {
        counted(hits, "PRIMARY HIT IS", "PRIMARY HITS ARE") + " WRONG by the f64 reference"
    };
    let gain = "Gain of needs: against the pipeline with every feature; empty where a scene gets that one.";
    format!("\n{speed}; {same}; {right}.\n{gain}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn busy_names_the_engine_that_was_held_up_most() {
        let result = |scene: &str, frames, low| Measurement {
            scene: scene.into(),
            width: 240,
            height: 135,
            max_bounces: 4,
            engine: "simd",
            lanes: 8,
            threads: 2,
            frames,
            fps_median: 100.0,
            fps_low_1_percent: low,
            fps_spread: [low, 100.0],
            mrays_per_s: 1.0,
            rays_per_frame: 1e4,
            speedup: None,
            scaling: None,
            needs: Vec::new(),
            pipeline: "needed",
            gain: None,
            stats: None,
        };
        let few = result("few", FEWEST_FRAMES - 1, 1.0);
        assert_eq!(busy(&[few.clone(), result("calm", 99, 61.0)]), None);
        let sentence = busy(&[few, result("bad", 99, 50.0), result("worse", 99, 40.0)]).unwrap();
        assert!(
            sentence.contains("busy") && sentence.contains("worse (simd, 2 threads) is 40 %"),
            "{sentence}"
        );
    }
}
