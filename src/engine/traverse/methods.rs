//! The methods of a rendering, chosen at run time: intersection methods, traversal, light sampling, sampler.

use super::quadrics::SphereChoice;
use super::tree::Traversal;
use crate::buffers::{Features, LightChoice};
use crate::choice::{Choice, choices, serde_by_name};
use crate::sampling::Sampler;
use crate::scene::Scene;

choices! {
    /// The ray–triangle intersection method: the default, and the classic for contrast.
    pub enum TriangleChoice {
        #[default]
        Woop = "woop", "Watertight: no ray slips through between neighbouring triangles.";
        MollerTrumbore = "moller-trumbore", "The classic: leaks at edges and vertices.";
    }
}

/// The cost of testing a triangle, in tests of a sphere.
pub const TRIANGLE_COST: usize = 6;
/// Up to this [`list_cost`] primitives are tested one by one, above it through a hierarchy: about where that
/// becomes faster. Measured in frames, both take equally long for terrains of about 45 triangles with 16
/// lanes (AMD Zen 4) and 32 with 8, knots of 55 and 90, 285 spheres and 200 to 290.
pub const MAX_LIST_COST: usize = 240;

/// The cost of testing every primitive for a ray, in tests of a sphere.
pub fn list_cost(scene: &Scene) -> usize {
    scene.first_triangle() + TRIANGLE_COST * scene.triangles.len()
}

/// The features that traversal adds to those of [`Features::of`]: [`Features::HIERARCHY`] above
/// [`MAX_LIST_COST`].
pub fn features_of(scene: &Scene) -> Features {
    if list_cost(scene) > MAX_LIST_COST { Features::HIERARCHY } else { Features::NONE }
}

/// The methods of a rendering. The defaults are robust: they hold where others fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Methods {
    /// How rays meet spheres.
    pub sphere: SphereChoice,
    /// How rays meet triangles.
    pub triangle: TriangleChoice,
    /// How rays find primitives.
    pub traversal: TraversalChoice,
    /// Which lights are sampled.
    pub lights: LightChoice,
    /// Where sample values come from.
    pub sampler: Sampler,
}

/// How rays find the primitives that they hit.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TraversalChoice {
    /// Linear in small scenes, else the fastest traversal: see [`Features::HIERARCHY`].
    #[default]
    Auto,
    /// Every primitive is tested.
    Linear,
    /// Through a hierarchy. Only the default sphere and triangle methods have one; others test every
    /// primitive.
    Through(Traversal),
}

impl TraversalChoice {
    /// `auto` and `linear`, then every traversal.
    const ALL: [Self; 2 + Traversal::ALL.len()] = {
        let mut all = [Self::Auto; 2 + Traversal::ALL.len()];
        all[1] = Self::Linear;
        let mut index = 0;
        while index < Traversal::ALL.len() {
            all[2 + index] = Self::Through(Traversal::ALL[index]);
            index += 1;
        }
        all
    };
    const ALL_NAMES: [&'static str; Self::ALL.len()] = {
        let mut names = [""; Self::ALL.len()];
        let mut index = 0;
        while index < names.len() {
            names[index] = Self::ALL[index].name();
            index += 1;
        }
        names
    };

    /// As the command line, view files and reports spell it.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::Linear => "linear",
            Self::Through(traversal) => traversal.name(),
        }
    }
}

impl Choice for TraversalChoice {
    const NAMES: &'static [&'static str] = &Self::ALL_NAMES;
    fn all() -> &'static [Self] {
        &Self::ALL
    }
    fn name(self) -> &'static str {
        self.name()
    }
    fn about(self) -> &'static str {
        match self {
            Self::Auto => "Linear in small scenes, else hybrid (scalar with --lanes 1).",
            Self::Linear => "Every primitive is tested.",
            Self::Through(traversal) => traversal.about(),
        }
    }
}

serde_by_name!(TraversalChoice);

impl Methods {
    /// The traversal of a scene's hierarchy at a width of 1, or of 8 and more; `None` where every primitive
    /// is tested.
    pub fn traversal_of(&self, scene: &Scene, lanes: usize) -> Option<Traversal> {
        if self.without_hierarchy().is_some() {
            return None;
        }
        let default = if lanes == 1 { Traversal::Scalar } else { Traversal::Hybrid };
        match self.traversal {
            TraversalChoice::Linear => None,
            TraversalChoice::Auto => features_of(scene).contains(Features::HIERARCHY).then_some(default),
            TraversalChoice::Through(_) if lanes == 1 => Some(default),
            TraversalChoice::Through(traversal) => Some(traversal),
        }
    }
    /// The name of [`Methods::traversal_of`]: `linear` where every primitive is tested.
    pub fn traversal_name(&self, scene: &Scene, lanes: usize) -> &'static str {
        self.traversal_of(scene, lanes).map_or(TraversalChoice::Linear, TraversalChoice::Through).name()
    }
    /// The first method that has no hierarchy, so that every primitive is tested: its option and its name.
    pub fn without_hierarchy(&self) -> Option<(&'static str, &'static str)> {
        match (self.sphere, self.triangle) {
            (SphereChoice::Naive, _) => Some(("--sphere", self.sphere.name())),
            (_, TriangleChoice::MollerTrumbore) => Some(("--triangle", self.triangle.name())),
            (SphereChoice::Robust, TriangleChoice::Woop) => None,
        }
    }
    /// Do these methods claim hits only within rounding error of the primitive? The others do not: from a
    /// distance, naive spheres are hit at several times their radius, and slivers far off their edges.
    pub fn keep_to_their_primitives(&self) -> bool {
        self.sphere != SphereChoice::Naive && self.triangle == TriangleChoice::Woop
    }
}
