//! `octray render`: stills, and parts of them.

use super::checkpoint::CheckpointWriter;
use super::error::{CliError, INTERRUPTED, refuse};
use super::jobs::{Job, RenderOptions, jobs, keep_files, numbered, refuse_shard};
use super::limits::Limits;
use super::outputs::is_same;
use super::progress::Progress;
use super::terminal::{self, Printer};
use super::trace::{Traced, trace};
use super::{denoise, interrupt, memory, scenes};
use crate::adaptive::ErrorEstimate;
use crate::camera::Tile;
use crate::checkpoint::{self, Header, Identity, Shard};
use crate::diagnosis;
use crate::film::Film;
use crate::integrate::edge_aovs::DenoiserAovs;
use crate::measure::stats::FrameStats;
use crate::methods;
use crate::output::{self, Format, OutputError};
use crate::render::{Renderer, Settings};
use crate::report::numbers::mrays_per_s;
use crate::report::render::{End, Report};
use crate::report::settings::RunSettings;
use crate::report::stats;
use crate::sampling::random::mix_bits;
use crate::scene::{Camera, Loaded, Scene, srgb_to_linear};
use crate::tone::Tone;
use crate::wording::counted;
use std::path::Path;
use std::process::ExitCode;

pub fn run(options: RenderOptions) -> Result<ExitCode, CliError> {
    // Outputs are checked before hours of rendering.
    let jobs = jobs(&options)?;
    let scene = scenes::load_with_warnings(&options.scene, false)?;
    keep_files(&jobs, &scene.files)?;
    let cameras = cameras(&options, &jobs, &scene)?;
    let limits = options.limits.limits(scenes::of_view(&scene).samples)?;
    // Only options cause the warning: those of a view are for files of any format.
    let is_displayed = options.picture.exposure.is_some() || options.picture.tone.is_some();
    if Format::from_path(&options.output).is_ok_and(Format::is_linear) && is_displayed {
        terminal::warn(&format!(
            "--exposure and --tone have no effect on {}: it holds the linear radiance.",
            options.output.display()
        ));
    }

    let (settings, tone) = (options.picture.settings(&scene), options.picture.tone(&scene));
    let (run_settings, differing) = options.picture.run_settings(&scene);
    let with_aovs = options.denoise || options.aovs.is_some();
    memory::check_film(settings.resolution, limits.target.is_some(), with_aovs)?;
    let tiles = Tile::cover(settings.resolution, settings.tile_size).count();
    if let Some(shard) = jobs[0].shard.filter(|shard| shard.count as usize > tiles) {
        let tiles = counted(tiles, "tile", "tiles");
        return Err(refuse_shard(shard, format!("the picture has {tiles}: give at most as many parts")));
    }
    let renderer = methods::renderer(&scene, settings);
    interrupt::listen();
    let rendering = Rendering { options, limits, settings, tone, run_settings, differing };
    let mut prepared = Some((scene.scene, renderer));
    let last = jobs.len() - 1;
    for (index, (job, camera)) in jobs.into_iter().zip(cameras).enumerate() {
        if let (Some((scene, renderer)), Some(frame)) = (&mut prepared, job.frame) {
            scene.camera = camera;
            renderer.set_view(&camera, settings.resolution, settings.max_bounces);
            // Each frame has noise of its own, and frame 0 that of a still.
            renderer.set_seed(settings.seed.wrapping_add(mix_bits(frame)));
        }
        interrupt::begin();
        let code = rendering.run(&job, &mut prepared, [index == 0, index == last])?;
        if code != ExitCode::SUCCESS {
            return Ok(code);
        }
        // Ctrl-C may have come while the files of this frame were written.
        if index < last && interrupt::requested() {
            return Ok(ExitCode::from(INTERRUPTED));
        }
        interrupt::release();
    }
    Ok(ExitCode::SUCCESS)
}

