//! The JSON report of `octray chart`, and which drawings it has.
//!
//! For: [`Chart`], [`drawings`], [`verdict`]. May import: `chart_drawings`, `chart_kernels`, `measure::chart`. Must
//! not know: files, pages.

use super::chart_drawings::{Measure, display, frames, motion, of_pictures};
use super::chart_kernels::intersection;
use super::dots::DotTable;
use super::plot::Figure;
use crate::machine::Machine;
use crate::measure::chart::kernels::Kernel;
use crate::measure::chart::{SceneChart, pictures};
use crate::wording::counted;
use serde::Serialize;

/// All figures of a run.
#[derive(Clone, Debug, Serialize)]
pub struct Chart {
    pub schema: &'static str,
    pub machine: Machine,
    /// Time allowed, and time taken.
    pub budget_s: f64,
    pub seconds: f64,
    pub max_bounces: u32,
    /// Number of seeds behind every median of `pictures`.
    pub seeds: u32,
    pub kernels: Vec<Kernel>,
    pub scenes: Vec<SceneChart>,
}

pub const SCHEMA: &str = "octray-chart-1";

/// A drawing, and its file name without an extension.
#[derive(Clone, Debug)]
pub struct Drawing {
    pub name: String,
    pub kind: Kind,
}

#[derive(Clone, Debug)]
pub enum Kind {
    Lines(Figure),
    Dots(DotTable),
}

impl Drawing {
    /// The text of an SVG file.
    pub fn svg(&self) -> String {
        match &self.kind {
            Kind::Lines(figure) => figure.svg(),
            Kind::Dots(table) => table.svg(),
        }
    }
}

/// All drawings of a chart.
pub fn drawings(chart: &Chart) -> Vec<Drawing> {
    let mut all = intersection(&chart.kernels);
    for scene in &chart.scenes {
        all.extend(Measure::ALL.map(|measure| of_pictures(scene, chart.seeds, measure)));
        all.extend([frames(scene), display(scene), motion(scene)]);
    }
    all
}

/// A scene's name as part of a file name: letters and digits, and hyphens for all else.
pub fn file_name(scene: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let name: String = scene.strip_prefix("builtin:").unwrap_or(scene).chars().map(plain).collect();
    let words: Vec<&str> = name.split('-').filter(|word| !word.is_empty()).collect();
    words.join("-")
}

/// The verdict on a configuration.
pub fn verdict(line: &pictures::Line) -> String {
    let rings = line.points.iter().filter(|point| point.on_front).count();
    let place = match line.dominated_by {
        _ if line.is_broken() => "NOT the default's picture".to_owned(),
        Some(better) => format!("dominated by {better}"),
        None if rings > 0 => {
            format!("on the front at {rings} of {}", counted(line.points.len(), "point", "points"))
        }
        None => "behind the front, by less than the spread of the seeds in places".to_owned(),
    };
    if line.robust { place } else { place + "; not robust" }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_hold_nothing_that_a_shell_or_a_folder_would_mind() {
        assert_eq!(file_name("builtin:cornell-spheres"), "cornell-spheres");
        assert_eq!(file_name("../My scenes/Kitchen 2.json"), "my-scenes-kitchen-2-json");
        assert_eq!(file_name("builtin:terrain:2000"), "terrain-2000");
    }
}
