//! The drawings of a scene in `octray chart`: pictures, frames, display filters, motion.

use super::chart::equal_error;
use super::drawing::{Drawing, file_name};
use super::figure::{Figure, Line, Look, Panel};
use super::numbers::{figure, mark};
use crate::measure::chart::clock::Clock;
use crate::measure::chart::configurations::{DEFAULT, GROUPS, Group};
use crate::measure::chart::motion::CameraPath;
use crate::measure::chart::pareto::ErrorCurve;
use crate::measure::chart::pictures::Point;
use crate::measure::chart::{SceneChart, display, motion, pictures};
use crate::measure::quantiles::Spread;
use crate::wording::counted;

type ErrorOf = fn(&Point) -> Spread;
/// The name of the axis of the usual one.
const RMSE: &str = "root mean square error (radiance)";

/// Draws a scene: pictures by RMSE, relMSE and FLIP; frames, display filters, motion.
pub fn of_scene(scene: &SceneChart, seeds: u32) -> [Drawing; 6] {
    let by = |y, error| pictures(scene, seeds, y, error);
    let name = file_name(&scene.scene);
    let figures = [
        ("pictures", by(RMSE, |point| point.rmse)),
        ("pictures-relmse", by("relMSE without the worst 0.1 % of pixels", |point| point.relmse_trimmed)),
        ("pictures-flip", by("mean FLIP of the displayed picture", |point| point.flip)),
        ("frames", frames(scene)),
        ("display", display(scene)),
        ("motion", motion(scene)),
    ];
    figures.map(|(of, figure)| Drawing { name: format!("{name}-{of}"), svg: figure.svg() })
}

/// Returns the number of a configuration, which gives it one colour in all drawings; 0 is the default's.
fn number(configuration: &str) -> usize {
    let mut names = GROUPS.into_iter().flat_map(|(_, named)| named);
    names.position(|(name, _)| *name == configuration).map_or(0, |place| place + 1)
}

/// Draws error against time on a scene: a panel for each group of configurations.
fn pictures(scene: &SceneChart, seeds: u32, y: &str, error: ErrorOf) -> Figure {
    let unit = scene.default_pass_s;
    let lines = &scene.pictures;
    let front = front_points(lines, error);
    let of = |group: Option<Group>| {
        let lines = lines.iter().filter(move |line| line.group == group);
        lines.map(move |line| drawn(line, unit, error))
    };
    let points = falling(front.iter().map(|[time, error]| [time / unit, *error]).collect());
    let name = "Pareto front".into();
    let shared = Line { name, look: Look::Front, points, ..Line::default() };
    let panels = GROUPS.into_iter().filter(|(group, _)| of(Some(*group)).next().is_some());
    let panels = panels.map(|(group, _)| Panel {
        title: match group {
            Group::Sampling => "Sampling".into(),
            Group::Speed => "The same picture at another speed".into(),
            Group::NotRobust => "Methods that are not robust".into(),
        },
        lines: std::iter::once(shared.clone()).chain(of(None)).chain(of(Some(group))).collect(),
    });
    let [width, height] = scene.size;
    let clock = match scene.clock {
        Clock::Wall => "wall time",
        Clock::Processor => "processor time of a busy machine",
    };
    let notes = vec![
        "Left is faster, lower is more accurate. Each point has twice the samples of the one before (adaptive: half the target error).".into(),
        "Pale: the Pareto front, which no robust configuration beats. Thick: the default. Thin: dominated. Dashed: not robust.".into(),
        "Numbers: the time to the RMSE of the last point, over the default's; a ? means unreliable.".into(),
        format!("{width}×{height} on one thread, {clock}, {seeds} seeds: medians, and 10 to 90 % of them."),
    ];
    Figure {
        title: format!("{}: error against time", scene.scene),
        notes,
        x: format!("time, × one pass of the default ({} ms)", figure(1e3 * unit, 2)),
        y: y.into(),
        panels: panels.collect(),
    }
}

