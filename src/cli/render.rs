//! `octray render`: a still.

use super::INTERRUPTED;
use super::asked::Asked;
use super::error::CliError;
use super::interrupt::Interrupt;
use super::limits::Limits;
use super::memory;
use super::options::RenderOptions;
use super::picture::PictureOptions;
use super::progress::{Progress, mrays_per_s};
use super::samples_map;
use super::scenes;
use super::stats;
use super::terminal::{self, figure};
use super::trace::{End, trace};
use crate::adaptive::{ErrorEstimate, MAX_BLOCK_ERROR};
use crate::film::Film;
use crate::film::noise::Noise;
use crate::measure::stats::FrameStats;
use crate::output::{self, Existing, Format};
use crate::render::{Renderer, Settings};
use crate::scene::Scene;
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::process::ExitCode;
use std::time::Duration;

/// What was done; the JSON report.
#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    scene: String,
    output: String,
    width: u32,
    height: u32,
    /// Samples that every pixel has had, and the most that one has had: more only with a target, or where the end came in the middle of one.
    samples: u32,
    most_samples: u32,
    mean_samples: f64,
    ended_by: End,
    time_limit: Option<f64>,
    target_error: Option<f64>,
    /// With a target; null in them is "unknown".
    estimated_error: Option<EstimatedError>,
    max_bounces: u32,
    seed: u32,
    /// The most that a sample could bring to a channel: then the picture is biased. Null without a limit.
    clamp: Option<f32>,
    /// Wall time of the tracing alone.
    seconds: f64,
    rays: u64,
    mrays_per_s: f64,
    discarded_samples: u64,
    interrupted: bool,
    /// With `--stats`.
    #[serde(skip_serializing_if = "Option::is_none")]
    stats: Option<FrameStats>,
}

/// What [`crate::adaptive`] says of the picture.
#[derive(Clone, Copy, Debug, Serialize)]
struct EstimatedError {
    rms: f64,
    largest: f64,
}

