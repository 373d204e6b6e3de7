//! `octray view`: walks through scenes in a terminal or, with the feature `window`, in a window.
//!
//! For: [`ViewOptions`], [`run`].

use super::args::ViewArgs;
use super::error::CliError;
use super::memory;
use super::numbers::whole;
use super::overrides::Overrides;
use super::picture::PictureOptions;
use super::scenes;
use super::terminal;
use crate::machine::{self, Machine};
use crate::report::numbers::figure;
use crate::scene::Loaded;
use crate::viewer::playlist::Playlist;
use crate::viewer::{self, Options, Summary};
use crate::wording::counted;
use serde::Serialize;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// The validated options.
pub struct ViewOptions {
    scenes: Vec<String>,
    terminal: bool,
    json: bool,
    target: Option<u32>,
    frames: Option<u64>,
    screenshots: PathBuf,
    picture: PictureOptions,
}

/// What brings a window, in a sentence without its end.
const FOR_A_WINDOW: &str = if cfg!(feature = "window") {
    "without --terminal it opens a window; to write a picture into a file, use octray render"
} else {
    "for a window: cargo run --release --features window -- view; for a picture in a file: octray render"
};

#[cfg(feature = "window")]
fn in_window(viewer: Options, playlist: Playlist, first: Loaded) -> Result<Report, CliError> {
    let (summary, presented) = viewer::window(viewer, playlist, first)?;
    Ok(Report::of(&summary, Some((presented.frames, presented.time))))
}

#[cfg(not(feature = "window"))]
fn in_window(_: Options, _: Playlist, _: Loaded) -> Result<Report, CliError> {
    unreachable!("without windows it draws in the terminal")
}

/// Highest frame rate that can be a target.
const MOST_FPS: u32 = 1_000;

impl TryFrom<ViewArgs> for ViewOptions {
    type Error = CliError;
    fn try_from(args: ViewArgs) -> Result<Self, CliError> {
        let whole_of =
            |option, text: Option<String>, most| text.map(|text| whole(option, &text, 1, most)).transpose();
        Ok(Self {
            scenes: args.scenes,
            terminal: args.terminal,
            json: args.json,
            target: whole_of("--target-fps", args.target_fps, MOST_FPS)?,
            frames: whole_of("--frames", args.frames, u32::MAX)?.map(u64::from),
            screenshots: args.screenshots,
            picture: args.picture.try_into()?,
        })
    }
}

impl ViewOptions {
    /// The viewer's options. Seed, tone and pipeline are those of its first scene; methods are those of each
    /// scene.
    fn viewer(&self, first: &Loaded) -> Result<Options, CliError> {
        let PictureOptions { size, bounces, threads, lanes, overrides } = self.picture;
        let methods = overrides.methods;
        let overrides = overrides.or(Overrides::of_view(first)?);
        Ok(Options {
            size,
            bounces,
            seed: overrides.seed.unwrap_or(0),
            pipeline: overrides.pipeline.unwrap_or_default(),
            clamp: overrides.clamp.unwrap_or(f32::INFINITY),
            threads,
            max_threads: machine::cores().max(threads),
            lanes,
            tone: overrides.tone(),
            target: self.target,
            // A later view whose numbers are out of range keeps the defaults.
            methods: Box::new(move |scene| {
                methods.or(Overrides::of_view(scene).unwrap_or_default().methods).of(scene)
            }),
            fits: Box::new(|size| memory::room_for(size, viewer::BYTES_PER_PIXEL)),
            frames: self.frames,
            screenshots: self.screenshots.clone(),
        })
    }
}

/// The JSON report.
#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    machine: Machine,
    /// `window` or `terminal`.
    front_end: &'static str,
    /// Frames presented, in all and per second.
    frames: u64,
    fps: f64,
    /// Samples of whole pictures, in all, and per second of rendering alone, as `bench` counts fps.
    samples: f64,
    samples_per_s: f64,
    /// Shares of the engine's time in which samples were taken and frames painted.
    tracing_share: f64,
    painting_share: f64,
    /// Milliseconds for painting a frame, and for enlarging and presenting it.
    painting_ms: f64,
    presenting_ms: Option<f64>,
    /// Latency in milliseconds, from an event to the first frame that shows its effect: mean and longest;
    /// null without events.
    answer_ms: Option<f64>,
    slowest_answer_ms: Option<f64>,
    /// The longest time from the request for another scene to its first frame.
    slowest_switch_ms: Option<f64>,
}

