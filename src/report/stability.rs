//! What `octray stability` reports: tables, JSON, drawings of failures and errors along a test case's axis.

use super::Checked;
use super::drawing::Drawing;
use super::figure::{Figure, Line, Look, Panel};
use super::numbers::percent;
use super::text::row;
use crate::machine::Machine;
use crate::measure::stability::{Bound, Curve, Outcome, Point, TestCase};
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::fmt::Write;

/// The JSON report.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Name and version of the report's form.
    pub schema: &'static str,
    /// What the program was built for: failures depend on fused multiply-add.
    pub machine: Machine,
    /// Were ten times as many inputs tried?
    pub thorough: bool,
    /// Do the default methods keep their bounds in all test cases?
    pub holds: bool,
    /// In the order of the list.
    pub test_cases: Vec<Outcome>,
}

impl Report {
    /// Made on this machine.
    pub fn new(thorough: bool, test_cases: Vec<Outcome>) -> Self {
        let holds = test_cases.iter().all(|outcome| outcome.holds);
        Self { schema: "octray-stability-1", machine: Machine::current(), thorough, holds, test_cases }
    }
}

impl Checked for Report {
    fn has_failed(&self) -> bool {
        !self.holds
    }
}

/// Width of the column of names, and of those of figures.
const NAME: isize = -28;
const FIGURE: usize = 8;

/// A test case: a row a method for its failures, and a second row for its error where that is measured.
pub fn table(outcome: &Outcome) -> String {
    let Outcome { test_case, curves, .. } = outcome;
    let TestCase { name, title, axis, failure, error, .. } = test_case;
    let mut text = format!("\n{name}: {title}\n  %: {failure}");
    if let Some(error) = error {
        let _ = write!(text, "; below it {error}, 99th percentile");
    }
    let _ = writeln!(text, "\n  by {axis}:");
    let places = curves.first().map_or(&[][..], |curve| &curve.points);
    let widths = [&[NAME][..], &vec![FIGURE as isize; places.len()]].concat();
    let mut add = |name: String, figure: &dyn Fn(&Point) -> String, points: &[Point]| {
        text += &row(&widths, std::iter::once(name).chain(points.iter().map(figure)));
    };
    add(String::new(), &|point| place(point.x), places);
    for Curve { method, default, points } in curves {
        let failures = |point: &Point| {
            let share = percent(point.rate()).trim_end_matches(" %").to_string();
            if point.promises_nothing() { format!("({share})") } else { share }
        };
        add(format!("  {method}{}", if *default { " *" } else { "" }), &failures, points);
        if error.is_some() {
            let error = |point: &Point| point.p99.map_or("-".into(), |p99| format!("{p99:.1e}"));
            add(String::new(), &error, points);
        }
    }
    for Point { x, failures, tested, p99, bound, .. } in outcome.faults() {
        let Bound { failures: share, p99: most } = bound.unwrap_or(Bound::NONE);
        let _ = writeln!(
            text,
            "  THE DEFAULT FAILS at {}: {} of {}, expected at most {}; error {p99:?}, at most {most:?}",
            place(*x),
            grouped(failures),
            grouped(tested),
            percent(share)
        );
    }
    text
}

/// A place on an axis, in fewer characters than [`FIGURE`].
fn place(x: f64) -> String {
    let text = if x == 0.0 || (1e-3..1e5).contains(&x) { format!("{x}") } else { format!("{x:e}") };
    if text.len() < FIGURE { text } else { format!("{x:.1e}") }
}

/// The tables in words.
pub fn verdict(report: &Report) -> String {
    let broken = report.test_cases.iter().filter(|outcome| !outcome.holds);
    let failed: Vec<&str> = broken.map(|outcome| outcome.test_case.name).collect();
    match failed[..] {
        [] => format!(
            "The default methods (*) keep their bounds in {}. In brackets: places where they have no bound.\n",
            counted(report.test_cases.len(), "test case", "test cases")
        ),
        _ => format!("THE DEFAULT METHODS (*) DO NOT KEEP THEIR BOUNDS in {}.\n", failed.join(", ")),
    }
}

/// The drawings of a test case: failures, and errors where they are measured.
pub fn drawings(outcome: &Outcome) -> Vec<Drawing> {
    let failures = Drawing { name: outcome.test_case.name.to_string(), svg: failures(outcome).svg() };
    let errors = outcome.test_case.error.map(|error| Drawing {
        name: format!("{}-error", outcome.test_case.name),
        svg: errors(outcome, error).svg(),
    });
    std::iter::once(failures).chain(errors).collect()
}

