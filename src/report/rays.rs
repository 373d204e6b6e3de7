//! The report of `octray rays`: rays per second, as a table or as JSON.

use super::baseline::{self, new_over_old};
use super::methods::hierarchy_text;
use super::numbers::{mark, ratio, times};
use super::settings::{Differences, RunSettings, differences, in_words, json};
use super::stats;
use super::text::{busy, paragraph, row};
use crate::measure::rays::{BuildTime, Measurement};
use crate::measure::stats::RayStats;
use crate::rays::{Statistics, Traversal};
use crate::render::TraversalChoice;
use crate::scene::Scene;
use crate::wording::{counted, grouped};
use serde::Serialize;
use serde_json::Value;

const SCHEMA: &str = "octray-rays-1";
/// The keys that identify a row of the results.
const KEYS: [&str; 4] = ["kind", "traversal", "lanes", "threads"];
/// The traversal with which the others are compared.
const SCALAR: &str = TraversalChoice::Through(Traversal::Scalar).name();

#[derive(Debug, Default, Serialize)]
pub struct Report {
    pub schema: &'static str,
    pub settings: RunSettings,
    /// Whether neither a busy machine nor a debug build makes the figures unreliable.
    pub reliable: bool,
    pub scene: String,
    pub triangles: usize,
    pub spheres: usize,
    /// Pixels of the picture; primary rays pass through their centres.
    pub width: u32,
    pub height: u32,
    /// Median milliseconds of a build on one thread.
    pub build_ms: f64,
    /// Build times by number of threads, one thread first.
    pub builds: Vec<BuildTime>,
    /// Memory of nodes, and of leaves with all that traversal reads.
    pub bvh_bytes: usize,
    /// Null for an invalid hierarchy.
    pub tree: Option<Statistics>,
    /// Why the hierarchy is invalid: a bug in octray.
    pub fault: Option<String>,
    /// A row a kind of rays, traversal and number of threads.
    pub results: Vec<Measurement>,
    /// Test counts of a pass that was not timed, with `--stats`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stats: Option<Vec<RayStats>>,
    /// The measurements that were left out, and why: a sentence each.
    pub left_out: Vec<String>,
    /// Differences from the settings and the scene of `--baseline`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub baseline_differences: Option<Differences>,
}

impl Report {
    /// Builds a report without results. `builds` begins with one thread.
    pub fn new(
        settings: RunSettings,
        scene: &Scene,
        builds: Vec<BuildTime>,
        bvh_bytes: usize,
        tree: Result<Statistics, String>,
    ) -> Self {
        let [width, height] = settings.size.expect("rays have a size");
        Self {
            schema: SCHEMA,
            settings,
            scene: scene.name.clone(),
            triangles: scene.triangles.len(),
            spheres: scene.spheres.len(),
            width,
            height,
            build_ms: builds.first().map_or(0.0, |build| build.ms),
            builds,
            bvh_bytes,
            fault: tree.as_ref().err().cloned(),
            tree: tree.ok(),
            ..Self::default()
        }
    }

    /// Reads an earlier report. The error says why `text` is none.
    pub fn read(text: &str) -> Result<Value, String> {
        let report: Value = serde_json::from_str(text).unwrap_or_default();
        let is_one = report["schema"] == SCHEMA && report["results"].is_array();
        is_one.then_some(report).ok_or("it is no report of rays: make one with octray rays --json".into())
    }

    /// Adds the ratios to an earlier report, and what differs in it.
    pub fn compare(&mut self, baseline: &Value) {
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
        let parts = |report: &Value| -> Value {
            let keys = ["settings", "scene", "triangles", "spheres"];
            keys.into_iter().map(|key| (key, report[key].clone())).collect()
        };
        self.baseline_differences = Some(differences(&parts(&json(self)), &parts(baseline)));
        for new in &mut self.results {
            let row = json(new);
            let is_same = |old: &&Value| KEYS.iter().all(|key| old[*key] == row[*key]);
            let old = baseline["results"].as_array().into_iter().flatten().find(is_same);
            new.over_baseline = old.map(|old| {
                let spread = [0, 1].map(|end| number(&old["mrays_per_s_spread"][end]));
                let rates =
                    [(new.mrays_per_s, new.mrays_per_s_spread), (number(&old["mrays_per_s"]), spread)];
                new_over_old(rates, new.reliability, old["reliable"] == true)
            });
        }
    }

    /// Tests whether the hierarchy is invalid, or a hit differs from that of the scalar traversal.
    pub fn has_failed(&self) -> bool {
        self.fault.is_some() || self.results.iter().any(|result| result.disagreements > 0)
    }
}

/// Returns a row of the table; two cells for each number of threads.
fn cells(first: [&str; 2], of_threads: Vec<[String; 2]>, last: &str) -> String {
    let widths = [&[-12, 6][..], &[26, 10].repeat(of_threads.len()), &[9]].concat();
    let of_threads = of_threads.iter().flatten().map(String::as_str);
    row(&widths, first.into_iter().chain(of_threads).chain([last]))
}