/// Returns the camera of each job: the scene's, or that of its frame. All are checked before the first is
/// rendered.
fn cameras(options: &RenderOptions, jobs: &[Job], scene: &Loaded) -> Result<Vec<Camera>, CliError> {
    let path = scene.view.as_ref().map(|view| &view.path);
    let keyed = path.and_then(|path| Some((path, path.frames()?)));
    let Some(frames) = options.frames.clone() else {
        if let Some((_, [begin, end])) = keyed {
            let (output, add) = (&options.output, format!("--frames {begin}..{end}"));
            if numbered(output, begin).is_some() {
                let instead = format!("# is the number of a frame: add {add}, or give a name without #");
                return Err(refuse("--output", output.display(), instead));
            }
            terminal::note(&format!("the view's own camera is used: add {add} to render its keyframes"));
        }
        return Ok(vec![scene.camera]);
    };
    let refuse = |why: String| refuse("--frames", format!("{}..{}", frames.start(), frames.end()), why);
    let Some((path, [begin, end])) = keyed else {
        let why = format!("`{}` has no keyframes: add `keyframes` to a view of the scene", scene.name);
        return Err(refuse(why));
    };
    let camera = |frame| {
        let outside = || refuse(format!("the keyframes of `{}` go from {begin} to {end}", scene.name));
        let camera = path.camera_at(frame).ok_or_else(outside)?;
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
    // Checks the frames of other shards too, so that a fault shows wherever it is.
    frames.clone().try_for_each(|frame| camera(frame).map(drop))?;
    jobs.iter().filter_map(|job| job.frame).map(camera).collect()
}

/// The settings that all jobs share.
struct Rendering {
    options: RenderOptions,
    limits: Limits,
    settings: Settings,
    tone: Tone,
    run_settings: RunSettings,
    /// The options that differ from the defaults.
    differing: String,
}

impl Rendering {
    /// Renders a film, writes its files and prints its report; of the `first` one, prints warnings. Drops
    /// what is prepared after the `last` one.
    fn run(
        &self,
        job: &Job,
        prepared: &mut Option<(Scene, Renderer)>,
        [first, last]: [bool; 2],
    ) -> Result<ExitCode, CliError> {
        let Self { options, limits, .. } = self;
        let (scene, renderer) = prepared.as_mut().expect("kept until the last job");
        if options.stats {
            renderer.start_stats();
        }
        let mut film = if limits.target.is_some() { renderer.film_with_noise() } else { renderer.film() };
        film.keep_tiles(|number| job.shard.is_none_or(|shard| shard.contains(number)));
        let is_kept = job.shard.is_some() || job.checkpoint.is_some();
        let header = is_kept.then(|| self.header(job, scene, renderer));
        let mut writer = match (&job.checkpoint, header.clone()) {
            (Some(file), Some(header)) => {
                Some(CheckpointWriter::resume(file, header, options.checkpoint_interval, &mut film)?)
            }
            _ => None,
        };
        let kept_rows = match job.shard.filter(|_| options.denoise) {
            Some(shard) => denoise::rows_of_shard(&renderer.aovs().1, shard),
            None => Vec::new(),
        };
        if let Some(writer) = &mut writer {
            writer.guides.clone_from(&kept_rows);
        }
        if film.pixel_samples() > 0 {
            interrupt::set_begun();
        }
        let progress = Progress::new(film.pixels(), film.pixel_samples(), limits.time);
        let traced = trace(renderer, &mut film, limits, writer.as_mut(), &progress);
        progress.writing(&job.output);
        let report = self.report(job, &film, &traced, scene, renderer);
        let tone =
            Format::from_path(&job.output).is_ok_and(|format| !format.is_linear()).then_some(self.tone);
        let is_judged = first && job.shard.is_none() && traced.end != End::Interrupt;
        let odd = if is_judged { diagnosis::warnings(renderer, scene, &film, tone) } else { Vec::new() };
        let begun = film.pixels_begun() as f64 / film.pixels() as f64;
        interrupt::hold();
        let seen = (report.denoised || job.aovs.is_some()).then(|| renderer.aovs());
        let aovs = match (&job.aovs, &seen) {
            (Some(file), Some(seen)) => {
                output::save_channels(file, film.resolution(), renderer.channels(scene, &film, seen))
            }
            _ => Ok(()),
        };
        let guides = seen.filter(|_| report.denoised).map(|(_, guides)| guides);
        if last {
            // Frees memory for the encoder.
            *prepared = None;
        }
        let complete = matches!(traced.end, End::Samples | End::TargetError);
        let kept = writer.map_or(Ok(()), |mut writer| writer.finish(&film, &traced.goals, complete));
        let saved = match header.filter(|_| job.shard.is_some()) {
            None => self.save_picture(job, film, guides.as_ref()),
            // The output is the checkpoint, which is written.
            Some(_) if job.checkpoint.as_ref().is_some_and(|file| is_same(file, &job.output)) => Ok(()),
            Some(header) => {
                let header = Header { complete, ..header };
                checkpoint::save(&job.output, &header, &film, &traced.goals, &kept_rows, &interrupt::insisted)
            }
        };
        progress.bar.finish_and_clear();
        if (saved.is_err() || kept.is_err()) && interrupt::insisted() {
            return Ok(ExitCode::from(INTERRUPTED));
        }
        saved?;
        if job.raw.is_some() && !report.denoised {
            terminal::warn("the picture is not denoised: some of its pixels have no sample.");
        }
        odd.iter().for_each(|odd| terminal::warn(&format!("{odd}.")));
        self.tell(&report, begun)?;
        // The picture is written; without a checkpoint, no later run can continue it.
        aovs.and(kept)?;
        Ok(if report.interrupted { ExitCode::from(INTERRUPTED) } else { ExitCode::SUCCESS })
    }

    /// Returns the header of this film's checkpoints.
    fn header(&self, job: &Job, scene: &Scene, renderer: &Renderer) -> Header {
        Header {
            name: scene.name.clone(),
            identity: Identity::new(
                scene,
                renderer.settings(),
                self.limits.target.as_ref(),
                job.shard.unwrap_or(Shard::WHOLE),
            ),
            display: self.tone,
            wanted: self.limits.samples,
            complete: false,
            rays: 0,
            tiles: 0,
            guides: 0,
        }
    }

    fn save_picture(&self, job: &Job, film: Film, guides: Option<&DenoiserAovs>) -> Result<(), OutputError> {
        if let Some(file) = &job.samples_map {
            save_samples_map(file, &film)?;
        }
        denoise::save(&job.output, job.raw.as_deref(), film, guides, &self.tone)
    }

    fn tell(&self, report: &Report, begun: f64) -> Result<(), CliError> {
        if report.discarded_samples > 0 {
            terminal::warn(&format!(
                "{} not finite and left out; this is a bug in octray: please report it with the scene.",
                counted(report.discarded_samples, "sample was", "samples were")
            ));
        }
        let out = Printer { json: self.options.json };
        out.text(&report.line(self.limits.samples, begun, &self.differing))?;
        let raw = report.raw.as_deref().filter(|_| report.denoised);
        out.text(&raw.map(denoise::line).unwrap_or_default())?;
        if let Some(taken) = &report.stats {
            out.text(&(stats::frames("stage", &[taken]) + &stats::meaning_of_frames()))?;
        }
        out.end(report, false).map(drop)
    }

    fn report(&self, job: &Job, film: &Film, traced: &Traced, scene: &Scene, renderer: &Renderer) -> Report {
        let Self { options, limits, settings, .. } = self;
        let [width, height] = settings.resolution;
        let target = &limits.target;
        let frames = (film.mean_samples() - traced.resumed_samples).round().max(1.0) as u32;
        let stats = || FrameStats::of(&renderer.take_stats(), settings.lanes, settings.threads, frames);
        Report {
            schema: "octray-render-1",
            scene: options.scene.to_string_lossy().into_owned(),
            frame: job.frame,
            shard: job.shard.map(|Shard { number, count }| [number, count]),
            output: job.output.display().to_string(),
            raw: job.raw.clone(),
            // Pixels without a sample are black, and would darken their neighbours.
            denoised: job.raw.is_some() && film.pixels_begun() == film.pixels(),
            width,
            height,
            samples: film.samples(),
            most_samples: film.most_samples(),
            mean_samples: film.mean_samples(),
            resumed_samples: Some(traced.resumed_samples).filter(|&samples| samples > 0.0),
            ended_by: traced.end,
            time_limit: limits.time.map(|time| time.as_secs_f64()),
            target_error: target.map(|target| target.error),
            estimated_error: target.map(|_| ErrorEstimate::of(film)),
            max_bounces: settings.max_bounces,
            seed: renderer.settings().seed,
            traversal: settings.methods.traversal_name(scene, settings.lanes),
            settings: self.run_settings.clone(),
            clamp: Some(settings.clamp).filter(|clamp| clamp.is_finite()),
            seconds: traced.time.as_secs_f64(),
            rays: film.rays(),
            mrays_per_s: mrays_per_s(traced.rays, traced.time),
            discarded_samples: film.discarded(),
            interrupted: traced.end == End::Interrupt,
            stats: options.stats.then(stats),
        }
    }
}

/// Writes a picture of the number of samples of each pixel; fails and leaves no file after a second Ctrl-C.
/// Formats for display get shades: equal factors are equal steps to the eye, from black for 0 and 1 to white
/// for the most.
fn save_samples_map(file: &Path, film: &Film) -> Result<(), OutputError> {
    let mut counts = film.counts();
    if !Format::from_path(file)?.is_linear() {
        let whole = f64::from(film.most_samples().max(2)).ln();
        for pixel in &mut counts.pixels {
            let shown = f64::from(pixel[0].max(1.0)).ln() / whole;
            *pixel = [srgb_to_linear(shown) as f32; 3];
        }
    }
    output::save_unless(file, &counts, (&Tone::default(), ""), &interrupt::insisted)
}
