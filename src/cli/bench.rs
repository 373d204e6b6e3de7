//! `octray bench`: frames per second, SIMD beside scalar.

use super::error::{CliError, refuse};
use super::numbers::{threads, whole};
use super::options::{FrameOptions, baseline, lanes};
use super::terminal::{self, Printer};
use super::{interrupt, scenes};
use crate::lane::WIDTHS;
use crate::machine;
use crate::measure::bench::{Effort, Engine, FEWEST_FRAMES, Measurement, bench};
use crate::measure::compare::{BYTES_PER_PIXEL as COMPARE_BYTES_PER_PIXEL, compare};
use crate::methods;
use crate::render::LaneChoice;
use crate::report::baseline::{Baseline, over_rounds, text as over_baseline};
use crate::report::bench::{
    Against, MeasuredScene, Report, SCHEMA, doubt, heading, meaning, ratios, row, stats_of, summary,
};
use crate::report::settings::{RunSettings, differences, json, own_size};
use crate::scene::bench_names;
use clap::{ArgAction, Args, FromArgMatches, Parser};
use std::collections::BTreeSet;
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode, Stdio};
use std::time::{Duration, Instant};
use std::{env, iter};

/// Measuring time of a scene, all engines together; the eight built-in ones take half a minute, loading and
/// comparing included.
const PER_SCENE: Duration = Duration::from_secs(2);
/// Measuring time of the slowest engine of a program that another is compared with, in each of the rounds.
const A_TURN: Duration = Duration::from_millis(250);
const PROGRAM_ROUNDS: usize = 10;
const MAX_FRAMES: u32 = 1_000_000;

/// Measure frames per second, SIMD beside scalar.
///
/// A frame is one sample per pixel. Each scene is rendered frame after frame, first to warm up, then to
/// measure; loading and building are not timed. One pass is checked: SIMD against scalar, and against a
/// reference in double precision.
///
/// Columns: 16 lanes (where they are one vector), 8 lanes, scalar: frames per second on one thread (or
/// --threads): the median and, in brackets, the 1 % low (99 % of the frames are at least this fast). all
/// cores: frames per second of the first width. Mray/s: its millions of rays per second on one thread. 178k
/// means 178,000, and a dash "not measured". differing: pixels in which any width differs from scalar in any
/// bit. wrong hits: primary hits that are wrong by the reference. If one of these two is not 0, the exit code
/// is 1. rmse: root mean square error of a frame without next event estimation against the reference on the
/// same random numbers.
///
/// A ? marks a figure that is not reliable: other programs took more than 5 % of the time of the measuring
/// threads in the median turn, or it has fewer than 50 frames or 3 rounds.
///
/// The second table has ratios: medians of alternating rounds and, in brackets, 10 to 90 % of them. speed-up:
/// over scalar. scaling: all cores over one thread. specialisation: the pipeline compiled for the features of
/// the scene over the one with every feature. The last line is a summary to paste.
#[derive(Debug, clap::Parser)]
#[command(after_help = "Examples:
  octray bench builtin:three --threads 1 --json > bench.json
  octray bench builtin:knot:2000 --against \"--traversal single\"")]
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
    /// Measured frames [default: two seconds, at least 50].
    #[arg(long, value_name = "N", value_parser = whole::<1, MAX_FRAMES>, allow_hyphen_values = true)]
    frames: Option<u32>,
    /// An earlier report (--json).
    #[arg(long, value_name = "FILE", help_heading = RATIOS)]
    baseline: Option<PathBuf>,
    /// Other options, in alternating rounds.
    ///
    /// The other side has the same options except these, as in --against "--traversal single". With other
    /// --lanes or --threads, the first width has a ratio to the first one there.
    #[arg(long, value_name = "OPTIONS", help_heading = RATIOS, allow_hyphen_values = true, conflicts_with = "against_program")]
    against: Option<String>,
    /// Another octray, in alternating runs.
    #[arg(long, value_name = "PROGRAM", help_heading = RATIOS)]
    against_program: Option<PathBuf>,
    #[command(flatten)]
    engines: Engines,
}

/// The heading of options of what a run is compared with.
const RATIOS: &str = "Print ratios to";

/// The engines and their frames.
#[derive(Clone, Debug, clap::Args)]
struct Engines {
    /// Worker threads [default: one, and SIMD on all cores].
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    threads: Option<usize>,
    /// Widths, such as 8,1: auto, 1, 8, 16 [default: all].
    #[arg(long, value_name = "LANES", value_parser = lanes(), hide_possible_values = true, value_delimiter = ',', action = ArgAction::Set)]
    lanes: Vec<LaneChoice>,
    #[command(flatten)]
    frame: FrameOptions,
}

