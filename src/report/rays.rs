//! What `octray rays` reports: rays per second, as a table or as JSON.

use super::Checked;
use super::numbers::{bytes, figure, mark, ratio, times};
use super::settings::{Differences, RunSettings, differences, in_words, json};
use super::stats;
use super::text::{busy, paragraph, row};
use crate::bvh::check::Statistics;
use crate::measure::cores::Reliability;
use crate::measure::rays::{BuildTime, Measurement};
use crate::measure::stats::RayStats;
use crate::measure::timed::Ratio;
use crate::render::TraversalChoice;
use crate::scene::Scene;
use crate::traverse::Traversal;
use crate::wording::{counted, grouped};
use serde::Serialize;
use serde_json::{Value, json};

/// Name and version of the JSON report's form.
const SCHEMA: &str = "octray-rays-1";
/// What names a row of the results.
const KEYS: [&str; 4] = ["kind", "traversal", "lanes", "threads"];
/// The traversal with which the others are compared.
const SCALAR: &str = TraversalChoice::Through(Traversal::Scalar).name();

/// The JSON report.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Name and version of the report's form.
    pub schema: &'static str,
    /// How the figures were measured.
    pub settings: RunSettings,
    /// Whether nothing tells of a busy machine or of a debug build.
    pub reliable: bool,
    /// Its name.
    pub scene: String,
    /// In the scene.
    pub triangles: usize,
    /// In the scene.
    pub spheres: usize,
    /// Of the picture whose pixel centres primary rays pass through, in pixels.
    pub width: u32,
    /// In pixels.
    pub height: u32,
    /// Median milliseconds of a build on one thread.
    pub build_ms: f64,
    /// By number of threads, one first.
    pub builds: Vec<BuildTime>,
    /// Memory of nodes, and of leaves with all that traversal reads.
    pub bvh_bytes: usize,
    /// Null for an invalid hierarchy.
    pub tree: Option<Statistics>,
    /// Why the hierarchy is invalid: a bug in octray.
    pub fault: Option<String>,
    /// A row a kind of rays, traversal and number of threads.
    pub results: Vec<Measurement>,
    /// With `--stats`: a pass that was not timed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stats: Option<Vec<RayStats>>,
    /// What was not measured, and why: each a full sentence.
    pub left_out: Vec<String>,
    /// With `--baseline`: what its settings and its scene do not share with these.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub baseline_differences: Option<Differences>,
}

impl Report {
    /// Without results yet; of a scene and its hierarchy, with builds of one thread first.
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
            reliable: false,
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
            results: Vec::new(),
            stats: None,
            left_out: Vec::new(),
            baseline_differences: None,
        }
    }

    /// Reads an earlier report; otherwise the reason why it is none.
    pub fn read(text: &str) -> Result<Value, String> {
        let report: Value = serde_json::from_str(text).unwrap_or_default();
        let is_one = report["schema"] == SCHEMA && report["results"].is_array();
        is_one.then_some(report).ok_or("it is no report of rays: make one with octray rays --json".into())
    }

    /// Adds the ratios to an earlier report, and what differs in it.
    pub fn compare(&mut self, baseline: &Value) {
        let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
        let parts = |report: &Value| {
            let [settings, scene, triangles, spheres] =
                ["settings", "scene", "triangles", "spheres"].map(|key| &report[key]);
            json!({ "settings": settings, "scene": scene, "triangles": triangles, "spheres": spheres })
        };
        self.baseline_differences = Some(differences(&parts(&json(self)), &parts(baseline)));
        for new in &mut self.results {
            let row = json(new);
            let is_same = |old: &&Value| KEYS.iter().all(|key| old[*key] == row[*key]);
            let old = baseline["results"].as_array().into_iter().flatten().find(is_same);
            new.over_baseline = old.map(|old| {
                let [slow, fast] = [0, 1].map(|end| number(&old["mrays_per_s_spread"][end]));
                let reliable = new.reliability.reliable && old["reliable"] == true;
                Ratio {
                    median: new.mrays_per_s / number(&old["mrays_per_s"]),
                    spread: [new.mrays_per_s_spread[0] / fast, new.mrays_per_s_spread[1] / slow],
                    rounds: 1,
                    reliability: Reliability { reliable, ..new.reliability },
                }
            });
        }
    }
}

