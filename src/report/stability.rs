//! The report of `octray stability`: tables, JSON, drawings of failures and errors along a test case's axis.

use super::drawing::Drawing;
use super::figure::{Figure, Line, Look, Panel};
use super::numbers::percent;
use super::text::row;
use crate::machine::Machine;
use crate::measure::stability::{Bound, Curve, Outcome, Point, TestCase};
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::fmt::Write;

#[derive(Debug, Serialize)]
pub struct Report {
    pub schema: &'static str,
    /// Machine and build: failures depend on fused multiply-add.
    pub machine: Machine,
    /// Whether ten times as many inputs were tried.
    pub thorough: bool,
    /// Whether the default methods keep their bounds in all test cases.
    pub holds: bool,
    /// Results in the order of the test cases.
    pub test_cases: Vec<Outcome>,
}

impl Report {
    /// Builds the report of this machine.
    pub fn new(thorough: bool, test_cases: Vec<Outcome>) -> Self {
        let holds = test_cases.iter().all(|outcome| outcome.holds);
        Self { schema: "octray-stability-1", machine: Machine::current(), thorough, holds, test_cases }
    }

    /// Tests whether a default method breaks a bound.
    pub fn has_failed(&self) -> bool {
        !self.holds
    }
}

/// Width of the column of names, and of those of figures.
const NAME: isize = -28;
const FIGURE: usize = 8;

const SUMMARY: [isize; 8] = [-21, -24, 9, 8, 9, -26, 9, 9];

/// Returns a row for each test case: the default method where it is worst among the places at which it has a
/// bound, and the best other method where that is worst. Then come the bounds that the default breaks.
pub fn summary(report: &Report) -> String {
    let names = ["test case", "default *", "worst, %", "at", "error", "  best rival", "worst, %", "error"];
    let mut text = format!("\n{}", row(&SUMMARY, names));
    for Outcome { test_case, curves, .. } in &report.test_cases {
        let of_default = curves.iter().filter(|curve| curve.default).flat_map(|curve| &curve.points);
        let open: Vec<f64> =
            of_default.filter(|point| point.promises_nothing()).map(|point| point.x).collect();
        let by_figures = |a: &Point, b: &Point| {
            a.rate().total_cmp(&b.rate()).then(a.p99.unwrap_or(0.0).total_cmp(&b.p99.unwrap_or(0.0)))
        };
        let of = |default| {
            let curves = curves.iter().filter(move |curve| curve.default == default);
            // The first of equal places.
            let worst = curves.filter_map(|curve| {
                let points = curve.points.iter().filter(|point| !open.contains(&point.x));
                points.rev().max_by(|a, b| by_figures(a, b)).map(|point| (curve.method, point))
            });
            worst.min_by(|a, b| by_figures(a.1, b.1)).map_or(
                ["–"; 4].map(String::from),
                |(method, point)| {
                    let share = percent(point.rate()).trim_end_matches(" %").to_string();
                    let error = point.p99.filter(|_| test_case.error.is_some());
                    let error = error.map_or("–".into(), |p99| format!("{p99:.1e}"));
                    [method.into(), share, place(point.x), error]
                },
            )
        };
        let [rival, share, _, error] = of(false);
        let rival = [format!("  {rival}"), share, error];
        text += &row(&SUMMARY, [test_case.name.into()].into_iter().chain(of(true)).chain(rival));
    }
    text + &report.test_cases.iter().map(faults).collect::<String>()
}

/// Returns the table of a test case: a row for the failures of each method, and a second row for its error
/// where that is measured.
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
    text
}

/// Returns a line for each place where the default method of a test case breaks its bound.
fn faults(outcome: &Outcome) -> String {
    let fault = |Point { x, failures, tested, p99, bound, .. }: &Point| {
        let Bound { failures: share, p99: most } = bound.unwrap_or(Bound::NONE);
        format!(
            "THE DEFAULT FAILS in {} at {}: {} of {}, expected at most {}; error {p99:?}, at most {most:?}\n",
            outcome.test_case.name,
            place(*x),
            grouped(failures),
            grouped(tested),
            percent(share)
        )
    };
    outcome.faults().map(fault).collect()
}

/// Formats a place on an axis in fewer characters than [`FIGURE`].
fn place(x: f64) -> String {
    let text = if x == 0.0 || (1e-3..1e5).contains(&x) { format!("{x}") } else { format!("{x:e}") };
    if text.len() < FIGURE { text } else { format!("{x:.1e}") }
}

