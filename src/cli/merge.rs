//! `octray merge`: the shards of a picture joined.

use super::error::CliError;
use super::memory;
use super::options::MergeOptions;
use super::terminal;
use crate::checkpoint::merge::Parts;
use crate::film::Film;
use crate::film::noise::Noise;
use crate::output::{self, Existing, Format};
use crate::tone::Tone;
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::process::ExitCode;

/// The JSON report.
#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    /// Name of the scene.
    scene: String,
    output: String,
    parts: usize,
    width: u32,
    height: u32,
    samples: u32,
    rays: u64,
    discarded_samples: u64,
}

/// Runs the command.
pub fn run(options: MergeOptions) -> Result<ExitCode, CliError> {
    Format::of(&options.output)?;
    output::check(&options.output, Existing::Replace)?;
    let parts = Parts::open(&options.parts)?;
    let header = parts.header().clone();
    let settings = &header.identity.settings;
    let noise = if settings.target.is_some() { Noise::BYTES_PER_PIXEL } else { 0 };
    memory::check(settings.resolution, Film::BYTES_PER_PIXEL + noise)?;
    let film = parts.film()?;
    let [width, height] = settings.resolution;
    let report = Report {
        schema: "octray-merge-1",
        scene: header.name,
        output: options.output.display().to_string(),
        parts: options.parts.len(),
        width,
        height,
        samples: film.samples(),
        rays: film.rays(),
        discarded_samples: film.discarded(),
    };
    let shown = header.display;
    let tone = Tone {
        exposure: options.exposure.unwrap_or(shown.exposure),
        operator: options.tone.unwrap_or(shown.operator),
    };
    let picture = film.picture();
    drop(film);
    output::save(&options.output, &picture, &tone)?;
    if options.json {
        terminal::print_json(&report)?;
    } else {
        let Report { output, parts, samples, .. } = report;
        let parts = counted(parts, "part", "parts");
        terminal::print(&format!(
            "{output}: {width}×{height}, {} samples, from {parts}\n",
            grouped(samples)
        ))?;
    }
    Ok(ExitCode::SUCCESS)
}
