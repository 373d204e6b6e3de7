//! The JSON report of `octray chart`, and which drawings it has.
//!
//! For: [`Chart`], `drawings`, `verdict`.

use super::chart_drawings::of_scene;
use super::chart_kernels::intersection;
use super::drawing::Drawing;
use crate::machine::Machine;
use crate::measure::chart::kernels::Kernel;
use crate::measure::chart::{SceneChart, pictures};
use crate::wording::counted;
use serde::Serialize;

/// All figures of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Chart {
    /// [`SCHEMA`].
    pub schema: &'static str,
    /// What it was measured with.
    pub machine: Machine,
    /// Seconds allowed, for all scenes together.
    pub budget_s: f64,
    /// Seconds taken.
    pub seconds: f64,
    /// Most scattering events of a path.
    pub max_bounces: u32,
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
