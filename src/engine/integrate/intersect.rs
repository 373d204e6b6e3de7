//! Second stage: finds the nearest hit of every ray of the queue.
//!
//! For: [`intersect`], and [`intersect_linear`] for rays of any queue. May import: `scratch` and what stands
//! above it. Must never know: shading.

use super::context::TraceContext;
use super::features::has;
use super::queue::PathQueue;
use super::ray_queries::RayQueries;
use super::scratch::Scratch;
use super::stats::RayKind;
use crate::buffers::Features;
use crate::lane::Lane;
use crate::math::{Hit, Ray};
use crate::traverse::{Batch, Visible};

/// Finds the nearest hits of the first `count` rays.
pub fn intersect<L: Lane, const N: u32>(context: &TraceContext, scratch: &mut Scratch, count: usize) {
    if let Some((hierarchy, traversal)) = context.primitives.hierarchy() {
        scratch.intersect_hierarchy(hierarchy, traversal, count, RayKind::Bounce);
    } else if context.primitives.uses_default_methods() {
        let batch = IntersectBatch::<N> { queue: &mut scratch.queue, count };
        context.primitives.for_default_batch::<L>(&context.buffers, None, batch);
    } else {
        intersect_linear::<L>(context, None, scratch.queue.queries(count));
    }
}

struct IntersectBatch<'a, const N: u32> {
    queue: &'a mut PathQueue,
    count: usize,
}

impl<L: Lane, const N: u32> Batch<L> for IntersectBatch<'_, N> {
    #[inline(always)]
    fn run(self, closest: impl Fn(&Ray<L>) -> Hit<L>) {
        for at in (0..self.count).step_by(L::WIDTH) {
            let hit = closest(&self.queue.ray(at));
            self.queue.store_hit(at, &hit, has(N, Features::TRIANGLES));
        }
    }
}

/// Finds nearest hits by testing every primitive, or every `visible` one, with the intersection methods that
/// were chosen.
///
/// Not inlined, and shared by all pipelines: each pair of methods is much code.
#[inline(never)]
pub fn intersect_linear<L: Lane>(context: &TraceContext, visible: Option<&Visible>, queries: RayQueries) {
    context.primitives.for_batch::<L>(&context.buffers, visible, queries);
}
