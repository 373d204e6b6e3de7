//! The structure that answers queries about primitives: a list or a hierarchy.

use super::custom::{Custom, PrimitiveTests};
use super::hierarchy::Hierarchy;
use super::occluders::Occluders;
use super::tracer::Traversal;
use crate::bvh::check::{Statistics, check_geometry};
use crate::bvh::{Bvh, Trees};
use crate::coordinates::Coordinates;
use crate::kind::{Geometry, List};
use crate::lane::NATIVE_WIDTH;
use crate::numbering::Candidates;
use std::sync::Arc;

/// Up to this [cost](crate::KindCounts::list_cost) primitives are tested one by one, above it through a
/// hierarchy, which is faster from there on. Measured in frames, both are equal for terrains of about 45
/// triangles with 16 lanes (AMD Zen 4) and 32 with 8, knots of 55 and 90, 285 spheres and 200 to 290.
pub const MAX_LIST_COST: usize = 240;

/// Primitives prepared for queries, which [`super::Tracer`] runs. A structure is built once and shared by all
/// threads. Clones share the memory.
#[derive(Clone)]
pub struct Structure {
    pub(super) primitives: Primitives,
    /// The primitives that shadow rays are tested against; `None` means all.
    pub(super) occluders: Option<Arc<Occluders>>,
    /// The width of packets in a list, and in the caller's tests.
    pub(super) lanes: usize,
}

/// The primitives in the form that a traversal reads.
#[derive(Clone)]
pub(super) enum Primitives {
    List(Arc<List>),
    Tree(Arc<Hierarchy>, Traversal),
    Custom(Arc<Custom>),
}

impl Structure {
    /// Builds a list of few primitives or a hierarchy of many, whichever is faster.
    pub fn new(geometry: &Geometry) -> Self {
        if geometry.counts().list_cost() <= MAX_LIST_COST {
            Self::list(geometry, NATIVE_WIDTH)
        } else {
            Self::tree(geometry, Traversal::default())
        }
    }

    /// Builds a list that traces packets of `lanes` rays: 1, 8 or 16.
    pub fn list(geometry: &Geometry, lanes: usize) -> Self {
        Self::new_with(Primitives::List(Arc::new(List::new(geometry))), lanes)
    }

    /// Builds a list that uses the caller's `tests` of primitives, in packets of `lanes` rays.
    pub fn list_with(geometry: &Geometry, tests: Arc<dyn PrimitiveTests>, lanes: usize) -> Self {
        Self::new_with(Primitives::Custom(Arc::new(Custom::list(geometry, tests))), lanes)
    }

    /// Builds a hierarchy.
    pub fn tree(geometry: &Geometry, traversal: Traversal) -> Self {
        Self::from_hierarchy(Hierarchy::new(geometry, traversal.trees()), traversal)
    }

    /// Builds a hierarchy that uses the caller's `tests` of primitives, in packets of `lanes` rays. It has a
    /// traversal of its own. If a test finds a hit outside the primitive's box, the result may differ from
    /// that of [`Structure::list_with`].
    pub fn tree_with(geometry: &Geometry, tests: Arc<dyn PrimitiveTests>, lanes: usize) -> Self {
        Self::new_with(Primitives::Custom(Arc::new(Custom::tree(geometry, tests))), lanes)
    }

    /// Builds a hierarchy that every traversal can read: see [`Structure::with_traversal`].
    pub fn tree_for_all(geometry: &Geometry) -> Self {
        Self::from_hierarchy(Hierarchy::new(geometry, Trees::WideAndBinary), Traversal::default())
    }

    /// Returns a structure over primitives that have moved, in the order and number of those before. A
    /// hierarchy keeps its tree, which takes a fraction of the time of building one. What
    /// [`Structure::with_targets`] found is dropped.
    ///
    /// # Panics
    /// If the structure has the caller's tests, or a binary tree.
    pub fn refitted(&self, geometry: &Geometry) -> Self {
        match &self.primitives {
            Primitives::List(_) => Self::list(geometry, self.lanes),
            Primitives::Tree(hierarchy, traversal) => {
                let hierarchy = Arc::new(hierarchy.refitted(geometry));
                Self::new_with(Primitives::Tree(hierarchy, *traversal), self.lanes)
            }
            Primitives::Custom(_) => panic!("the caller's tests cannot be refitted"),
        }
    }

