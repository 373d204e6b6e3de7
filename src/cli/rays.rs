//! `octray rays`: rays per second, by kind of ray and traversal.

use super::error::{CliError, refuse};
use super::numbers::{seed, size, threads, whole};
use super::options::{SCENE, baseline, choice, lanes, one_of};
use super::outputs::keep_inputs;
use super::terminal::{self, Printer};
use super::{ray_dump, scenes};
use crate::lane::NATIVE_WIDTH;
use crate::measure::rays;
use crate::measure::trace::{self, Accelerators, TracePool};
use crate::render::{LaneChoice, Methods, TraversalChoice};
use crate::report::rays::{Report, heading, meaning, over_baseline, rows, warning};
use crate::report::settings::RunSettings;
use crate::report::stats;
use crate::scene::SceneError;
use crate::wording::grouped;
use crate::{machine, output};
use clap::Parser;
use clap::builder::TypedValueParser;
use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;

/// Fewest builds behind the median build time.
const FEWEST_BUILDS: usize = 3;
/// Most measured passes over the rays.
const MAX_PASSES: u32 = 1_000_000;
/// Most pixels, because all rays are held in memory: 3840×2160, about 1.5 GB.
const MAX_RAYS: u32 = 1 << 23;

/// Measure rays per second, by kind of ray and traversal.
///
/// Three kinds: primary rays from a camera that sees the whole scene or from the scene's own (blocks of 4×4
/// pixels), one shadow ray from each of their hits (cosine-weighted, a quarter of the scene's diagonal long,
/// any hit), and one diffuse ray from each (cosine-weighted, nearest hit). Making the rays is not timed. All
/// traversals are measured in alternation.
///
/// Columns: lanes: rays traced at a time. Mray/s: millions of rays per second on one thread (or --threads)
/// and on all cores, the median, and in brackets from 10 to 90 % of the passes. × scalar: over one scalar ray
/// at a time, whose speed stands above the rows of its kind, on as many threads; the median of the passes.
/// differ: rays whose hit is not that of one scalar ray at a time; it should be 0, or the exit code is 1. A
/// figure with a ? is not reliable: other programs took the processor, or the passes are too few.
#[derive(Debug, clap::Parser)]
#[command(after_help = "Examples:
  octray rays bunny.obj
  octray rays builtin:knot:1000000 --size 240x135 --threads 1 --json > rays.json
  octray rays bunny.obj --dump bunny-rays")]
pub struct Options {
    #[arg(value_name = "SCENE", help = SCENE)]
    scene: OsString,
    /// Print the figures as JSON (schema octray-rays-1).
    #[arg(long)]
    json: bool,
    /// Print box, triangle and sphere tests per ray.
    #[arg(long)]
    stats: bool,
    /// Write rays, hits, triangles (see perf/README.md).
    #[arg(long, value_name = "DIR")]
    dump: Option<PathBuf>,
    /// Print ratios to an earlier report (--json).
    #[arg(long, value_name = "FILE")]
    baseline: Option<PathBuf>,
    /// Camera of primary rays.
    #[arg(long, value_name = "CAMERA", value_enum, default_value = "overview")]
    camera: CameraChoice,
    /// Pixels, one primary ray each.
    #[arg(long, value_name = "WxH", default_value = "960x540", value_parser = rays_size, allow_hyphen_values = true)]
    size: [u32; 2],
    /// Worker threads [default: one, then all cores].
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    threads: Option<usize>,
    /// Measure this traversal [default: all that suit].
    #[arg(long, value_name = "METHOD", default_value = TraversalChoice::default().name(), value_parser = choice::<TraversalChoice>(), hide_possible_values = true, hide_default_value = true, long_help = one_of::<TraversalChoice>("Measure one traversal; auto measures all that suit the kind of rays"))]
    traversal: TraversalChoice,
    /// Measure these widths: auto, 1, or auto,1 [default: all].
    #[arg(long, value_name = "LANES", value_parser = ray_lanes(), value_delimiter = ',', hide_possible_values = true)]
    lanes: Vec<LaneChoice>,
    /// Measured passes [default: a second, at least 10].
    #[arg(long, value_name = "N", value_parser = whole::<1, MAX_PASSES>, allow_hyphen_values = true)]
    passes: Option<u32>,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value = "0", value_parser = seed, allow_hyphen_values = true)]
    seed: u32,
}

/// Reads a width that traversals have: hierarchies are as wide as the vectors of the build.
fn ray_lanes() -> impl TypedValueParser<Value = LaneChoice> {
    lanes().try_map(|choice| match choice.lanes() {
        1 | NATIVE_WIDTH => Ok(choice),
        _ => Err(format!("in this build traversals have {NATIVE_WIDTH} lanes or 1: give auto or 1")),
    })
}

/// The start of primary rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum CameraChoice {
    /// Beside the scene, all of which it sees.
    Overview,
    /// The scene's own, or that of a view.
    Scene,
}

