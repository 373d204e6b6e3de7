//! Second stage: finds the nearest hit of every path of the queue, and ends the paths that miss.
//!
//! For: [`intersect`], and [`intersect_linear`] for rays of any queue. May import: `scratch`, `emission` (of
//! the environment) and what stands above them. Must never know: shading of surfaces.

use super::context::TraceContext;
use super::emission::missed_radiance;
use super::features::{ends_missed, has};
use super::queue::PathQueue;
use super::ray_queries::RayQueries;
use super::scratch::Scratch;
use super::stats::RayKind;
use crate::buffers::Features;
use crate::lane::{Lane, Mask};
use crate::math::{Hit, Ray};
use crate::traverse::{Batch, Visible};

/// What a run of [`intersect`] leaves.
pub struct Intersected {
    /// Paths to shade, at the front of the queue.
    pub hits: usize,
    /// Contributions of those that missed.
    pub contributions: usize,
}

impl Intersected {
    /// The `count` paths of a tile's primary rays, as [`super::generate()`] leaves them: each at the index of
    /// its pixel, those that missed too.
    pub fn all(count: usize) -> Self {
        Self { hits: count, contributions: 0 }
    }
}

/// Finds the nearest hits of the first `count` paths after a bounce. Under a sky, paths that miss end here:
/// they add the environment's radiance, and the others are compressed to the front, so that shading has full
/// packets. Without one ([`ends_missed`]), shading finds them.
pub fn intersect<L: Lane, const N: u32>(
    context: &TraceContext,
    scratch: &mut Scratch,
    count: usize,
) -> Intersected {
    let mut left = Intersected { hits: 0, contributions: 0 };
    if let Some((hierarchy, traversal)) = context.primitives.hierarchy() {
        scratch.intersect_hierarchy(hierarchy, traversal, count, RayKind::Bounce);
        end_missed::<L, N>(context, scratch, count, &mut left, |queue, at| queue.hit(at));
    } else if context.primitives.uses_default_methods() {
        let batch = IntersectBatch::<N> { context, scratch, count, left: &mut left };
        context.primitives.for_default_batch::<L>(&context.buffers, None, batch);
    } else {
        intersect_linear::<L>(context, None, scratch.queue.queries(count));
        end_missed::<L, N>(context, scratch, count, &mut left, |queue, at| queue.hit(at));
    }
    left
}

struct IntersectBatch<'a, const N: u32> {
    context: &'a TraceContext,
    scratch: &'a mut Scratch,
    count: usize,
    left: &'a mut Intersected,
}

impl<L: Lane, const N: u32> Batch<L> for IntersectBatch<'_, N> {
    #[inline(always)]
    fn run(self, closest: impl Fn(&Ray<L>) -> Hit<L>) {
        let Self { context, scratch, count, left } = self;
        end_missed::<L, N>(context, scratch, count, left, |queue, at| closest(&queue.ray(at)));
    }
}

/// Stores the hits that `hit` finds packet by packet; under a sky, ends the paths that miss, and compresses
/// the others and their hits.
#[inline(always)]
fn end_missed<L: Lane, const N: u32>(
    context: &TraceContext,
    scratch: &mut Scratch,
    count: usize,
    left: &mut Intersected,
    hit: impl Fn(&PathQueue, usize) -> Hit<L>,
) {
    let (lights, triangles) = (has(N, Features::LIGHTS), has(N, Features::TRIANGLES));
    for at in (0..count).step_by(L::WIDTH) {
        let hit = hit(&scratch.queue, at);
        if !ends_missed(N) {
            scratch.queue.store_hit(at, &hit, triangles);
            left.hits = count;
            continue;
        }
        let active = L::Mask::first(count - at);
        let found = hit.found() & active;
        if found.all() && left.hits == at {
            scratch.queue.store_hit(at, &hit, triangles);
            left.hits += L::WIDTH;
            continue;
        }
        let path = scratch.queue.path(at, lights);
        let missed = active & !found;
        if missed.any() {
            let radiance = missed_radiance::<L, N, false>(context, &path, missed);
            left.contributions = scratch.push_contribution(left.contributions, missed, path.slot, radiance);
        }
        // In place: no more paths are left than were read, so nothing unread is overwritten.
        if found.any() {
            let indices = L::compress_indices(found);
            scratch.queue.store_path(left.hits, &path.compress(indices), lights);
            scratch.queue.store_hit(left.hits, &compress_hit(&hit, indices), triangles);
            left.hits += found.count();
        }
    }
}

/// The lanes at `indices`, moved to the front.
#[inline(always)]
fn compress_hit<L: Lane>(hit: &Hit<L>, indices: L::CompressIndices) -> Hit<L> {
    Hit {
        t: hit.t.compress(indices),
        primitive: L::compress_bits(hit.primitive, indices),
        u: hit.u.compress(indices),
        v: hit.v.compress(indices),
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
