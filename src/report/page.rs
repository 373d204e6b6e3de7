//! A chart as one page of HTML that needs no other file: drawings, what was found, tables, and a glossary.

use super::chart::{Chart, verdict};
use super::chart_drawings::of_scene;
use super::chart_kernels::intersection as of_kernels;
use super::drawing::Drawing;
use super::settings::json;
use super::stats::engine;
use super::tables::Row;
use crate::measure::chart::SceneChart;
use crate::measure::chart::configurations::{DEFAULT, GROUPS};
use crate::measure::chart::display::FILTERS;
use crate::measure::stability::methods::MEANINGS;
use crate::wording::counted;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use serde_json::Value;

/// For phones (one column; tables and figures scroll instead of shrinking), desktops, and print (no page
/// break inside a figure).
const STYLE: &str = "
body { font: 16px/1.5 sans-serif; max-width: 64rem; margin: 0 auto; padding: 1rem; color: #222; background: #fff }
h1, h2, h3 { line-height: 1.2 }
figure { margin: 1rem 0; overflow-x: auto }
figure svg { display: block; width: 100%; min-width: 50rem; height: auto }
.wide { overflow-x: auto }
table { border-collapse: collapse; font-size: 0.85rem; font-variant-numeric: tabular-nums }
th, td { padding: 0.25rem 0.4rem; border-bottom: 1px solid #ccc; text-align: right; vertical-align: baseline }
th:first-child, td:first-child, .text { text-align: left }
td { white-space: pre }
td.text, td:first-child { white-space: normal }
.default { font-weight: bold }
small { color: #555 }
@media screen and (prefers-color-scheme: dark) { body { color: #e6edf3; background: #0d1117 } small { color: #9aa4ae } th, td { border-color: #30363d } }
@media print { figure svg { min-width: 0; max-height: 12cm } figure, table { break-inside: avoid } body { max-width: none; font-size: 10px } table { font-size: 7px } th, td { padding: 0.1rem 0.3rem } }
";

/// The words of the page, a line each, and what they mean.
const WORDS: &str = "\
ground truth: a picture of so many samples that its own error is small
RMSE: root mean square error: the root of the mean of (x − y)² over channels, y the ground truth's; bright regions \
dominate it
relMSE: relative mean square error: the mean of (x − y)² / (y² + 0.01); dark and bright regions count alike
trimmed: without the worst 0.1 % of pixels, so that a few fireflies do not decide
FLIP: the difference that a viewer notices on a display, 0 to 1 (Andersson et al. 2020)
time to equal error: the time to the last error of a configuration, or to the default's where that is larger, over \
the default's time to the same error
dominated: of a configuration: for nine of ten seeds, a robust one has a smaller error in the same time, at each \
point; of a method: another is faster beyond the spread, with no larger error and no more failures
sooner, later: of 10 to 90 % of the seeds, the time to equal error is below 1, or above 1
as default: the time to equal error cannot be told from the default's
unreliable: of the configuration or of the default: fewer than three points, or times of the same work that differ \
by more than half; it is compared with none
taken: the share of the time that other programs took: above 0.05 the machine was busy. Then processor time decides \
where one thread runs; times of more threads are not reliable
p99: the error of t that 99 % of the cases stay below
failures: the share of the cases that fail
fps: passes (one sample per pixel) per second
times lower: how many times lower the error is than that of the unfiltered frame
–: unknown: of errors, below that of the ground truth
FXAA: a filter that smooths the edges of a displayed picture (Lottes 2009)
";

pub fn page(chart: &Chart) -> String {
    let drawings: Vec<[Drawing; 6]> = chart.scenes.iter().map(|scene| of_scene(scene, chart.seeds)).collect();
    let figures = figures(chart);
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "octray: speed against accuracy" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Speed against accuracy" }
                @for [rmse, ..] in &drawings { (drawn(rmse)) }
                (found(chart))
                @for (number, (scene, drawings)) in chart.scenes.iter().zip(&drawings).enumerate() {
                    (of_one(scene, &figures["scenes"][number], drawings))
                }
                (intersection(chart, &figures))
                (source(chart))
                (glossary(chart))
            }
        }
    };
    page.into_string()
}

/// Summarises the findings in three sentences.
fn found(chart: &Chart) -> Markup {
    let lines = || chart.scenes.iter().flat_map(|scene| scene.pictures.iter().map(move |line| (scene, line)));
    let scenes = chart.scenes.len();
    let beaten =
        lines().filter(|(_, line)| line.configuration == DEFAULT && line.dominated_by.is_some()).count();
    let default = match beaten {
        0 => "No other configuration dominates the default.".into(),
        _ => format!("The default is dominated in {} of {scenes}.", counted(beaten, "scene", "scenes")),
    };
    let doubtful = lines().filter(|(_, line)| !line.reliability.reliable).count();
    let unlike: usize = lines().filter_map(|(_, line)| line.pictures_unlike_default).sum();
    let same = match unlike {
        0 => "Configurations that must give the default's picture gave it, bit by bit.".into(),
        _ => {
            let pictures = counted(unlike, "picture", "pictures");
            format!("{pictures} DIFFERED from the default's where all bits should agree: a bug in octray.")
        }
    };
    let dominated = lines().filter_map(|(scene, line)| {
        Some(format!("{} in {} by {}", line.configuration, scene.scene, line.dominated_by?))
    });
    html! {
        h2 { "What was found" }
        ul { li { (default) } @if doubtful > 0 { li { (counted(doubtful, "line is", "lines are")) " unreliable and compared with none." } } li { (same) } li { (list_of_dominated(dominated.collect())) } }
        p {
            small {
                "Pictures are timed on one thread and at a third of a frame's width and height. Which traversal is the fastest depends on the \
                 size: measure at yours. Methods that are not robust dominate none here: a picture's error hardly shows their failures; the \
                 failure rates are below. Some dominated configurations stay on purpose: the scalar path checks SIMD, and naive methods show the \
                 gain of robust ones."
            }
        }
    }
}

fn list_of_dominated(all: Vec<String>) -> String {
    if all.is_empty() { "None is dominated.".into() } else { format!("Dominated: {}.", all.join("; ")) }
}

/// Returns the tables of a scene, and the drawings that the page does not begin with.
fn of_one(
    scene: &SceneChart,
    figures: &Value,
    [_, relmse, flip, frames, display, motion]: &[Drawing; 6],
) -> Markup {
    let [width, height] = scene.frame_size;
    let (by_configuration, by_filter) = (("configuration", DEFAULT), ("filter", FILTERS[0]));
    html! {
        h2 { (scene.scene) }
        (table(figures, &["pictures"], "configuration verdict time_to_equal_error last/samples last/wall_s/median last/processor_s/median taken last/rmse/median last/flip/median", by_configuration))
        (drawn(relmse))
        (drawn(flip))
        p {
            small {
                "Ground truth: " (counted(scene.truth.samples, "sample", "samples")) " per pixel at " (width) "×" (height)
                " by octray's own default methods, with independent numbers and other seeds. Its own error is " (number(scene.truth.frame_rmse)) ", and "
                (number(scene.truth.small_rmse)) " at a third of the size" @if scene.truth.cached { " (kept from an earlier run)" }
                ". The errors above include it; the root mean squares below exclude it."
            }
        }
        (drawn(frames))
        (table(figures, &["frames", "moments"], "configuration fps after_s samples rmse flip reliable taken", by_configuration))
        (drawn(display))
        (table(figures, &["display"], "filter samples rmse flip frame_ms filter_ms reliable taken", by_filter))
        (drawn(motion))
        (table(figures, &["motion"], "path filter rmse times_lower frame_ms filter_ms reliable taken", by_filter))
        p {
            small {
                "The camera moves by a quarter of the distance to near surfaces per second, or turns by 30° per second, at 60 frames per second \
                 of one sample per pixel. Errors are those of the second half of the frames. \
                 Times of the denoiser and of reprojection include the AOVs (albedo, normal and depth of each pixel)."
            }
        }
    }
}

/// Returns the report as JSON, in which lines of pictures also have their verdict and their last point.
fn figures(chart: &Chart) -> Value {
    let mut figures = json(chart);
    for (number, scene) in chart.scenes.iter().enumerate() {
        for (place, line) in scene.pictures.iter().enumerate() {
            let of_line = &mut figures["scenes"][number]["pictures"][place];
            of_line["verdict"] = verdict(line).into();
            of_line["last"] = of_line["points"][line.points.len().saturating_sub(1)].clone();
        }
    }
    figures
}

/// Returns a table of these paths of an object's list, with the rows in bold that have a value.
fn table(object: &Value, lists: &[&str], paths: &str, (key, default): (&str, &str)) -> Markup {
    let name = |path: &str| {
        let name = path.trim_end_matches("/median").trim_start_matches("last/").replace('_', " ");
        name.replace("relmse", "relMSE").replace("rmse", "RMSE").replace("flip", "FLIP")
    };
    let class = |path: &str| (path == "verdict").then_some("text");
    html! {
        div class="wide" {
            table {
                tr { @for path in paths.split(' ') { th class=[class(path)] { (name(path)) } } }
                @for row in Row::all(object, lists) {
                    tr class=[(cell(row.get(key)) == default).then_some("default")] {
                        @for path in paths.split(' ') { td class=[class(path)] { (cell(row.get(path))) } }
                    }
                }
            }
        }
    }
}

/// Formats a number, a spread as its median and below it the 10 % and 90 % quantiles, or a word.
fn cell(value: &Value) -> String {
    match value {
        Value::Null => "–".into(),
        Value::String(word) => word.clone(),
        Value::Bool(yes) => if *yes { "yes" } else { "no" }.into(),
        Value::Number(x) => match x.as_f64().unwrap_or(f64::NAN) {
            whole if whole.fract() == 0.0 => whole.to_string(),
            x => number(x),
        },
        spread if spread["p10"] == spread["p90"] => cell(&spread["median"]),
        spread => {
            let [median, p10, p90] = ["median", "p10", "p90"].map(|part| cell(&spread[part]));
            format!("{median}\n({p10}–{p90})")
        }
    }
}

fn intersection(chart: &Chart, figures: &Value) -> Markup {
    let dominated = chart.kernels.iter().filter_map(|kernel| {
        let by = kernel.dominated_by(&chart.kernels)?.method;
        Some(format!("{} {} ({}) by {by}", kernel.family, kernel.method, engine(kernel.lanes)))
    });
    html! {
        h2 { "Intersection methods" }
        p { "The error of a picture hardly shows where intersection methods fail. The drawings below show it on difficult inputs; " code { "octray stability" } " has more of them." }
        p { (list_of_dominated(dominated.collect())) }
        @for drawing in of_kernels(&chart.kernels) { (drawn(&drawing)) }
        (table(figures, &["kernels"], "method family lanes wall_ns processor_ns reliable taken failures p99", ("default", "yes")))
    }
}

fn source(chart: &Chart) -> Markup {
    html! {
        h2 { "Machine and build" }
        p {
            "Machine: " (chart.settings.machine) ". Instruction sets compiled for: " (chart.settings.machine.target_features.join(", ")) ". Taken in "
            (format!("{:.0} s", chart.seconds)) " of " (format!("{:.0} s", chart.budget_s)) " allowed; up to "
            (chart.settings.bounces.map_or("each scene's own number of bounces".into(), |bounces| counted(bounces, "bounce", "bounces"))) ". The same numbers are in chart.json, pictures.csv, frames.csv, display.csv, motion.csv and kernels.csv beside this page."
        }
    }
}

/// Explains each configuration that the chart shows, its intersection methods, and the words of the page.
fn glossary(chart: &Chart) -> Markup {
    let shown = |name: &str| {
        chart.scenes.iter().flat_map(|scene| &scene.pictures).any(|line| line.configuration == name)
    };
    let configurations = GROUPS.into_iter().flat_map(|(_, named)| named).filter(|(name, _)| shown(name));
    let measured = |name: &str| chart.kernels.iter().any(|kernel| kernel.method == name);
    html! {
        h2 { "What the names of configurations mean" }
        p { "The default has the methods that " code { "octray render" } " takes without options. Every other configuration differs from it in one thing:" }
        (explained(configurations.copied()))
        h2 { "What the names of intersection methods mean" }
        (explained(MEANINGS.into_iter().filter(|(name, _)| measured(name))))
        h2 { "What the words mean" }
        p { "Of two lines the lower left one is better. Where they cross, it depends on the time available." }
        (explained(WORDS.lines().filter_map(|line| line.split_once(": "))))
    }
}

/// Returns a table of names and what each is.
fn explained(named: impl Iterator<Item = (&'static str, &'static str)>) -> Markup {
    html! {
        div class="wide" {
            table {
                @for (name, meaning) in named { tr { td { (name) } td class="text" { (meaning) } } }
            }
        }
    }
}

fn drawn(drawing: &Drawing) -> Markup {
    html! { figure { (PreEscaped(&drawing.svg)) } }
}

fn number(x: f64) -> String {
    match x {
        x if !x.is_finite() => "–".into(),
        0.0 => "0".into(),
        x if (0.01..10_000.0).contains(&x.abs()) => {
            format!("{x:.*}", (2 - x.abs().log10().floor() as i32).max(0) as usize)
        }
        x => format!("{x:.1e}"),
    }
}
