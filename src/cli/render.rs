//! `octray render`: stills, and parts of them.

use super::checkpoint::CheckpointWriter;
use super::error::{CliError, INTERRUPTED, refuse};
use super::interrupt::Interrupt;
use super::jobs::{Job, RenderOptions, is_same, jobs, refuse_shard};
use super::limits::Limits;
use super::memory;
use super::picture::of_view;
use super::progress::Progress;
use super::samples_map;
use super::scenes;
use super::terminal::{self, Printer};
use super::trace::{Traced, Watch, trace};
use crate::adaptive::ErrorEstimate;
use crate::camera::Tile;
use crate::checkpoint::{self, Header, Identity, Shard};
use crate::film::Film;
use crate::measure::stats::FrameStats;
use crate::output::{self, Format};
use crate::render::{Renderer, Settings};
use crate::report::numbers::mrays_per_s;
use crate::report::render::{End, EstimatedError, Report};
use crate::report::stats;
use crate::scene::{Camera, Loaded, Scene};
use crate::tone::Tone;
use crate::wording::counted;
use std::process::ExitCode;

/// Runs the command.
pub fn run(options: RenderOptions) -> Result<ExitCode, CliError> {
    // Outputs are checked before hours of rendering.
    let jobs = jobs(&options)?;
    let scene = scenes::load_with_warnings(&options.scene)?;
    let cameras = cameras(&options, &jobs, &scene)?;
    let limits = options.limits.limits(of_view(&scene).samples)?;
    // Options alone get the warning: a view's are for files of any format.
    let is_displayed = options.picture.exposure.is_some() || options.picture.tone.is_some();
    if Format::of(&options.output).is_ok_and(Format::is_linear) && is_displayed {
        terminal::warn(&format!(
            "--exposure and --tone have no effect on {}: it holds the linear radiance.",
            options.output.display()
        ));
    }

    let (settings, tone) = (options.picture.settings(&scene), options.picture.tone(&scene));
    memory::check_film(settings.resolution, limits.target.is_some())?;
    check_shard(&jobs, &settings)?;
    let renderer = Renderer::new(&scene, settings);
    let interrupt = Interrupt::listen();
    let rendering = Rendering { options, limits, settings, tone, interrupt };
    let mut prepared = Some((scene.scene, renderer));
    let last = jobs.len() - 1;
    for (index, (job, camera)) in jobs.into_iter().zip(cameras).enumerate() {
        let (scene, renderer) = prepared.as_mut().expect("kept until the last job");
        if job.frame.is_some() {
            scene.camera = camera;
            renderer.set_view(scene, &camera, settings.resolution, settings.max_bounces);
        }
        rendering.interrupt.begin();
        let done = rendering.trace(&job, scene, renderer)?;
        if index == last {
            // Frees memory for the encoder.
            prepared = None;
        }
        let code = rendering.finish(&job, done)?;
        if code != ExitCode::SUCCESS {
            return Ok(code);
        }
        // While the files of this frame were written.
        if index < last && rendering.interrupt.requested() {
            return Ok(ExitCode::from(INTERRUPTED));
        }
        rendering.interrupt.release();
    }
    Ok(ExitCode::SUCCESS)
}

/// The camera of each job: the scene's, or that of its frame. All are checked before the first is rendered.
fn cameras(options: &RenderOptions, jobs: &[Job], scene: &Loaded) -> Result<Vec<Camera>, CliError> {
    let Some(frames) = options.frames.clone() else { return Ok(vec![scene.camera]) };
    let refuse = |why: String| refuse("--frames", format!("{}..{}", frames.start(), frames.end()), why);
    let path = scene.view.as_ref().map(|view| &view.path);
    let Some((path, [begin, end])) = path.and_then(|path| Some((path, path.frames()?))) else {
        let why = format!("`{}` has no keyframes: add `keyframes` to a view of the scene", scene.name);
        return Err(refuse(why));
    };
    let camera = |frame| {
        let outside = || refuse(format!("the keyframes of `{}` go from {begin} to {end}", scene.name));
        let camera = path.at(frame).ok_or_else(outside)?;
        match camera.fault() {
            None => Ok(camera),
            Some((key, what, _)) => {
                let mend = "move the keyframes around it, or add one";
                Err(refuse(format!(
                    "between keyframes, frame {frame} has an impossible `{key}` ({what}): {mend}"
                )))
            }
        }
    };
    // Frames of other shards too: a fault shows wherever it lies.
    frames.clone().try_for_each(|frame| camera(frame).map(drop))?;
    jobs.iter().filter_map(|job| job.frame).map(camera).collect()
}

/// Refuses shards without tiles.
fn check_shard(jobs: &[Job], settings: &Settings) -> Result<(), CliError> {
    let tiles = Tile::cover(settings.resolution, settings.tile_size).count();
    let Some(shard) = jobs.iter().filter_map(|job| job.shard).find(|shard| shard.of as usize > tiles) else {
        return Ok(());
    };
    let tiles = counted(tiles, "tile", "tiles");
    Err(refuse_shard(shard, format!("the picture has {tiles}: give at most as many parts")))
}

/// What all jobs share.
struct Rendering {
    options: RenderOptions,
    limits: Limits,
    settings: Settings,
    tone: Tone,
    interrupt: Interrupt,
}

/// A film at its end, and what is told of it.
struct Done {
    film: Film,
    /// For checkpoints and parts.
    header: Option<Header>,
    goals: Vec<u32>,
    writer: Option<CheckpointWriter>,
    report: Report,
    progress: Progress,
}