impl Report {
    /// `presented`: the frames that a window enlarged and presented, and the time that took.
    fn of(summary: &Summary, presented: Option<(u64, Duration)>) -> Self {
        let elapsed = summary.elapsed.as_secs_f64().max(1e-9);
        let frames = summary.frames.max(1) as f64;
        let answered = |ms: f64| (summary.latencies > 0).then_some(ms);
        Self {
            schema: "octray-window-1",
            machine: Machine::current(),
            front_end: if presented.is_some() { "window" } else { "terminal" },
            frames: summary.frames,
            fps: summary.frames as f64 / elapsed,
            samples: summary.samples,
            samples_per_s: summary.samples / summary.tracing.as_secs_f64().max(1e-9),
            tracing_share: summary.tracing.as_secs_f64() / elapsed,
            painting_share: summary.painting.as_secs_f64() / elapsed,
            painting_ms: summary.painting.as_secs_f64() * 1e3 / frames,
            presenting_ms: presented.map(|(frames, time)| time.as_secs_f64() * 1e3 / frames.max(1) as f64),
            answer_ms: answered(summary.latency_sum.as_secs_f64() * 1e3 / summary.latencies.max(1) as f64),
            slowest_answer_ms: answered(summary.max_latency.as_secs_f64() * 1e3),
            slowest_switch_ms: summary.max_switch_time.map(|time| time.as_secs_f64() * 1e3),
        }
    }

    fn line(&self) -> String {
        let presenting = self.presenting_ms.map(|ms| format!(", presenting {} ms", figure(ms, 2)));
        format!(
            "{}, {} fps; {} samples/s; painting a frame {} ms{}\n",
            counted(self.frames, "frame", "frames"),
            figure(self.fps, 0),
            figure(self.samples_per_s, 0),
            figure(self.painting_ms, 2),
            presenting.unwrap_or_default()
        )
    }
}

/// Runs the command.
pub fn run(options: ViewOptions) -> Result<ExitCode, CliError> {
    let names = scenes::or_built_in(&options.scenes);
    let Some(playlist) = Playlist::new(&names) else {
        let what = format!(
            "there is no scene (.json) and no model (.obj, .gltf, .glb, .ply) in {}",
            names.join(", ")
        );
        return Err(CliError::Nothing { what, mend: "name a folder that holds some, or a file" });
    };
    if !options.screenshots.is_dir() {
        let what = format!("there is no folder `{}` for screenshots", options.screenshots.display());
        return Err(CliError::Nothing { what, mend: "make it, or name another with --screenshots" });
    }
    let name = playlist.current();
    if !name.starts_with("builtin:") && Path::new(name).extension().is_none() && !Path::new(name).exists() {
        let what = format!("there is no file or folder `{name}`");
        return Err(CliError::Nothing {
            what,
            mend: "name a scene, a model, a folder of them, or builtin:NAME",
        });
    }
    let first = scenes::load_with_warnings(name)?;
    memory::check(options.picture.size.unwrap_or(first.resolution), viewer::BYTES_PER_PIXEL)?;
    let in_terminal = options.terminal || !cfg!(feature = "window");
    if in_terminal && !std::io::stdout().is_terminal() {
        let what = "octray view draws in a terminal here, and standard output is not one".to_string();
        return Err(CliError::Nothing { what, mend: FOR_A_WINDOW });
    }
    let viewer = options.viewer(&first)?;
    let report = if in_terminal {
        let summary = viewer::terminal(viewer, playlist, first).map_err(CliError::Terminal)?;
        if !options.terminal {
            terminal::note(&format!("this octray was built without windows; {FOR_A_WINDOW}"));
        }
        Report::of(&summary, None)
    } else {
        in_window(viewer, playlist, first)?
    };
    if options.json {
        terminal::print_json(&report)?;
    } else if options.frames.is_some() {
        terminal::print(&report.line())?;
    }
    Ok(ExitCode::SUCCESS)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::args::{Args, Command};
    use crate::scene::{Rendering, View, load_with_view};
    use crate::traverse::TriangleChoice;
    use clap::Parser;

    #[test]
    fn every_view_has_its_own_methods_unless_an_option_overrides_them() {
        let plain = load_with_view("builtin:cornell").unwrap();
        let render = Rendering { triangle: Some(TriangleChoice::MollerTrumbore), ..Rendering::default() };
        let view = View { render, ..View::of(&plain, None, Path::new("")) };
        let later = Loaded { view: Some(view), ..plain.clone() };
        let triangle = |options: &[&str], scene: &Loaded| {
            let words = ["octray", "view"].iter().chain(options);
            let Some(Command::View(args)) = Args::parse_from(words).command else {
                unreachable!("the command is view")
            };
            let options = ViewOptions::try_from(args).unwrap().viewer(&plain).unwrap();
            (options.methods)(scene).triangle
        };
        assert_eq!(triangle(&[], &plain), TriangleChoice::Woop);
        assert_eq!(triangle(&[], &later), TriangleChoice::MollerTrumbore);
        assert_eq!(triangle(&["--triangle", "woop"], &later), TriangleChoice::Woop);
    }

    #[test]
    fn later_scenes_are_checked_against_memory() {
        let Some(Command::View(args)) = Args::parse_from(["octray", "view"]).command else {
            unreachable!("the command is view")
        };
        let plain = load_with_view("builtin:cornell").unwrap();
        let options = ViewOptions::try_from(args).unwrap().viewer(&plain).unwrap();
        assert_eq!((options.fits)([16, 9]), Ok(()));
        if machine::available_memory().is_some() {
            let refused = (options.fits)([1 << 20, 1 << 20]).unwrap_err();
            assert!(refused.contains("of memory") && refused.contains("--size"), "{refused}");
        }
    }
}
