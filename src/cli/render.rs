//! `octray render`: a still.

use super::INTERRUPTED;
use super::error::CliError;
use super::interrupt::Interrupt;
use super::memory;
use super::options::RenderOptions;
use super::progress::{Progress, mrays_per_s};
use super::stats;
use super::terminal::{self, figure};
use crate::film::Film;
use crate::measure::stats::FrameStats;
use crate::output::{self, Existing, Format};
use crate::render::{Renderer, Settings, Watch};
use crate::scene::{self, Scene};
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// How long a chunk of samples should take: short enough for Ctrl-C to feel immediate, long enough that starting and ending it costs
/// nothing.
const CHUNK: Duration = Duration::from_millis(100);
/// How long a chunk may take to end by itself after Ctrl-C, so that every pixel has the same number of samples; one that takes longer
/// stops between tiles.
const GRACE: Duration = Duration::from_millis(300);

/// What was done; the JSON report.
#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    scene: String,
    output: String,
    width: u32,
    height: u32,
    /// Samples that every pixel has had, and the most that one has had: more only where Ctrl-C came in the middle of one.
    samples: u32,
    most_samples: u32,
    max_bounces: u32,
    seed: u32,
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
    memory::check(settings.resolution, Film::BYTES_PER_PIXEL)?;
    let renderer = Renderer::new(&scene, settings);
    if options.stats {
        renderer.start_stats();
    }
    let interrupt = Interrupt::listen();
    let mut film = renderer.film();
    let progress = Progress::new(settings.resolution, options.samples);
    let time = trace(&renderer, &mut film, options.samples, &interrupt, &progress);
    progress.writing(&options.output);
    let (mut report, begun) = (Report::of(&options, &settings, &film, time), film.pixels_begun());
    report.stats = options
        .stats
        .then(|| FrameStats::of(&renderer.take_stats(), settings.lanes, settings.threads, film.samples()));
    let picture = film.picture();
    // Encoders need memory of their own: in place of the film's and the scene's.
    drop((film, renderer, scene));
    interrupt.hold();
    let saved = output::save_unless(&options.output, &picture, &options.tone, &|| interrupt.insisted());
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
        terminal::print(&report.line(options.samples, begun))?;
        if let Some(taken) = &report.stats {
            terminal::print(&stats::frames("stage", &[taken]))?;
            terminal::print(&stats::meaning_of_frames())?;
        }
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

/// Adds samples in chunks until there are enough or the user has asked for an end; says how long it took.
fn trace(
    renderer: &Renderer,
    film: &mut Film,
    samples: u32,
    interrupt: &Interrupt,
    progress: &Progress,
) -> Duration {
    let mut chunk = 1;
    let start = Instant::now();
    while film.samples() < samples && !interrupt.asked() {
        let watched = Chunk { began: Instant::now(), interrupt, progress };
        renderer.add_samples_watched(film, chunk, &watched);
        chunk = next_chunk(chunk, watched.began.elapsed()).min(samples - film.samples());
    }
    start.elapsed()
}

/// A chunk under way: tells the progress, hears the interruption.
struct Chunk<'a> {
    began: Instant,
    interrupt: &'a Interrupt,
    progress: &'a Progress,
}

impl Watch for Chunk<'_> {
    fn stop(&self) -> bool {
        self.interrupt.asked() && self.began.elapsed() >= GRACE
    }
    fn done(&self, pixels: usize, rays: u64) {
        self.interrupt.begun();
        self.progress.add(pixels, rays);
    }
}

/// How many samples to trace next, given how long the last ones took: as many as should take [`CHUNK`], but not more than
/// four times as many as before, because a short time measures poorly.
fn next_chunk(last: u32, took: Duration) -> u32 {
    let fitting = f64::from(last) * CHUNK.as_secs_f64() / took.as_secs_f64().max(1e-9);
    (fitting as u32).clamp(1, last.saturating_mul(4))
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
            most_samples: film.most_samples(),
            max_bounces: settings.max_bounces,
            seed: settings.seed,
            seconds: time.as_secs_f64(),
            rays: film.rays(),
            mrays_per_s: mrays_per_s(film.rays(), time),
            discarded_samples: film.discarded(),
            interrupted: film.samples() < options.samples,
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
        let plural = if *samples == 1 && !self.interrupted { "" } else { "s" };
        let black = 1.0 - begun as f64 / (f64::from(*width) * f64::from(*height));
        let black = match black > 0.0 {
            true => format!("; {:.0} % of the picture has had none and is black", 100.0 * black),
            false => String::new(),
        };
        format!(
            "{output}: {width}×{height}, {had}{of_wanted} sample{plural}, {seconds:.2} s, {rate} Mray/s{black}\n"
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
            let (mut film, progress) = (renderer.film(), Progress::new(settings.resolution, samples));
            trace(&renderer, &mut film, samples, &Interrupt::default(), &progress);
            assert_eq!((film.samples(), film.most_samples()), (samples, samples));
        }
    }
}