    fn from_hierarchy(hierarchy: Hierarchy, traversal: Traversal) -> Self {
        Self::new_with(Primitives::Tree(Arc::new(hierarchy), traversal), traversal.lanes())
    }

    fn new_with(primitives: Primitives, lanes: usize) -> Self {
        assert!([1, 8, 16].contains(&lanes), "packets of {lanes} rays instead of 1, 8 or 16");
        Self { primitives, occluders: None, lanes }
    }

    /// Returns a structure that traces the same hierarchy with another traversal. A list stays a list, and
    /// the caller's tests keep their traversal.
    pub fn with_traversal(&self, traversal: Traversal) -> Self {
        let mut other = self.clone();
        if let Primitives::Tree(_, of_other) = &mut other.primitives {
            *of_other = traversal;
        }
        other
    }

    /// Finds the primitives that can lie between a surface and a target, if not all can:
    /// [`super::Tracer::occluded_in_scene`] then tests no others. All its rays must run from a surface of the
    /// geometry, or from the height above it at which spawned rays start, to a point of a primitive for which
    /// `is_target(number)` is true. The caller's tests always test all.
    pub fn with_targets(mut self, geometry: &Geometry, is_target: impl Fn(usize) -> bool) -> Self {
        let hierarchy = match &self.primitives {
            Primitives::Tree(hierarchy, traversal) => Some((&**hierarchy, traversal.trees())),
            Primitives::List(_) => None,
            Primitives::Custom(_) => return self,
        };
        self.occluders = Occluders::find(geometry, is_target, hierarchy).map(Arc::new);
        self
    }

    /// Returns whether rays can be tested against [`Candidates`] alone: see
    /// [`Rays::among`](crate::Rays::among).
    pub fn accepts_candidates(&self) -> bool {
        matches!(self.primitives, Primitives::List(_))
    }

    /// Returns whether queries take rays with lower bounds ([`Rays::beyond`](crate::Rays::beyond)): the
    /// caller's tests do not.
    pub fn accepts_lower_bounds(&self) -> bool {
        !matches!(self.primitives, Primitives::Custom(_))
    }

    /// Returns the candidates that [`super::Tracer::occluded_in_scene`] tests; `None` means all primitives.
    pub fn occluders(&self) -> Option<&Candidates> {
        self.occluders.as_ref().map(|occluders| &occluders.candidates)
    }

    /// Returns the statistics of the hierarchy over this geometry, or its first fault. Returns `None` for a
    /// list.
    pub fn check(&self, geometry: &Geometry) -> Option<Result<Statistics, String>> {
        match &self.primitives {
            Primitives::List(_) => None,
            Primitives::Tree(hierarchy, _) => Some(check_geometry(&hierarchy.bvh, geometry)),
            Primitives::Custom(custom) => custom.bvh().map(|bvh| check_geometry(bvh, geometry)),
        }
    }

    /// Returns the place of the primitives' coordinates in the world.
    pub fn coordinates(&self) -> Coordinates {
        match &self.primitives {
            Primitives::List(list) => list.coordinates,
            Primitives::Tree(hierarchy, _) => hierarchy.coordinates,
            Primitives::Custom(custom) => custom.coordinates,
        }
    }

    /// Returns the size of the hierarchy's nodes and leaves in bytes; 0 for a list.
    pub fn bytes(&self) -> usize {
        match &self.primitives {
            Primitives::List(_) => 0,
            Primitives::Tree(hierarchy, _) => hierarchy.bytes(),
            Primitives::Custom(custom) => custom.bvh().map_or(0, Bvh::bytes),
        }
    }
}
