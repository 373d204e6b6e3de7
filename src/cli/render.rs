//! `octray render`: a still.

use super::error::{CliError, INTERRUPTED};
use super::interrupt::Interrupt;
use super::limits::Limits;
use super::memory;
use super::options::RenderOptions;
use super::overrides::Overrides;
use super::picture::PictureOptions;
use super::progress::Progress;
use super::samples_map;
use super::scenes;
use super::terminal;
use super::trace::trace;
use crate::adaptive::ErrorEstimate;
use crate::film::Film;
use crate::film::noise::Noise;
use crate::measure::stats::FrameStats;
use crate::output::{self, Existing, Format};
use crate::render::{Renderer, Settings};
use crate::report::numbers::mrays_per_s;
use crate::report::render::{End, EstimatedError, Report};
use crate::report::stats;
use crate::scene::Scene;
use crate::wording::counted;
use std::process::ExitCode;
use std::time::Duration;

/// Runs the command.
pub fn run(options: RenderOptions) -> Result<ExitCode, CliError> {
    // Outputs are checked before hours of rendering.
    let format = Format::of(&options.output)?;
    output::check(&options.output, Existing::Replace)?;
    samples_map::check(&options)?;
    let scene = scenes::load_with_warnings(&options.scene)?;
    let overrides = options.picture.overrides.or(Overrides::of_view(&scene)?);
    let limits = overrides.limits.unwrap_or_default();
    // Options alone get the warning: a view's are for files of any format.
    let Overrides { exposure, tone, .. } = options.picture.overrides;
    if format.is_linear() && (exposure.is_some() || tone.is_some()) {
        terminal::warn(&format!(
            "--exposure and --tone have no effect on {}: it holds the linear radiance.",
            options.output.display()
        ));
    }

    let settings = settings(&scene, &options.picture, &overrides);
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
        (report_of(&options, &limits, &settings, &film, time, end), film.pixels_begun());
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
    // Frees memory for the encoder.
    drop((film, renderer, scene));
    let saved = output::save_unless(&options.output, &picture, &overrides.tone(), &|| interrupt.insisted());
    progress.end();
    if saved.is_err() && interrupt.insisted() {
        return Ok(ExitCode::from(INTERRUPTED));
    }
    saved?;

    if report.discarded_samples > 0 {
        terminal::warn(&format!(
            "{} not finite and left out; this is a bug in octray: please report it with the scene.",
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

fn settings(scene: &Scene, options: &PictureOptions, overrides: &Overrides) -> Settings {
    let default = Settings::of(scene);
    let methods = overrides.methods.of(scene);
    Settings {
        resolution: options.size.unwrap_or(scene.resolution),
        max_bounces: options.bounces.unwrap_or(scene.max_bounces),
        seed: overrides.seed.unwrap_or(default.seed),
        methods,
        pipeline: overrides.pipeline.unwrap_or(default.pipeline),
        lanes: options.lanes.lanes(scene, &methods),
        threads: options.threads,
        clamp: overrides.clamp.unwrap_or(default.clamp),
        ..default
    }
}

fn report_of(
    options: &RenderOptions,
    limits: &Limits,
    settings: &Settings,
    film: &Film,
    time: Duration,
    end: End,
) -> Report {
    let [width, height] = settings.resolution;
    let target = &limits.target;
    let estimated = target.map(|_| {
        let ErrorEstimate { rms, largest } = ErrorEstimate::of(film);
        EstimatedError { rms, largest }
    });
    Report {
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
