//! A chart as one page of HTML that needs no other file: figures, tables, and the origin of the numbers.
//!
//! For: [`page`].

use super::chart::{self, Chart};
use super::chart_drawings::{Measure, display, frames, motion, of_pictures};
use super::chart_kernels::intersection as of_kernels;
use super::drawing::Drawing;
use crate::measure::chart::SceneChart;
use crate::measure::chart::configurations::{DEFAULT, GROUPS};
use crate::measure::chart::display::FILTERS;
use crate::measure::chart::kernels::Kernel;
use crate::measure::chart::pictures::Line;
use crate::measure::quantiles::Spread;
use crate::measure::stability::methods::MEANINGS;
use crate::wording::counted;
use maud::{DOCTYPE, Markup, PreEscaped, html};

/// For phones (one column; tables and figures scroll instead of shrinking), desktops, and print (no page
/// break inside a figure).
const STYLE: &str = "
body { font: 16px/1.5 sans-serif; max-width: 64rem; margin: 0 auto; padding: 1rem; color: #222; background: #fff }
h1, h2, h3 { line-height: 1.2 }
figure { margin: 1rem 0; overflow-x: auto }
svg { display: block; width: 100%; min-width: 50rem; height: auto }
.wide { overflow-x: auto }
table { border-collapse: collapse; font-size: 0.9rem; font-variant-numeric: tabular-nums }
th, td { padding: 0.25rem 0.75rem; border-bottom: 1px solid #ccc; text-align: right; white-space: nowrap }
th:first-child, td:first-child, .text { text-align: left }
td.text { white-space: normal; min-width: 11rem }
.default { font-weight: bold }
small { color: #555 }
@media screen and (prefers-color-scheme: dark) { body { color: #e6edf3; background: #0d1117 } small { color: #9aa4ae } th, td { border-color: #30363d } }
@media print { svg { min-width: 0 } figure, table { break-inside: avoid } body { max-width: none; font-size: 10px } table { font-size: 7px } th, td { padding: 0.1rem 0.3rem; white-space: normal } figure svg { max-height: 12cm } }
";

/// The words of the page.
const WORDS: [(&str, &str); 10] = [
    ("ground truth", "a picture of so many samples that its own error is small"),
    (
        "RMSE",
        "root mean square error: the root of the mean of (x − y)² over channels, y the ground truth's; bright regions dominate it",
    ),
    (
        "relMSE",
        "relative mean square error: the mean of (x − y)² / (y² + 0.01); dark and bright regions count alike",
    ),
    ("trimmed", "without the worst 0.1 % of pixels, so that a few fireflies do not decide"),
    ("FLIP", "the difference that a viewer notices on a display, 0 to 1 (Andersson et al. 2020)"),
    (
        "time to equal error",
        "the time to the last error of a configuration, or to the default's where that is larger, over the default's time to the same error",
    ),
    (
        "dominated",
        "of a configuration: for nine of ten seeds, a robust one has a smaller error in the same time, at each point; of a method: another is \
         faster beyond the spread, with no larger error and no more failures",
    ),
    ("on the front", "no robust configuration has a smaller error in the same time, by the medians"),
    ("p99", "the error that 99 % of the cases stay below"),
    ("FXAA", "a filter that smooths the edges of a displayed picture (Lottes 2009)"),
];

/// For an error below that of the ground truth.
const UNKNOWN: &str = "below the ground truth's";

/// The page.
pub fn page(chart: &Chart) -> String {
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
                @for scene in &chart.scenes { (figure(&of_pictures(scene, chart.seeds, Measure::Rmse))) }
                p { (introduction()) }
                (verdict(chart))
                @for scene in &chart.scenes { (of_scene(chart, scene)) }
                (intersection(chart))
                (source(chart))
                (meanings(chart))
            }
        }
    };
    page.into_string()
}

fn introduction() -> Markup {
    html! {
        "Every configuration is measured by its time and by its error against a ground truth. Further left is faster, lower is more accurate. \
         Of two lines the lower left one is better; where they cross, it depends on the time available."
    }
}

/// The findings in words.
fn verdict(chart: &Chart) -> Markup {
    let default =
        |scene: &SceneChart| scene.pictures.iter().find(|line| line.configuration == DEFAULT).cloned();
    let undominated = |scene: &&SceneChart| default(scene).is_some_and(|line| line.dominated_by.is_none());
    let count = chart.scenes.iter().filter(undominated).count();
    let unlike: usize = chart
        .scenes
        .iter()
        .flat_map(|scene| &scene.pictures)
        .filter_map(|line| line.pictures_unlike_default)
        .sum();
    let slow_equations: Vec<&Kernel> =
        chart.kernels.iter().filter(|one| one.dominated_by(&chart.kernels).is_some()).collect();
    html! {
        h2 { "What was found" }
        ul {
            li {
                @if count == chart.scenes.len() { "No other configuration dominates the default." }
                @else { "The default is dominated in " (counted(chart.scenes.len() - count, "scene", "scenes")) " of " (chart.scenes.len()) "." }
            }
            li {
                @if unlike == 0 { "Configurations that must give the default's picture gave it, bit by bit." }
                @else { (counted(unlike, "picture", "pictures")) " DIFFERED from the default's where all bits should agree: a bug in octray." }
            }
            @for scene in &chart.scenes {
                @for line in &scene.pictures {
                    @if let Some(better) = line.dominated_by {
                        li { (scene.scene) ": " em { (line.configuration) } " is dominated, at its last point by " em { (better) } "." }
                    }
                }
            }
            @for kernel in slow_equations {
                @let by = kernel.dominated_by(&chart.kernels).map_or("", |other| other.method);
                li { (kernel.family) " method " em { (kernel.method) } ", " (lanes(kernel)) ", is dominated by " em { (by) } "." }
            }
        }
        p {
            small {
                "Pictures are timed on one thread and at a third of a frame's width and height: which traversal is the fastest depends on the size, so \
                 measure at yours. In pictures, methods that are not robust are compared with all others, but dominate none: their failures hardly \
                 show in a picture's error; the failure rates are below."
            }
        }
        p { small { "Some dominated configurations are kept on purpose: the scalar path checks SIMD, and naive methods show the gain of robust ones." } }
    }
}

/// What differs from the default in each configuration that the chart shows.
fn meanings(chart: &Chart) -> Markup {
    let shown = |name: &str| {
        chart.scenes.iter().flat_map(|scene| &scene.pictures).any(|line| line.configuration == name)
    };
    let named = GROUPS.into_iter().flat_map(|(_, named)| named).filter(|(name, _)| shown(name));
    html! {
        h2 { "What the names of lines mean" }
        p { "The default has the methods that " code { "octray render" } " takes without options. Every other configuration differs from it in one thing:" }
        (explained(named.copied()))
        h2 { "What the words mean" }
        (explained(WORDS.into_iter()))
    }
}

/// A table of names and what each is.
fn explained(named: impl Iterator<Item = (&'static str, &'static str)>) -> Markup {
    html! {
        div class="wide" {
            table {
                @for (name, meaning) in named { tr { td { (name) } td class="text" { (meaning) } } }
            }
        }
    }
}

fn of_scene(chart: &Chart, scene: &SceneChart) -> Markup {
    let [width, height] = scene.frame_size;
    html! {
        h2 { (scene.scene) }
        (pictures_table(scene))
        (figure(&of_pictures(scene, chart.seeds, Measure::Relmse)))
        (figure(&of_pictures(scene, chart.seeds, Measure::Flip)))
        p {
            small {
                "Ground truth: " (counted(scene.truth.samples, "sample", "samples")) " per pixel at " (width) "×" (height)
                " by octray's own default methods, with independent numbers and other seeds; its own error is " (number(scene.truth.frame_rmse)) ", and "
                (number(scene.truth.small_rmse)) " at a third of the size" @if scene.truth.cached { " (kept from an earlier run)" }
                ". The errors above include it; the root mean squares below exclude it."
            }
        }
        (figure(&frames(scene)))
        (frames_table(scene))
        (figure(&display(scene)))
        (display_table(scene))
        (figure(&motion(scene)))
        (motion_table(scene))
    }
}

fn pictures_table(scene: &SceneChart) -> Markup {
    let last = |line: &Line| line.points.last().cloned();
    html! {
        div class="wide" {
            table {
                tr {
                    th { "configuration" } th class="text" { "verdict" } th { "time to equal error" } th { "samples" } th { "seconds" }
                    th { "RMSE" } th { "relMSE" } th { "relMSE, trimmed" } th { "FLIP" }
                }
                @for line in &scene.pictures {
                    @if let Some(point) = last(line) {
                        tr class=[(line.configuration == DEFAULT).then_some("default")] {
                            td { (line.configuration) } td class="text" { (chart::verdict(line)) }
                            td { (times(line.time_to_equal_error)) } td { (format!("{:.0}", point.samples)) }
                            td { (spread(&point.seconds)) } td { (number(point.rmse.median)) } td { (number(point.relmse.median)) }
                            td { (number(point.relmse_trimmed.median)) } td { (number(point.flip.median)) }
                        }
                    }
                }
            }
        }
    }
}

fn frames_table(scene: &SceneChart) -> Markup {
    html! {
        div class="wide" {
            table {
                tr {
                    th { "configuration" } th { "frames per second" }
                    @for moment in scene.frames.iter().take(1).flat_map(|frames| &frames.moments) {
                        th { "RMSE after " (format!("{:.2} s", moment.after_s)) } th { "FLIP" }
                    }
                }
                @for frames in &scene.frames {
                    tr class=[(frames.configuration == DEFAULT).then_some("default")] {
                        td { (frames.configuration) } td { (spread(&frames.fps)) }
                        @for moment in &frames.moments {
                            td { @match &moment.rmse { Some(rmse) => (spread(rmse)), None => (UNKNOWN) } }
                            td { (spread(&moment.flip)) }
                        }
                    }
                }
            }
        }
    }
}

fn display_table(scene: &SceneChart) -> Markup {
    html! {
        div class="wide" {
            table {
                tr {
                    th { "shown" } th { "samples" } th { "RMSE" } th { "FLIP" } th { "ms to render" } th { "ms to filter" }
                }
                @for shown in &scene.display {
                    tr class=[(shown.filter == FILTERS[0]).then_some("default")] {
                        td { (shown.filter) } td { (shown.samples) }
                        td { (shown.rmse.as_ref().map_or(UNKNOWN.into(), spread)) } td { (spread(&shown.flip)) }
                        td { (spread(&shown.frame_ms)) } td { (spread(&shown.filter_ms)) }
                    }
                }
            }
        }
    }
}

fn motion_table(scene: &SceneChart) -> Markup {
    html! {
        div class="wide" {
            table {
                tr {
                    th { "camera" } th class="text" { "shown" } th { "RMSE" } th { "lower by" } th { "ms to render" } th { "ms to filter" }
                }
                @for moving in &scene.motion {
                    tr class=[(moving.filter == FILTERS[0]).then_some("default")] {
                        td { (moving.path.name()) } td class="text" { (moving.filter) }
                        td { (moving.rmse.map_or("–".into(), number)) } td { (moving.times_lower.map_or("–".into(), times)) }
                        td { (spread(&moving.frame_ms)) } td { (spread(&moving.filter_ms)) }
                    }
                }
            }
        }
        p {
            small {
                "The camera moves by a quarter of the distance to near surfaces per second, or turns by 30° per second, at 60 frames per second with one sample per pixel each; errors are those of the second half of the frames. "
                "Times of the denoiser and of reprojection include the AOVs (albedo, normal and depth of each pixel)."
            }
        }
    }
}

fn intersection(chart: &Chart) -> Markup {
    html! {
        h2 { "Intersection methods" }
        p { "The error of a picture hardly shows where intersection methods fail. The figures below show it on difficult inputs; " code { "octray stability" } " has more of them." }
        (explained(MEANINGS.into_iter()))
        @for drawing in of_kernels(&chart.kernels) { (figure(&drawing)) }
        div class="wide" {
            table {
                tr { th { "method" } th class="text" { "width" } th { "ns per test" } th { "10 to 90 %" } th { "fails" } th { "error of t, p99" } }
                @for kernel in &chart.kernels {
                    tr class=[kernel.default.then_some("default")] {
                        td { (kernel.family) ": " (kernel.method) } td class="text" { (lanes(kernel)) } td { (format!("{:.2}", kernel.ns)) }
                        td { (format!("{:.2}–{:.2}", kernel.ns_spread[0], kernel.ns_spread[1])) } td { (percent(kernel.failures)) }
                        td { (kernel.p99.map_or("–".to_owned(), number)) }
                    }
                }
            }
        }
    }
}

fn source(chart: &Chart) -> Markup {
    html! {
        h2 { "Machine and build" }
        p {
            "Machine: " (chart.machine) ". Instruction sets compiled for: " (chart.machine.target_features.join(", ")) ". Taken in "
            (format!("{:.0} s", chart.seconds)) " of " (format!("{:.0} s", chart.budget_s)) " allowed; up to "
            (counted(chart.max_bounces, "bounce", "bounces")) ". The same numbers are in chart.json, pictures.csv, frames.csv, display.csv, motion.csv and kernels.csv beside this page."
        }
    }
}

fn figure(drawing: &Drawing) -> Markup {
    html! { figure { (PreEscaped(drawing.svg())) } }
}

fn lanes(kernel: &Kernel) -> &'static str {
    if kernel.lanes == 1 { "scalar" } else { "SIMD" }
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

fn times(ratio: f64) -> String {
    format!("{}×", number(ratio))
}

fn percent(share: f64) -> String {
    format!("{} %", number(100.0 * share))
}

fn spread(spread: &Spread) -> String {
    if spread.p10 == spread.p90 {
        return number(spread.median);
    }
    format!("{} ({}–{})", number(spread.median), number(spread.p10), number(spread.p90))
}
