//! Which methods a scene gets unless others are asked for, and why: a part of what `octray inspect` tells.
//!
//! For: [`DefaultReport`]. May import: `methods`' choices, `traverse`'s. Must never know: what else a scene holds.
//!
//! The figures are those of `octray stability` and `octray chart`.

use crate::buffers::Features;
use crate::scene::Scene;
use crate::traverse::{Methods, linear};
use serde::Serialize;

/// A choice that the scene leaves open.
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
        let hierarchy = linear::features_of(scene).contains(Features::HIERARCHY);
        add(
            spheres,
            "sphere",
            "robust",
            "seen from 1,000 radii it misjudges less than one ray in 100,000, where naive misjudges one in 28, for hardly more time",
        );
        add(
            triangles,
            "triangle",
            "woop",
            "no ray slips through an edge or a vertex; of those aimed at edges, moller-trumbore lets one in six through, baldwin-weber one in nine",
        );
        add(
            triangles || hierarchy,
            "box",
            "padded-fma",
            "loses no hit; without padding, one in nine aimed at corners is lost, and no time is saved",
        );
        let fast = Methods::fast(scene) != Methods::default();
        let robust = if fast {
            "pictures hardly show the difference, rays aimed at edges do; --fast takes baldwin-weber"
        } else {
            "nothing is faster here: --fast takes the same"
        };
        add(triangles, "robust", "on", robust);
        add(true, "sampler", "sobol", "spread points cost what independent numbers do, and leave less noise");
        add(
            true,
            "pipeline",
            "needed",
            "what the scene does not need is not compiled in, and the picture stays the same",
        );
        all
    }

    /// For people: what is chosen, and why.
    pub fn text(&self) -> String {
        let Self { option, default, why } = self;
        match *default {
            "on" => format!("--{option}: {why}"),
            _ => format!("--{option} {default}: {why}"),
        }
    }
}
