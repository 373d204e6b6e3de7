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

/// An error measure.
type ErrorOf = fn(&Point) -> Spread;
/// The name of the axis of the usual one.
const RMSE: &str = "root mean square error (radiance)";

/// The drawings of a scene: pictures by RMSE, relMSE and FLIP; frames, display filters, motion.
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

/// The title of a group's panel.
fn title(group: Group) -> &'static str {
    match group {
        Group::Sampling => "Sampling",
        Group::Speed => "The same picture at another speed",
        Group::NotRobust => "Methods that are not robust",
    }
}

/// The number of a configuration, so that it has the same colour in all drawings; 0 is the default's.
fn number(configuration: &str) -> usize {
    let mut names = GROUPS.into_iter().flat_map(|(_, named)| named);
    names.position(|(name, _)| *name == configuration).map_or(0, |place| place + 1)
}

/// Error against time on a scene: a panel for each group of configurations.
fn pictures(scene: &SceneChart, seeds: u32, y: &str, error: ErrorOf) -> Figure {
    let unit = scene.default_pass_s;
    let lines = &scene.pictures;
    let front = front_points(lines, error);
    let of = |group: Option<Group>| {
        let lines = lines.iter().filter(move |line| line.group == group);
        lines.map(move |line| drawn(line, unit, error))
    };
    let points = falling(front.iter().map(|(_, [time, error])| [time / unit, *error]).collect());
    let name = "Pareto front".into();
    let shared = Line { name, look: Look::Front, points, ..Line::default() };
    let panels = GROUPS.into_iter().filter(|(group, _)| of(Some(*group)).next().is_some());
    let panels = panels.map(|(group, _)| Panel {
        title: title(group).into(),
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

/// The line of a configuration, with times in multiples of `unit`.
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

/// The points, in seconds, of robust configurations that no other robust one passes below, each with its
/// configuration.
fn front_points(lines: &[pictures::Line], error: ErrorOf) -> Vec<(&'static str, [f64; 2])> {
    let at = |point: &Point| [point.seconds.median, error(point).median];
    let robust: Vec<(&pictures::Line, ErrorCurve)> = lines
        .iter()
        .filter(|line| line.robust)
        .map(|line| {
            (line, ErrorCurve::new(line.points.iter().map(|point| at(point).map(|value| vec![value]).into())))
        })
        .collect();
    let mut found = Vec::new();
    for (number, (line, curve)) in robust.iter().enumerate() {
        let others = || robust.iter().enumerate().filter(|(other, _)| *other != number);
        let beaten = |level| others().any(|(_, (_, other))| other.beats(curve, level));
        let left = line.points.iter().enumerate().filter(|(level, _)| !beaten(*level));
        found.extend(left.map(|(_, point)| (line.configuration, at(point))));
    }
    found
}

/// By time, without the points whose error an earlier one already has.
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

/// Error of the accumulated picture in a window, against the time since it began.
fn frames(scene: &SceneChart) -> Figure {
    let lines = scene.frames.iter().map(|frames| {
        let known = frames.moments.iter().filter_map(|moment| Some([moment.after_s, moment.rmse?.median]));
        Line {
            name: frames.configuration.into(),
            figure: format!("{} fps{}", figure(frames.fps.median, 0), mark(frames.reliability)),
            look: if frames.configuration == DEFAULT { Look::Default } else { Look::Plain },
            number: number(frames.configuration),
            points: known.collect(),
            ..Line::default()
        }
    });
    let (threads, seeds) = scene.frames.first().map_or((1, 0), |frames| (frames.threads, frames.seeds));
    let notes = vec![
        size_and(scene, threads, &counted(seeds, "seed", "seeds")),
        "Numbers: passes (one sample per pixel) per second.".into(),
    ];
    of_frames(scene, "accumulation in a window", notes, "seconds of accumulation".into(), lines.collect())
}

/// Error of a picture with several display filters, against the time to render and to filter it.
fn display(scene: &SceneChart) -> Figure {
    let unit = scene.display.first().map_or(f64::NAN, |shown| shown.frame_ms.median);
    let line = |(number, filter): (usize, &&'static str)| {
        let shown = scene.display.iter().filter(|shown| shown.filter == *filter);
        let point = |shown: &display::FilterResult| {
            Some([(shown.frame_ms.median + shown.filter_ms.median) / unit, shown.rmse?.median])
        };
        let look = if number == 0 { Look::Default } else { Look::Plain };
        Line {
            name: (*filter).into(),
            look,
            number,
            points: shown.filter_map(point).collect(),
            ..Line::default()
        }
    };
    let (threads, seeds) = scene.display.first().map_or((1, 0), |shown| (shown.threads, shown.seeds));
    let notes = vec![
        size_and(scene, threads, &counted(seeds, "seed", "seeds")),
        "From left to right: 1, 4 and 16 samples a pixel. The time includes the filter.".into(),
    ];
    let x = format!("time, × rendering one pass ({} ms)", figure(unit, 2));
    let lines = display::FILTERS.iter().enumerate().map(line).collect();
    of_frames(scene, "a picture with display filters", notes, x, lines)
}

/// Error of frames of a moving camera, against the time to render and to filter them.
fn motion(scene: &SceneChart) -> Figure {
    let line = |(number, path): (usize, CameraPath)| {
        let moving = || scene.motion.iter().filter(move |moving| moving.path == path);
        let unit = moving().next().map_or(f64::NAN, |moving| moving.frame_ms.median);
        let point = |moving: &motion::MotionResult| {
            Some([(moving.frame_ms.median + moving.filter_ms.median) / unit, moving.rmse?])
        };
        let lower = moving().nth(1).and_then(|moving| moving.times_lower);
        Line {
            name: path.name().into(),
            figure: lower.map_or(String::new(), |lower| format!("÷{}", figure(lower, 1))),
            number,
            points: moving().filter_map(point).collect(),
            ..Line::default()
        }
    };
    let (frames, threads) = scene.motion.first().map_or((0, 1), |moving| (moving.frames, moving.threads));
    let notes = vec![
        size_and(scene, threads, &counted(frames, "frame", "frames")),
        "From top to bottom: unfiltered, reprojected, reprojected and denoised. Numbers: how much reprojection lowers the error.".into(),
    ];
    let lines = CameraPath::ALL.into_iter().enumerate().map(line).collect();
    of_frames(scene, "one pass a frame, in motion", notes, "time of a frame, × rendering it".into(), lines)
}

/// RMSE in one plane.
fn of_frames(scene: &SceneChart, what: &str, notes: Vec<String>, x: String, lines: Vec<Line>) -> Figure {
    let title = format!("{}: {what}", scene.scene);
    let unknown = "Left out: points whose error cannot be told from that of the ground truth.";
    let notes = notes.into_iter().chain([unknown.into()]).collect();
    Figure { title, notes, x, y: RMSE.into(), panels: vec![Panel { lines, ..Panel::default() }] }
}

fn size_and(scene: &SceneChart, threads: usize, more: &str) -> String {
    let [width, height] = scene.frame_size;
    format!("{width}×{height}, {}, {more}.", counted(threads, "thread", "threads"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::chart::ground_truth::GroundTruthInfo;
    use crate::measure::cores::Reliability;
    use crate::report::chart::verdict;
    use crate::report::drawing::{line_class, marks};

    /// Seven doublings from a time and an error on; the error falls with the root of time.
    fn measured(configuration: &'static str, seconds: f64, error: f64) -> pictures::Line {
        let one = |value| Spread { median: value, p10: 0.9 * value, p90: 1.1 * value };
        let point = |level: u32| {
            let samples = f64::from(1 << level);
            let error = one(error / samples.sqrt());
            Point {
                samples,
                seconds: one(seconds * samples),
                wall_s: one(seconds * samples),
                processor_s: one(seconds * samples),
                rmse: error,
                relmse: error,
                relmse_trimmed: error,
                flip: error,
                on_front: true,
            }
        };
        pictures::Line {
            configuration,
            group: Group::of(configuration),
            points: (0..7).map(point).collect(),
            robust: Group::of(configuration) != Some(Group::NotRobust),
            pictures_unlike_default: None,
            time_to_equal_error: one(seconds * error * error),
            dominated_by: (configuration == "scalar").then_some(DEFAULT),
            reliability: Reliability { reliable: true, pinned: true, taken: Some(0.0) },
        }
    }

    fn scene(pictures: Vec<pictures::Line>) -> SceneChart {
        let truth =
            GroundTruthInfo { samples: 2, frame_rmse: 0.1, small_rmse: 0.1, budget_s: 1.0, cached: false };
        SceneChart {
            max_bounces: 4,
            scene: "one".into(),
            size: [1, 1],
            frame_size: [3, 3],
            truth,
            default_pass_s: pictures::pass_time(&pictures[0]),
            clock: Clock::Wall,
            pictures,
            frames: Vec::new(),
            display: Vec::new(),
            motion: Vec::new(),
        }
    }

    fn panels(scene: &SceneChart) -> Vec<Panel> {
        super::pictures(scene, 8, RMSE, |point| point.rmse).panels
    }

    #[test]
    fn every_configuration_is_in_one_panel_with_a_colour_and_a_mark_of_its_own() {
        let names: Vec<&str> =
            GROUPS.into_iter().flat_map(|(_, named)| named.iter().map(|&(name, _)| name)).collect();
        let all = std::iter::once(&DEFAULT).chain(&names).map(|name| measured(name, 1.5, 1.0)).collect();
        let panels = panels(&scene(all));
        assert_eq!(panels.len(), GROUPS.len());
        for panel in &panels {
            assert_eq!((panel.lines[0].look, panel.lines[1].look), (Look::Front, Look::Default));
        }
        let mut looks = Vec::new();
        for name in names {
            let drawn: Vec<&Line> =
                panels.iter().flat_map(|panel| &panel.lines).filter(|line| line.name == name).collect();
            let [line] = drawn[..] else { panic!("{name}: {}", drawn.len()) };
            looks.push(marks(&line_class(line.number), line.number, &[[0, 0]]).into_string());
        }
        let count = looks.len();
        looks.sort();
        looks.dedup();
        assert_eq!(looks.len(), count);
    }

    #[test]
    fn verdicts_are_none_on_what_is_unreliable_or_cannot_be_told_apart() {
        let lines = [
            ("random numbers", 2.0),
            ("random numbers", 1.05),
            ("random numbers", 0.5),
            ("scalar", 7.0),
            ("naive spheres", 0.1),
            (DEFAULT, 1.0),
        ];
        let verdicts = lines.map(|(name, seconds)| verdict(&measured(name, seconds, 1.0)));
        assert_eq!(verdicts, ["later", "as default", "sooner", "dominated", "not robust", "default"]);
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
        let points = front_points(&lines, |point| point.rmse);
        assert!(points.iter().all(|(name, _)| [DEFAULT, "random numbers"].contains(name)), "{points:?}");
        let front = falling(points.into_iter().map(|(_, point)| point).collect());
        assert_eq!(front[..3], [[0.25, 4.0], [0.5, 4.0 / 2f64.sqrt()], [1.0, 1.0]]);
        assert_eq!(front.len(), 2 + 7, "then the default alone");
        assert!(front.is_sorted_by(|a, b| a[0] < b[0] && a[1] > b[1]), "{front:?}");
    }

    #[test]
    fn dominated_configurations_are_thin_and_methods_that_fail_dashed() {
        // Times are multiples of the default's sample: the same on any machine.
        for unit in [1e-4, 3.0] {
            let lines = vec![
                measured(DEFAULT, unit, 1.0),
                measured("scalar", 7.0 * unit, 1.0),
                measured("naive spheres", 0.1 * unit, 1.0),
            ];
            let panels = panels(&scene(lines));
            let drawn: Vec<&Line> = panels.iter().map(|panel| &panel.lines[2]).collect();
            assert_eq!([drawn[0].look, drawn[1].look], [Look::Behind, Look::Dashed]);
            for (line, wanted) in drawn.into_iter().zip([7.0, 0.1]) {
                assert!((line.points[0][0] / wanted - 1.0).abs() < 1e-12, "{}", line.name);
            }
        }
    }
}
