//! `octray rays`: rays per second, by kind of ray and traversal.

use super::error::{CHECK_FAILED, CliError};
use super::options::RaysOptions;
use super::ray_dump;
use super::scenes;
use super::terminal;
use crate::bvh::check::check_scene;
use crate::machine::{self, Machine};
use crate::measure::rays;
use crate::measure::trace::{PreparedScene, TraceMethod, TracePool};
use crate::output;
use crate::report::rays::{Report, heading, meaning, row, warning};
use crate::report::stats;
use crate::scene::SceneError;
use std::process::ExitCode;

/// Fewest builds behind the median build time.
const FEWEST_BUILDS: usize = 3;

/// Runs the command.
pub fn run(options: RaysOptions) -> Result<ExitCode, CliError> {
    terminal::warn_of_debug_build("rays SCENE");
    let scene = scenes::load_with_warnings(&options.scene)?;
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
        ways.retain(|way| options.traversal.is_none_or(|chosen| chosen == *way));
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
    if let Some(sentence) = warning(&report.results) {
        terminal::warn(&sentence);
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
