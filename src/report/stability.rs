//! The outcome of a stability recipe as drawings: failures along the axis, and errors.
//!
//! For: [`drawings`].

use super::drawing::{Drawing, Ink};
use super::figure::{Figure, Line, Look, Panel};
use super::numbers::percent;
use crate::measure::stability::{Curve, Outcome, Point};
use crate::wording::grouped;

/// The drawings of a recipe: failures, and errors where they are measured.
pub fn drawings(outcome: &Outcome) -> Vec<Drawing> {
    let failures = Drawing { name: outcome.recipe.name.to_string(), svg: failures(outcome).svg() };
    let errors = outcome.recipe.error.map(|error| Drawing {
        name: format!("{}-error", outcome.recipe.name),
        svg: errors(outcome, error).svg(),
    });
    std::iter::once(failures).chain(errors).collect()
}

fn failures(outcome: &Outcome) -> Figure {
    let tested = outcome.curves.iter().flat_map(|curve| &curve.points).map(|point| point.tested);
    let least = tested.min().unwrap_or(0).max(1);
    let seen = format!("{} cases a point: one failure is {}.", grouped(least), percent(1.0 / least as f64));
    let mut notes = vec![format!("Failure: {}.", outcome.recipe.failure), seen];
    let open = in_order(outcome).flat_map(|curve| &curve.points).filter(|point| point.promises_nothing());
    let open: Vec<String> = open.map(|point| format!("{:e}", point.x)).collect();
    if !open.is_empty() {
        notes.push(format!("The default method has no bound at {}.", open.join(", ")));
    }
    let points = |curve: &Curve| curve.points.iter().map(|point| [point.x, 100.0 * point.rate()]).collect();
    figure(outcome, notes, "failures, %", |curve| (points(curve), Vec::new()))
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
        (points, if curve.default { band.collect() } else { Vec::new() })
    };
    figure(outcome, notes, error, of)
}

/// The default first.
fn in_order(outcome: &Outcome) -> impl Iterator<Item = &Curve> {
    let of = |default| outcome.curves.iter().filter(move |curve| curve.default == default);
    of(true).chain(of(false))
}

/// A line a curve, with the points and the band that `of` gives.
fn figure(
    outcome: &Outcome,
    notes: Vec<String>,
    y: &str,
    of: impl Fn(&Curve) -> (Vec<[f64; 2]>, Vec<[f64; 3]>),
) -> Figure {
    let line = |(number, curve): (usize, &Curve)| {
        let (points, band) = of(curve);
        let (mark, look, ink) = match curve.default {
            true => (" (default)", Look::Default, Ink::Main),
            false => ("", Look::Plain, Ink::Line(number)),
        };
        Line { name: format!("{}{mark}", curve.method), look, ink, points, band, ..Line::default() }
    };
    let lines = in_order(outcome).enumerate().map(line).collect();
    Figure {
        title: outcome.recipe.title.to_string(),
        notes,
        x: outcome.recipe.axis.to_string(),
        y: y.to_string(),
        panels: vec![Panel { lines, ..Panel::default() }],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::stability::Recipe;

    #[test]
    fn drawings_show_every_method_and_mark_the_default() {
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
        let recipe = |error| &*Box::leak(Box::new(Recipe { name: "far", error, ..Recipe::COMMON }));
        let outcome = Outcome {
            recipe: recipe(Some("|Δt|")),
            holds: true,
            curves: vec![curve("robust", true), curve("naive", false)],
        };
        let drawings = drawings(&outcome);
        let names: Vec<&str> = drawings.iter().map(|drawing| &drawing.name[..]).collect();
        assert_eq!(names, ["far", "far-error"]);
        let figures = [super::failures(&outcome), super::errors(&outcome, "|Δt|")];
        let [failures, errors] = [0, 1].map(|number| &figures[number].panels[0]);
        assert_eq!(failures.lines[0].points, [[1.0, 0.0], [10.0, 0.5]]);
        assert_eq!(
            failures.lines.iter().map(|line| line.look).collect::<Vec<_>>(),
            [Look::Default, Look::Plain]
        );
        assert!(failures.lines[0].name.contains("default") && !failures.lines[1].name.contains("default"));
        assert_eq!((&errors.lines[1].points[..], errors.lines[0].band.len()), (&[[1.0, 1e-6]][..], 1));
        assert_eq!(super::drawings(&Outcome { recipe: recipe(None), ..outcome }).len(), 1);
    }
}
