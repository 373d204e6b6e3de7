//! `octray chart`: speed against accuracy.

use super::error::{CHECK_FAILED, CliError};
use super::ground_truth;
use super::interrupt;
use super::options::ChartOptions;
use super::progress::Countdown;
use super::scenes;
use super::terminal;
use crate::machine::{self, Machine};
use crate::measure::chart::ground_truth::SHRINK;
use crate::measure::chart::pictures::Line;
use crate::measure::chart::{Plan, kernels};
use crate::output;
use crate::report::chart::{Chart, SCHEMA, drawings, text, warnings};
use crate::report::page::page;
use crate::report::tables::{json, tables};
use std::path::Path;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// The intersection methods are timed for this share of the budget, at most so long.
const KERNELS_SHARE: f64 = 0.08;
const KERNELS_MOST: Duration = Duration::from_secs(10);
/// Time for drawing and writing at the end.
const WRITING: Duration = Duration::from_millis(500);
/// The budget of each scene without `--budget`.
const A_SCENE: Duration = Duration::from_secs(20);

/// Runs the command.
pub fn run(options: ChartOptions) -> Result<ExitCode, CliError> {
    let start = Instant::now();
    terminal::warn_of_debug_build("chart");
    let names = scenes::checked(&options.scenes)?;
    // The first scene is read before the kernels are timed, so that a fault in it is reported at once; the
    // others when they are charted.
    let mut first = names.first().map(|name| scenes::load(name)).transpose()?;
    let budget = options.budget.unwrap_or(A_SCENE * names.len() as u32);
    output::make_folder(&options.output)?;
    let countdown = Countdown::new(start, budget);
    let truths = Arc::new(AtomicUsize::new(0));
    let (kept, folder) = (truths.clone(), options.output.clone());
    interrupt::end_with(move || interrupted(kept.load(Ordering::SeqCst), &folder));

    countdown.step("intersection methods");
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
    let mut shapes = vec!["box"];
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
        countdown.step(&format!("{}: ground truth", scene.name));
        let place = ground_truth::place(&options.output, &scene, options.size, options.bounces);
        let kept = ground_truth::load(&place, options.size);
        let truth = match kept.filter(|truth| plan.accepts(&truth.info)) {
            Some(truth) => truth,
            None => {
                let truth = plan.ground_truth(&scene);
                ground_truth::save(&place, &truth)?;
                truth
            }
        };
        truths.fetch_add(1, Ordering::SeqCst);
        let step = |what: &str| countdown.step(&format!("{}: {what}", scene.name));
        let mut charted = plan.chart(&scene, &truth, &step);
        // The name on the command line: files in different folders may share a file name.
        charted.scene = name.clone();
        chart.scenes.push(charted);
        let of_scene = [("sphere", !scene.spheres.is_empty()), ("triangle", !scene.triangles.is_empty())];
        shapes.extend(of_scene.into_iter().filter_map(|(shape, has)| has.then_some(shape)));
    }
    // Methods for shapes that no scene has tell nothing of these scenes.
    chart.kernels.retain(|kernel| shapes.contains(&kernel.family));
    countdown.step("drawing");
    chart.seconds = start.elapsed().as_secs_f64();
    write(&options.output, &chart)?;
    countdown.end();

    if options.json {
        terminal::print_json(&chart)?;
    } else {
        terminal::print(&text(&chart, &options.output))?;
    }
    for sentence in warnings(&chart) {
        terminal::warn(&sentence);
    }
    let broken = chart.scenes.iter().flat_map(|scene| &scene.pictures).any(Line::is_broken);
    Ok(if broken { ExitCode::from(CHECK_FAILED) } else { ExitCode::SUCCESS })
}

/// What is left of a run that ends before its chart is drawn.
fn interrupted(truths: usize, folder: &Path) -> String {
    let folder = folder.display();
    match truths {
        0 => format!("Ctrl-C: nothing was drawn in `{folder}`."),
        1 => format!(
            "Ctrl-C: nothing was drawn in `{folder}`. It keeps a ground truth, which the next run takes."
        ),
        _ => format!(
            "Ctrl-C: nothing was drawn in `{folder}`. It keeps {truths} ground truths, which the next run takes."
        ),
    }
}

/// The page, its drawings and its tables.
fn write(folder: &Path, chart: &Chart) -> Result<(), CliError> {
    let save = |name: String, text: &str| output::save_text(&folder.join(name), text);
    for drawing in drawings(chart) {
        save(format!("{}.svg", drawing.name), &drawing.svg)?;
    }
    for (name, text) in tables(&json(chart)) {
        save(name, &text)?;
    }
    output::save_json(&folder.join("chart.json"), chart)?;
    Ok(save("report.html".into(), &page(chart))?)
}
