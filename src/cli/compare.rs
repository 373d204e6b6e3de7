//! `octray compare`: checks SIMD against scalar, bit by bit, and both against the f64 reference; or prints
//! hashes of films, to compare machines and builds.

use super::error::{CHECK_FAILED, CliError};
use super::memory;
use super::options::CompareOptions;
use super::scenes;
use super::terminal;
use crate::measure::compare::{BYTES_PER_PIXEL, compare};
use crate::render::{LaneChoice, Renderer, Settings};
use crate::report::compare::{FilmHash, HashReport, Report, hash_row, heading, meaning, row};
use crate::scene::Scene;
use std::process::ExitCode;

/// Runs the command.
pub fn run(options: CompareOptions) -> Result<ExitCode, CliError> {
    memory::check(options.size, BYTES_PER_PIXEL)?;
    if options.hash { hash(&options) } else { compare_all(&options) }
}

/// Prints a hash of each scene's film.
fn hash(options: &CompareOptions) -> Result<ExitCode, CliError> {
    let mut report = HashReport::default();
    for spec in scenes::checked(&options.scenes)? {
        let scene = scenes::load_with_warnings(&spec)?;
        let renderer = Renderer::new(&scene, settings(options, &scene));
        let mut film = renderer.film();
        renderer.add_samples(&mut film, options.samples);
        let result = FilmHash { scene: spec, hash: format!("{:016x}", film.picture().hash()) };
        if !options.json {
            terminal::print(&hash_row(&result))?;
        }
        report.results.push(result);
    }
    if options.json {
        terminal::print_json(&report)?;
    }
    Ok(ExitCode::SUCCESS)
}

fn settings(options: &CompareOptions, scene: &Scene) -> Settings {
    let methods = options.methods.of(scene);
    Settings {
        resolution: options.size,
        max_bounces: options.bounces,
        seed: options.seed,
        methods,
        lanes: LaneChoice::Auto.lanes(),
        pipeline: options.pipeline,
        threads: options.threads,
        ..Settings::of(scene)
    }
}

fn compare_all(options: &CompareOptions) -> Result<ExitCode, CliError> {
    let mut report = Report { schema: "octray-compare-1", results: Vec::new() };
    let scenes = scenes::checked(&options.scenes)?;
    let (mut failed, mut lossy) = (false, false);
    for spec in scenes {
        let scene = scenes::load_with_warnings(&spec)?;
        if !options.json && report.results.is_empty() {
            terminal::print(&heading())?;
        }
        let settings = settings(options, &scene);
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
