//! `octray view`: walks through scenes in a terminal or, with the feature `window`, in a window.

use super::error::{CliError, refuse, refuse_input};
use super::numbers::whole;
use super::options::PictureOptions;
use super::terminal::{self, Printer};
use super::{memory, scenes};
use crate::machine::{self, Machine};
use crate::methods;
use crate::render::Settings;
use crate::report::numbers::figure;
use crate::scene::{Loaded, builtin_names};
use crate::viewer::playlist::Playlist;
use crate::viewer::{self, Summary, keys};
use crate::wording::counted;
use serde::Serialize;
use std::ffi::{OsStr, OsString};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;

/// Highest frame rate that can be a target.
const MAX_FPS: u32 = 1_000;

/// Walk through scenes in a terminal or, in builds with it, a window.
///
/// While the camera stands, samples accumulate, up to 65,536 per pixel: after N of them the picture has the
/// bits of `octray render --samples N`. While it moves, earlier frames are reprojected. A scene whose files
/// change is loaded again; if it cannot be read, the old one stays and the reason is shown.
///
/// Two rates are shown: frames per second of the screen, at most the display's, and passes per second of the
/// renderer alone, which are the fps of `octray bench` with the same settings.
///
/// A build with --features window opens a window, onto which scenes can be dropped. Others, and --terminal,
/// draw with half-block characters in true colour, which needs no display and takes the same keys except
/// Shift, Ctrl and mouse movement. Ctrl-C ends the viewer, with exit code 0.
#[derive(Debug, clap::Parser)]
#[command(after_long_help = after_help())]
pub struct Options {
    /// Scenes, models, folders, builtin:NAME [default: all built-in].
    #[arg(value_name = "SCENE")]
    scenes: Vec<OsString>,
    /// Draw in this terminal instead of a window.
    #[arg(long)]
    terminal: bool,
    /// Hold so many frames per second, by coarser pixels.
    #[arg(long, value_name = "N", value_parser = whole::<1, MAX_FPS>, allow_hyphen_values = true)]
    target_fps: Option<u32>,
    /// The folder for screenshots.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    screenshots: PathBuf,
    /// End after so many frames.
    #[arg(long, value_name = "N", value_parser = whole::<1, { u32::MAX }>, allow_hyphen_values = true)]
    frames: Option<u32>,
    /// Print rates and times (schema octray-window-1).
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    picture: PictureOptions,
}

/// Keys and examples.
fn after_help() -> String {
    let keys: Vec<String> = keys::help().map(|line| format!("  {line}")).collect();
    let examples = "Examples:
  octray view
  octray view scene.json model.obj scenes/
  octray view builtin:thesis --terminal
  octray view builtin:three --frames 600 --json > view.json";
    format!("Keys:\n{}\n\n{examples}", keys.join("\n"))
}

/// Says how to open a window, without the end of the sentence.
const FOR_A_WINDOW: &str = if cfg!(feature = "window") {
    "without --terminal it opens a window; to write a picture into a file, use octray render"
} else {
    "for a window: cargo run --release --features window -- view; for a picture in a file: octray render"
};

impl Options {
    /// Returns the viewer's options. Seed, tone and pipeline are those of its first scene; size, bounces and
    /// methods are those of each scene.
    fn viewer(&self, first: &Loaded) -> viewer::Options {
        let Settings { seed, pipeline, clamp, threads, .. } = self.picture.settings(first);
        let mut picture = self.picture;
        picture.threads = Some(threads);
        let settings = move |scene: &Loaded| Settings { seed, pipeline, clamp, ..picture.settings(scene) };
        viewer::Options {
            settings: Box::new(settings),
            max_threads: machine::cores().max(threads),
            tone: picture.tone(first),
            target: self.target_fps,
            renderer: methods::renderer,
            fits: Box::new(|size| memory::room_for(size, viewer::BYTES_PER_PIXEL)),
            frames: self.frames.map(u64::from),
            screenshots: self.screenshots.clone(),
        }
    }
}