/// Returns the verdict on all test cases.
pub fn verdict(report: &Report) -> String {
    let broken = report.test_cases.iter().filter(|outcome| !outcome.holds);
    let failed: Vec<&str> = broken.map(|outcome| outcome.test_case.name).collect();
    match failed[..] {
        [] => format!(
            "The default methods (*) keep their bounds in {}.\n",
            counted(report.test_cases.len(), "test case", "test cases")
        ),
        _ => format!("THE DEFAULT METHODS (*) DO NOT KEEP THEIR BOUNDS in {}.\n", failed.join(", ")),
    }
}

/// Returns the drawings of a test case: failures, and errors where they are measured.
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

/// Returns the curves, the default first.
fn in_order(outcome: &Outcome) -> impl Iterator<Item = &Curve> {
    let of = |default| outcome.curves.iter().filter(move |curve| curve.default == default);
    of(true).chain(of(false))
}

/// Draws a line for each curve, with the points and the band that `of` returns.
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

    /// A curve of places, each with its failures of 2,000 inputs and its error. The default promises that
    /// there is no failure, except at 1e9.
    fn curve(method: &'static str, default: bool, points: &[(f64, usize, Option<f64>)]) -> Curve {
        let point = |&(x, failures, p99): &(f64, usize, Option<f64>)| {
            let bound = default.then_some(if x < 1e9 { Bound::NO_FAILURE } else { Bound::NONE });
            Point { x, tested: 2000, failures, p50: p99, p90: p99, p99, max: p99, bound }
        };
        Curve { method, default, points: points.iter().map(point).collect() }
    }

    fn outcome(error: Option<&'static str>, curves: Vec<Curve>) -> Outcome {
        let test_case = Box::leak(Box::new(TestCase { name: "far", error, ..TestCase::COMMON }));
        let holds = curves.iter().flat_map(|curve| &curve.points).all(Point::holds);
        Outcome { test_case, holds, curves }
    }

    #[test]
    fn summary_has_the_worst_of_the_default_and_the_best_rival() {
        let default =
            curve("robust", true, &[(4096.0, 3, Some(1.5e-6)), (8192.0, 3, Some(2e-6)), (1e9, 2000, None)]);
        // Bad at one place is worse than middling at both. Places where the default has no bound do not
        // count.
        let rivals = [("naive", [10, 10]), ("middling", [4, 6]), ("uneven", [0, 400])];
        let rivals = rivals.map(|(method, [a, b])| {
            curve(method, false, &[(4096.0, a, None), (8192.0, b, None), (1e9, 2000, None)])
        });
        let curves = rivals.into_iter().chain([default]).collect();
        let said = summary(&Report::new(false, vec![outcome(Some("|Δt|"), curves)]));
        let has = |row: &str| said.lines().any(|line| line.split_whitespace().eq(row.split(' ')));
        assert!(has("far robust 0.15 8192 2.0e-6 middling 0.30 –"), "{said}");
        assert!(said.contains("FAILS in far at 4096: 3 of 2,000"), "{said}");
    }

    #[test]
    fn verdict_names_the_test_cases_in_which_a_default_fails() {
        // A default that fails in one input of ten thousand, through the same code as the others.
        let broken = |places| {
            let run: Trial = Box::new(move |rng, x, counts| {
                counts.tested += 1;
                counts.failures += usize::from(x == 2.0 && rng.unit() < 1e-3);
            });
            let methods = vec![Method { name: "broken", default: true, run }];
            &*Box::leak(Box::new(TestCase { name: "far", places, methods, ..TestCase::COMMON }))
        };
        let report = |places| Report::new(false, run(&[broken(&[1.0]), broken(places)], Effort(0.1), &|| {}));
        let [good, bad] = [report(&[1.0]), report(&[1.0, 2.0])];
        assert!(!good.has_failed() && verdict(&good).contains("keep their bounds in 2 test cases."));
        assert!(bad.has_failed() && verdict(&bad).contains("BOUNDS in far."));
    }

    #[test]
    fn drawings_show_every_method_the_default_first() {
        let curves = || {
            vec![
                curve("naive", false, &[(4096.0, 10, None)]),
                curve("robust", true, &[(4096.0, 0, Some(1.5e-6))]),
            ]
        };
        let measured = outcome(Some("|Δt|"), curves());
        let lines = |mut figure: Figure| figure.panels.remove(0).lines;
        let [failures, errors] = [failures(&measured), errors(&measured, "|Δt|")].map(lines);
        assert_eq!([&failures[0].points, &failures[1].points], [&[[4096.0, 0.0]], &[[4096.0, 0.5]]]);
        assert_eq!((&failures[0].name[..], failures[0].look), ("robust (default)", Look::Default));
        assert_eq!((&errors[0].points, errors[1].points.len()), (&vec![[4096.0, 1.5e-6]], 0));
        assert_eq!((errors[0].band.len(), errors[1].band.len()), (1, 0));
        assert_eq!([drawings(&measured).len(), drawings(&outcome(None, curves())).len()], [2, 1]);
    }
}
