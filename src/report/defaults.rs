//! The default methods that matter to a scene, and why they are the default: a part of what `octray inspect`
//! reports.
//!
//! For: [`DefaultReport`].
//!
//! The figures come from `octray stability` and `octray chart`.

use crate::buffers::Features;
use crate::render::LaneChoice;
use crate::scene::Scene;
use crate::traverse::{Methods, features_of};
use serde::Serialize;

/// A default, and the reason for it.
#[derive(Debug, Serialize)]
pub struct DefaultReport {
    /// As the command line has it, without hyphens.
    option: &'static str,
    default: &'static str,
    why: &'static str,
}

impl DefaultReport {
    /// Those that make a difference to this scene.
    pub fn all(scene: &Scene) -> Vec<Self> {
        let mut all = Vec::new();
        let mut add = |matters: bool, option, default, why| {
            if matters {
                all.push(Self { option, default, why });
            }
        };
        let (spheres, triangles) = (!scene.spheres.is_empty(), !scene.triangles.is_empty());
        let hierarchy = features_of(scene).contains(Features::HIERARCHY);
        add(
            spheres,
            "sphere",
            "robust",
            "at 1,000 radii it is wrong on less than one ray in 100,000, naive on one in 28, for hardly more time",
        );
        add(
            triangles,
            "triangle",
            "woop",
            "no ray slips through an edge or a vertex; of rays aimed at edges, moller-trumbore loses one in six, baldwin-weber one in nine",
        );
        add(
            triangles || hierarchy,
            "box",
            "padded-fma",
            "loses no hit; without padding, one ray in nine aimed at corners is lost, and no time is saved",
        );
        let fast = Methods::fast(scene) != Methods::default();
        let robust = if fast {
            "pictures hardly show the difference, rays aimed at edges do; --fast uses baldwin-weber"
        } else {
            "no method is faster here: --fast uses the same"
        };
        add(triangles, "robust", "on", robust);
        let (lanes, why) = match LaneChoice::Auto.lanes() {
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
        add(true, "lanes", lanes, why);
        add(
            true,
            "sampler",
            "sobol",
            "Sobol points cost a few per cent more than independent numbers and leave less noise",
        );
        add(
            true,
            "pipeline",
            "needed",
            "it is compiled for the smallest set of features that holds the scene's; the picture stays the same",
        );
        all
    }

    /// The option, its default, and why.
    pub fn text(&self) -> String {
        let Self { option, default, why } = self;
        match *default {
            "on" => format!("--{option}: {why}"),
            _ => format!("--{option} {default}: {why}"),
        }
    }
}