/// Returns the machine, the scene and its hierarchy, and the heading of the table.
pub fn heading(report: &Report, defaults: &RunSettings) -> String {
    let Report { settings, scene, triangles, spheres, width, height, builds, bvh_bytes, tree, fault, .. } =
        report;
    let (bytes, primitives) = (*bvh_bytes as f64, (triangles + spheres).max(1) as f64);
    let hierarchy = hierarchy_text(tree, fault, builds, [bytes, bytes / primitives]);
    let rate =
        |threads: &usize| [format!("Mray/s, {}", counted(threads, "thread", "threads")), "× scalar".into()];
    format!(
        "{}\n{}{scene}: {}, {}; {width}×{height} primary rays\n{}\n{}",
        settings.machine,
        settings.line(defaults),
        counted(triangles, "triangle", "triangles"),
        counted(spheres, "sphere", "spheres"),
        paragraph(&format!("hierarchy: {hierarchy}")),
        cells(["traversal", "lanes"], settings.threads.iter().map(rate).collect(), "differ")
    )
}

/// Returns the rows of a kind of rays, one for each traversal. If scalar rays are measured beside others,
/// they are in the line above the rows.
pub fn rows(results: &[Measurement]) -> String {
    let Some(first) = results.first() else { return String::new() };
    let of_traversal = |traversal| results.iter().filter(move |result| result.traversal == traversal);
    let rate = |result: &Measurement| {
        let [low, high] = result.mrays_per_s_spread;
        format!("{:.2}{} ({low:.2}–{high:.2})", result.mrays_per_s, mark(result.reliability))
    };
    let (kind, rays, hits) = (first.kind.name(), grouped(first.rays), grouped(first.hits));
    let mut text = format!("{kind}: {rays} rays, {hits} hits");
    let has_scalar = results.iter().any(|result| result.over_scalar.is_some());
    if has_scalar {
        let rates: Vec<String> = of_traversal(SCALAR).map(rate).collect();
        text += &format!("; {SCALAR} {} Mray/s", rates.join(", "));
    }
    text += "\n";
    let ways = results.iter().filter(|result| result.threads == first.threads);
    for way in ways.filter(|way| !has_scalar || way.traversal != SCALAR) {
        let over = |of: &Measurement| of.over_scalar.map_or("–".into(), |over| times(over.median));
        let rates = of_traversal(way.traversal).map(|of| [rate(of), over(of)]).collect();
        let differ = of_traversal(way.traversal).map(|of| of.disagreements).max().unwrap_or(0);
        let (name, lanes) = (format!("  {}", way.traversal), way.lanes.to_string());
        text += &cells([&name, &lanes], rates, &grouped(differ));
    }
    text
}

/// Returns the warning of a busy machine.
pub fn warning(results: &[Measurement]) -> Option<String> {
    busy(results.iter().map(|Measurement { kind, traversal, threads, reliability, .. }| {
        let threads = counted(threads, "thread", "threads");
        (*reliability, format!("{} rays, {traversal}, {threads}", kind.name()))
    }))
}

/// Returns the ratios to the baseline, if there is one: a row a result that it has.
pub fn over_baseline(report: &Report) -> String {
    let Some(differences) = &report.baseline_differences else { return String::new() };
    let rows = report.results.iter().filter_map(|result| {
        let threads = counted(result.threads, "thread", "threads");
        let name = format!("{}, {}, {}", result.kind.name(), result.traversal, stats::engine(result.lanes));
        Some(row(&[-32, -12, 24], [name, threads, ratio(result.over_baseline?)]))
    });
    let meaning = baseline::meaning("rays", "passes") + &in_words(differences);
    format!("\n{}{}", paragraph(&meaning), rows.collect::<String>())
}

/// Explains the table.
pub fn meaning(report: &Report) -> String {
    let differ = report.results.iter().filter_map(|result| {
        let first = result.first_disagreement.as_ref()?;
        Some(format!(
            "{} OF {} {} RAYS DIFFER for {} on {}: first number {}, {:?} instead of {:?}",
            grouped(result.disagreements),
            grouped(result.rays),
            result.kind.name(),
            result.traversal,
            counted(result.threads, "thread", "threads"),
            grouped(first.ray),
            first.found,
            first.expected
        ))
    });
    let mut lines: Vec<String> = report.left_out.iter().cloned().chain(differ).collect();
    if report.results.is_empty() {
        lines.push("Nothing was measured.".into());
    } else if report.results.iter().all(|result| result.disagreements == 0) {
        lines.push("Every traversal finds the hits of one scalar ray at a time, bit by bit.".into());
    }
    format!("\n{}\n", lines.join("\n"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::rays::{measure, prepare};
    use crate::measure::trace::{Accelerators, TracePool, traversals};
    use crate::render::Methods;

    #[test]
    fn a_ray_whose_hit_differs_and_an_invalid_hierarchy_are_failures() {
        let scene = crate::scene::load("builtin:three").unwrap();
        let structures =
            Accelerators::new(&scene.geometry(), crate::rays::Structure::tree_for_all(&scene.geometry()));
        let (pools, methods) = ([TracePool::new(1)], traversals().collect::<Vec<_>>());
        let mut rays =
            prepare(&scene, &scene.overview().unwrap(), &structures, &pools[0], [8, 8], 0).remove(0);
        let mut report_of = |fault: Option<&str>, off: f32| {
            rays.nearest.t.iter_mut().for_each(|t| *t += off);
            let settings = RunSettings { size: Some([8, 8]), ..RunSettings::of(Methods::default()) };
            let mut report = Report::new(settings, &scene, Vec::new(), 0, Err(String::new()));
            report.fault = fault.map(String::from);
            report.results = measure(&structures, &rays, &methods, &pools, Some(1));
            report.has_failed()
        };
        assert_eq!(
            [report_of(None, 0.0), report_of(Some("a box"), 0.0), report_of(None, 1.0)],
            [false, true, true]
        );
    }
}
