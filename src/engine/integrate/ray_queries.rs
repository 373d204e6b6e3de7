//! Ray queries: columns of rays, and the columns that receive their hits.
//!
//! For: [`RayQueries`].

use super::columns::{Column, IntColumn, Vec3Columns};
use crate::math::MISS;
use crate::traverse::batch::{Tracer, Traversal};
use crate::traverse::counter::Counter;
use crate::traverse::hierarchy::Hierarchy;
use crate::traverse::rays::{Hits, Rays};
use std::ops::Range;

/// A range of the rays of a queue, and where their hits are written.
pub struct RayQueries<'a> {
    pub range: Range<usize>,
    pub origin: &'a Vec3Columns,
    pub direction: &'a Vec3Columns,
    /// Hits from here on do not count; without it, all do.
    pub t_max: Option<&'a Column>,
    pub t: &'a mut Column,
    pub primitive: &'a mut IntColumn,
    pub u: &'a mut Column,
    pub v: &'a mut Column,
}

impl RayQueries<'_> {
    /// Finds the nearest hits in a hierarchy, or with `ANY` only whether there is any hit.
    #[inline(always)]
    pub fn trace<const ANY: bool>(
        self,
        tracer: &mut Tracer,
        hierarchy: &Hierarchy,
        traversal: Traversal,
        counter: Option<&Counter>,
    ) {
        let RayQueries { range, origin, direction, t_max, t, primitive, u, v } = self;
        let rays = Rays { origin: origin.range(range.clone()), direction: direction.range(range.clone()) };
        let [t, u, v] = [t, u, v].map(|column| &mut column[range.clone()]);
        let primitive = &mut primitive[range.clone()];
        match t_max {
            Some(t_max) => t.copy_from_slice(&t_max[range]),
            None => t.fill(f32::INFINITY),
        }
        primitive.fill(MISS);
        if !ANY {
            // Spheres and misses have no barycentric coordinates.
            u.fill(0.0);
            v.fill(0.0);
        }
        let mut hits = Hits { t, primitive, u, v };
        match counter {
            None => tracer.trace::<ANY>(traversal, hierarchy, &rays, &mut hits),
            Some(counter) => tracer.count::<ANY>(traversal, hierarchy, &rays, &mut hits, counter),
        }
    }
}
