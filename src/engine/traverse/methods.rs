//! What there is to choose between when rays are traced, at run time.

use super::batch::Traversal;
use super::linear;
use crate::buffers::{Features, LightChoice};
use crate::lane::{F32x8, Lane};
use crate::sampling::Sampler;
use crate::scene::Scene;

/// Which method intersects spheres: the default, and the textbook's for contrast. [`crate::kernel::ray_sphere`] has more, which only charts show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum SphereChoice {
    #[default]
    Robust,
    Naive,
}

impl SphereChoice {
    pub const ALL: [Self; 2] = [Self::Robust, Self::Naive];

    /// As the command line and reports name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Robust => "robust",
            Self::Naive => "naive",
        }
    }
}

/// Which method intersects triangles: the default, the fastest of the measured front, and the classic for contrast.
/// [`crate::kernel::ray_triangle`] has more, which only charts show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TriangleChoice {
    #[default]
    Woop,
    MollerTrumbore,
    BaldwinWeber,
}

impl TriangleChoice {
    pub const ALL: [Self; 3] = [Self::Woop, Self::MollerTrumbore, Self::BaldwinWeber];

    /// As the command line and reports name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Woop => "woop",
            Self::MollerTrumbore => "moller-trumbore",
            Self::BaldwinWeber => "baldwin-weber",
        }
    }
}

/// Which equation intersects boxes; see [`crate::kernel::ray_box`]. Others than these have no place in a hierarchy: `octray chart` shows them, and
/// each is slower than the default, or as fast and wrong.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum BoxChoice {
    #[default]
    PaddedFma,
    /// Without padding: no faster, as padding is added once a ray, and hits are lost at corners and edges. Different traversals lose different
    /// ones.
    Fma,
}

impl BoxChoice {
    /// As the command line and reports name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::PaddedFma => "padded-fma",
            Self::Fma => "fma",
        }
    }
}

/// The equations of a picture, and how it finds what it looks for. The defaults are the ones that hold where others fail.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub struct Methods {
    pub sphere: SphereChoice,
    pub triangle: TriangleChoice,
    pub boxes: BoxChoice,
    pub traversal: TraversalChoice,
    pub lights: LightChoice,
    pub sampler: Sampler,
}

/// How rays find what they meet.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum TraversalChoice {
    /// Whatever measured fastest for a scene of so many primitives: see [`Features::HIERARCHY`].
    #[default]
    Needed,
    /// Every primitive is tested.
    Linear,
    /// Through a hierarchy. Only the default equations have one; the others test every primitive.
    Through(Traversal),
}

impl TraversalChoice {
    /// As the command line and reports name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Needed => "needed",
            Self::Linear => "linear",
            Self::Through(traversal) => traversal.name(),
        }
    }
}

impl Methods {
    /// The fastest point of the measured front (`octray chart`): equations that leak at edges and vertices, where they pay. In a
    /// hierarchy, and among spheres alone, nothing is faster than the defaults.
    pub fn fast(scene: &Scene) -> Self {
        let default = Self::default();
        match default.traversal_of(scene, F32x8::WIDTH) {
            Some(_) => default,
            None => Self { triangle: TriangleChoice::BaldwinWeber, ..default },
        }
    }
    /// Does testing boxes lose no hit? Then pictures have the same bits whatever way their rays go.
    pub fn lose_no_hit(&self) -> bool {
        self.boxes == BoxChoice::PaddedFma
    }
    /// Are these the equations that hold where others fail?
    pub fn are_robust(&self) -> bool {
        self.sphere != SphereChoice::Naive && self.triangle == TriangleChoice::Woop && self.lose_no_hit()
    }
    /// The traversal of a scene's hierarchy at a width of 1 or 8; `None` where every primitive is tested.
    pub fn traversal_of(&self, scene: &Scene, lanes: usize) -> Option<Traversal> {
        if self.sphere != SphereChoice::Robust || self.triangle != TriangleChoice::Woop {
            return None;
        }
        let default = if lanes == 1 { Traversal::Scalar } else { Traversal::Hybrid };
        match self.traversal {
            TraversalChoice::Linear => None,
            TraversalChoice::Needed => {
                linear::features_of(scene).contains(Features::HIERARCHY).then_some(default)
            }
            TraversalChoice::Through(_) if lanes == 1 => Some(default),
            TraversalChoice::Through(traversal) => Some(traversal),
        }
    }
    /// Do these methods claim hits only within rounding error of the primitive? The naive ones do not: from afar they hit spheres
    /// at several times their radius, and slivers far off their edges.
    pub fn keep_to_their_primitives(&self) -> bool {
        self.sphere != SphereChoice::Naive && self.triangle == TriangleChoice::Woop
    }
}
