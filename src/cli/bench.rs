//! `octray bench`: frames per second, SIMD beside scalar.

use super::error::{CliError, checked, refuse};
use super::frame::FrameOptions;
use super::groups::lanes;
use super::interrupt;
use super::numbers::{threads, whole};
use super::scenes;
use super::terminal::{self, Printer};
use crate::lane::WIDTHS;
use crate::machine;
use crate::measure::bench::{Configuration, Effort, Engine, bench};
use crate::measure::compare::{BYTES_PER_PIXEL as COMPARE_BYTES_PER_PIXEL, compare};
use crate::render::{LaneChoice, Renderer, Settings};
use crate::report::baseline::Baseline;
use crate::report::bench::{MeasuredScene, Report, doubt, heading, meaning, ratios, row, stats_of, summary};
use crate::report::settings::{RunSettings, own_size};
use crate::scene::{Scene, bench_names};
use clap::Parser;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// Measuring time of a scene, all engines together; the eight built-in ones take half a minute, loading and
/// comparing included.
const PER_SCENE: Duration = Duration::from_secs(2);
/// Most measured frames.
const MAX_FRAMES: u32 = 1_000_000;

/// Measure frames per second, SIMD beside scalar.
///
/// A frame is one sample per pixel. Each scene is rendered frame after frame, first to warm up, then to
/// measure; loading and building are not timed. One pass is checked: SIMD against scalar, and against a
/// reference in double precision.
///
/// Columns: 16 lanes (where they are one vector), 8 lanes, scalar: frames per second on one thread (or
/// --threads), the median, and in brackets the 1 % low (the rate that 99 % of the frames reach). all cores,
/// and Mray/s, millions of rays per second on one thread: by the width of --lanes. 178k is 178,000; a dash
/// was not measured. differing: pixels in which any width differs from scalar in any bit. wrong hits: primary
/// hits that are wrong by the reference. Both should be 0, or the exit code is 1. rmse: root mean square
/// error of a frame without next event estimation against the reference on the same random numbers.
///
/// A ? marks a figure that is not reliable: other programs took more than 5 % of the time of the measuring
/// threads in the median turn, or it has fewer than 50 frames or 3 rounds.
///
/// Then ratios: medians of alternating rounds, and in brackets from 10 to 90 % of them. speed-up: over
/// scalar. scaling: all cores over one thread. specialisation: the pipeline compiled for the features of the
/// scene over the one with every feature. The last line is a summary to paste.
#[derive(Debug, clap::Parser)]
#[command(after_help = "Example:\n  octray bench builtin:three --threads 1 --json > bench.json")]
pub struct Options {
    /// Scenes, models, builtin:NAME [default: the built-in bench scenes].
    #[arg(value_name = "SCENE")]
    scenes: Vec<OsString>,
    /// Print the figures as JSON (schema octray-bench-1).
    #[arg(long)]
    json: bool,
    /// Print time by stage, rays, SIMD use, tests per ray.
    #[arg(long)]
    stats: bool,
    /// Worker threads [default: one, and SIMD on all cores].
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    threads: Option<usize>,
    /// Measure one width: auto, 1, 8, 16 [default: all].
    #[arg(long, value_name = "LANES", value_parser = lanes(), hide_possible_values = true)]
    lanes: Option<LaneChoice>,
    /// Measured frames [default: two seconds, at least 50].
    #[arg(long, value_name = "N", value_parser = whole::<1, MAX_FRAMES>, allow_hyphen_values = true)]
    frames: Option<u32>,
    /// Print ratios to an earlier report (--json).
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    #[command(flatten)]
    frame: FrameOptions,
}

