//! `octray chart`: speed against accuracy.

use super::error::CliError;
use super::numbers::{seconds, size, whole};
use super::outputs::keep_inputs;
use super::terminal::{self, Printer};
use super::{ground_truth, interrupt, progress, scenes};
use crate::measure::chart::ground_truth::SHRINK;
use crate::measure::chart::pictures::{Line, SEEDS};
use crate::measure::chart::{Plan, kernels};
use crate::render::{LaneChoice, Methods, Settings};
use crate::report::chart::{Chart, SCHEMA, drawings, text, warnings};
use crate::report::page::page;
use crate::report::settings::{RunSettings, json, own_size, own_sizes};
use crate::report::tables::tables;
use crate::scene::{MAX_BOUNCES, Scene, bench_names};
use crate::wording::counted;
use crate::{machine, output};
use clap::Parser;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// The intersection methods are timed for this share of the budget, at most so long.
const KERNELS_SHARE: f64 = 0.08;
const KERNELS_MOST: Duration = Duration::from_secs(10);
/// Time for drawing and writing at the end.
const WRITING: Duration = Duration::from_millis(500);
/// The budget of each scene without `--budget`.
const A_SCENE: Duration = Duration::from_secs(20);
const MAX_SEEDS: u32 = 1_000;

/// Chart speed against accuracy.
///
/// Five charts: intersection methods (cost of a test beside failures and errors, at the widest vector of the
/// machine and scalar), pictures of a third of each side (error against time for every configuration, from
/// one sample per pixel on, with the Pareto front as one line), frames (the error of a window's accumulated
/// picture after a short time), display (one picture unfiltered, blurred, with FXAA, and denoised), and
/// motion (frames of a moving camera with one sample per pixel, unfiltered, reprojected, and also denoised).
/// Errors are measured against a ground truth that is rendered first, with other random numbers, and cached
/// in the folder for the next run; those in motion against ground truths of their own.
///
/// Times in drawings are multiples of the default's, comparable between machines; the tables have seconds.
/// Pictures and intersection methods are timed on one thread, and compared by its processor time where other
/// programs took more than 5 % of the wall time. Configurations of too few points, or whose times are
/// scattered, are unreliable and compared with none.
///
/// Writes report.html (one page that needs no other file), an .svg for each figure, .csv tables and
/// chart.json. Exits with 1 if a configuration that must give the default's picture, bit by bit, gives
/// another.
#[derive(Debug, clap::Parser)]
#[command(after_help = "Example:\n  octray chart builtin:three builtin:cornell -o charts --budget 60")]
pub struct Options {
    /// Scenes, models, builtin:NAME [default: the built-in bench scenes].
    #[arg(value_name = "SCENE")]
    scenes: Vec<OsString>,
    /// The folder for all files; created if it does not exist.
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
    /// Also print the figures as JSON (schema octray-chart-1).
    #[arg(long)]
    json: bool,
    /// Time for the run; more gives narrower bands [default: 20 a scene].
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true)]
    budget: Option<Duration>,
    /// Take each scene's own size, rounded up to multiples of 3, and bounces.
    #[arg(long, conflicts_with_all = ["size", "bounces"])]
    as_scene: bool,
    /// Pixels of a frame, multiples of 3.
    #[arg(long, value_name = "WxH", default_value = "240x135", value_parser = chart_size, allow_hyphen_values = true)]
    size: [u32; 2],
    /// Most scattering events on a path.
    #[arg(long, value_name = "N", default_value = "4", value_parser = whole::<0, MAX_BOUNCES>, allow_hyphen_values = true)]
    bounces: u32,
    /// Random seeds behind every median: 8 or more.
    #[arg(long, value_name = "N", default_value = "8", value_parser = whole::<SEEDS, MAX_SEEDS>, allow_hyphen_values = true)]
    seeds: u32,
}

fn chart_size(text: &str) -> Result<[u32; 2], String> {
    let size = size(text)?;
    let [width, height] = size.map(|side| side.next_multiple_of(SHRINK));
    if size != [width, height] {
        return Err(format!(
            "pictures have a third of its width and height: give multiples of 3, such as {width}x{height}"
        ));
    }
    Ok(size)
}

impl Options {
    /// Returns the size and the bounces of a scene's frames.
    fn sized(&self, scene: &Scene) -> ([u32; 2], u32) {
        match self.as_scene {
            true => (scene.resolution.map(|side| side.next_multiple_of(SHRINK)), scene.max_bounces),
            false => (self.size, self.bounces),
        }
    }

