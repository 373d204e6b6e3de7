//! The drawings of a scene in `octray chart`: pictures, frames, display filters, motion.
//!
//! For: `of_pictures`, `frames`, `display`, `motion`.

use super::drawing::{Drawing, Kind, file_name};
use super::figure::{Axis, Figure, Line, Look, Panel};
use super::numbers::figure;
use crate::measure::chart::configurations::{DEFAULT, GROUPS, Group};
use crate::measure::chart::motion::CameraPath;
use crate::measure::chart::pareto::ErrorCurve;
use crate::measure::chart::pictures::Point;
use crate::measure::chart::{SceneChart, display, motion, pictures};
use crate::measure::quantiles::Spread;
use crate::wording::counted;

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

/// The title of a group's panels.
fn title(group: Group) -> &'static str {
    match group {
        Group::Sampling => "Sampling",
        Group::Speed => "The same picture at another speed",
        Group::NotRobust => "Methods that are not robust",
    }
}

/// Error against time on a scene: a panel for each group of configurations.
pub fn of_pictures(scene: &SceneChart, seeds: u32, measure: Measure) -> Drawing {
    let unit = scene.default_sample_s;
    let lines = &scene.pictures;
    let of = |group: Option<Group>| lines.iter().filter(move |line| line.group == group);
    let front = front_points(lines, measure);
    let drawn = |line: &pictures::Line| {
        drawn(line, unit, measure, front.iter().any(|(on, _)| *on == line.configuration))
    };
    let points = falling(front.iter().map(|(_, [time, error])| [time / unit, *error]).collect());
    let front = Line { name: "front".into(), look: Look::Front, points, ..Line::default() };
    let shared: Vec<Line> = std::iter::once(front).chain(of(None).map(&drawn)).collect();
    let panels = GROUPS.into_iter().flat_map(|(group, _)| {
        let lines: Vec<Line> = of(Some(group)).map(&drawn).collect();
        if lines.is_empty() { Vec::new() } else { Panel::split(title(group), &shared, lines) }
    });
    let [width, height] = scene.size;
    let mut notes = vec![
        "Left is faster, lower is more accurate. Each point has twice the samples of the one before (adaptive: half the target error).".into(),
        "Pale band: the front, which no robust configuration beats. Blue: the default. Grey: never on the front. Dashed: not robust.".into(),
        format!("{width}×{height} on one thread, {seeds} seeds: medians, and 10 to 90 % of them."),
    ];
    if measure == Measure::Rmse {
        notes.insert(2, "Numbers: the time to the error of the last point, over the default's.".into());
    }
    let name = match measure {
        Measure::Rmse => format!("{}-pictures", file_name(&scene.scene)),
        _ => format!("{}-pictures-{}", file_name(&scene.scene), measure.name()),
    };
    let figure = Figure {
        title: format!("{}: error against time", scene.scene),
        notes,
        x: Axis {
            label: format!("time, × one sample of the default ({} ms)", figure(1e3 * unit, 2)),
            log: true,
        },
        y: Axis { label: measure.label().into(), log: true },
        panels: panels.collect(),
    };
    Drawing { name, kind: Kind::Lines(figure) }
}

/// The line of a configuration, with times in multiples of `unit`.
fn drawn(line: &pictures::Line, unit: f64, measure: Measure, on_front: bool) -> Line {
    let at = |point: &Point| [point.seconds.median / unit, measure.of(point).median];
    let band = |point: &Point| {
        let Spread { p10, p90, .. } = measure.of(point);
        [point.seconds.median / unit, p10, p90]
    };
    let look = match line {
        _ if line.configuration == DEFAULT => Look::Default,
        _ if !line.robust => Look::Dashed,
        _ if on_front => Look::Plain,
        _ => Look::Behind,
    };
    Line {
        name: line.configuration.into(),
        figure: match measure {
            Measure::Rmse if look != Look::Default => times(line.time_to_equal_error),
            _ => String::new(),
        },
        look,
        points: line.points.iter().map(at).collect(),
        band: match look {
            Look::Default | Look::Plain => line.points.iter().map(band).collect(),
            _ => Vec::new(),
        },
    }
}

