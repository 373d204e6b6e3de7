//! `octray bench`: frames per second, SIMD beside scalar.

use super::CHECK_FAILED;
use super::error::CliError;
use super::options::BenchOptions;
use super::terminal;
use crate::measure::bench::{Effort, Engine, Measurement, bench};
use crate::measure::compare::{Comparison, compare};
use crate::measure::{Machine, machine};
use crate::render::{Renderer, Settings};
use crate::scene::{self, Scene};
use serde::Serialize;
use std::fmt::Write;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Measuring time of a scene, all engines together: six built-in scenes stay below 20 seconds.
const PER_SCENE: Duration = Duration::from_secs(2);

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
    for (index, spec) in scenes(&options.scenes).iter().enumerate() {
        let scene = scene::load(spec)?;
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
        let results = bench(&scene, settings, &engines, effort);
        let accuracy = compare(&scene, settings, 1);
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
    }
    let failed = report.accuracy.iter().any(|accuracy| accuracy.failed(options.methods));
    Ok(if failed { ExitCode::from(CHECK_FAILED) } else { ExitCode::SUCCESS })
}

/// The scenes asked for, or the built-in ones.
pub(super) fn scenes(asked: &[String]) -> Vec<String> {
    if asked.is_empty() {
        scene::builtin_names().map(|name| format!("builtin:{name}")).collect()
    } else {
        asked.to_vec()
    }
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
        methods: options.methods,
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
         {width}×{height}, 1 sample a frame, up to {} bounces; fps: median (1 % low)\n\n\
         {:<24}{:>18}{:>18}{:>9}{:>18}{:>9}{:>9}{:>8}{:>8}\n",
        report.machine,
        settings.max_bounces,
        "scene",
        "SIMD",
        "scalar",
        "speed-up",
        "all cores",
        "scaling",
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
            format!("{:.0} ({:.0})", result.fps_median, result.fps_low_1_percent)
        })
    };
    let ratio = |over: Option<&Measurement>, under: Option<&Measurement>| match (over, under) {
        (Some(over), Some(under)) => format!("{:.2}×", over.fps_median / under.fps_median),
        _ => String::new(),
    };
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{:<24}{:>18}{:>18}{:>9}{:>18}{:>9}{:>9.1}{:>8}{:>8}",
        first.scene,
        fps(simd),
        fps(scalar),
        ratio(simd, scalar),
        fps(all),
        ratio(all, simd),
        first.mrays_per_s,
        accuracy.mismatched_pixels,
        accuracy.reference.mismatched_hits,
    );
    text
}

/// What the table says, in a line.
fn meaning(report: &Report) -> String {
    let pixels: usize = report.accuracy.iter().map(|accuracy| accuracy.mismatched_pixels).sum();
    let hits: usize = report.accuracy.iter().map(|accuracy| accuracy.reference.mismatched_hits).sum();
    let ratios: Vec<f64> = report
        .results
        .iter()
        .filter(|result| result.engine == "scalar")
        .filter_map(|scalar| {
            let same = |simd: &&Measurement| {
                simd.engine == "simd" && simd.scene == scalar.scene && simd.threads == scalar.threads
            };
            report.results.iter().find(same).map(|simd| simd.fps_median / scalar.fps_median)
        })
        .collect();
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
        format!("{pixels} PIXELS DIFFER")
    };
    let right = if hits == 0 {
        "every primary hit is right by the f64 reference".into()
    } else {
        format!("{hits} PRIMARY HITS ARE WRONG by the f64 reference")
    };
    format!("\n{speed}; {same}; {right}.\n")
}