fn rays_size(text: &str) -> Result<[u32; 2], String> {
    let [width, height] = size(text)?;
    if width * height > MAX_RAYS {
        return Err(format!("all rays are held in memory: give at most {} pixels", grouped(MAX_RAYS)));
    }
    Ok([width, height])
}

impl Options {
    fn threads(&self) -> Vec<usize> {
        match (self.threads, machine::cores()) {
            (Some(threads), _) => vec![threads],
            (None, 1) => vec![1],
            (None, cores) => vec![1, cores],
        }
    }

    /// Returns the methods that were asked for, where their widths were.
    fn ways(&self) -> Vec<TraversalChoice> {
        let is_wanted = |way: &TraversalChoice| {
            let lanes = trace::lanes(*way);
            (self.traversal == TraversalChoice::Auto || self.traversal == *way)
                && (self.lanes.is_empty() || self.lanes.iter().any(|choice| choice.lanes() == lanes))
        };
        trace::traversals().filter(is_wanted).collect()
    }

    fn run_settings(&self) -> RunSettings {
        let lanes: BTreeSet<usize> = self.ways().into_iter().map(trace::lanes).collect();
        let run = RunSettings {
            seed: self.seed,
            size: Some(self.size),
            lanes: lanes.into_iter().rev().collect(),
            threads: self.threads(),
            ..RunSettings::of(Methods { traversal: self.traversal, ..Methods::default() })
        };
        let camera = if self.camera == CameraChoice::Scene { "scene" } else { "overview" };
        run.with("camera", Some(camera)).with("passes", self.passes)
    }
}

pub fn run(options: Options) -> Result<ExitCode, CliError> {
    terminal::warn_of_debug_build("rays SCENE");
    let out = Printer { json: options.json };
    if options.ways().is_empty() {
        let lanes: Vec<String> = options.lanes.iter().map(|choice| choice.lanes().to_string()).collect();
        let mend = "the traversal of --traversal has no such width: leave out one of the two";
        return Err(refuse("--lanes", lanes.join(","), mend));
    }
    let scene = scenes::load_with_warnings(&options.scene, false)?;
    let baseline = options.baseline.as_deref().map(|file| baseline(file, Report::read)).transpose()?;
    let camera = match options.camera {
        CameraChoice::Scene => scene.camera,
        CameraChoice::Overview => scene.overview().ok_or_else(|| SceneError::no_overview(&scene))?,
    };
    if let Some(folder) = &options.dump {
        let files = ray_dump::files(folder);
        keep_inputs(&scene.files, files.iter().map(|file| ("--dump", file.as_path())))?;
        output::make_folder(folder)?;
    }
    let threads = options.threads();
    let mut building = vec![1];
    building.extend(threads.iter().filter(|&&threads| threads > 1));
    let geometry = scene.geometry();
    let (hierarchy, builds) = rays::build(&geometry, &building, FEWEST_BUILDS);
    let tree = hierarchy.check(&geometry).expect("a hierarchy");
    let mut report = Report::new(options.run_settings(), &scene, builds, hierarchy.bytes(), tree);
    report.stats = options.stats.then(Vec::new);
    // Without --lanes, the widths follow from the traversals.
    let mut defaults = Options::parse_from(["rays", ""]).run_settings();
    if options.lanes.is_empty() {
        defaults.lanes.clone_from(&report.settings.lanes);
    }
    out.text(&heading(&report, &defaults))?;

    let structures = Accelerators::new(&geometry, hierarchy);
    let pools: Vec<TracePool> = threads.into_iter().map(TracePool::new).collect();
    let largest = pools.iter().max_by_key(|pool| pool.threads()).expect("there is a pool");
    let sets = rays::prepare(&scene, &camera, &structures, largest, options.size, options.seed);
    if let Some(folder) = &options.dump {
        if !scene.spheres.is_empty() {
            terminal::warn("the dump holds no spheres: other programs cannot find the hits on them");
        }
        ray_dump::write(folder, &scene, &sets)?;
    }
    for prepared in &sets {
        let mut ways = options.ways();
        if ways.contains(&TraversalChoice::Linear) && rays::too_many_for_linear(&scene, &prepared.set) {
            ways.retain(|way| *way != TraversalChoice::Linear);
            report.left_out.push(format!(
                "Testing all primitives for all {} rays would take too long: a smaller --size would do.",
                prepared.set.kind.name()
            ));
        }
        let results = rays::measure(&structures, prepared, &ways, &pools, options.passes);
        out.text(&rows(&results))?;
        report.results.extend(results);
        if let Some(stats) = &mut report.stats {
            stats.extend(rays::count(&structures, prepared, &ways));
        }
    }
    out.text(&meaning(&report))?;
    if let Some(taken) = &report.stats {
        out.text(&stats::rays(taken))?;
    }
    if let Some(baseline) = &baseline {
        report.compare(baseline);
        out.text(&over_baseline(&report))?;
    }
    let warning = warning(&report.results);
    report.reliable = warning.is_none() && !cfg!(debug_assertions);
    warning.iter().for_each(|sentence| terminal::warn(sentence));
    out.end(&report, report.has_failed())
}
