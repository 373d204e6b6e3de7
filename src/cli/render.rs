//! `octray render`: a still.

use super::INTERRUPTED;
use super::error::CliError;
use super::interrupt::Interrupt;
use super::options::RenderOptions;
use super::terminal::{self, figure};
use crate::film::Film;
use crate::output::{self, Existing, Format};
use crate::render::{Renderer, Settings};
use crate::scene::{self, Scene};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// How long a chunk of samples should take: short enough for Ctrl-C and the progress bar to feel immediate, long enough
/// that starting and ending it costs nothing.
const CHUNK: Duration = Duration::from_millis(100);

/// What was done; the JSON report.
#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    scene: String,
    output: String,
    width: u32,
    height: u32,
    samples: u32,
    max_bounces: u32,
    seed: u32,
    /// Wall time of the tracing alone.
    seconds: f64,
    rays: u64,
    mrays_per_s: f64,
    discarded_samples: u64,
    interrupted: bool,
}

/// Runs the command.
pub fn run(options: RenderOptions) -> Result<ExitCode, CliError> {
    // What can be known to fail fails before hours of rendering.
    let format = Format::of(&options.output)?;
    output::check(&options.output, Existing::Replace)?;
    let scene = scene::load(&options.scene)?;
    for warning in &scene.warnings {
        terminal::warn(warning);
    }
    if format.is_linear() && options.tone_asked {
        terminal::warn(&format!(
            "--exposure and --tone have no effect on {}: it holds the linear radiance.",
            options.output.display()
        ));
    }

    let settings = settings(&scene, &options);
    let renderer = Renderer::new(&scene, settings);
    let interrupt = Interrupt::listen();
    let (film, time) = trace(&renderer, options.samples, &interrupt);
    interrupt.hold();
    output::save(&options.output, &film.picture(), &options.tone)?;

    let report = Report::of(&options, &settings, &film, time);
    if report.discarded_samples > 0 {
        terminal::warn(&format!(
            "{} samples were not finite numbers and were left out; this is a bug in octray: please report it with the \
             scene.",
            report.discarded_samples
        ));
    }
    if options.json {
        terminal::print_json(&report)?;
    } else {
        terminal::print(&report.line(options.samples))?;
    }
    Ok(if report.interrupted { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
}

fn settings(scene: &Scene, options: &RenderOptions) -> Settings {
    Settings {
        resolution: options.size.unwrap_or(scene.resolution),
        max_bounces: options.bounces.unwrap_or(scene.max_bounces),
        seed: options.seed,
        methods: options.methods,
        pipeline: options.pipeline,
        lanes: options.lanes,
        threads: options.threads,
        ..Settings::of(scene)
    }
}

/// Adds samples in chunks until there are enough or the user has asked for an end; at least one chunk. Also says how long
/// it took.
fn trace(renderer: &Renderer, samples: u32, interrupt: &Interrupt) -> (Film, Duration) {
    let progress = Progress::new(samples);
    let mut film = renderer.film();
    let mut chunk = 1;
    let start = Instant::now();
    while film.samples() < samples {
        let began = Instant::now();
        renderer.add_samples(&mut film, chunk);
        progress.show(&film, start.elapsed());
        if interrupt.asked() {
            break;
        }
        chunk = next_chunk(chunk, began.elapsed()).min(samples - film.samples());
    }
    let time = start.elapsed();
    progress.end();
    (film, time)
}

/// How many samples to trace next, given how long the last ones took: as many as should take [`CHUNK`], but not more than
/// four times as many as before, because a short time measures poorly.
fn next_chunk(last: u32, took: Duration) -> u32 {
    let fitting = f64::from(last) * CHUNK.as_secs_f64() / took.as_secs_f64().max(1e-9);
    (fitting as u32).clamp(1, last.saturating_mul(4))
}

/// The bar on standard error; there is none where standard error is not a terminal.
struct Progress(ProgressBar);

impl Progress {
    fn new(samples: u32) -> Self {
        let bar = ProgressBar::with_draw_target(Some(samples.into()), ProgressDrawTarget::stderr_with_hz(10));
        let template = "{wide_bar} {pos}/{len} samples  {msg}  {eta} left";
        bar.set_style(
            ProgressStyle::with_template(template).unwrap_or_else(|_| ProgressStyle::default_bar()),
        );
        bar.set_message("starting");
        Self(bar)
    }

    fn show(&self, film: &Film, time: Duration) {
        if !self.0.is_hidden() {
            self.0.set_message(format!("{} Mray/s", figure(mrays_per_s(film.rays(), time), 1)));
        }
        self.0.set_position(film.samples().into());
    }

    fn end(self) {
        self.0.finish_and_clear();
    }
}

fn mrays_per_s(rays: u64, time: Duration) -> f64 {
    rays as f64 / time.as_secs_f64().max(1e-9) / 1e6
}

impl Report {
    fn of(options: &RenderOptions, settings: &Settings, film: &Film, time: Duration) -> Self {
        let [width, height] = settings.resolution;
        Self {
            schema: "octray-render-1",
            scene: options.scene.clone(),
            output: options.output.display().to_string(),
            width,
            height,
            samples: film.samples(),
            max_bounces: settings.max_bounces,
            seed: settings.seed,
            seconds: time.as_secs_f64(),
            rays: film.rays(),
            mrays_per_s: mrays_per_s(film.rays(), time),
            discarded_samples: film.discarded(),
            interrupted: film.samples() < options.samples,
        }
    }

    /// The line for people.
    fn line(&self, wanted: u32) -> String {
        let Self { output, width, height, samples, seconds, mrays_per_s, .. } = self;
        let of_wanted = if self.interrupted { format!(" of {wanted}") } else { String::new() };
        let rate = figure(*mrays_per_s, 1);
        let plural = if *samples == 1 && !self.interrupted { "" } else { "s" };
        format!(
            "{output}: {width}×{height}, {samples}{of_wanted} sample{plural}, {seconds:.2} s, {rate} Mray/s\n"
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn next_chunk_aims_at_its_time_and_grows_slowly() {
        assert_eq!(next_chunk(10, CHUNK), 10);
        assert_eq!(next_chunk(10, CHUNK * 2), 5);
        assert_eq!(next_chunk(10, CHUNK / 2), 20);
        assert_eq!(next_chunk(10, CHUNK / 100), 40);
        assert_eq!(next_chunk(1, CHUNK * 100), 1);
        assert_eq!(next_chunk(10, Duration::ZERO), 40);
        assert_eq!(next_chunk(u32::MAX, Duration::ZERO), u32::MAX);
    }

    #[test]
    fn trace_adds_exactly_the_samples_asked_for() {
        let scene = scene::load("builtin:three").unwrap();
        for samples in [1, 2, 3, 7, 100] {
            let settings = Settings { resolution: [8, 8], max_bounces: 1, ..Settings::of(&scene) };
            let renderer = Renderer::new(&scene, settings);
            assert_eq!(trace(&renderer, samples, &Interrupt::default()).0.samples(), samples);
        }
    }
}