impl Checked for Report {
    fn has_failed(&self) -> bool {
        self.fault.is_some() || self.results.iter().any(|result| result.disagreements > 0)
    }
}

/// A row of the table; two cells for each number of threads.
fn cells(first: [&str; 2], of_threads: Vec<[String; 2]>, last: &str) -> String {
    let widths = [&[-12, 6][..], &[26, 10].repeat(of_threads.len()), &[9]].concat();
    let of_threads = of_threads.iter().flatten().map(String::as_str);
    row(&widths, first.into_iter().chain(of_threads).chain([last]))
}

/// The machine, the scene and its hierarchy, and what stands above the rows.
pub fn heading(report: &Report, defaults: &RunSettings) -> String {
    let Report { settings, scene, triangles, spheres, width, height, bvh_bytes, .. } = report;
    let built = |build: &BuildTime| {
        format!("{} ms on {}", figure(build.ms, 1), counted(build.threads, "thread", "threads"))
    };
    let built: Vec<String> = report.builds.iter().map(built).collect();
    let tree = match &report.tree {
        Some(Statistics {
            wide_nodes,
            node_fill,
            leaves,
            leaf_fill,
            wide_depth,
            node_visits,
            leaf_visits,
            cost,
            ..
        }) => format!(
            "{} of {node_fill:.1} boxes, {} of {leaf_fill:.1} primitives, {}\n\
             a random line tests {node_visits:.1} nodes and {leaf_visits:.1} leaves, \
             which costs as much as {cost:.1} nodes",
            counted(wide_nodes, "node", "nodes"),
            counted(leaves, "leaf", "leaves"),
            counted(wide_depth, "level", "levels")
        ),
        None => format!("THE HIERARCHY IS INVALID: {}", report.fault.as_deref().unwrap_or_default()),
    };
    let rate =
        |threads: &usize| [format!("Mray/s, {}", counted(threads, "thread", "threads")), "× scalar".into()];
    let names = cells(["traversal", "lanes"], settings.threads.iter().map(rate).collect(), "differ");
    format!(
        "{}\n\
         {}{scene}: {}, {}; {width}×{height} primary rays\n\
         hierarchy: built in {}; {}, {:.0} bytes a primitive\n\
         {tree}\n\n{}",
        settings.machine,
        settings.line(defaults),
        counted(triangles, "triangle", "triangles"),
        counted(spheres, "sphere", "spheres"),
        built.join(", "),
        bytes(*bvh_bytes as u64),
        *bvh_bytes as f64 / (triangles + spheres).max(1) as f64,
        names
    )
}

/// The rows of a kind of rays, one a traversal; scalar rays, if others are measured beside them, stand in the
/// line above.
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

/// The warning of a busy machine.
pub fn warning(results: &[Measurement]) -> Option<String> {
    busy(results.iter().map(|Measurement { kind, traversal, threads, reliability, .. }| {
        let threads = counted(threads, "thread", "threads");
        (*reliability, format!("{} rays, {traversal}, {threads}", kind.name()))
    }))
}

/// The ratios to the baseline, if there is one: a row a result that it has.
pub fn over_baseline(report: &Report) -> String {
    let Some(differences) = &report.baseline_differences else { return String::new() };
    let rows = report.results.iter().filter_map(|result| {
        let threads = counted(result.threads, "thread", "threads");
        let name = format!("{}, {}, {}", result.kind.name(), result.traversal, stats::engine(result.lanes));
        Some(row(&[-32, -12, 24], [name, threads, ratio(result.over_baseline?)]))
    });
    let meaning = format!(
        "New over old, rays per second: of the median passes, and in brackets from the slow tenth of the new over \
         the fast tenth of the old to the reverse. {}",
        in_words(differences)
    );
    format!("\n{}{}", paragraph(&meaning), rows.collect::<String>())
}

/// The table in words.
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
    use crate::measure::trace::{Accelerators, TraceMethod, TracePool};
    use crate::render::Methods;

    #[test]
    fn a_ray_whose_hit_differs_and_an_invalid_hierarchy_are_failures() {
        let scene = crate::scene::load("builtin:three").unwrap();
        let structures =
            Accelerators::new(&scene.geometry(), crate::rays::Structure::tree_for_all(&scene.geometry()));
        let (pools, methods) = ([TracePool::new(1)], TraceMethod::all().collect::<Vec<_>>());
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
