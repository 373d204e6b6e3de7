//! `octray compare`: do SIMD and scalar agree, bit by bit, and with the judge?

use super::CHECK_FAILED;
use super::bench::shown;
use super::error::CliError;
use super::memory;
use super::options::CompareOptions;
use super::scenes;
use super::terminal;
use crate::measure::compare::{BYTES_PER_PIXEL, Comparison, compare};
use crate::render::Settings;
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::process::ExitCode;

/// A speed-up of fewer rounds says nothing.
const FEWEST_ROUNDS: usize = 3;

/// The JSON report.
#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    results: Vec<Comparison>,
}

/// Runs the command.
pub fn run(options: CompareOptions) -> Result<ExitCode, CliError> {
    let mut report = Report { schema: "octray-compare-1", results: Vec::new() };
    memory::check(options.size, BYTES_PER_PIXEL)?;
    let scenes = scenes::asked_for(&options.scenes)?;
    if !options.json {
        terminal::print(&format!(
            "{:<24}{:>12}{:>12}{:>12}{:>18}{:>12}{:>12}{:>12}\n",
            "scene", "pixels", "samples", "differing", "speed-up", "rmse/f64", "max/f64", "wrong hits"
        ))?;
    }
    let (mut failed, mut lossy) = (false, false);
    for spec in scenes {
        let scene = scenes::load(&spec)?;
        for warning in &scene.warnings {
            terminal::warn(warning);
        }
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
    let differ = report.results.iter().any(|result| result.mismatched_pixels > 0);
    if options.json {
        terminal::print_json(&report)?;
    } else {
        let wrong: usize = report.results.iter().map(|result| result.reference.mismatched_hits).sum();
        let right = match wrong {
            0 => "every judged primary hit is right".to_string(),
            _ => counted(wrong, "primary hit is", "primary hits are") + " WRONG by the f64 reference",
        };
        terminal::print(&if differ && lossy {
            format!(
                "\nSIMD and scalar differ, as they may: unpadded boxes lose hits, each traversal its own; {right}.\n"
            )
        } else if differ {
            format!("\nSIMD and scalar DIFFER: a bug in octray, please report it with the scene; {right}.\n")
        } else {
            format!("\nSIMD and scalar pictures are the same, bit by bit; {right}.\n")
        })?;
    }
    Ok(if failed { ExitCode::from(CHECK_FAILED) } else { ExitCode::SUCCESS })
}

fn row(result: &Comparison) -> String {
    let Comparison { scene, pixels, samples, mismatched_pixels, first_mismatch, reference, .. } = result;
    let known = result.speedup_rounds >= FEWEST_ROUNDS;
    let mut row = format!(
        "{scene:<24}{:>12}{:>12}{:>12}{:>18}{:>12.2e}{:>12.2e}{:>12}\n",
        grouped(pixels),
        grouped(samples),
        grouped(mismatched_pixels),
        if known { shown(result.speedup, result.speedup_spread) } else { "–".into() },
        reference.rmse,
        reference.max_abs,
        grouped(reference.mismatched_hits),
    );
    if !known {
        row += &format!(
            "  speed-up: {} timed; give --samples {FEWEST_ROUNDS} or more\n",
            counted(result.speedup_rounds, "sample was", "samples were")
        );
    }
    if result.discarded_samples > 0 {
        let discarded = counted(result.discarded_samples, "sample was", "samples were");
        row += &format!("  {discarded} not finite and left out\n");
    }
    if let Some(first) = first_mismatch {
        row += &format!(
            "  first at ({}, {}): SIMD {:?}, scalar {:?}\n",
            first.x, first.y, first.simd, first.scalar
        );
    }
    row
}