    fn run_settings(&self) -> RunSettings {
        let (lanes, threads) = (vec![LaneChoice::default().lanes()], vec![machine::cores()]);
        let run = RunSettings { lanes, threads, ..RunSettings::of(Methods::default()) };
        let run = run.sized(self.size, self.bounces, self.as_scene);
        let run = run.with("seeds", Some(self.seeds));
        run.with("budget", self.budget.map(|time| time.as_secs_f64()))
    }
}

pub fn run(options: Options) -> Result<ExitCode, CliError> {
    let start = Instant::now();
    terminal::warn_of_debug_build("chart");
    let names = scenes::checked(&options.scenes, bench_names())?;
    // The first scene is read before the kernels are timed, so that a fault in it is reported at once; the
    // others when they are charted.
    let mut first = names.first().map(|name| scenes::load(name, false)).transpose()?;
    let budget = options.budget.unwrap_or(A_SCENE * names.len() as u32);
    output::make_folder(&options.output)?;
    let bar = progress::countdown(start, budget);
    let nothing = format!("Ctrl-C: nothing was drawn in `{}`.", options.output.display());
    interrupt::end_with(&nothing);

    bar.set_message("intersection methods");
    let kernels = kernels::measure(start + budget.mul_f64(KERNELS_SHARE).min(KERNELS_MOST));
    let mut chart = Chart {
        schema: SCHEMA,
        settings: options.run_settings(),
        budget_s: budget.as_secs_f64(),
        seconds: 0.0,
        seeds: options.seeds,
        kernels,
        scenes: Vec::new(),
    };
    let (mut shapes, mut own) = (vec!["box"], Vec::new());
    for (number, name) in names.iter().enumerate() {
        let scene = first.take().map_or_else(|| scenes::load(name, false), Ok)?;
        keep_inputs(&scene.files, [("--output", options.output.join("chart.json").as_path())])?;
        scene.warnings.iter().for_each(|warning| bar.suspend(|| terminal::warn(warning)));
        let left = (start + budget).saturating_duration_since(Instant::now() + WRITING);
        let (size, max_bounces) = options.sized(&scene);
        own.extend(own_size(&scene, &Settings { resolution: size, max_bounces, ..Settings::of(&scene) }));
        let plan = Plan {
            size: size.map(|side| side / SHRINK),
            max_bounces,
            seeds: options.seeds,
            threads: machine::cores(),
            start: Instant::now(),
            time: left / (names.len() - number) as u32,
            budget: budget / names.len() as u32,
        };
        let step = |what: &str| bar.set_message(format!("{}: {what}", scene.name));
        step("ground truth");
        let place = ground_truth::place(&options.output, &scene, size, max_bounces);
        let kept = ground_truth::load(&place, size);
        let truth = match kept.filter(|truth| truth.info.is_enough_for(plan.budget)) {
            Some(truth) => truth,
            None => {
                let truth = plan.ground_truth(&scene);
                ground_truth::save(&place, &truth)?;
                truth
            }
        };
        let truths = counted(number + 1, "ground truth", "ground truths");
        interrupt::set_last_note(format!("{nothing} It keeps {truths} for the next run."));
        let mut charted = plan.chart(&scene, &truth, &step);
        // The name on the command line: files in different folders may share a file name.
        charted.scene = name.to_string_lossy().into_owned();
        chart.scenes.push(charted);
        let of_scene = [("sphere", !scene.spheres.is_empty()), ("triangle", !scene.triangles.is_empty())];
        shapes.extend(of_scene.into_iter().filter_map(|(shape, has)| has.then_some(shape)));
    }
    // Methods for shapes that no scene has say nothing about these scenes.
    chart.kernels.retain(|kernel| shapes.contains(&kernel.family));
    bar.set_message("drawing");
    chart.seconds = start.elapsed().as_secs_f64();
    write(&options.output, &chart)?;
    bar.finish_and_clear();

    let out = Printer { json: options.json };
    let defaults = Options::parse_from(["chart", "-o", "charts"]).run_settings();
    out.text(
        &(text(&chart, &defaults, &options.output) + &own_sizes(if options.as_scene { &[] } else { &own })),
    )?;
    warnings(&chart).iter().for_each(|sentence| terminal::warn(sentence));
    out.end(&chart, chart.scenes.iter().flat_map(|scene| &scene.pictures).any(Line::is_broken))
}

/// Writes the page, its drawings and its tables.
fn write(folder: &Path, chart: &Chart) -> Result<(), CliError> {
    let save = |name: &str, text: &str| output::save_text(&folder.join(name), text);
    for drawing in drawings(chart) {
        save(&format!("{}.svg", drawing.name), &drawing.svg)?;
    }
    for (name, text) in tables(&json(chart)) {
        save(&name, &text)?;
    }
    output::save_json(&folder.join("chart.json"), chart)?;
    Ok(save("report.html", &page(chart))?)
}
