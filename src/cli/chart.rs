//! `octray chart`: speed against accuracy.

use super::CHECK_FAILED;
use super::error::CliError;
use super::options::ChartOptions;
use super::progress::Countdown;
use super::scenes;
use super::terminal::{self, figure};
use super::truths;
use crate::measure::chart::pictures::Line;
use crate::measure::chart::truth::SHRINK;
use crate::measure::chart::{Chart, Plan, SCHEMA, kernels};
use crate::measure::{Machine, machine};
use crate::output;
use crate::report::{chart::drawings, page::page, tables};
use crate::scene;
use crate::wording::grouped;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

/// The share of the budget in which the equations are timed, at most this long.
const KERNELS_SHARE: f64 = 0.08;
const KERNELS_MOST: Duration = Duration::from_secs(10);
/// What is left at the end for drawing and writing.
const WRITING: Duration = Duration::from_millis(500);
/// Without `--budget`, for each scene.
const A_SCENE: Duration = Duration::from_secs(20);

/// Runs the command.
pub fn run(options: ChartOptions) -> Result<ExitCode, CliError> {
    let start = Instant::now();
    if cfg!(debug_assertions) {
        terminal::warn("this is a debug build: its figures say nothing. Use cargo run --release -- chart.");
    }
    let names = scenes::asked_for(&options.scenes)?;
    if let [only] = &names[..] {
        scene::load(only)?;
    }
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
        let scene = scene::load(name)?;
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
        let truth = match kept.filter(|truth| plan.is_content_with(&truth.quality)) {
            Some(truth) => truth,
            None => {
                let truth = plan.truth(&scene);
                truths::save(&place, &truth)?;
                truth
            }
        };
        let step = |what: &str| countdown.step(&format!("{}: {what}", scene.name));
        chart.scenes.push(plan.chart(&scene, &truth, &step));
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
    let broken = chart.scenes.iter().flat_map(|scene| &scene.pictures).any(Line::is_broken);
    Ok(if broken { ExitCode::from(CHECK_FAILED) } else { ExitCode::SUCCESS })
}

/// The page, its drawings and its tables.
fn write(folder: &Path, chart: &Chart) -> Result<(), CliError> {
    let save = |name: String, text: &str| output::save_text(&folder.join(name), text);
    for drawing in drawings(chart) {
        save(drawing.name + ".svg", &drawing.figure.svg())?;
    }
    save("pictures.csv".into(), &tables::pictures(chart))?;
    save("frames.csv".into(), &tables::frames(chart))?;
    save("kernels.csv".into(), &tables::kernels(chart))?;
    save("chart.json".into(), &(serde_json::to_string_pretty(chart).expect("figures are JSON") + "\n"))?;
    Ok(save("report.html".into(), &page(chart))?)
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
            let verdict = match line.dominated_by {
                _ if line.is_broken() => "NOT the default's picture".to_owned(),
                Some(better) => format!("dominated by {better}"),
                None if !line.robust => format!("{}, but not robust", line.standing()),
                None => line.standing().to_owned(),
            };
            text += &format!(
                "{:<24}{:>12}{:>12}{:>12.2e}{:>13}×  {verdict}\n",
                line.configuration,
                figure(last.samples, 0),
                figure(last.seconds.median, 3),
                last.rmse.median,
                figure(line.time_to_equal_error, 2),
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
