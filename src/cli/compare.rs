//! `octray compare`: checks SIMD against scalar, bit by bit, and both against the f64 reference.

use super::error::{CHECK_FAILED, CliError};
use super::memory;
use super::options::CompareOptions;
use super::scenes;
use super::terminal;
use crate::measure::compare::{BYTES_PER_PIXEL, compare};
use crate::render::Settings;
use crate::report::compare::{Report, heading, meaning, row};
use std::process::ExitCode;

/// Runs the command.
pub fn run(options: CompareOptions) -> Result<ExitCode, CliError> {
    let mut report = Report { schema: "octray-compare-1", results: Vec::new() };
    memory::check(options.size, BYTES_PER_PIXEL)?;
    let scenes = scenes::checked(&options.scenes)?;
    if !options.json {
        terminal::print(&heading())?;
    }
    let (mut failed, mut lossy) = (false, false);
    for spec in scenes {
        let scene = scenes::load_with_warnings(&spec)?;
        let settings = Settings {
            resolution: options.size,
            max_bounces: options.bounces,
            seed: options.seed,
            methods: options.methods.of(&scene),
            pipeline: options.pipeline,
            threads: options.threads,
            ..Settings::of(&scene)
        };
        let comparison = compare(&scene, settings, options.samples);
        failed |= comparison.failed(settings.methods);
        lossy |= !settings.methods.lose_no_hit();
        if !options.json {
            terminal::print(&row(&comparison))?;
        }
        report.results.push(comparison);
    }
    if options.json {
        terminal::print_json(&report)?;
    } else {
        terminal::print(&meaning(&report, lossy))?;
    }
    Ok(if failed { ExitCode::from(CHECK_FAILED) } else { ExitCode::SUCCESS })
}