pub fn run(options: Options) -> Result<ExitCode, CliError> {
    let start = Instant::now();
    terminal::warn_of_debug_build("bench");
    let (out, engines) = (Printer { json: options.json }, &options.engines);
    let second = options.against.as_deref().map(|words| engines.with(words)).transpose()?;
    let bytes = COMPARE_BYTES_PER_PIXEL * if second.is_some() { 2 } else { 1 };
    iter::once(engines).chain(&second).try_for_each(|one| one.frame.check(bytes))?;
    let mut report = Report { schema: SCHEMA, settings: options.run_settings(), ..Report::default() };
    let defaults = Options::parse_from(["bench"]).run_settings();
    let (mut failed, mut own) = (false, Vec::new());
    let scenes = scenes::checked(&options.scenes, bench_names())?;
    let baseline = options.baseline.as_deref().map(|file| baseline(file, Baseline::read)).transpose()?;
    // A program that cannot be used is refused before anything is measured.
    let probe = Instant::now();
    report.against = options.against(second.as_ref(), &scenes[0])?;
    let start = start + probe.elapsed();
    let last_note = |report: &Report| {
        let done = format!("Ctrl-C came after {} of {} scenes", report.accuracy.len(), scenes.len());
        match options.json {
            true => format!("{done}: the report was not written."),
            false => format!("{}\n{done}.", ratios(report)),
        }
    };
    interrupt::end_with(last_note(&report));
    for (index, spec) in scenes.iter().enumerate() {
        let (scene, settings) = engines.frame.load(spec, bytes)?;
        let mut timed = vec![(settings, engines.list())];
        if let Some(second) = &second {
            let mut others = second.list();
            others.truncate(if others == engines.list() { others.len() } else { 1 });
            timed.push((second.frame.checked(&scene, bytes)?, others));
        }
        if index == 0 {
            let renderer = methods::renderer(&scene, settings);
            renderer.add_samples(&mut renderer.film(), 1);
            report.first_frame_ms = start.elapsed().as_secs_f64() * 1e3;
            out.text(&heading(&report, &defaults))?;
        }
        let effort = options.frames.map_or(Effort::Time(PER_SCENE * timed.len() as u32), Effort::Frames);
        let mut measured = bench(&scene, &timed, effort, options.stats).into_iter();
        let mut compared = timed.iter().map(|(settings, _)| {
            let accuracy = compare(&scene, *settings, 1, false);
            failed |= accuracy.failed(settings.methods);
            accuracy
        });
        let (Some(results), Some(accuracy)) = (measured.next(), compared.next()) else { continue };
        if let Some(against) = &mut report.against {
            if let (Some(second), Some(accuracy)) = (measured.next(), compared.next()) {
                against.push(&results, second, accuracy);
            } else if let Some(program) = &options.against_program {
                let reports = options.rounds(program, spec, &results)?;
                against.ratios.extend(over_rounds(&scene.name, &reports));
            }
        }
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
    if let Some(baseline) = &baseline {
        baseline.compare(&mut report);
    }
    out.text(&(ratios(&report) + &meaning(&report, &own) + &over_baseline(&report)))?;
    out.text(&report.against.as_ref().map(Against::text).unwrap_or_default())?;
    if options.stats {
        out.text(&stats_of(&report))?;
    }
    out.text(&summary(&report, &defaults))?;
    doubt.iter().for_each(|(_, warning)| terminal::warn(warning));
    out.end(&report, failed)
}

impl Options {
    fn run_settings(&self) -> RunSettings {
        self.engines.run_settings().with("frames", self.frames)
    }

    /// Returns the configuration or the program that the run is compared with, without figures.
    fn against(&self, second: Option<&Engines>, scene: &OsStr) -> Result<Option<Against>, CliError> {
        let (with, mut settings) = match (&self.against, second, &self.against_program) {
            (Some(with), Some(second), _) => (with.clone(), json(&second.run_settings())),
            (_, _, Some(program)) => {
                let report = program_report(program, scene, &self.engines.words(), 1)?;
                (program.display().to_string(), report.settings)
            }
            _ => return Ok(None),
        };
        // The number of frames changes no rate.
        settings.as_object_mut().map(|options| options.remove("frames"));
        let differences = differences(&json(&self.engines.run_settings()), &settings);
        Ok(Some(Against { with, differences, ..Against::default() }))
    }

    /// Runs this program and `other` in alternating rounds; `results` are this one's speeds. Returns the
    /// reports of both.
    fn rounds(
        &self,
        other: &Path,
        scene: &OsStr,
        results: &[Measurement],
    ) -> Result<[Vec<Baseline>; 2], CliError> {
        let slowest = results.iter().map(|result| result.fps_median).fold(f64::INFINITY, f64::min);
        let enough = (A_TURN.as_secs_f64() * slowest) as u32;
        let frames = self.frames.unwrap_or(enough.clamp(FEWEST_FRAMES as u32, MAX_FRAMES));
        let programs = [&env::current_exe().unwrap_or_else(|_| "octray".into()), other];
        let mut reports = [Vec::new(), Vec::new()];
        for turn in 0..2 * PROGRAM_ROUNDS {
            let side = [0, 1, 1, 0][turn % 4];
            reports[side].push(program_report(programs[side], scene, &self.engines.words(), frames)?);
        }
        Ok(reports)
    }
}

impl Engines {
    /// Returns the widths that were asked for or, by default, that of `--lanes auto`, the other packets that
    /// are one vector of the machine, and scalar; and the first once more on all cores.
    fn list(&self) -> Vec<Engine> {
        let threads = self.threads.unwrap_or(1);
        let given = self.lanes.iter().map(|choice| choice.lanes());
        let all = iter::once(LaneChoice::default().lanes()).chain(WIDTHS.into_iter().rev());
        let widths: Vec<usize> = if self.lanes.is_empty() { all.collect() } else { given.collect() };
        let mut engines: Vec<Engine> = Vec::new();
        for engine in widths.into_iter().map(|lanes| Engine { lanes, threads }) {
            if !engines.contains(&engine) {
                engines.push(engine);
            }
        }
        let first = engines[0].lanes;
        if self.threads.is_none() && machine::cores() > 1 && first > 1 {
            engines.push(Engine { lanes: first, threads: machine::cores() });
        }
        engines
    }

    fn run_settings(&self) -> RunSettings {
        let engines = self.list();
        let lanes: BTreeSet<usize> = engines.iter().map(|engine| engine.lanes).collect();
        let threads: BTreeSet<usize> = engines.iter().map(|engine| engine.threads).collect();
        let (lanes, threads) = (lanes.into_iter().rev().collect(), threads.into_iter().collect());
        RunSettings { lanes, threads, ..self.frame.run_settings() }
    }

    /// Returns the options that are not the defaults.
    fn words(&self) -> String {
        self.run_settings().options(&Options::parse_from(["bench"]).engines.run_settings())
    }

    /// Returns these options, replaced by those in `text` where it has them.
    fn with(&self, text: &str) -> Result<Self, CliError> {
        if text.trim().is_empty() {
            let instead = "name the options that differ, as in \"--traversal single\"";
            return Err(refuse("--against", "\"\"", instead));
        }
        let command = clap::Command::new("bench").no_binary_name(true).disable_help_flag(true);
        let command = Self::augment_args(command).args_override_self(true);
        let words = format!("{} {text}", self.words());
        let found = command.try_get_matches_from(words.split_whitespace());
        found.and_then(|found| Self::from_arg_matches(&found)).map_err(|error| {
            let error = error.to_string();
            let about =
                |part: &&str| !["Usage", "For", "  tip: to"].iter().any(|other| part.starts_with(other));
            let parts: Vec<&str> = error.trim_start_matches("error: ").split("\n\n").filter(about).collect();
            refuse("--against", format!("\"{text}\""), parts.join("\n"))
        })
    }
}

/// Returns the report of a program on a scene, with these options.
fn program_report(program: &Path, scene: &OsStr, words: &str, frames: u32) -> Result<Baseline, CliError> {
    let refuse = |why: String| refuse("--against-program", program.display(), why);
    // A name without a folder would be searched for among the installed programs.
    let mut command = Command::new(program.canonicalize().unwrap_or_else(|_| program.into()));
    command.arg("bench").arg(scene).args(words.split_whitespace());
    let output = command.args(["--frames", &frames.to_string(), "--json"]).stdin(Stdio::null()).output();
    let output = output.map_err(|error| refuse(format!("it cannot be run ({error})")))?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(refuse(format!("it ended with {}: {}", output.status, said.trim())));
    }
    Baseline::read(&String::from_utf8_lossy(&output.stdout)).map_err(refuse)
}
