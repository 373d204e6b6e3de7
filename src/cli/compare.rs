//! `octray compare`: checks SIMD against scalar, bit by bit, and both against the f64 reference; or prints
//! hashes of films, to compare machines and builds.

use super::error::CliError;
use super::numbers::{samples, threads};
use super::options::FrameOptions;
use super::scenes;
use super::terminal::{self, Printer};
use crate::lane::{FUSED, WIDTHS};
use crate::machine;
use crate::measure::compare::{BYTES_PER_PIXEL, compare};
use crate::methods;
use crate::render::Settings;
use crate::report::compare::{FilmHash, HashReport, Report, doubt, heading, meaning, row};
use crate::report::settings::RunSettings;
use crate::scene::{Loaded, builtin_names};
use clap::Parser;
use std::ffi::{OsStr, OsString};
use std::process::ExitCode;

const HASH: &str = "Only print a hash of each scene's film, equal on every machine: FNV-1a (64 bits) of width and \
     height (u32) and of the linear RGB of all pixels by rows (f32), little-endian, for builds with fused \
     multiply-add (\"fused\") or without (\"plain\")";

/// Check that SIMD and scalar render the same picture.
///
/// Renders each scene at every width (1, 8 and, with AVX-512, 16) and counts the pixels that differ in any
/// bit: 0 is expected. Then they are compared with a reference in double precision that shares no code with
/// them. Exits with 1 if a pixel differs, a sample is not finite, or a primary hit is wrong; wrong hits are
/// allowed with a method that is not robust. All widths are always compared, so there is no --lanes.
///
/// Columns: differing: pixels that differ. speed-up: SIMD over scalar, the median, and in brackets from 10 to
/// 90 % of the rounds; a ? marks fewer than 3 rounds, or a busy machine. rmse/f64, max/f64: root mean square
/// and largest difference from the reference. wrong hits: primary hits that are wrong by the reference.
/// Samples are timed on all cores at once, where other programs disturb them: `octray bench` measures the
/// speed-up on one.
#[derive(Debug, clap::Parser)]
#[command(after_help = "Example:\n  octray compare builtin:three --samples 64")]
pub struct Options {
    /// Scenes, models, builtin:NAME [default: the built-in scenes].
    #[arg(value_name = "SCENE")]
    scenes: Vec<OsString>,
    /// Print JSON (schemas octray-compare-1, octray-hash-1).
    #[arg(long)]
    json: bool,
    /// Worker threads [default: all cores].
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    threads: Option<usize>,
    /// Only print a hash of each film, to compare machines.
    #[arg(long, long_help = HASH)]
    hash: bool,
    /// Samples per pixel.
    #[arg(long, value_name = "N", default_value = "16", value_parser = samples, allow_hyphen_values = true)]
    samples: u32,
    #[command(flatten)]
    frame: FrameOptions,
}

impl Options {
    fn load(&self, name: &OsStr) -> Result<(Loaded, Settings), CliError> {
        let (scene, settings) = self.frame.load(name, BYTES_PER_PIXEL)?;
        Ok((scene, Settings { threads: self.threads(), ..settings }))
    }

    fn threads(&self) -> usize {
        self.threads.unwrap_or_else(machine::cores)
    }

    fn run_settings(&self) -> RunSettings {
        let (lanes, threads) = (WIDTHS.into_iter().rev().collect(), vec![self.threads()]);
        let run = RunSettings { lanes, threads, ..self.frame.run_settings() };
        run.with("samples", Some(self.samples))
    }
}

pub fn run(options: Options) -> Result<ExitCode, CliError> {
    options.frame.check(BYTES_PER_PIXEL)?;
    let (out, scenes) = (Printer { json: options.json }, scenes::checked(&options.scenes, builtin_names())?);
    if options.hash { hash(&options, scenes, out) } else { compare_all(&options, scenes, out) }
}

fn hash(options: &Options, scenes: Vec<OsString>, out: Printer) -> Result<ExitCode, CliError> {
    let mut report = HashReport { schema: "octray-hash-1", fused: FUSED, results: Vec::new() };
    let rounding = if FUSED { "fused" } else { "plain" };
    for spec in scenes {
        let (scene, settings) = options.load(&spec)?;
        let renderer = methods::renderer(&scene, settings);
        let mut film = renderer.film();
        renderer.add_samples(&mut film, options.samples);
        let scene = spec.to_string_lossy().into_owned();
        let hash = format!("{:016x}", film.picture().hash());
        out.text(&format!("{hash}  {rounding}  {scene}\n"))?;
        report.results.push(FilmHash { scene, hash });
    }
    out.end(&report, false)
}

fn compare_all(options: &Options, scenes: Vec<OsString>, out: Printer) -> Result<ExitCode, CliError> {
    terminal::warn_of_debug_build("compare");
    let (schema, settings) = ("octray-compare-1", options.run_settings());
    let mut report = Report { schema, settings, ..Report::default() };
    let mut failed = false;
    let defaults = Options::parse_from(["compare"]).run_settings();
    for spec in scenes {
        let (scene, settings) = options.load(&spec)?;
        if report.results.is_empty() {
            out.text(&heading(&report, &defaults))?;
        }
        let comparison = compare(&scene, settings, options.samples, true);
        failed |= comparison.failed(settings.methods);
        out.text(&row(&comparison))?;
        report.results.push(comparison);
    }
    let doubt = doubt(&report.results);
    report.reliable = doubt.is_none() && !cfg!(debug_assertions);
    out.text(&meaning(&report))?;
    doubt.iter().for_each(|warning| terminal::warn(warning));
    out.end(&report, failed)
}
