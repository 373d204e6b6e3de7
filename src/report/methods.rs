//! The methods that a scene gets, and why: its traversal, its hierarchy, its defaults. A part of what `octray
//! inspect` reports.

use super::numbers::figure;
use crate::buffers::Features;
use crate::lane::{F32x8, Lane};
use crate::machine;
use crate::measure::rays::{self, BuildTime};
use crate::rays::{Kind, MAX_LIST_COST, Statistics};
use crate::render::{LaneChoice, Methods, features_of};
use crate::scene::Scene;
use crate::wording::{counted, grouped};
use indicatif::DecimalBytes;
use serde::Serialize;

/// The default traversal, and why.
#[derive(Debug, Serialize)]
pub struct TraversalReport {
    /// The traversal of camera rays, as `--traversal` names it.
    pub primary: &'static str,
    /// The traversal of rays after a bounce.
    bounces: &'static str,
    /// Cost of testing every primitive, per ray, in units of a sphere test.
    linear_cost: usize,
    /// Up to this cost, testing every primitive is faster than a hierarchy.
    most_linear_cost: usize,
}

/// The bounding volume hierarchy: how long it takes to build, its size, its shape.
#[derive(Debug, Serialize)]
pub struct HierarchyReport {
    /// On all cores.
    build: BuildTime,
    /// Nodes, and leaves with all that traversal reads.
    bytes: usize,
    /// `bytes` over spheres and triangles.
    bytes_per_primitive: f64,
    /// Null for an invalid hierarchy.
    tree: Option<Statistics>,
    /// Why it is invalid: a bug in octray.
    pub fault: Option<String>,
}

impl TraversalReport {
    /// Returns the choice of [`Methods::default`] for this scene with 8 lanes.
    pub fn of(scene: &Scene) -> Self {
        let traversal = Methods::default().traversal_name(scene, F32x8::WIDTH);
        Self {
            // Both are equal: a traversal itself finds out which rays are coherent.
            primary: traversal,
            bounces: traversal,
            linear_cost: scene.counts().list_cost(),
            most_linear_cost: MAX_LIST_COST,
        }
    }

    pub fn text(&self) -> String {
        format!("{} for primary rays, {} for bounces", self.primary, self.bounces)
    }

    pub fn why(&self) -> String {
        let Self { linear_cost, most_linear_cost, .. } = self;
        let (relation, faster) = match linear_cost > most_linear_cost {
            true => ("above", "a hierarchy is faster"),
            false => ("up to", "that is faster than a hierarchy"),
        };
        let cost = format!(
            "testing everything would cost a ray {} (1 a sphere, {} a triangle)",
            grouped(*linear_cost),
            Kind::Triangle.test_cost()
        );
        format!("{cost}; {relation} {most_linear_cost}, {faster}")
    }
}

impl HierarchyReport {
    /// Builds it on all cores, and checks it.
    pub fn of(scene: &Scene) -> Self {
        let geometry = scene.geometry();
        let (hierarchy, mut builds) = rays::build(&geometry, &[machine::cores()], 1);
        let tree = hierarchy.check(&geometry).expect("a hierarchy");
        let bytes = hierarchy.bytes();
        Self {
            build: builds.remove(0),
            bytes,
            bytes_per_primitive: bytes as f64 / scene.primitives() as f64,
            fault: tree.as_ref().err().cloned(),
            tree: tree.ok(),
        }
    }

    pub fn text(&self) -> String {
        let builds = std::slice::from_ref(&self.build);
        hierarchy_text(&self.tree, &self.fault, builds, [self.bytes as f64, self.bytes_per_primitive])
    }
}

/// Describes the shape of a hierarchy, its bytes in all and for each primitive, and its build times; or says
/// why it is invalid.
pub fn hierarchy_text(
    tree: &Option<Statistics>,
    fault: &Option<String>,
    builds: &[BuildTime],
    [bytes, bytes_per_primitive]: [f64; 2],
) -> String {
    let Some(tree) = tree else { return format!("INVALID: {}", fault.as_deref().unwrap_or_default()) };
    let Statistics { node_fill, leaf_fill, node_visits, leaf_visits, cost, .. } = tree;
    let built = builds.iter().map(|BuildTime { threads, ms, .. }| {
        format!("{} ms on {}", figure(*ms, 1), counted(threads, "thread", "threads"))
    });
    format!(
        "{} of {node_fill:.1} boxes in {}, {} of {leaf_fill:.1} primitives; a random line tests {node_visits:.1} nodes \
         and {leaf_visits:.1} leaves, which costs as much as {cost:.1} nodes; {}, {bytes_per_primitive:.0} bytes a \
         primitive; built in {}",
        counted(tree.wide_nodes, "node", "nodes"),
        counted(tree.wide_depth, "level", "levels"),
        counted(tree.leaves, "leaf", "leaves"),
        DecimalBytes(bytes as u64),
        built.collect::<Vec<_>>().join(", "),
    )
}

/// A default, and the reason for it: the figures come from `octray stability` and `octray chart`.
#[derive(Debug, Serialize)]
pub struct DefaultReport {
    /// The option, without hyphens.
    option: &'static str,
    default: &'static str,
    why: &'static str,
}

impl DefaultReport {
    /// Returns the defaults that make a difference to this scene.
    pub fn all(scene: &Scene) -> Vec<Self> {
        let hierarchy = features_of(scene).contains(Features::HIERARCHY);
        let (lanes, why_lanes) = match LaneChoice::Auto.lanes() {
            16 if hierarchy => (
                "16",
                "fills AVX-512's vectors: 1.0 to 1.06 times as fast as 8 (traversals of a hierarchy have widths of their own)",
            ),
            16 => (
                "16",
                "fills AVX-512's vectors: 1.1 to 1.6 times as fast as 8 where every primitive is tested",
            ),
            _ => ("8", "this build has vectors of 8; with AVX-512, 16 is the faster one"),
        };
        let why_sphere = "at 1,000 radii it is wrong on less than one ray in 100,000, naive on one in 28, for hardly more time";
        let why_triangle = "no ray slips through an edge or a vertex; of rays aimed at edges, moller-trumbore loses one in six";
        let why_sampler =
            "Sobol points cost a few per cent more than independent numbers and leave less noise";
        let why_pipeline = "it is compiled for the smallest set of features that holds the scene's; the picture stays the same";
        let all = [
            (!scene.spheres.is_empty(), "sphere", "robust", why_sphere),
            (!scene.triangles.is_empty(), "triangle", "woop", why_triangle),
            (true, "lanes", lanes, why_lanes),
            (true, "sampler", "sobol", why_sampler),
            (true, "pipeline", "auto", why_pipeline),
        ];
        let matters = all.into_iter().filter(|(matters, ..)| *matters);
        matters.map(|(_, option, default, why)| Self { option, default, why }).collect()
    }

    /// Returns the option, its default, and why.
    pub fn text(&self) -> String {
        let Self { option, default, why } = self;
        format!("--{option} {default}: {why}")
    }
}
