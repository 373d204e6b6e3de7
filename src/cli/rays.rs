//! `octray rays`: rays per second, by kind of ray and way of tracing.

use super::CHECK_FAILED;
use super::error::CliError;
use super::memory::bytes;
use super::options::RaysOptions;
use super::ray_dump;
use super::scenes;
use super::stats;
use super::terminal::{self, figure};
use crate::bvh::check::{Statistics, check_scene};
use crate::machine::{self, Machine};
use crate::measure::rays::{self, BuildTime, Measurement};
use crate::measure::stats::RayStats;
use crate::measure::trace::{PreparedScene, TracePool, TraceMethod};

use crate::output;
use crate::scene::SceneError;
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::fmt::Write;
use std::process::ExitCode;

/// Fewest builds behind the median of the time they take.
const FEWEST_BUILDS: usize = 3;

/// The JSON report.
#[derive(Debug, Serialize)]
struct Report {
    schema: &'static str,
    machine: Machine,
    scene: String,
    triangles: usize,
    spheres: usize,
    width: u32,
    height: u32,
    seed: u32,
    /// On one thread.
    build_ms: f64,
    builds: Vec<BuildTime>,
    /// Nodes, and leaves with all that tracing reads.
    bvh_bytes: usize,
    tree: Option<Statistics>,
    /// What makes the hierarchy invalid: a fault of the program.
    fault: Option<String>,
    results: Vec<Measurement>,
    /// With `--stats`: a pass that was not timed.
    #[serde(skip_serializing_if = "Option::is_none")]
    stats: Option<Vec<RayStats>>,
    /// What was not measured, and why: each a full sentence.
    left_out: Vec<String>,
}

/// Runs the command.
pub fn run(options: RaysOptions) -> Result<ExitCode, CliError> {
    if cfg!(debug_assertions) {
        terminal::warn(
            "this is a debug build: its figures say nothing. Use cargo run --release -- rays SCENE.",
        );
    }
    let scene = scenes::load(&options.scene)?;
    scene.warnings.iter().for_each(|warning| terminal::warn(warning));
    let camera = scene.overview().ok_or_else(|| SceneError::no_overview(&scene))?;
    if let Some(folder) = &options.dump {
        output::make_folder(folder)?;
    }
    let threads = threads(&options);
    let mut building = vec![1];
    building.extend(threads.iter().filter(|&&threads| threads > 1));
    let (hierarchy, builds) = rays::build(&scene, &building, FEWEST_BUILDS);
    let tree = check_scene(&hierarchy.bvh, &scene);
    let mut report = Report {
        schema: "octray-rays-1",
        machine: Machine::current(),
        scene: scene.name.clone(),
        triangles: scene.triangles.len(),
        spheres: scene.spheres.len(),
        width: options.size[0],
        height: options.size[1],
        seed: options.seed,
        build_ms: builds[0].ms,
        builds,
        bvh_bytes: hierarchy.bytes(),
        fault: tree.as_ref().err().cloned(),
        tree: tree.ok(),
        results: Vec::new(),
        stats: options.stats.then(Vec::new),
        left_out: Vec::new(),
    };
    if !options.json {
        terminal::print(&heading(&report))?;
    }

    let prepared_scene = PreparedScene::new(&scene, hierarchy);
    let pools: Vec<TracePool> = threads.into_iter().map(TracePool::new).collect();
    let largest = pools.iter().max_by_key(|pool| pool.threads()).expect("there is a pool");
    let sets = rays::prepare(&scene, &camera, &prepared_scene, largest, options.size, options.seed);
    if let Some(folder) = &options.dump {
        if !scene.spheres.is_empty() {
            terminal::warn("the dump holds no spheres: other programs cannot find the hits on them");
        }
        ray_dump::write(folder, &scene, &sets)?;
    }
    for prepared in &sets {
        let mut ways: Vec<TraceMethod> = TraceMethod::all().collect();
        ways.retain(|way| options.traversal.is_none_or(|asked| asked == *way));
        if ways.contains(&TraceMethod::Linear) && rays::too_many_for_linear(&scene, &prepared.set) {
            ways.retain(|way| *way != TraceMethod::Linear);
            report.left_out.push(format!(
                "Testing all primitives for all {} rays would take too long: a smaller --size would do.",
                prepared.set.kind.name()
            ));
        }
        let results = rays::measure(&prepared_scene, prepared, &ways, &pools, options.passes);
        if !options.json {
            results.iter().try_for_each(|result| terminal::print(&row(result)))?;
        }
        report.results.extend(results);
        if let Some(stats) = &mut report.stats {
            stats.extend(rays::count(&prepared_scene, prepared, &ways));
        }
    }
    if options.json {
        terminal::print_json(&report)?;
    } else {
        terminal::print(&meaning(&report))?;
        if let Some(taken) = &report.stats {
            terminal::print(&stats::rays(taken))?;
        }
    }
    let failed = report.fault.is_some() || report.results.iter().any(|result| result.disagreements > 0);
    Ok(if failed { ExitCode::from(CHECK_FAILED) } else { ExitCode::SUCCESS })
}

