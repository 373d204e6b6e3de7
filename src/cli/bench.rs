//! `octray bench`: frames per second, SIMD beside scalar.

use super::error::{CHECK_FAILED, CliError};
use super::interrupt;
use super::memory;
use super::options::BenchOptions;
use super::scenes;
use super::terminal;
use crate::lane::WIDTHS;
use crate::machine;
use crate::measure::bench::{Effort, Engine, bench};
use crate::measure::compare::{BYTES_PER_PIXEL as COMPARE_BYTES_PER_PIXEL, compare};
use crate::render::{Renderer, Settings};
use crate::report::bench::{Report, heading, meaning, ratios, row, stats_of, warning};
use crate::scene::Scene;
use std::process::ExitCode;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Measuring time of a scene, all engines together; the eight built-in ones take half a minute, loading and
/// comparing included.
const PER_SCENE: Duration = Duration::from_secs(2);

/// Runs the command.
pub fn run(options: BenchOptions) -> Result<ExitCode, CliError> {
    let start = Instant::now();
    terminal::warn_of_debug_build("bench");
    let mut report = Report::of_this_machine();
    memory::check(options.size, COMPARE_BYTES_PER_PIXEL)?;
    let mut failed = false;
    let scenes = scenes::checked(&options.scenes)?;
    let measured =
        Arc::new(Mutex::new(Measured { json: options.json, scenes: scenes.len(), ..Measured::default() }));
    let until_now = measured.clone();
    interrupt::end_with(move || until_now.lock().unwrap_or_else(PoisonError::into_inner).on_ctrl_c());
    for (index, spec) in scenes.iter().enumerate() {
        let scene = scenes::load_with_warnings(spec)?;
        let settings = settings(&scene, &options);
        if index == 0 {
            report.first_frame_ms = first_frame(&scene, settings, start);
            if !options.json {
                terminal::print(&heading(
                    &report,
                    settings.resolution,
                    settings.max_bounces,
                    threads(&options),
                ))?;
            }
        }
        let effort = options.frames.map_or(Effort::Time(PER_SCENE), Effort::Frames);
        let engines = engines(&options);
        let results = bench(&scene, settings, &engines, effort, options.stats);
        let accuracy = compare(&scene, settings, 1);
        failed |= accuracy.failed(settings.methods);
        let row = row(&results, &accuracy);
        report.results.extend(results);
        report.accuracy.push(accuracy);
        {
            let mut measured = measured.lock().unwrap_or_else(PoisonError::into_inner);
            (measured.done, measured.ratios) = (index + 1, ratios(&report));
        }
        if !options.json {
            terminal::print(&row)?;
        }
    }
    if options.json {
        terminal::print_json(&report)?;
    } else {
        terminal::print(&ratios(&report))?;
        terminal::print(&meaning(&report))?;
        if options.stats {
            terminal::print(&stats_of(&report))?;
        }
    }
    if let Some(sentence) = warning(&report.results) {
        terminal::warn(&sentence);
    }
    Ok(if failed { ExitCode::from(CHECK_FAILED) } else { ExitCode::SUCCESS })
}

/// What is measured when Ctrl-C comes.
#[derive(Default)]
struct Measured {
    json: bool,
    /// All that are to be measured.
    scenes: usize,
    done: usize,
    /// The table of those that are done.
    ratios: String,
}

impl Measured {
    /// Printed on Ctrl-C.
    fn on_ctrl_c(&self) -> String {
        let Self { json, scenes, done, ratios } = self;
        match (json, done) {
            (true, _) => format!("Ctrl-C came after {done} of {scenes} scenes: the report was not written."),
            (false, 0) => "Ctrl-C came before a scene was measured.".into(),
            (false, _) => format!("{ratios}\nCtrl-C came after {done} of {scenes} scenes."),
        }
    }
}

/// The width that was asked for or that of `--lanes auto`; then, by default, the other packets that are one
/// vector of the machine, scalar, and the first once more on all cores.
fn engines(options: &BenchOptions) -> Vec<Engine> {
    let threads = threads(options);
    let first = options.lanes.unwrap_or_default().lanes();
    let mut engines = vec![Engine { lanes: first, threads }];
    if options.lanes.is_none() {
        let others = WIDTHS.into_iter().rev().filter(|&lanes| lanes != first);
        engines.extend(others.map(|lanes| Engine { lanes, threads }));
    }
    if options.threads.is_none() && machine::cores() > 1 && first > 1 {
        engines.push(Engine { lanes: first, threads: machine::cores() });
    }
    engines
}

/// Of every engine but the one on all cores.
fn threads(options: &BenchOptions) -> usize {
    options.threads.unwrap_or(1)
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