/// Returns the line of a configuration, with times in multiples of `unit`.
fn drawn(line: &pictures::Line, unit: f64, error: ErrorOf) -> Line {
    let at = |point: &Point| [point.seconds.median / unit, error(point).median];
    let band = |point: &Point| {
        let Spread { p10, p90, .. } = error(point);
        [point.seconds.median / unit, p10, p90]
    };
    let look = match line {
        _ if line.configuration == DEFAULT => Look::Default,
        _ if !line.robust => Look::Dashed,
        _ if line.dominated_by.is_some() => Look::Behind,
        _ => Look::Plain,
    };
    Line {
        name: line.configuration.into(),
        figure: if look == Look::Default { String::new() } else { equal_error(line) },
        look,
        number: number(line.configuration),
        points: line.points.iter().map(at).collect(),
        band: match look {
            Look::Default | Look::Plain => line.points.iter().map(band).collect(),
            _ => Vec::new(),
        },
    }
}

/// Returns the points of robust configurations, in seconds, that no other robust configuration passes below.
fn front_points(lines: &[pictures::Line], error: ErrorOf) -> Vec<[f64; 2]> {
    let at = |point: &Point| [point.seconds.median, error(point).median];
    let robust = lines.iter().filter(|line| line.robust);
    let robust: Vec<Vec<_>> = robust.map(|line| line.points.iter().map(at).collect()).collect();
    let curve =
        |points: &Vec<[f64; 2]>| ErrorCurve::new(points.iter().map(|point| point.map(|x| vec![x]).into()));
    let curves: Vec<ErrorCurve> = robust.iter().map(curve).collect();
    let mut front = Vec::new();
    for (number, points) in robust.iter().enumerate() {
        let others = || curves.iter().enumerate().filter(|(other, _)| *other != number);
        let is_beaten = |level| others().any(|(_, other)| other.beats(&curves[number], level));
        front.extend(
            points.iter().enumerate().filter(|(level, _)| !is_beaten(*level)).map(|(_, point)| *point),
        );
    }
    front
}

/// Sorts points by time, and drops those whose error an earlier point already has.
fn falling(mut points: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut least = f64::INFINITY;
    points.retain(|&[_, error]| {
        let lower = error < least;
        least = least.min(error);
        lower
    });
    points
}

/// Draws the error of the accumulated picture in a window against the time since it began.
fn frames(scene: &SceneChart) -> Figure {
    let lines = scene.frames.iter().map(|frames| {
        let points = frames.moments.iter().map(|moment| Some([moment.after_s, moment.rmse?.median]));
        let figure = format!("{} fps{}", figure(frames.fps.median, 0), mark(frames.reliability));
        Line { figure, ..line(frames.configuration, number(frames.configuration), points) }
    });
    let (threads, seeds) = scene.frames.first().map_or((1, 0), |frames| (frames.threads, frames.seeds));
    let runs = format!("{}, {}", counted(threads, "thread", "threads"), counted(seeds, "seed", "seeds"));
    let note = "Numbers: passes (one sample per pixel) per second.";
    let x = "seconds of accumulation".into();
    of_frames(scene, "accumulation in a window", runs, note, x, lines.collect())
}

/// Draws the error of a picture with several display filters against the time to render and to filter it.
fn display(scene: &SceneChart) -> Figure {
    let unit = scene.display.first().map_or(f64::NAN, |shown| shown.frame_ms.median);
    let lines = display::FILTERS.into_iter().enumerate().map(|(number, filter)| {
        let shown = scene.display.iter().filter(|shown| shown.filter == filter);
        let time = |shown: &display::FilterResult| (shown.frame_ms.median + shown.filter_ms.median) / unit;
        line(filter, number, shown.map(|shown| Some([time(shown), shown.rmse?.median])))
    });
    let (threads, seeds) = scene.display.first().map_or((1, 0), |shown| (shown.threads, shown.seeds));
    let runs = format!("{}, {}", counted(threads, "thread", "threads"), counted(seeds, "seed", "seeds"));
    let note = "From left to right: 1, 4 and 16 samples a pixel. The time includes the filter.";
    let x = format!("time, × rendering one pass ({} ms)", figure(unit, 2));
    of_frames(scene, "a picture with display filters", runs, note, x, lines.collect())
}