impl Rendering {
    /// Renders a film to its end.
    fn trace(&self, job: &Job, scene: &Scene, renderer: &Renderer) -> Result<Done, CliError> {
        let Self { options, limits, settings, interrupt, .. } = self;
        if options.stats {
            renderer.start_stats();
        }
        let mut film = if limits.target.is_some() { renderer.film_with_noise() } else { renderer.film() };
        film.keep_tiles(|number| job.shard.is_none_or(|shard| shard.has(number)));
        let mut header = (job.shard.is_some() || job.checkpoint.is_some()).then(|| self.header(job, scene));
        let (mut goals, mut writer) = (Vec::new(), None);
        if let (Some(file), Some(header)) = (&job.checkpoint, &header) {
            let (header, interval) = (header.clone(), options.checkpoint_interval);
            let resumed = CheckpointWriter::resume(file, header, interval, interrupt, &mut film)?;
            (writer, goals) = (Some(resumed.0), resumed.1);
        }
        if film.pixel_samples() > 0 {
            interrupt.set_begun();
        }
        let progress = Progress::new(film.pixels(), film.pixel_samples(), limits.time);
        let watch = Watch { interrupt, progress: &progress };
        let traced = trace(renderer, &mut film, limits, goals, writer.as_mut(), watch);
        progress.writing(&job.output);
        if let Some(header) = &mut header {
            header.complete = matches!(traced.end, End::Samples | End::TargetError);
        }
        let mut report = self.report(job, &film, &traced);
        let frames = (report.mean_samples - traced.resumed_samples).round().max(1.0) as u32;
        report.stats = options
            .stats
            .then(|| FrameStats::of(&renderer.take_stats(), settings.lanes, settings.threads, frames));
        Ok(Done { film, header, goals: traced.goals, writer, report, progress })
    }

    /// Writes the files of a film, and its report.
    fn finish(&self, job: &Job, done: Done) -> Result<ExitCode, CliError> {
        let Done { film, header, goals, writer, report, progress } = done;
        let begun = film.pixels_begun() as f64 / film.pixels() as f64;
        self.interrupt.hold();
        let complete = header.as_ref().is_some_and(|header| header.complete);
        let kept = writer.map_or(Ok(()), |mut writer| writer.finish(&film, &goals, complete));
        let saved = match header.filter(|_| job.shard.is_some()) {
            None => self.save_picture(job, film),
            // Where both are one file, it is written.
            Some(_) if job.checkpoint.as_ref().is_some_and(|file| is_same(file, &job.output)) => Ok(()),
            Some(header) => {
                let given_up = || self.interrupt.insisted();
                checkpoint::save(&job.output, &header, &film, &goals, &given_up).map_err(CliError::from)
            }
        };
        progress.bar.finish_and_clear();
        if (saved.is_err() || kept.is_err()) && self.interrupt.insisted() {
            return Ok(ExitCode::from(INTERRUPTED));
        }
        saved?;
        self.tell(&report, begun)?;
        // The picture is there; what cannot be is a later run that goes on from here.
        kept?;
        Ok(if report.interrupted { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
    }

    /// What checkpoints say of this film.
    fn header(&self, job: &Job, scene: &Scene) -> Header {
        let (target, shard) = (self.limits.target.as_ref(), job.shard.unwrap_or(Shard::WHOLE));
        Header {
            name: scene.name.clone(),
            identity: Identity::new(scene, &self.settings, target, shard),
            display: self.tone.into(),
            wanted: self.limits.samples,
            complete: false,
            rays: 0,
            tiles: 0,
        }
    }

    fn save_picture(&self, job: &Job, film: Film) -> Result<(), CliError> {
        let given_up = || self.interrupt.insisted();
        if let Some(file) = &job.samples_map {
            samples_map::save(file, &film, &given_up)?;
        }
        let picture = film.picture();
        // Frees memory for the encoder.
        drop(film);
        Ok(output::save_unless(&job.output, &picture, &self.tone, &given_up)?)
    }

    fn tell(&self, report: &Report, begun: f64) -> Result<(), CliError> {
        if report.discarded_samples > 0 {
            terminal::warn(&format!(
                "{} not finite and left out; this is a bug in octray: please report it with the scene.",
                counted(report.discarded_samples, "sample was", "samples were")
            ));
        }
        let out = Printer { json: self.options.json };
        out.text(&report.line(self.limits.samples, begun))?;
        if let Some(taken) = &report.stats {
            out.text(&(stats::frames("stage", &[taken]) + &stats::meaning_of_frames()))?;
        }
        out.report(report)
    }

    fn report(&self, job: &Job, film: &Film, traced: &Traced) -> Report {
        let Self { options, limits, settings, .. } = self;
        let [width, height] = settings.resolution;
        let target = &limits.target;
        let estimated = target.map(|_| {
            let ErrorEstimate { rms, largest } = ErrorEstimate::of(film);
            EstimatedError { rms, largest }
        });
        Report {
            schema: "octray-render-1",
            scene: options.scene.clone(),
            frame: job.frame,
            shard: job.shard.map(|Shard { number, of }| [number, of]),
            output: job.output.display().to_string(),
            width,
            height,
            samples: film.samples(),
            most_samples: film.most_samples(),
            mean_samples: film.mean_samples(),
            resumed_samples: Some(traced.resumed_samples).filter(|&samples| samples > 0.0),
            ended_by: traced.end,
            time_limit: limits.time.map(|time| time.as_secs_f64()),
            target_error: target.map(|target| target.error),
            estimated_error: estimated,
            max_bounces: settings.max_bounces,
            seed: settings.seed,
            clamp: Some(settings.clamp).filter(|clamp| clamp.is_finite()),
            seconds: traced.time.as_secs_f64(),
            rays: film.rays(),
            mrays_per_s: mrays_per_s(traced.rays, traced.time),
            discarded_samples: film.discarded(),
            interrupted: traced.end == End::Interrupt,
            stats: None,
        }
    }
}
