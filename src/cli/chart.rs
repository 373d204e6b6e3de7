//! `octray chart`: speed against accuracy.

use super::CHECK_FAILED;
use super::error::CliError;
use super::options::ChartOptions;
use super::progress::Countdown;
use super::scenes;
use super::terminal::{self, figure};
use super::truths;
use crate::machine::{self, Machine};
use crate::measure::chart::pictures::Line;
use crate::measure::chart::ground_truth::SHRINK;
use crate::measure::chart::{Plan, kernels, motion};

use crate::output;
use crate::report::chart::{Chart, SCHEMA, drawings, verdict};
use crate::report::{page::page, tables};
use crate::wording::grouped;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// The share of the budget in which the equations are timed, at most this long.
const KERNELS_SHARE: f64 = 0.08;
const KERNELS_MOST: Duration = Duration::from_secs(10);
/// What is left at the end for drawing and writing.
const WRITING: Duration = Duration::from_millis(500);
/// From here on a budget is said to be exceeded, and a machine to be busy: times of the default's seeds, 90 % over 10 %.
const MOST_OVER: f64 = 1.1;
const BUSY: f64 = 1.5;
/// Without `--budget`, for each scene.
const A_SCENE: Duration = Duration::from_secs(20);

/// Runs the command.
pub fn run(options: ChartOptions) -> Result<ExitCode, CliError> {
    let start = Instant::now();
    if cfg!(debug_assertions) {
        terminal::warn("this is a debug build: its figures say nothing. Use cargo run --release -- chart.");
    }
    let names = scenes::asked_for(&options.scenes)?;
    // Before the equations take their time; it is read once, as the others are read when it is their turn.
    let mut first = names.first().map(|name| scenes::load(name)).transpose()?;
    let budget = options.budget.unwrap_or(A_SCENE * names.len() as u32);
    output::make_folder(&options.output)?;
    let countdown = Countdown::new(start, budget);

    countdown.step("equations");
    let kernels = kernels::measure(start + budget.mul_f64(KERNELS_SHARE).min(KERNELS_MOST));
    let mut chart = Chart {
        schema: SCHEMA,
        machine: Machine::current(),
        budget_s: budget.as_secs_f64(),
        seconds: 0.0,
        max_bounces: options.bounces,
        seeds: options.seeds,
        kernels,
        scenes: Vec::new(),
    };
    for (number, name) in names.iter().enumerate() {
        let scene = first.take().map_or_else(|| scenes::load(name), Ok)?;
        scene.warnings.iter().for_each(|warning| countdown.above(|| terminal::warn(warning)));
        let left = (start + budget).saturating_duration_since(Instant::now() + WRITING);
        let plan = Plan {
            size: options.size.map(|side| side / SHRINK),
            max_bounces: options.bounces,
            seeds: options.seeds,
            threads: machine::cores(),
            start: Instant::now(),
            time: left / (names.len() - number) as u32,
            budget: budget / names.len() as u32,
        };
        countdown.step(&format!("{}: truth", scene.name));
        let place = truths::place(&options.output, &scene, options.size, options.bounces);
        let kept = truths::load(&place, options.size);
        let truth = match kept.filter(|truth| plan.accepts(&truth.info)) {
            Some(truth) => truth,
            None => {
                let truth = plan.ground_truth(&scene);
                truths::save(&place, &truth)?;
                truth
            }
        };
        let step = |what: &str| countdown.step(&format!("{}: {what}", scene.name));
        let mut charted = plan.chart(&scene, &truth, &step);
        // As it was asked for: files in different folders may have one name.
        charted.scene = name.clone();
        chart.scenes.push(charted);
    }
    countdown.step("drawing");
    chart.seconds = start.elapsed().as_secs_f64();
    write(&options.output, &chart)?;
    countdown.end();

    if options.json {
        terminal::print_json(&chart)?;
    } else {
        terminal::print(&text(&chart, &options.output))?;
    }
    for sentence in doubts(&chart) {
        terminal::warn(&sentence);
    }
    let broken = chart.scenes.iter().flat_map(|scene| &scene.pictures).any(Line::is_broken);
    Ok(if broken { ExitCode::from(CHECK_FAILED) } else { ExitCode::SUCCESS })
}

/// What makes the figures worth less than they look.
fn doubts(chart: &Chart) -> Vec<String> {
    let mut doubts = Vec::new();
    let (took, budget) = (chart.seconds, chart.budget_s);
    if took > MOST_OVER * budget {
        let enough = figure(took.ceil(), 0);
        doubts.push(format!("it took {took:.1} s of {budget} s: the least that there is to do. Give --budget {enough} or more."));
    }
    for scene in &chart.scenes {
        let last = scene.pictures.first().and_then(|line| line.points.last());
        if last.is_some_and(|point| point.seconds.p90 > BUSY * point.seconds.p10) {
            doubts.push(format!(
                "the machine was busy during {}: the same work took more than {BUSY} times as long now and then.",
                scene.scene
            ));
        }
    }
    doubts
}

/// The page, its drawings and its tables.
fn write(folder: &Path, chart: &Chart) -> Result<(), CliError> {
    let save = |name: String, text: &str| output::save_text(&folder.join(name), text);
    for drawing in drawings(chart) {
        save(drawing.name + ".svg", &drawing.figure.svg())?;
    }
    save("pictures.csv".into(), &tables::pictures(chart))?;
    save("frames.csv".into(), &tables::frames(chart))?;
    save("display.csv".into(), &tables::display(chart))?;
    save("motion.csv".into(), &tables::motion(chart))?;
    save("kernels.csv".into(), &tables::kernels(chart))?;
    output::save_json(&folder.join("chart.json"), chart)?;
    Ok(save("report.html".into(), &page(chart))?)
}

fn times(ratio: f64) -> String {
    if ratio.is_finite() { format!("{}×", figure(ratio, 2)) } else { "–".into() }
}

/// What was found, for people.
fn text(chart: &Chart, folder: &Path) -> String {
    let mut text = format!("{}\n", chart.machine);
    for scene in &chart.scenes {
        let [width, height] = scene.size;
        text += &format!(
            "\n{}, {width}×{height}; the truth has {} samples and an error of {:.1e}\n{:<24}{:>12}{:>12}{:>12}{:>14}  verdict\n",
            scene.scene,
            grouped(scene.truth.samples * SHRINK * SHRINK),
            scene.truth.small_rmse,
            "configuration",
            "samples",
            "seconds",
            "RMSE",
            "equal error",
        );
        for line in &scene.pictures {
            let Some(last) = line.points.last() else { continue };
            text += &format!(
                "{:<24}{:>12}{:>12}{:>12.2e}{:>14}  {}\n",
                line.configuration,
                figure(last.samples, 0),
                figure(last.seconds.median, 3),
                last.rmse.median,
                times(line.time_to_equal_error),
                verdict(line),
            );
        }
        let reprojected = scene.motion.iter().filter(|moving| moving.filter == motion::FILTERS[1]);
        let lower: Vec<String> = reprojected
            .filter_map(|moving| Some(format!("{} {}", times(moving.times_lower?), moving.path.name())))
            .collect();
        if !lower.is_empty() {
            text += &format!(
                "in motion, frames have this many times the error of reprojected ones: {}\n",
                lower.join(", ")
            );
        }
    }
    let report: PathBuf = folder.join("report.html");
    text + &format!(
        "\nEqual error: the time to the error of the last column, over the default's.\n{} in {:.0} s\n",
        report.display(),
        chart.seconds
    )
}
