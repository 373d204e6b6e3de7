//! The drawings of `octray chart`: intersection methods, pictures, frames, display filters, motion.
//!
//! For: [`Chart`], the JSON report, and [`drawings`]. May import: `plot`, `measure::chart`. Must not know:
//! files, pages.

use super::plot::{Axis, Figure, Line};
use crate::machine::Machine;
use crate::measure::chart::configurations::{DEFAULT, NAMES};
use crate::measure::chart::kernels::{Case, Kernel};
use crate::measure::chart::motion::CameraPath;
use crate::measure::chart::pictures::Point;
use crate::measure::chart::{SceneChart, display, motion, pictures};
use crate::measure::quantiles::Spread;
use crate::wording::{counted, grouped};
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

/// A figure, and its file name without an extension.
#[derive(Clone, Debug)]
pub struct Drawing {
    pub name: String,
    pub figure: Figure,
}

/// The error measure of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    Rmse,
    Relmse,
    Flip,
}

impl Measure {
    pub const ALL: [Self; 3] = [Self::Rmse, Self::Relmse, Self::Flip];

    /// In file names.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rmse => "rmse",
            Self::Relmse => "relmse",
            Self::Flip => "flip",
        }
    }
    fn label(self) -> &'static str {
        match self {
            Self::Rmse => "root mean square error (radiance)",
            Self::Relmse => "relMSE without the worst 0.1 % of pixels",
            Self::Flip => "mean FLIP of the displayed picture",
        }
    }
    fn of(self, point: &Point) -> Spread {
        match self {
            Self::Rmse => point.rmse,
            Self::Relmse => point.relmse_trimmed,
            Self::Flip => point.flip,
        }
    }
}