/// Draws the error of frames of a moving camera against the time to render and to filter them.
fn motion(scene: &SceneChart) -> Figure {
    let lines = CameraPath::ALL.into_iter().enumerate().map(|(number, path)| {
        let moving = || scene.motion.iter().filter(move |moving| moving.path == path);
        let unit = moving().next().map_or(f64::NAN, |moving| moving.frame_ms.median);
        let time = |moving: &motion::MotionResult| (moving.frame_ms.median + moving.filter_ms.median) / unit;
        let lower = moving().nth(1).and_then(|moving| moving.times_lower);
        let figure = lower.map_or(String::new(), |lower| format!("÷{}", figure(lower, 1)));
        let line = line(path.name(), number, moving().map(|moving| Some([time(moving), moving.rmse?])));
        Line { figure, look: Look::Plain, ..line }
    });
    let (frames, threads) = scene.motion.first().map_or((0, 1), |moving| (moving.frames, moving.threads));
    let runs = format!("{}, {}", counted(threads, "thread", "threads"), counted(frames, "frame", "frames"));
    let note = "From top to bottom: unfiltered, reprojected, reprojected and denoised. Numbers: how much reprojection lowers the error.";
    let x = "time of a frame, × rendering it".into();
    of_frames(scene, "one pass a frame, in motion", runs, note, x, lines.collect())
}

/// Returns a line through the known points; number 0 is the default.
fn line(name: &str, number: usize, points: impl Iterator<Item = Option<[f64; 2]>>) -> Line {
    let look = if number == 0 { Look::Default } else { Look::Plain };
    Line { name: name.into(), look, number, points: points.flatten().collect(), ..Line::default() }
}

/// Draws RMSE in one plane; `runs` says how many threads measured, and how often.
fn of_frames(
    scene: &SceneChart,
    what: &str,
    runs: String,
    note: &str,
    x: String,
    lines: Vec<Line>,
) -> Figure {
    let title = format!("{}: {what}", scene.scene);
    let [width, height] = scene.frame_size;
    let unknown = "Left out: points whose error cannot be told from that of the ground truth.";
    let notes = vec![format!("{width}×{height}, {runs}."), note.into(), unknown.into()];
    Figure { title, notes, x, y: RMSE.into(), panels: vec![Panel { lines, ..Panel::default() }] }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::chart::verdict;

    /// Seven doublings from a time and an error on; the error falls with the root of time.
    fn measured(configuration: &'static str, seconds: f64, error: f64) -> pictures::Line {
        let one = |value| Spread { median: value, p10: 0.9 * value, p90: 1.1 * value };
        let points = (0..7).map(|level| f64::from(1 << level)).map(|samples| Point {
            samples,
            seconds: one(seconds * samples),
            rmse: one(error / samples.sqrt()),
            ..Point::default()
        });
        let mut line = pictures::Line {
            configuration,
            points: points.collect(),
            robust: Group::of(configuration) != Some(Group::NotRobust),
            time_to_equal_error: one(seconds * error * error),
            dominated_by: (configuration == "scalar").then_some(DEFAULT),
            ..pictures::Line::default()
        };
        line.reliability.reliable = true;
        line
    }

    #[test]
    fn verdicts_are_none_on_what_is_unreliable_or_cannot_be_told_apart() {
        for (name, seconds, expected) in [
            ("random numbers", 2.0, "later"),
            ("random numbers", 1.05, "as default"),
            ("random numbers", 0.5, "sooner"),
            ("scalar", 7.0, "dominated"),
            ("naive spheres", 0.1, "not robust"),
            (DEFAULT, 1.0, "default"),
        ] {
            assert_eq!(verdict(&measured(name, seconds, 1.0)), expected, "{name}");
        }
        let mut doubtful = measured("scalar", 7.0, 1.0);
        doubtful.reliability.reliable = false;
        assert_eq!((verdict(&doubtful), &equal_error(&doubtful)[..]), ("unreliable", "7.0×?"));
    }

    #[test]
    fn front_is_one_falling_line_of_robust_points() {
        // Quick and rough, slow and fine, and between them one that is always behind.
        let lines = vec![
            measured(DEFAULT, 1.0, 1.0),
            measured("random numbers", 0.25, 4.0),
            measured("scalar", 7.0, 1.0),
            measured("naive spheres", 0.1, 0.1),
        ];
        let front = falling(front_points(&lines, |point| point.rmse));
        assert_eq!(front[..3], [[0.25, 4.0], [0.5, 4.0 / 2f64.sqrt()], [1.0, 1.0]]);
        assert_eq!(front.len(), 2 + 7, "then the default alone");
        assert!(front.is_sorted_by(|a, b| a[0] < b[0] && a[1] > b[1]), "{front:?}");
    }
}