/// Runs the command.
pub fn run(options: RenderOptions) -> Result<ExitCode, CliError> {
    // What can be known to fail fails before hours of rendering.
    let format = Format::of(&options.output)?;
    output::check(&options.output, Existing::Replace)?;
    samples_map::check(&options)?;
    let scene = scenes::load(&options.scene)?;
    let asked = options.picture.asked.or(Asked::of(&scene)?);
    let limits = asked.limits.unwrap_or_default();
    for warning in &scene.warnings {
        terminal::warn(warning);
    }
    // Of the options alone: a view says it for all formats at once.
    let Asked { exposure, tone, .. } = options.picture.asked;
    if format.is_linear() && (exposure.is_some() || tone.is_some()) {
        terminal::warn(&format!(
            "--exposure and --tone have no effect on {}: it holds the linear radiance.",
            options.output.display()
        ));
    }

    let settings = settings(&scene, &options.picture, &asked);
    let adaptive = limits.target.is_some();
    let noise = if adaptive { Noise::BYTES_PER_PIXEL } else { 0 };
    memory::check(settings.resolution, Film::BYTES_PER_PIXEL + noise)?;
    let renderer = Renderer::new(&scene, settings);
    if options.stats {
        renderer.start_stats();
    }
    let interrupt = Interrupt::listen();
    let mut film = if adaptive { renderer.film_with_noise() } else { renderer.film() };
    let progress = Progress::new(settings.resolution, limits.time);
    let (time, end) = trace(&renderer, &mut film, &limits, &interrupt, &progress);
    progress.writing(&options.output);
    let (mut report, begun) =
        (Report::of(&options, &limits, &settings, &film, time, end), film.pixels_begun());
    let frames = report.mean_samples.round() as u32;
    report.stats = options
        .stats
        .then(|| FrameStats::of(&renderer.take_stats(), settings.lanes, settings.threads, frames));
    interrupt.hold();
    if let Some(file) = &options.samples_map
        && let Err(error) = samples_map::save(file, &film, &|| interrupt.insisted())
    {
        progress.end();
        return if interrupt.insisted() { Ok(ExitCode::from(INTERRUPTED)) } else { Err(error) };
    }
    let picture = film.picture();
    // Encoders need memory of their own: in place of the film's and the scene's.
    drop((film, renderer, scene));
    let saved = output::save_unless(&options.output, &picture, &asked.shown(), &|| interrupt.insisted());
    progress.end();
    if saved.is_err() && interrupt.insisted() {
        return Ok(ExitCode::from(INTERRUPTED));
    }
    saved?;

    if report.discarded_samples > 0 {
        terminal::warn(&format!(
            "{} no finite numbers and left out; this is a bug in octray: please report it with the scene.",
            counted(report.discarded_samples, "sample was", "samples were")
        ));
    }
    if options.json {
        terminal::print_json(&report)?;
    } else {
        terminal::print(&report.line(limits.samples, begun))?;
        if let Some(taken) = &report.stats {
            terminal::print(&stats::frames("stage", &[taken]))?;
            terminal::print(&stats::meaning_of_frames())?;
        }
    }
    Ok(if report.interrupted { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
}

fn settings(scene: &Scene, options: &PictureOptions, asked: &Asked) -> Settings {
    let scenes_own = Settings::of(scene);
    Settings {
        resolution: options.size.unwrap_or(scene.resolution),
        max_bounces: options.bounces.unwrap_or(scene.max_bounces),
        seed: asked.seed.unwrap_or(scenes_own.seed),
        methods: asked.methods.of(scene),
        pipeline: asked.pipeline.unwrap_or(scenes_own.pipeline),
        lanes: options.lanes,
        threads: options.threads,
        clamp: asked.clamp.unwrap_or(scenes_own.clamp),
        ..scenes_own
    }
}

impl Report {
    fn of(
        options: &RenderOptions,
        limits: &Limits,
        settings: &Settings,
        film: &Film,
        time: Duration,
        end: End,
    ) -> Self {
        let [width, height] = settings.resolution;
        let target = &limits.target;
        let estimated = target.map(|_| {
            let ErrorEstimate { rms, largest } = ErrorEstimate::of(film);
            EstimatedError { rms, largest }
        });
        Self {
            schema: "octray-render-1",
            scene: options.scene.clone(),
            output: options.output.display().to_string(),
            width,
            height,
            samples: film.samples(),
            most_samples: film.most_samples(),
            mean_samples: film.mean_samples(),
            ended_by: end,
            time_limit: limits.time.map(|time| time.as_secs_f64()),
            target_error: target.map(|target| target.error),
            estimated_error: estimated,
            max_bounces: settings.max_bounces,
            seed: settings.seed,
            clamp: Some(settings.clamp).filter(|clamp| clamp.is_finite()),
            seconds: time.as_secs_f64(),
            rays: film.rays(),
            mrays_per_s: mrays_per_s(film.rays(), time),
            discarded_samples: film.discarded(),
            interrupted: end == End::Interrupt,
            stats: None,
        }
    }

    /// The line for people; so many samples were asked for, and so many pixels have had one.
    fn line(&self, wanted: u32, begun: u64) -> String {
        let Self { output, width, height, samples, most_samples, seconds, mrays_per_s, .. } = self;
        let had = if samples == most_samples {
            grouped(samples)
        } else {
            format!("{} to {}", grouped(samples), grouped(most_samples))
        };
        let of_wanted = if self.interrupted { format!(" of {}", grouped(wanted)) } else { String::new() };
        let rate = figure(*mrays_per_s, 1);
        let plural = if had == "1" && !self.interrupted { "" } else { "s" };
        let mean = match samples == most_samples {
            true => String::new(),
            false => format!(" (mean {})", figure(self.mean_samples, 0)),
        };
        let black = 1.0 - begun as f64 / (f64::from(*width) * f64::from(*height));
        let black = match black > 0.0 {
            true => format!("; {:.0} % of the picture has had none and is black", 100.0 * black),
            false => String::new(),
        };
        format!(
            "{output}: {width}×{height}, {had}{of_wanted} sample{plural}{mean}, {seconds:.2} s, {rate} Mray/s{black}\n{}",
            self.ending()
        )
    }

    /// What ended it, where more than the number of samples could have, and the error reached.
    fn ending(&self) -> String {
        if self.target_error.is_none() && self.time_limit.is_none() {
            return String::new();
        }
        let by = match self.ended_by {
            End::Samples => "the limit of samples",
            End::TargetError => "the target error",
            End::TimeLimit => "the time limit",
            End::Interrupt => "Ctrl-C",
        };
        let errors = match (&self.estimated_error, self.target_error) {
            (Some(error), Some(target)) if error.rms.is_finite() => {
                let [rms, largest] = [error.rms, error.largest].map(|error| figure(error, 1));
                let worst = MAX_BLOCK_ERROR * target;
                format!(
                    "; estimated error {rms} ({target} asked for), in the worst block {largest} ({worst})"
                )
            }
            (Some(_), _) => "; too few samples to estimate the error".to_string(),
            _ => String::new(),
        };
        format!("ended by {by}{errors}\n")
    }
}
