//! What `octray stability` reports, as a table or as JSON.
//!
//! For: [`Report`], [`table`], [`verdict`].

use super::numbers::percent;
use super::text::row;
use crate::machine::Machine;
use crate::measure::stability::{Bound, Curve, Outcome, Point, Recipe};
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
    /// Were ten times as many cases tried?
    pub thorough: bool,
    /// Do the default methods keep their bounds in all recipes?
    pub holds: bool,
    /// In the order of the list.
    pub recipes: Vec<Outcome>,
}

/// Width of the column of names, and of those of figures.
const NAME: isize = -28;
const FIGURE: usize = 8;

/// A recipe: a row a method for its failures, and a second row for its error where that is measured.
pub fn table(outcome: &Outcome) -> String {
    let Outcome { recipe, curves, .. } = outcome;
    let Recipe { name, title, axis, failure, error, .. } = recipe;
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
    let failed: Vec<&str> =
        report.recipes.iter().filter(|outcome| !outcome.holds).map(|outcome| outcome.recipe.name).collect();
    match failed[..] {
        [] => format!(
            "The default methods (*) keep their bounds in {}. In brackets: places where they have no bound.\n",
            counted(report.recipes.len(), "recipe", "recipes")
        ),
        _ => format!("THE DEFAULT METHODS (*) DO NOT KEEP THEIR BOUNDS in {}.\n", failed.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(failures: usize) -> Outcome {
        let point = Point {
            x: 4096.0,
            tested: 2000,
            failures,
            p50: None,
            p90: None,
            p99: Some(1.5e-6),
            max: None,
            bound: Some(Bound::NO_FAILURE),
        };
        Outcome {
            recipe: Box::leak(Box::new(Recipe { name: "far", error: Some("|Δt|"), ..Recipe::COMMON })),
            holds: point.holds(),
            curves: vec![Curve { method: "robust", default: true, points: vec![point] }],
        }
    }

    #[test]
    fn table_marks_the_default_and_tells_its_faults() {
        let good = table(&outcome(0));
        let bad = table(&outcome(3));
        let has = |text: &str, row: &[&str]| {
            text.lines().any(|line| line.split_whitespace().eq(row.iter().copied()))
        };
        assert!(
            has(&good, &["4096"]) && has(&good, &["robust", "*", "0"]) && has(&good, &["1.5e-6"]),
            "{good}"
        );
        assert!(!good.contains("FAILS") && bad.contains("FAILS at 4096: 3 of 2,000"), "{bad}");
    }

    #[test]
    fn verdict_names_the_recipes_in_which_a_default_fails() {
        let report = |recipes: Vec<Outcome>| Report {
            schema: "",
            thorough: false,
            machine: Machine::current(),
            holds: recipes.iter().all(|outcome| outcome.holds),
            recipes,
        };
        assert!(verdict(&report(vec![outcome(0)])).contains("keep their bounds in 1 recipe."));
        assert!(verdict(&report(vec![outcome(0), outcome(1)])).contains("BOUNDS in far."));
    }

    #[test]
    fn places_are_short() {
        assert_eq!(
            [0.0, 1e-6, 0.02, 4096.0, 1e5, 4294967296.0].map(place),
            ["0", "1e-6", "0.02", "4096", "1e5", "4.3e9"]
        );
    }
}