/// The numbers of threads to measure with.
fn threads(options: &RaysOptions) -> Vec<usize> {
    match (options.threads, machine::cores()) {
        (Some(threads), _) => vec![threads],
        (None, 1) => vec![1],
        (None, cores) => vec![1, cores],
    }
}

fn heading(report: &Report) -> String {
    let mut text = format!("{}\n", report.machine);
    let Report { scene, triangles, spheres, width, height, .. } = report;
    let _ = writeln!(
        text,
        "{scene}: {}, {}; {width}×{height} primary rays",
        counted(triangles, "triangle", "triangles"),
        counted(spheres, "sphere", "spheres")
    );
    let built = |build: &BuildTime| {
        format!("{} ms on {}", figure(build.ms, 1), counted(build.threads, "thread", "threads"))
    };
    let built: Vec<String> = report.builds.iter().map(built).collect();
    let primitives = (triangles + spheres).max(1);
    let _ = writeln!(
        text,
        "hierarchy: built in {}; {}, {:.0} bytes a primitive",
        built.join(", "),
        bytes(report.bvh_bytes as u64),
        report.bvh_bytes as f64 / primitives as f64
    );
    match (&report.tree, &report.fault) {
        (Some(tree), _) => {
            let Statistics { wide_nodes, node_fill, leaves, leaf_fill, wide_depth, .. } = tree;
            let Statistics { node_visits, leaf_visits, cost, .. } = tree;
            let _ = writeln!(
                text,
                "{} of {node_fill:.1} boxes, {} of {leaf_fill:.1} primitives, {}; a random line tests {node_visits:.1} nodes and \
                 {leaf_visits:.1} leaves, cost {cost:.1}",
                counted(wide_nodes, "node", "nodes"),
                counted(leaves, "leaf", "leaves"),
                counted(wide_depth, "level", "levels")
            );
        }
        (None, fault) => {
            let _ = writeln!(text, "THE HIERARCHY IS INVALID: {}", fault.as_deref().unwrap_or_default());
        }
    }
    let _ = writeln!(
        text,
        "\n{:<9}{:>11}{:>11}  {:<10}{:>6}{:>8}{:>9}{:>19}{:>8}",
        "kind", "rays", "hits", "traversal", "lanes", "threads", "Mray/s", "10 % to 90 %", "differ"
    );
    text
}

fn row(result: &Measurement) -> String {
    let [low, high] = result.mrays_per_s_spread;
    format!(
        "{:<9}{:>11}{:>11}  {:<10}{:>6}{:>8}{:>9.2}{:>19}{:>8}\n",
        result.kind.name(),
        grouped(result.rays),
        grouped(result.hits),
        result.traversal,
        result.lanes,
        result.threads,
        result.mrays_per_s,
        format!("{low:.2} to {high:.2}"),
        grouped(result.disagreements)
    )
}

/// What the table says.
fn meaning(report: &Report) -> String {
    let mut text = String::from("\n");
    for sentence in &report.left_out {
        let _ = writeln!(text, "{sentence}");
    }
    for result in &report.results {
        if let Some(first) = &result.first_disagreement {
            let _ = writeln!(
                text,
                "{} OF {} {} RAYS DIFFER for {} on {}: first number {}, {:?} instead of {:?}",
                grouped(result.disagreements),
                grouped(result.rays),
                result.kind.name(),
                result.traversal,
                counted(result.threads, "thread", "threads"),
                grouped(first.ray),
                first.found,
                first.expected
            );
        }
    }
    if report.results.is_empty() {
        text.push_str("Nothing was measured.\n");
    } else if report.results.iter().all(|result| result.disagreements == 0) {
        text.push_str("Every way finds the hits of one scalar ray at a time, bit by bit.\n");
    }
    text
}
