//! The report of `octray chart`: JSON, a table of every scene, warnings about the figures; and its drawings.

use super::chart_drawings::of_scene;
use super::chart_kernels::intersection;
use super::drawing::Drawing;
use super::numbers::{figure, mark, times};
use super::settings::RunSettings;
use super::text::row;
use crate::measure::chart::clock::Clock;
use crate::measure::chart::configurations::DEFAULT;
use crate::measure::chart::ground_truth::SHRINK;
use crate::measure::chart::kernels::Kernel;
use crate::measure::chart::{SceneChart, motion, pictures};
use crate::measure::quantiles::Spread;
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::path::Path;

#[derive(Clone, Debug, Serialize)]
pub struct Chart {
    pub schema: &'static str,
    pub settings: RunSettings,
    /// Seconds allowed, for all scenes together.
    pub budget_s: f64,
    pub seconds: f64,
    /// Number of seeds behind every median of `pictures`.
    pub seeds: u32,
    /// The intersection methods alone, at both widths.
    pub kernels: Vec<Kernel>,
    /// Error against time, a chart a scene.
    pub scenes: Vec<SceneChart>,
}

pub const SCHEMA: &str = "octray-chart-1";

/// Returns all drawings of a chart.
pub(crate) fn drawings(chart: &Chart) -> Vec<Drawing> {
    let of_scenes = chart.scenes.iter().flat_map(|scene| of_scene(scene, chart.seeds));
    intersection(&chart.kernels).into_iter().chain(of_scenes).collect()
}

/// Returns the verdict on a configuration, in a word or two; "unreliable" where it cannot be compared.
pub(crate) fn verdict(line: &pictures::Line) -> &'static str {
    let Spread { p10, p90, .. } = line.time_to_equal_error;
    match line {
        _ if line.is_broken() => "WRONG PICTURE",
        _ if !line.reliability.reliable => "unreliable",
        _ if line.dominated_by.is_some() => "dominated",
        _ if line.configuration == DEFAULT => "default",
        _ if !line.robust => "not robust",
        _ if p10 > 1.0 => "later",
        _ if p90 < 1.0 => "sooner",
        _ => "as default",
    }
}

/// Returns the time to equal error, with a ? where it is not reliable.
pub(crate) fn equal_error(line: &pictures::Line) -> String {
    times(line.time_to_equal_error.median) + mark(line.reliability)
}

/// A run that takes longer than this many budgets gets a warning.
const MOST_OVER: f64 = 1.1;

/// Returns warnings about figures that may be unreliable.
pub(crate) fn warnings(chart: &Chart) -> Vec<String> {
    let mut warnings = Vec::new();
    let (took, budget) = (chart.seconds, chart.budget_s);
    if took > MOST_OVER * budget {
        let enough = figure(took.ceil(), 0);
        warnings.push(format!("the run took {took:.1} s of a budget of {budget} s, with the fewest samples. Give --budget {enough} or more."));
    }
    for scene in &chart.scenes {
        let name = &scene.scene;
        if scene.clock == Clock::Processor {
            warnings.push(format!(
                "the machine was busy during {name}: pictures are compared by processor time."
            ));
        }
        let unreliable = scene.pictures.iter().filter(|line| !line.reliability.reliable).count();
        if unreliable > 0 {
            let unreliable = counted(unreliable, "configuration of", "configurations of");
            warnings
                .push(format!("{unreliable} {name}: unreliable; give more --budget, or end other programs."));
        }
    }
    warnings
}

const WIDTHS: [isize; 6] = [-24, 12, 12, 12, 14, 0];

/// Returns the figures of a chart whose files are in `folder`.
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
                equal_error(line),
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
        "\nEqual error: the time to this RMSE, over the default's time to the same RMSE; a ? means unreliable.\n{} in {:.0} s\n",
        report.display(),
        chart.seconds
    )
}
