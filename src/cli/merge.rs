//! `octray merge`: the shards of a picture joined.

use super::error::CliError;
use super::numbers::exposure;
use super::options::choice;
use super::outputs::keep_inputs;
use super::terminal::Printer;
use super::{denoise, memory};
use crate::checkpoint::merge::Parts;
use crate::output::{self, Existing, Format};
use crate::tone::{Operator, Tone};
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::path::PathBuf;
use std::process::ExitCode;

/// Join the parts of a picture that was rendered in shards.
///
/// The parts come from `octray render --shard I/N -o PART`. The picture has the bits of one run. Parts that
/// are missing, doubled, incomplete or of other pictures are named, and nothing is written. A checkpoint of a
/// whole picture is a part too, the only one.
#[derive(Debug, clap::Parser)]
#[command(after_help = "Example:
  octray merge *.part -o scene.exr")]
pub struct Options {
    #[arg(value_name = "PART", required = true, help = "The parts, in any order")]
    parts: Vec<PathBuf>,
    /// The picture file: .png, .jpg, .exr or .hdr.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Exposure of .png and .jpg [default: the parts'].
    #[arg(long, value_name = "STOPS", value_parser = exposure, allow_hyphen_values = true)]
    exposure: Option<f32>,
    /// Tone: clamp, reinhard, aces [default: the parts'].
    #[arg(long, value_name = "OPERATOR", value_parser = choice::<Operator>(), hide_possible_values = true)]
    tone: Option<Operator>,
    /// Denoise (softens sharp shadows); the raw film is FILE.raw.exr.
    #[arg(long)]
    denoise: bool,
    /// Print the report as JSON (schema octray-merge-1).
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    scene: String,
    output: String,
    parts: usize,
    width: u32,
    height: u32,
    samples: u32,
    rays: u64,
    discarded_samples: u64,
    /// Path of the raw film, if the picture is denoised.
    raw: Option<PathBuf>,
}

pub fn run(options: Options) -> Result<ExitCode, CliError> {
    Format::from_path(&options.output)?;
    output::check(&options.output, Existing::Replace)?;
    let raw = options.denoise.then(|| denoise::raw_file(&options.output));
    raw.iter().try_for_each(|file| output::check(file, Existing::Replace))?;
    let raw_output = raw.iter().map(|file| ("--denoise", file.as_path()));
    keep_inputs(&options.parts, std::iter::once(("--output", options.output.as_path())).chain(raw_output))?;
    let parts = Parts::open(&options.parts)?;
    let header = parts.header().clone();
    let settings = &header.identity.settings;
    memory::check_film(settings.resolution, settings.target.is_some(), options.denoise)?;
    let (film, guides) = parts.film(options.denoise)?;
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
        raw: raw.clone(),
    };
    let shown = header.display;
    let tone = Tone {
        exposure: options.exposure.unwrap_or(shown.exposure),
        operator: options.tone.unwrap_or(shown.operator),
    };
    denoise::save(&options.output, raw.as_deref(), film, guides.as_ref(), &tone)?;
    let out = Printer { json: options.json };
    let (samples, parts) = (grouped(report.samples), counted(report.parts, "part", "parts"));
    let denoised = raw.map_or(String::new(), |raw| denoise::line(&raw));
    out.text(&format!("{}: {width}×{height}, {samples} samples, from {parts}\n{denoised}", report.output))?;
    out.end(&report, false)
}