/// The points, in seconds, of robust configurations that no other robust one passes below, each with its
/// configuration.
fn front_points(lines: &[pictures::Line], measure: Measure) -> Vec<(&'static str, [f64; 2])> {
    let at = |point: &Point| [point.seconds.median, measure.of(point).median];
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
        let beaten = |level| others().any(|(_, (_, other))| other.passes_below(curve, level));
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

/// A ratio with two digits, or three just around 1.
fn times(ratio: f64) -> String {
    match ratio {
        _ if !ratio.is_finite() => String::new(),
        _ if ratio < 1.995 => format!("{ratio:.2}×"),
        _ if ratio < 9.95 => format!("{ratio:.1}×"),
        _ => format!("{}×", figure(ratio, 0)),
    }
}

/// Error of the accumulated picture in a window, against the time since it began.
pub fn frames(scene: &SceneChart) -> Drawing {
    let lines = scene.frames.iter().map(|frames| {
        let known = frames.moments.iter().filter_map(|moment| Some((moment, moment.rmse?)));
        let points = known.map(|(moment, rmse)| [moment.after_s, rmse.median]).collect();
        let look = if frames.configuration == DEFAULT { Look::Default } else { Look::Plain };
        let figure = format!("{} fps", figure(frames.fps.median, 0));
        Line { name: frames.configuration.into(), figure, look, points, band: Vec::new() }
    });
    let (threads, seeds) = scene.frames.first().map_or((1, 0), |frames| (frames.threads, frames.seeds));
    let figure = Figure {
        title: format!("{}: accumulation in a window", scene.scene),
        notes: vec![
            size_and(scene, threads, &counted(seeds, "seed", "seeds")),
            "Numbers: frames of one sample per second. No point where the error is below the ground truth's."
                .into(),
        ],
        x: Axis { label: "seconds of accumulation".into(), log: true },
        y: Axis { label: Measure::Rmse.label().into(), log: true },
        panels: Panel::split("", &[], lines.collect()),
    };
    Drawing { name: format!("{}-frames", file_name(&scene.scene)), kind: Kind::Lines(figure) }
}

/// Error of a picture with several display filters, against the time to render and to filter it.
pub fn display(scene: &SceneChart) -> Drawing {
    let unit = scene.display.first().map_or(f64::NAN, |shown| shown.frame_ms.median);
    let line = |(number, filter): (usize, &&'static str)| {
        let shown = scene.display.iter().filter(|shown| shown.filter == *filter);
        let point = |shown: &display::FilterResult| {
            Some([(shown.frame_ms.median + shown.filter_ms.median) / unit, shown.rmse?.median])
        };
        let look = if number == 0 { Look::Default } else { Look::Plain };
        Line { name: (*filter).into(), look, points: shown.filter_map(point).collect(), ..Line::default() }
    };
    let (threads, seeds) = scene.display.first().map_or((1, 0), |shown| (shown.threads, shown.seeds));
    let mut notes = vec![
        size_and(scene, threads, &counted(seeds, "seed", "seeds")),
        "From left to right: 1, 4 and 16 samples a pixel. The time includes the filter.".into(),
    ];
    notes.extend(left_out(scene.display.iter().any(|shown| shown.rmse.is_none())));
    let figure = Figure {
        title: format!("{}: a picture with display filters", scene.scene),
        notes,
        x: Axis { label: format!("time, × rendering one sample ({} ms)", figure(unit, 2)), log: true },
        y: Axis { label: Measure::Rmse.label().into(), log: true },
        panels: Panel::split("", &[], display::FILTERS.iter().enumerate().map(line).collect()),
    };
    Drawing { name: format!("{}-display", file_name(&scene.scene)), kind: Kind::Lines(figure) }
}

/// Error of frames of a moving camera, against the time to render and to filter them.
pub fn motion(scene: &SceneChart) -> Drawing {
    let line = |path: CameraPath| {
        let moving = || scene.motion.iter().filter(move |moving| moving.path == path);
        let unit = moving().next().map_or(f64::NAN, |moving| moving.frame_ms.median);
        let point = |moving: &motion::MotionResult| {
            Some([(moving.frame_ms.median + moving.filter_ms.median) / unit, moving.rmse?])
        };
        let lower = moving().nth(1).and_then(|moving| moving.times_lower);
        Line {
            name: path.name().into(),
            figure: lower.map_or(String::new(), |lower| format!("÷{}", figure(lower, 1))),
            points: moving().filter_map(point).collect(),
            ..Line::default()
        }
    };
    let (frames, threads) = scene.motion.first().map_or((0, 1), |moving| (moving.frames, moving.threads));
    let mut notes = vec![
        size_and(scene, threads, &counted(frames, "frame", "frames")),
        "From top to bottom: unfiltered, reprojected, reprojected and denoised. Numbers: how much reprojection lowers the error.".into(),
    ];
    notes.extend(left_out(scene.motion.iter().any(|moving| moving.rmse.is_none())));
    let figure = Figure {
        title: format!("{}: one sample a frame, in motion", scene.scene),
        notes,
        x: Axis { label: "time of a frame, × rendering it".into(), log: true },
        y: Axis { label: Measure::Rmse.label().into(), log: true },
        panels: Panel::split("", &[], CameraPath::ALL.into_iter().map(line).collect()),
    };
    Drawing { name: format!("{}-motion", file_name(&scene.scene)), kind: Kind::Lines(figure) }
}

/// Why points are missing, if some are.
fn left_out(some: bool) -> Option<String> {
    some.then(|| "Left out: points whose error cannot be told from that of the ground truth.".into())
}

fn size_and(scene: &SceneChart, threads: usize, more: &str) -> String {
    let [width, height] = scene.frame_size;
    format!("{width}×{height}, {}, {more}.", counted(threads, "thread", "threads"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::chart::ground_truth::GroundTruthInfo;
    use crate::report::figure::MOST_LINES;

    /// Seven doublings from a time and an error on; the error falls with the root of time.
    fn measured(configuration: &'static str, seconds: f64, error: f64) -> pictures::Line {
        let one = |value| Spread { median: value, p10: 0.9 * value, p90: 1.1 * value };
        let point = |level: u32| {
            let samples = f64::from(1 << level);
            let error = one(error / samples.sqrt());
            Point {
                samples,
                seconds: one(seconds * samples),
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
            time_to_equal_error: seconds * error * error,
            dominated_by: (seconds > 1.0).then_some(DEFAULT),
        }
    }

    fn scene(pictures: Vec<pictures::Line>) -> SceneChart {
        let truth =
            GroundTruthInfo { samples: 2, frame_rmse: 0.1, small_rmse: 0.1, budget_s: 1.0, cached: false };
        SceneChart {
            scene: "one".into(),
            size: [1, 1],
            frame_size: [3, 3],
            truth,
            default_sample_s: pictures::sample_time(&pictures[0]),
            pictures,
            frames: Vec::new(),
            display: Vec::new(),
            motion: Vec::new(),
        }
    }

    fn panels(scene: &SceneChart) -> Vec<Panel> {
        match of_pictures(scene, 8, Measure::Rmse).kind {
            Kind::Lines(figure) => figure.panels,
            Kind::Dots(_) => panic!("lines"),
        }
    }

    #[test]
    fn every_configuration_is_in_one_panel_of_at_most_six_lines() {
        let names = || GROUPS.into_iter().flat_map(|(_, named)| named.iter().map(|&(name, _)| name));
        let all = std::iter::once(DEFAULT).chain(names()).map(|name| measured(name, 1.5, 1.0)).collect();
        let panels = panels(&scene(all));
        assert!(panels.len() > GROUPS.len(), "the largest group has two panels");
        for panel in &panels {
            assert!(panel.lines.len() <= MOST_LINES, "{}: {}", panel.title, panel.lines.len());
            assert_eq!((panel.lines[0].look, panel.lines[1].look), (Look::Front, Look::Default));
        }
        for name in names() {
            let drawn = panels.iter().flat_map(|panel| &panel.lines).filter(|line| line.name == name);
            assert_eq!(drawn.count(), 1, "{name}");
        }
    }

    #[test]
    fn times_are_multiples_of_the_defaults_sample_on_any_machine() {
        let lines = |unit| vec![measured(DEFAULT, unit, 1.0), measured("scalar", 6.0 * unit, 1.0)];
        for unit in [1e-4, 3.0] {
            let panels = panels(&scene(lines(unit)));
            let places: Vec<f64> = panels[0].lines.iter().map(|line| line.points[0][0]).collect();
            for (place, wanted) in places.into_iter().zip([1.0, 1.0, 6.0]) {
                assert!((place / wanted - 1.0).abs() < 1e-12, "{place}");
            }
        }
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
        let points = front_points(&lines, Measure::Rmse);
        assert!(points.iter().all(|(name, _)| [DEFAULT, "random numbers"].contains(name)), "{points:?}");
        let front = falling(points.into_iter().map(|(_, point)| point).collect());
        assert_eq!(front[..3], [[0.25, 4.0], [0.5, 4.0 / 2f64.sqrt()], [1.0, 1.0]]);
        assert_eq!(front.len(), 2 + 7, "then the default alone");
        assert!(front.is_sorted_by(|a, b| a[0] < b[0] && a[1] > b[1]), "{front:?}");
    }

    #[test]
    fn configurations_never_on_the_front_are_grey_and_methods_that_fail_dashed() {
        let lines = vec![
            measured(DEFAULT, 1.0, 1.0),
            measured("scalar", 7.0, 1.0),
            measured("naive spheres", 0.1, 1.0),
        ];
        let panels = panels(&scene(lines));
        let looks: Vec<Look> = panels.iter().map(|panel| panel.lines[2].look).collect();
        assert_eq!(looks, [Look::Behind, Look::Dashed]);
        assert_eq!(panels[0].lines[2].figure, "7.0×");
    }

    #[test]
    fn ratios_have_the_digits_that_tell_them_apart() {
        assert_eq!([1.004, 0.789, 4.13, 12.4].map(times), ["1.00×", "0.79×", "4.1×", "12×"]);
        assert_eq!(times(f64::NAN), "");
    }
}
