//! The seam between rays and primitives: two questions over columns of rays, whatever answers them.

use super::counter::Counter;
use super::hierarchy::Hierarchy;
use super::list::List;
use super::methods::Methods;
use super::occluders::Occluders;
use super::primitive_list::PrimitiveList;
use super::rays::{Hits, Rays};
use super::tree::{Tracer, Traversal};
use crate::buffers::Lights;
use crate::lane::Lane;
use crate::scene::Scene;

/// A scene's primitives ready for intersection by the chosen methods.
pub struct Primitives {
    all: Structure,
    /// Those that shadow rays are tested against, if not all.
    occluders: Option<Occluders>,
}

/// What finds hits.
enum Structure {
    List(List),
    Tree(Hierarchy, Traversal),
}

impl Primitives {
    /// For packets of `lanes` rays: a hierarchy if [`Methods::traversal_of`] names a traversal, else a list.
    /// `lights` are those that shadow rays run to.
    pub fn new(scene: &Scene, methods: Methods, lanes: usize, lights: &Lights) -> Self {
        let all = match methods.traversal_of(scene, lanes) {
            Some(traversal) => Structure::Tree(Hierarchy::new(scene, traversal.trees()), traversal),
            None => Structure::List(List::new(scene, methods)),
        };
        let hierarchy = match &all {
            Structure::Tree(hierarchy, traversal) => Some((hierarchy, *traversal)),
            Structure::List(_) => None,
        };
        let may_be_few = methods.keep_to_their_primitives();
        let occluders = may_be_few.then(|| Occluders::of(scene, lights, hierarchy)).flatten();
        Self { all, occluders }
    }

    /// Whether rays can be tested against a list of their own of what they can hit.
    pub fn take_lists(&self) -> bool {
        matches!(self.all, Structure::List(_))
    }

    /// Finds the nearest hit of each ray. `listed` holds all primitives that the rays can hit, if
    /// that is known.
    #[inline(always)]
    pub fn closest<L: Lane>(
        &self,
        rays: &Rays,
        hits: &mut Hits,
        listed: Option<&PrimitiveList>,
        tracer: &mut Tracer,
        counter: Option<&Counter>,
    ) {
        match &self.all {
            Structure::List(list) => list.trace::<L>(rays, hits, listed, counter),
            Structure::Tree(tree, traversal) => {
                hits.reset(rays);
                tracer.trace_in_scene::<false>(*traversal, tree, rays, hits, counter);
            }
        }
    }

    /// Finds which rays to lights hit anything: their primitive is no [`crate::math::MISS`]; all else in
    /// their hits is unspecified.
    pub fn occluded<L: Lane>(
        &self,
        rays: &Rays,
        hits: &mut Hits,
        tracer: &mut Tracer,
        counter: Option<&Counter>,
    ) {
        match &self.all {
            Structure::List(list) => {
                let listed = self.occluders.as_ref().map(|occluders| &occluders.list);
                list.trace::<L>(rays, hits, listed, counter);
            }
            Structure::Tree(all, traversal) => {
                let occluders = self.occluders.as_ref().and_then(|occluders| occluders.hierarchy.as_ref());
                hits.reset(rays);
                tracer.trace_in_scene::<true>(*traversal, occluders.unwrap_or(all), rays, hits, counter);
            }
        }
    }

    /// [`Primitives::closest`] of rays traced one by one: to count each ray's tests, or of so few rays that
    /// nothing is shared.
    pub fn closest_one_by_one(
        &self,
        rays: &Rays,
        hits: &mut Hits,
        listed: Option<&PrimitiveList>,
        tracer: &mut Tracer,
        counter: Option<&Counter>,
    ) {
        match &self.all {
            Structure::List(list) => list.trace::<f32>(rays, hits, listed, counter),
            Structure::Tree(tree, traversal) => {
                let single = if *traversal == Traversal::Scalar { *traversal } else { Traversal::Single };
                hits.reset(rays);
                tracer.trace_in_scene::<false>(single, tree, rays, hits, counter);
            }
        }
    }
}