/// Runs the command.
pub fn run(options: Options) -> Result<ExitCode, CliError> {
    let start = Instant::now();
    terminal::warn_of_debug_build("bench");
    let out = Printer { json: options.json };
    options.frame.check(COMPARE_BYTES_PER_PIXEL)?;
    let mut report = Report::new(options.run_settings());
    let defaults = Options::parse_from(["bench"]).run_settings();
    let (mut failed, mut own) = (false, Vec::new());
    let scenes = scenes::checked(&options.scenes, bench_names())?;
    let baseline = options.baseline.as_deref().map(|file| options.baseline(file, &scenes)).transpose()?;
    let last_note = |report: &Report| {
        let done = format!("Ctrl-C came after {} of {} scenes", report.accuracy.len(), scenes.len());
        match options.json {
            true => format!("{done}: the report was not written."),
            false => format!("{}\n{done}.", ratios(report)),
        }
    };
    interrupt::end_with(last_note(&report));
    for (index, spec) in scenes.iter().enumerate() {
        let (scene, settings) = options.frame.load(spec, COMPARE_BYTES_PER_PIXEL)?;
        if index == 0 {
            report.first_frame_ms = first_frame(&scene, settings, start);
            out.text(&heading(&report, &defaults))?;
        }
        let effort = options.frames.map_or(Effort::Time(PER_SCENE), Effort::Frames);
        let configuration = Configuration { settings, engines: options.engines() };
        let results = bench(&scene, &[configuration], effort, options.stats).concat();
        let accuracy = compare(&scene, settings, 1, false);
        failed |= accuracy.failed(settings.methods);
        let row = row(&results, &accuracy);
        report.scenes.push(MeasuredScene::of(&scene, &settings));
        own.extend(own_size(&scene, &settings));
        report.results.extend(results);
        report.accuracy.push(accuracy);
        interrupt::set_last_note(last_note(&report));
        out.text(&row)?;
    }
    let doubt = doubt(&report.results);
    report.reliable = doubt.is_none() && !cfg!(debug_assertions);
    report.over_baseline = baseline.as_ref().map(|baseline| baseline.ratios(&report));
    out.text(&(ratios(&report) + &meaning(&report, &own)))?;
    if let Some(baseline) = &baseline {
        out.text(&baseline.text(&report))?;
    }
    if options.stats {
        out.text(&stats_of(&report))?;
    }
    out.text(&summary(&report, &defaults))?;
    out.report(&report)?;
    doubt.iter().for_each(|(_, warning)| terminal::warn(warning));
    Ok(checked(failed))
}

impl Options {
    /// The width that was asked for or that of `--lanes auto`; then, by default, the other packets that are
    /// one vector of the machine, scalar, and the first once more on all cores.
    fn engines(&self) -> Vec<Engine> {
        let threads = self.threads();
        let first = self.lanes.unwrap_or_default().lanes();
        let mut engines = vec![Engine { lanes: first, threads }];
        if self.lanes.is_none() {
            let others = WIDTHS.into_iter().rev().filter(|&lanes| lanes != first);
            engines.extend(others.map(|lanes| Engine { lanes, threads }));
        }
        if self.threads.is_none() && machine::cores() > 1 && first > 1 {
            engines.push(Engine { lanes: first, threads: machine::cores() });
        }
        engines
    }

    fn run_settings(&self) -> RunSettings {
        let engines = self.engines();
        let lanes: BTreeSet<usize> = engines.iter().map(|engine| engine.lanes).collect();
        let threads: BTreeSet<usize> = engines.iter().map(|engine| engine.threads).collect();
        let (lanes, threads) = (lanes.into_iter().rev().collect(), threads.into_iter().collect());
        let run = RunSettings { lanes, threads, ..self.frame.run_settings() };
        run.with("frames", self.frames)
    }

    /// The report in this file, if it is one of these scenes and settings.
    fn baseline(&self, file: &Path, scenes: &[OsString]) -> Result<Baseline, CliError> {
        let refuse = |why: String| refuse("--baseline", file.display(), why);
        let text =
            fs::read_to_string(file).map_err(|error| refuse(format!("it cannot be read ({error})")))?;
        let baseline = Baseline::read(&text).map_err(refuse)?;
        let of = |name: &OsString| {
            scenes::load(name).map(|scene| MeasuredScene::of(&scene, &self.frame.settings(&scene)))
        };
        let scenes = scenes.iter().map(of).collect::<Result<Vec<_>, _>>()?;
        let (run, engines) = (self.run_settings(), self.engines());
        baseline.check(&run, &engines, &scenes).map_err(refuse)?;
        baseline.warnings(&run, &engines, &scenes).iter().for_each(|warning| terminal::warn(warning));
        Ok(baseline)
    }

    /// Of every engine but the one on all cores.
    fn threads(&self) -> usize {
        self.threads.unwrap_or(1)
    }
}

/// Milliseconds from `start` to the end of a first frame.
fn first_frame(scene: &Scene, settings: Settings, start: Instant) -> f64 {
    let renderer = Renderer::new(scene, settings);
    renderer.add_samples(&mut renderer.film(), 1);
    start.elapsed().as_secs_f64() * 1e3
}
