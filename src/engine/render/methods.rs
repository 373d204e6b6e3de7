//! The methods of a rendering, chosen at run time: intersection methods, traversal, light sampling, sampler.

use crate::buffers::Features;
use crate::choice::{choice, choices};
use crate::lights::{LightChoice, Lights};
use crate::sampling::Sampler;
use crate::scene::Scene;
use octray_rays::{Geometry, MAX_LIST_COST, PrimitiveTests, Structure, Traversal};
use std::sync::Arc;

choices! {
    /// The ray–sphere intersection method: the default, and the textbook's for contrast.
    pub enum SphereChoice {
        #[default]
        Robust = "robust",
            "Discriminant from the perpendicular distance: accurate for small, distant and huge spheres.";
        Naive = "naive", "The textbook quadratic formula: loses digits on small, distant and huge spheres.";
    }
}

choices! {
    /// The ray–triangle intersection method: the default, and the classic for contrast.
    pub enum TriangleChoice {
        #[default]
        Woop = "woop", "Watertight: no ray slips through between neighbouring triangles.";
        MollerTrumbore = "moller-trumbore", "The classic: leaks at edges and vertices.";
    }
}

/// Returns the features that traversal adds to those of [`Features::of`]: [`Features::HIERARCHY`] if
/// [`octray_rays::KindCounts::list_cost`] is above [`MAX_LIST_COST`].
pub fn features_of(scene: &Scene) -> Features {
    if scene.counts().list_cost() > MAX_LIST_COST { Features::HIERARCHY } else { Features::NONE }
}

/// The methods of a rendering. The defaults are robust: they work where others fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Methods {
    /// The intersection test of spheres.
    pub sphere: SphereChoice,
    /// The intersection test of triangles.
    pub triangle: TriangleChoice,
    /// The search for the primitives that rays hit.
    pub traversal: TraversalChoice,
    /// The lights that are sampled.
    pub lights: LightChoice,
    /// The source of sample values.
    pub sampler: Sampler,
}

/// The ways in which rays find the primitives that they hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TraversalChoice {
    /// Linear in small scenes, else the fastest traversal: see [`Features::HIERARCHY`].
    #[default]
    Auto,
    /// Every primitive is tested.
    Linear,
    /// Through a hierarchy; at a width of 1 always [`Traversal::Scalar`]. Methods that are not robust have a
    /// traversal of their own, which is reported as [`Traversal::Stream`].
    Through(Traversal),
}

choice! {
    TraversalChoice:
    (Self::Auto) = "auto", "Linear in small scenes, else hybrid (scalar with --lanes 1).";
    (Self::Linear) = "linear", "Every primitive is tested.";
    (Self::Through(Traversal::Scalar)) = "scalar",
        "One ray at a time through the binary tree, without SIMD: the baseline, and used by --lanes 1.";
    (Self::Through(Traversal::Single)) = "single",
        "One ray at a time against the boxes of a node, or the primitives of a leaf, at once.";
    (Self::Through(Traversal::Packet)) = "packet",
        "Tiles of camera rays in a frustum; other rays as `stream` traces them.";
    (Self::Through(Traversal::Stream)) = "stream", "Many rays together down the tree.";
    (Self::Through(Traversal::Hybrid)) = "hybrid",
        "The traversal that measured fastest for the rays at hand.";
}

impl Methods {
    /// Builds the structure of a scene for packets of `lanes` rays. Shadow rays end at `lights`. Without
    /// `tests`, the robust methods test the primitives.
    pub fn structure(
        &self,
        scene: &Scene,
        geometry: &Geometry,
        lanes: usize,
        lights: &Lights,
        tests: Option<Arc<dyn PrimitiveTests>>,
    ) -> Structure {
        let structure = match (self.traversal_of(scene, lanes), tests) {
            (Some(traversal), None) => Structure::tree(geometry, traversal),
            (None, None) => Structure::list(geometry, lanes),
            (Some(_), Some(tests)) => Structure::tree_with(geometry, tests, lanes),
            (None, Some(tests)) => Structure::list_with(geometry, tests, lanes),
        };
        // The sky and the lights that are no primitives may lie behind all walls; with vertex normals, rays
        // start above the triangles.
        let is_sky_sampled = lights.sky.is_some() || !lights.portals.is_empty();
        let all_are_primitives = !is_sky_sampled && scene.lights.is_empty();
        let has_targets = !lights.is_empty() && all_are_primitives && scene.normals.is_empty();
        match has_targets {
            true => structure.with_targets(geometry, |number| lights.probabilities[number] > 0.0),
            false => structure,
        }
    }
    /// Returns the traversal of a scene's hierarchy at a width of 1, or of 8 and more; `None` if every
    /// primitive is tested.
    pub fn traversal_of(&self, scene: &Scene, lanes: usize) -> Option<Traversal> {
        let default = match lanes {
            _ if !self.are_robust() => Traversal::Stream,
            1 => Traversal::Scalar,
            _ => Traversal::Hybrid,
        };
        match self.traversal {
            TraversalChoice::Linear => None,
            TraversalChoice::Auto => features_of(scene).contains(Features::HIERARCHY).then_some(default),
            TraversalChoice::Through(_) if lanes == 1 || !self.are_robust() => Some(default),
            TraversalChoice::Through(traversal) => Some(traversal),
        }
    }
    /// Returns the name of [`Methods::traversal_of`]: `linear` if every primitive is tested.
    pub fn traversal_name(&self, scene: &Scene, lanes: usize) -> &'static str {
        self.traversal_of(scene, lanes).map_or(TraversalChoice::Linear, TraversalChoice::Through).name()
    }
    /// Tests whether both intersection methods are the robust ones, which claim hits only within rounding
    /// error of the primitive. The others do not: from a distance, naive spheres are hit at several times
    /// their radius, and slivers far off their edges.
    pub fn are_robust(&self) -> bool {
        self.sphere == SphereChoice::Robust && self.triangle == TriangleChoice::Woop
    }
}
