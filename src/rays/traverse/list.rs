//! Tests every ray against every primitive: fastest for small scenes, and the result that every other
//! traversal must equal.

use super::counter::Counter;
use crate::candidates::Candidates;
use crate::columns::{Hits, Rays};
use crate::coordinates::Coordinates;
use crate::kind::{Geometry, Lists};
use crate::lane::Lane;

/// All primitives, in the order of their numbers.
pub struct List {
    pub(super) primitives: Lists,
    /// The place of the primitives' coordinates in the world.
    pub(super) coordinates: Coordinates,
}

impl List {
    /// Stores all primitives.
    pub fn new(geometry: &Geometry) -> Self {
        Self { primitives: Lists::new(geometry), coordinates: geometry.coordinates }
    }

    /// Finds the nearest hit of each ray by testing every primitive, or only the `listed` ones, which must
    /// include all that the rays can hit. A `counter` counts the tests.
    pub fn trace<L: Lane>(
        &self,
        rays: &Rays,
        hits: &mut Hits,
        listed: Option<&Candidates>,
        counter: Option<&Counter>,
    ) {
        if let Some(counter) = counter {
            let tested = listed.map_or(self.primitives.counts(), Candidates::counts);
            counter.list(tested, rays.len().div_ceil(L::WIDTH), rays.len());
        }
        self.primitives.trace::<L>(rays, hits, listed);
    }
}
