//! What `octray chart` reports: JSON, a table of every scene, warnings about the figures; and its drawings.
//!
//! For: [`Chart`], `drawings`, `verdict`, `text`, `warnings`.

use super::chart_drawings::of_scene;
use super::chart_kernels::intersection;
use super::drawing::Drawing;
use super::numbers::figure;
use super::settings::RunSettings;
use super::text::row;
use crate::measure::chart::ground_truth::SHRINK;
use crate::measure::chart::kernels::Kernel;
use crate::measure::chart::{SceneChart, motion, pictures};
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::path::Path;

/// All figures of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Chart {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// How it was measured.
    pub settings: RunSettings,
    /// Seconds allowed, for all scenes together.
    pub budget_s: f64,
    /// Seconds taken.
    pub seconds: f64,
    /// Number of seeds behind every median of `pictures`.
    pub seeds: u32,
    /// The intersection methods alone, at both widths.
    pub kernels: Vec<Kernel>,
    /// Error against time, a chart a scene.
    pub scenes: Vec<SceneChart>,
}

/// Name and version of the JSON report's form.
pub const SCHEMA: &str = "octray-chart-1";

/// All drawings of a chart.
pub(crate) fn drawings(chart: &Chart) -> Vec<Drawing> {
    let of_scenes = chart.scenes.iter().flat_map(|scene| of_scene(scene, chart.seeds));
    intersection(&chart.kernels).into_iter().chain(of_scenes).collect()
}

/// The verdict on a configuration.
pub(crate) fn verdict(line: &pictures::Line) -> String {
    let rings = line.points.iter().filter(|point| point.on_front).count();
    let place = match line.dominated_by {
        _ if line.is_broken() => "NOT the default's picture".to_owned(),
        Some(better) => format!("dominated by {better}"),
        None if rings > 0 => {
            format!("on the front at {rings} of {}", counted(line.points.len(), "point", "points"))
        }
        None => "not on the front, but within the spread of the seeds at some of its points".to_owned(),
    };
    if line.robust { place } else { place + "; not robust" }
}

/// A run that takes longer than this many budgets gets a warning.
const MOST_OVER: f64 = 1.1;
/// Above this ratio of the 90 % and 10 % quantiles of the default's times, over seeds, the machine was busy.
const BUSY: f64 = 1.5;

/// Why the figures may be unreliable.
pub(crate) fn warnings(chart: &Chart) -> Vec<String> {
    let mut warnings = Vec::new();
    let (took, budget) = (chart.seconds, chart.budget_s);
    if took > MOST_OVER * budget {
        let enough = figure(took.ceil(), 0);
        warnings.push(format!("the run took {took:.1} s of a budget of {budget} s, with the fewest samples. Give --budget {enough} or more."));
    }
    for scene in &chart.scenes {
        let last = scene.pictures.first().and_then(|line| line.points.last());
        if last.is_some_and(|point| point.seconds.p90 > BUSY * point.seconds.p10) {
            warnings.push(format!(
                "the machine was busy during {}: the same work took more than {BUSY} times as long now and then.",
                scene.scene
            ));
        }
    }
    warnings
}

fn times(ratio: f64) -> String {
    if ratio.is_finite() { format!("{}×", figure(ratio, 2)) } else { "–".into() }
}

/// The widths of the table's columns.
const WIDTHS: [isize; 6] = [-24, 12, 12, 12, 14, 0];

/// The figures of a chart whose files are in `folder`.
pub(crate) fn text(chart: &Chart, defaults: &RunSettings, folder: &Path) -> String {
    let mut text = format!("{}\n{}", chart.settings.machine, chart.settings.line(defaults));
    for scene in &chart.scenes {
        let ([width, height], [of_width, of_height]) = (scene.size, scene.frame_size);
        text += &format!(
            "\n{}, {width}×{height}, a third of {of_width}×{of_height}; the ground truth has {} samples and an error of {:.1e}\n",
            scene.scene,
            grouped(scene.truth.samples * SHRINK * SHRINK),
            scene.truth.small_rmse,
        );
        let names = ["configuration", "samples", "seconds", "RMSE", "equal error", "  verdict"];
        text += &row(&WIDTHS, names);
        for line in &scene.pictures {
            let Some(last) = line.points.last() else { continue };
            let cells = [
                line.configuration.to_owned(),
                figure(last.samples, 0),
                figure(last.seconds.median, 3),
                format!("{:.2e}", last.rmse.median),
                times(line.time_to_equal_error),
                format!("  {}", verdict(line)),
            ];
            text += &row(&WIDTHS, cells);
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
    let report = folder.join("report.html");
    text + &format!(
        "\nEqual error: the time to this RMSE, over the default's time to the same RMSE.\n{} in {:.0} s\n",
        report.display(),
        chart.seconds
    )
}