/// All drawings of a chart.
pub fn drawings(chart: &Chart) -> Vec<Drawing> {
    let mut all = intersection(&chart.kernels);
    for scene in &chart.scenes {
        all.extend(Measure::ALL.map(|measure| of_pictures(chart, scene, measure)));
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

/// Error against time on a scene.
pub fn of_pictures(chart: &Chart, scene: &SceneChart, measure: Measure) -> Drawing {
    let [width, height] = scene.size;
    let line = |line: &pictures::Line| {
        let at = |point: &Point| [point.seconds.median, measure.of(point).median];
        let band = |point: &Point| {
            let Spread { p10, p90, .. } = measure.of(point);
            [point.seconds.median, p10, p90]
        };
        let ringed = line.points.iter().enumerate().filter(|(_, point)| point.on_front);
        Line {
            name: line.configuration.into(),
            strong: line.configuration == DEFAULT,
            style: style(line.configuration),
            dashed: line.pictures_unlike_default.is_some() && line.configuration != DEFAULT,
            points: line.points.iter().map(at).collect(),
            band: line.points.iter().map(band).collect(),
            ringed: match measure {
                Measure::Rmse => ringed.map(|(number, _)| number).collect(),
                _ => Vec::new(),
            },
        }
    };
    let lines: Vec<Line> = scene.pictures.iter().map(line).collect();
    let mut notes = vec![
        format!(
            "{width}×{height}, one thread, {} seeds: median, and 10 to 90 % of them; every point has twice the samples of the one before (adaptive: half the target error)",
            chart.seeds
        ),
        "dashed: the default's pictures, bit by bit, at another speed; dotted: lines of equal efficiency, a factor of four apart".into(),
    ];
    if measure == Measure::Rmse {
        notes.push("rings: no other robust configuration has a smaller error in the same time".into());
    }
    let guides = if measure == Measure::Relmse { diagonals(&lines, -1.0) } else { diagonals(&lines, -0.5) };
    let name = match measure {
        Measure::Rmse => format!("{}-pictures", file_name(&scene.scene)),
        _ => format!("{}-pictures-{}", file_name(&scene.scene), measure.name()),
    };
    let figure = Figure {
        title: format!("{}: error against time", scene.scene),
        notes,
        x: Axis { label: "seconds of tracing".into(), log: true },
        y: Axis { label: measure.label().into(), log: true },
        lines,
        guides,
    };
    Drawing { name, figure }
}

/// Gives a configuration the same colour in every figure.
fn style(configuration: &str) -> Option<usize> {
    NAMES.iter().position(|name| *name == configuration)
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

/// Lines along which error falls with time to the power `slope`, each for four times the time of the next,
/// over all data.
fn diagonals(lines: &[Line], slope: f64) -> Vec<[[f64; 2]; 2]> {
    let points = || lines.iter().flat_map(|line| &line.points).filter(|point| point[1] > 0.0);
    let range = |axis: usize| {
        let values = points().map(move |point| point[axis]);
        (values.clone().fold(f64::INFINITY, f64::min), values.fold(0.0, f64::max))
    };
    let ((first, last), (low, high)) = (range(0), range(1));
    if low > high {
        return Vec::new();
    }
    // `start` is the time of a line at the largest error.
    let start = first * (low / high).powf(-1.0 / slope) / 4.0;
    let times =
        std::iter::successors(Some(start), |time| Some(4.0 * time)).take_while(|time| *time < last * 4.0);
    let end = 16.0 * last;
    times.map(|time| [[time, high], [end, high * (end / time).powf(slope)]]).collect()
}

/// Error of the accumulated picture in a window, against its frame rate.
pub fn frames(scene: &SceneChart) -> Drawing {
    let lines = scene.frames.iter().map(|frames| {
        let known = frames.moments.iter().filter_map(|moment| Some((moment, moment.rmse?)));
        let points = known.map(|(_, rmse)| [frames.fps.median, rmse.median]).collect();
        let strong = frames.configuration == DEFAULT;
        let style = style(frames.configuration);
        Line { name: frames.configuration.into(), strong, style, points, ..Line::default() }
    });
    let (threads, seeds) = scene.frames.first().map_or((1, 0), |frames| (frames.threads, frames.seeds));
    let figure = Figure {
        title: format!("{}: accumulation in a window", scene.scene),
        notes: vec![
            size_and(scene, threads, &counted(seeds, "seed", "seeds")),
            "from top to bottom: the error after 1/30 s, 1/5 s and 1 s of accumulation, including the frame in progress".into(),
        ],
        x: Axis { label: "frames per second".into(), log: true },
        y: Axis { label: Measure::Rmse.label().into(), log: true },
        lines: lines.collect(),
        guides: Vec::new(),
    };
    Drawing { name: format!("{}-frames", file_name(&scene.scene)), figure }
}

/// Error of a picture with several display filters, against the time to render and to filter it.
pub fn display(scene: &SceneChart) -> Drawing {
    let line = |(number, way): (usize, &&'static str)| {
        let shown = scene.display.iter().filter(|shown| shown.filter == *way);
        let point = |shown: &display::FilterResult| {
            Some([shown.frame_ms.median + shown.filter_ms.median, shown.rmse?.median])
        };
        Line {
            name: (*way).into(),
            strong: number == 0,
            points: shown.filter_map(point).collect(),
            ..Line::default()
        }
    };
    let seeds = scene.display.first().map_or(0, |shown| shown.seeds);
    let threads = scene.display.first().map_or(1, |shown| shown.threads);
    let figure = Figure {
        title: format!("{}: a picture with display filters", scene.scene),
        notes: vec![
            size_and(scene, threads, &counted(seeds, "seed", "seeds")),
            "from left to right: 1, 4 and 16 samples a pixel; the time includes the filter".into(),
        ],
        x: Axis { label: "milliseconds to render and to filter".into(), log: true },
        y: Axis { label: Measure::Rmse.label().into(), log: true },
        lines: display::FILTERS.iter().enumerate().map(line).collect(),
        guides: Vec::new(),
    };
    Drawing { name: format!("{}-display", file_name(&scene.scene)), figure }
}

/// Error of frames of a moving camera, against the time to render and to filter them.
pub fn motion(scene: &SceneChart) -> Drawing {
    let line = |path: CameraPath| {
        let moving = scene.motion.iter().filter(|moving| moving.path == path);
        let point = |moving: &motion::MotionResult| {
            Some([moving.frame_ms.median + moving.filter_ms.median, moving.rmse?])
        };
        Line { name: path.name().into(), points: moving.filter_map(point).collect(), ..Line::default() }
    };
    let (frames, threads) = scene.motion.first().map_or((0, 1), |moving| (moving.frames, moving.threads));
    let figure = Figure {
        title: format!("{}: one sample a frame, in motion", scene.scene),
        notes: vec![
            size_and(scene, threads, &counted(frames, "frame", "frames")),
            "from left to right: unfiltered, reprojected, reprojected and denoised".into(),
        ],
        x: Axis { label: "milliseconds to render and to filter a frame".into(), log: true },
        y: Axis { label: Measure::Rmse.label().into(), log: true },
        lines: CameraPath::ALL.into_iter().map(line).collect(),
        guides: Vec::new(),
    };
    Drawing { name: format!("{}-motion", file_name(&scene.scene)), figure }
}

fn size_and(scene: &SceneChart, threads: usize, more: &str) -> String {
    let [width, height] = scene.frame_size;
    format!("{width}×{height}, {}, {more}", counted(threads, "thread", "threads"))
}

/// Time of the intersection methods of each family, against their failure rate and their error of t.
pub fn intersection(kernels: &[Kernel]) -> Vec<Drawing> {
    let families = kernels.chunk_by(|a, b| a.family == b.family).map(|of_family| of_family[0].family);
    let mut names: Vec<&str> = families.collect();
    names.sort_unstable();
    names.dedup();
    names.iter().flat_map(|family| of_family(family, kernels)).collect()
}

fn of_family(family: &str, kernels: &[Kernel]) -> Vec<Drawing> {
    let kernels: Vec<&Kernel> = kernels.iter().filter(|kernel| kernel.family == family).collect();
    let of = |name, title, case: Case, label: &str, error: &dyn Fn(&Kernel) -> Option<f64>| Drawing {
        name: format!("kernels-{family}-{name}"),
        figure: Figure {
            title: format!("{family} intersection: time of a test, and {title}"),
            notes: vec![format!(
                "left end of a line: SIMD, right end: scalar; stability recipe {} at {}",
                case.recipe,
                grouped(case.place)
            )],
            x: Axis { label: "nanoseconds for one ray and one primitive".into(), log: true },
            y: Axis { label: label.into(), log: true },
            lines: widths(&kernels, error),
            guides: Vec::new(),
        },
    };
    let first = kernels[0];
    let failures = |kernel: &Kernel| Some(100.0 * kernel.failures);
    let mut all = vec![of("failures", "failure rate", first.failure_case, "failures, %", &failures)];
    if let Some(case) = first.error_case {
        all.push(of("errors", "error of t", case, "error of t, 99th percentile", &|kernel| kernel.p99));
    }
    all
}

/// One line a method: a point for eight lanes and a point for one.
fn widths(kernels: &[&Kernel], error: &dyn Fn(&Kernel) -> Option<f64>) -> Vec<Line> {
    let mut lines: Vec<Line> = Vec::new();
    for kernel in kernels {
        let Some(error) = error(kernel) else { continue };
        match lines.iter_mut().find(|line| line.name == kernel.method) {
            Some(line) => line.points.push([kernel.ns, error]),
            None => lines.push(Line {
                name: kernel.method.into(),
                strong: kernel.default,
                points: vec![[kernel.ns, error]],
                ..Line::default()
            }),
        }
    }
    lines
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

    #[test]
    fn diagonals_cross_all_data_with_the_slope() {
        let line = Line { points: vec![[0.01, 1.0], [1.0, 0.1]], ..Line::default() };
        let guides = diagonals(&[line], -0.5);
        for [[t0, e0], [t1, e1]] in &guides {
            assert!(((e1 / e0).ln() / (t1 / t0).ln() + 0.5).abs() < 1e-9);
        }
        let at_low: Vec<f64> = guides.iter().map(|[[time, _], _]| *time).collect();
        assert!(at_low[0] <= 0.01 / 100.0 && at_low[at_low.len() - 1] >= 0.25, "{at_low:?}");
        assert!(diagonals(&[], -0.5).is_empty());
    }
}