#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    machine: Machine,
    /// `window` or `terminal`.
    front_end: &'static str,
    /// Frames presented, in all and per second.
    frames: u64,
    fps: f64,
    /// Passes over the frame, in all, and per second of rendering alone, as `bench` counts fps.
    passes: f64,
    passes_per_s: f64,
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
    fn of(summary: &Summary) -> Self {
        let elapsed = summary.elapsed.as_secs_f64().max(1e-9);
        let frames = summary.frames.max(1) as f64;
        let answered = |ms: f64| (summary.latencies > 0).then_some(ms);
        let presenting = |(frames, time): (u64, Duration)| time.as_secs_f64() * 1e3 / frames.max(1) as f64;
        Self {
            schema: "octray-window-1",
            machine: Machine::current(),
            front_end: if summary.presented.is_some() { "window" } else { "terminal" },
            frames: summary.frames,
            fps: summary.frames as f64 / elapsed,
            passes: summary.passes,
            passes_per_s: summary.passes / summary.tracing.as_secs_f64().max(1e-9),
            tracing_share: summary.tracing.as_secs_f64() / elapsed,
            painting_share: summary.painting.as_secs_f64() / elapsed,
            painting_ms: summary.painting.as_secs_f64() * 1e3 / frames,
            presenting_ms: summary.presented.map(presenting),
            answer_ms: answered(summary.latency_sum.as_secs_f64() * 1e3 / summary.latencies.max(1) as f64),
            slowest_answer_ms: answered(summary.max_latency.as_secs_f64() * 1e3),
            slowest_switch_ms: summary.max_switch_time.map(|time| time.as_secs_f64() * 1e3),
        }
    }

    fn line(&self) -> String {
        let presenting = self.presenting_ms.map(|ms| format!(", presenting {} ms", figure(ms, 2)));
        format!(
            "{}, {} fps; {} passes/s; painting a frame {} ms{}\n",
            counted(self.frames, "frame", "frames"),
            figure(self.fps, 0),
            figure(self.passes_per_s, 0),
            figure(self.painting_ms, 2),
            presenting.unwrap_or_default()
        )
    }
}

pub fn run(options: Options) -> Result<ExitCode, CliError> {
    let names = scenes::or_built_in(&options.scenes, builtin_names());
    let Some(playlist) = Playlist::new(&names) else {
        let what = "there is no scene (.json) and no model (.obj, .gltf, .glb, .ply) in";
        let names = names.join(OsStr::new(", "));
        let instead = "name a folder that holds some, or a file";
        return Err(refuse_input(format!("{what} {}", names.display()), instead));
    };
    if !options.screenshots.is_dir() {
        let instead = "there is no such folder: make it, or name another";
        return Err(refuse("--screenshots", options.screenshots.display(), instead));
    }
    let name = playlist.current();
    let path = Path::new(name);
    let is_built_in = path.to_string_lossy().starts_with("builtin:");
    if !is_built_in && path.extension().is_none() && !path.exists() {
        let what = format!("there is no file or folder `{}`", path.display());
        return Err(refuse_input(what, "name a scene, a model, a folder of them, or builtin:NAME"));
    }
    let first = scenes::load_with_warnings(name, false)?;
    memory::check(options.picture.size.unwrap_or(first.resolution), viewer::BYTES_PER_PIXEL)?;
    let in_terminal = options.terminal || !cfg!(feature = "window");
    if in_terminal && !std::io::stdout().is_terminal() {
        let what = "octray view draws in a terminal here, and standard output is not one";
        return Err(refuse_input(what, FOR_A_WINDOW));
    }
    let summary = match options.viewer(&first) {
        #[cfg(feature = "window")]
        viewer if !in_terminal => viewer::window(viewer, playlist, first)?,
        viewer => viewer::terminal(viewer, playlist, first).map_err(CliError::Terminal)?,
    };
    if in_terminal && !options.terminal {
        terminal::note(&format!("this octray was built without windows; {FOR_A_WINDOW}"));
    }
    let report = Report::of(&summary);
    let out = Printer { json: options.json };
    if options.frames.is_some() {
        out.text(&report.line())?;
    }
    out.end(&report, false)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::TriangleChoice;
    use crate::scene::{Rendering, View, load_with_view};
    use clap::Parser;

    #[test]
    fn every_view_has_its_own_methods_unless_an_option_overrides_them() {
        let plain = load_with_view("builtin:cornell").unwrap();
        let render = Rendering { triangle: Some(TriangleChoice::MollerTrumbore), ..Rendering::default() };
        let view = View { render, ..View::from_scene(&plain, None, Path::new("")) };
        let later = Loaded { view: Some(view), ..plain.clone() };
        let triangle = |line: &str, scene| {
            let options = Options::parse_from(line.split(' ')).viewer(&plain);
            (options.settings)(scene).methods.triangle.name()
        };
        let found =
            [triangle("view", &plain), triangle("view", &later), triangle("view --triangle woop", &later)];
        assert_eq!(found, ["woop", "moller-trumbore", "woop"]);
    }
}
