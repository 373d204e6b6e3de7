//! The outcome of a stability recipe as figures: failures along the axis, and errors.
//!
//! For: [`figures`].

use super::figure::{Axis, Figure, Line, Look, Panel};
use super::numbers::percent;
use crate::measure::stability::{Curve, Outcome, Point};
use crate::wording::grouped;

/// The figures of a recipe, each with a name for its file: failures, and errors where they are measured.
pub fn figures(outcome: &Outcome) -> Vec<(String, Figure)> {
    let failures = (outcome.recipe.to_string(), failures(outcome));
    let errors = outcome.error.map(|error| (format!("{}-error", outcome.recipe), errors(outcome, error)));
    [Some(failures), errors].into_iter().flatten().collect()
}

fn failures(outcome: &Outcome) -> Figure {
    let tested = outcome.curves.iter().flat_map(|curve| &curve.points).map(|point| point.tested);
    let least = tested.min().unwrap_or(0).max(1);
    let seen = format!("{} cases a point: one failure is {}.", grouped(least), percent(1.0 / least as f64));
    let mut notes = vec![format!("Failure: {}.", outcome.failure), seen];
    let open = in_order(outcome).flat_map(|curve| &curve.points).filter(|point| point.promises_nothing());
    let open: Vec<String> = open.map(|point| format!("{:e}", point.x)).collect();
    if !open.is_empty() {
        notes.push(format!("The default method has no bound at {}.", open.join(", ")));
    }
    let of = |curve: &Curve| Line {
        points: curve.points.iter().map(|point| [point.x, 100.0 * point.rate()]).collect(),
        ..line(curve)
    };
    figure(outcome, notes, "failures, %", in_order(outcome).map(of).collect())
}

fn errors(outcome: &Outcome, error: &str) -> Figure {
    let notes = vec![
        format!("{error} where the method did not fail: 99th percentile."),
        "The band of the default method goes from its median to its largest error.".into(),
    ];
    let of = |curve: &Curve| {
        let with = |y: fn(&Point) -> Option<f64>| {
            curve.points.iter().filter_map(move |point| Some((point.x, y(point)?)))
        };
        let points = with(|point| point.p99).map(|(x, p99)| [x, p99]).collect();
        let spread = with(|point| point.p50).zip(with(|point| point.max));
        let band = spread.map(|((x, p50), (_, max))| [x, p50, max]);
        Line { points, band: if curve.default { band.collect() } else { Vec::new() }, ..line(curve) }
    };
    figure(outcome, notes, error, in_order(outcome).map(of).collect())
}

/// The default first, so that it has the same colour in all figures.
fn in_order(outcome: &Outcome) -> impl Iterator<Item = &Curve> {
    let of = |default| outcome.curves.iter().filter(move |curve| curve.default == default);
    of(true).chain(of(false))
}

fn line(curve: &Curve) -> Line {
    let name = if curve.default { format!("{} (default)", curve.method) } else { curve.method.to_string() };
    let look = if curve.default { Look::Default } else { Look::Plain };
    Line { name, look, ..Line::default() }
}

fn figure(outcome: &Outcome, notes: Vec<String>, y: &str, lines: Vec<Line>) -> Figure {
    Figure {
        title: outcome.title.to_string(),
        notes,
        x: Axis { label: outcome.axis.to_string(), log: true },
        y: Axis { label: y.to_string(), log: true },
        panels: Panel::split("", &[], lines),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_show_every_method_and_mark_the_default() {
        let point = |x, failures, p99| Point {
            x,
            tested: 1000,
            failures,
            p50: p99,
            p90: p99,
            p99,
            max: p99.map(|p99: f64| 2.0 * p99),
            bound: None,
        };
        let curve = |method, default| Curve {
            method,
            default,
            points: vec![point(1.0, 0, Some(1e-6)), point(10.0, 5, None)],
        };
        let outcome = Outcome {
            recipe: "far",
            title: "Far away",
            axis: "distance",
            failure: "missed",
            error: Some("|Δt|"),
            source: "somebody",
            holds: true,
            curves: vec![curve("robust", true), curve("naive", false)],
        };
        let figures = figures(&outcome);
        let names: Vec<&str> = figures.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["far", "far-error"]);
        let [failures, errors] = [0, 1].map(|number| &figures[number].1.panels[0]);
        assert_eq!(failures.lines[0].points, [[1.0, 0.0], [10.0, 0.5]]);
        assert_eq!(
            failures.lines.iter().map(|line| line.look).collect::<Vec<_>>(),
            [Look::Default, Look::Plain]
        );
        assert!(failures.lines[0].name.contains("default") && !failures.lines[1].name.contains("default"));
        assert_eq!((&errors.lines[1].points[..], errors.lines[0].band.len()), (&[[1.0, 1e-6]][..], 1));
        assert_eq!(super::figures(&Outcome { error: None, ..outcome }).len(), 1);
    }
}