fn failures(outcome: &Outcome) -> Figure {
    let tested = outcome.curves.iter().flat_map(|curve| &curve.points).map(|point| point.tested);
    let least = tested.min().unwrap_or(0).max(1);
    let seen = format!("{} inputs a point: one failure is {}.", grouped(least), percent(1.0 / least as f64));
    let mut notes = vec![format!("Failure: {}.", outcome.test_case.failure), seen];
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
        let ends = with(|point| point.p50).zip(with(|point| point.max));
        let band = ends.map(|((x, p50), (_, max))| [x, p50, max]);
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
        let (mark, look) = if curve.default { (" (default)", Look::Default) } else { ("", Look::Plain) };
        Line { name: format!("{}{mark}", curve.method), look, number, points, band, ..Line::default() }
    };
    let lines = in_order(outcome).enumerate().map(line).collect();
    Figure {
        title: outcome.test_case.title.to_string(),
        notes,
        x: outcome.test_case.axis.to_string(),
        y: y.to_string(),
        panels: vec![Panel { lines, ..Panel::default() }],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::stability::{Effort, Method, Trial, run};

    /// Two methods at one place, where the default has so many failures.
    fn test_case(error: Option<&'static str>) -> &'static TestCase {
        Box::leak(Box::new(TestCase { name: "far", error, ..TestCase::COMMON }))
    }

    fn outcome(failures: usize) -> Outcome {
        let point = |failures, p99| Point {
            x: 4096.0,
            tested: 2000,
            failures,
            p50: p99,
            p90: p99,
            p99,
            max: p99.map(|p99: f64| 2.0 * p99),
            bound: Some(Bound::NO_FAILURE),
        };
        let robust = point(failures, Some(1.5e-6));
        let naive = Point { bound: None, ..point(10, None) };
        Outcome {
            test_case: test_case(Some("|Δt|")),
            holds: robust.holds(),
            curves: vec![
                Curve { method: "naive", default: false, points: vec![naive] },
                Curve { method: "robust", default: true, points: vec![robust] },
            ],
        }
    }

    #[test]
    fn table_marks_the_default_and_tells_its_faults() {
        let good = table(&outcome(0));
        let bad = table(&outcome(3));
        let has = |row: &[&str]| good.lines().any(|line| line.split_whitespace().eq(row.iter().copied()));
        assert!(has(&["4096"]) && has(&["robust", "*", "0"]) && has(&["1.5e-6"]), "{good}");
        assert!(!good.contains("FAILS") && bad.contains("FAILS at 4096: 3 of 2,000"), "{bad}");
    }

    #[test]
    fn verdict_names_the_test_cases_in_which_a_default_fails() {
        let report = |test_cases: Vec<Outcome>| Report::new(false, test_cases);
        assert!(verdict(&report(vec![outcome(0)])).contains("keep their bounds in 1 test case."));
        assert!(verdict(&report(vec![outcome(0), outcome(1)])).contains("BOUNDS in far."));
        // A default that fails in one input of ten thousand, through the same code as the others.
        let broken = |places| {
            let run: Trial = Box::new(move |rng, x, counts| {
                counts.tested += 1;
                counts.failures += usize::from(x == 2.0 && rng.unit() < 1e-3);
            });
            let methods = vec![Method { name: "broken", default: true, run }];
            &*Box::leak(Box::new(TestCase { name: "far", places, methods, ..TestCase::COMMON }))
        };
        let failed =
            |places| report(run(&[broken(&[1.0]), broken(places)], Effort(0.1), &|| {})).has_failed();
        assert_eq!([failed(&[1.0]), failed(&[1.0, 2.0])], [false, true]);
    }

    #[test]
    fn places_are_short() {
        assert_eq!(
            [0.0, 1e-6, 0.02, 4096.0, 1e5, 4294967296.0].map(place),
            ["0", "1e-6", "0.02", "4096", "1e5", "4.3e9"]
        );
    }

    #[test]
    fn drawings_show_every_method_the_default_first() {
        let outcome = outcome(0);
        let names: Vec<String> = drawings(&outcome).into_iter().map(|drawing| drawing.name).collect();
        assert_eq!(names, ["far", "far-error"]);
        let [failures, errors] =
            [failures(&outcome), errors(&outcome, "|Δt|")].map(|mut figure| figure.panels.remove(0).lines);
        assert_eq!([&failures[0].points, &failures[1].points], [&[[4096.0, 0.0]], &[[4096.0, 0.5]]]);
        assert_eq!((&failures[0].name[..], failures[0].look), ("robust (default)", Look::Default));
        assert_eq!((&failures[1].name[..], failures[1].look), ("naive", Look::Plain));
        assert_eq!((&errors[0].points, errors[1].points.len()), (&vec![[4096.0, 1.5e-6]], 0));
        assert_eq!((errors[0].band.len(), errors[1].band.len()), (1, 0));
        assert_eq!(drawings(&Outcome { test_case: test_case(None), ..outcome }).len(), 1);
    }
}
