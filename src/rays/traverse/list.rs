//! Tests every ray against every primitive: fastest for small scenes, and the result that every other
//! traversal must equal.
//!
//! Each kind of primitive has a loop over the rays. In short loops the processor works on several packets at
//! a time, and a ray's values stay in registers: with 16 lanes this is 1.03 to 1.1 times as fast as one loop
//! in scenes that have both kinds; with 8 there is no difference.

use super::counter::Counter;
use crate::candidates::Candidates;
use crate::columns::{Hits, Rays};
use crate::coordinates::Coordinates;
use crate::geometry::Geometry;
use crate::kind::{Kind, KindCounts, sphere, triangle};
use crate::lane::Lane;

/// All primitives, in the order of their numbers.
pub struct List {
    spheres: sphere::List,
    triangles: triangle::List,
    /// The place of the primitives' coordinates in the world.
    pub(super) coordinates: Coordinates,
}

impl List {
    /// Stores all primitives.
    pub fn new(geometry: &Geometry) -> Self {
        let triangles = (geometry.counts().first(Kind::Triangle), geometry.triangles.as_slice());
        Self {
            spheres: sphere::List::new(&geometry.spheres),
            triangles: triangle::List::new(triangles, geometry.padding()),
            coordinates: geometry.coordinates,
        }
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
        let all = KindCounts([self.spheres.len(), self.triangles.len()]);
        let tested = listed.map_or(all, Candidates::counts);
        if let Some(counter) = counter {
            counter.list(tested, rays.len().div_ceil(L::WIDTH), rays.len());
        }
        let [spheres, triangles] = tested.0;
        // If there are no candidates, the loop over zero spheres stores the misses.
        if spheres > 0 || triangles == 0 {
            self.spheres.trace::<L>(rays, hits, listed.map(|listed| listed.of_kind(Kind::Sphere)));
        }
        if triangles > 0 {
            self.triangles.trace::<L>(rays, (spheres > 0, hits), listed);
        }
    }
}
