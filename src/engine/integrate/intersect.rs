//! Second stage: finds the nearest hit of every path of the queue, and ends the paths that miss or that hit
//! what scatters nothing.
//!
//! For: [`intersect`], [`intersect_queue`], which only finds hits. May import: `scratch`, `linear_rays`,
//! `emission` (of the environment) and what stands above them. Must never know: shading of surfaces.

use super::context::TraceContext;
use super::emission::missed_radiance;
use super::features::{ends_at_emitters, ends_missed, has};
use super::linear_rays::{LinearRays, RaySource};
use super::scratch::Scratch;
use super::stats::RayKind;
use crate::buffers::Features;
use crate::lane::{Bits, Lane, Mask};
use crate::math::Hit;
use crate::traverse::PrimitiveList;
use std::ops::Range;

/// The segment that [`intersect`] finds the ends of.
pub struct Segment {
    /// The paths' indices in the queue.
    pub paths: Range<usize>,
    /// Paths that have ended on a surface in earlier segments.
    pub ended: usize,
    /// No segment follows.
    pub is_last: bool,
}

/// What a run of [`intersect`] leaves.
pub struct Intersected {
    /// The indices in the queue of paths to shade.
    pub hits: Range<usize>,
    /// Contributions of those that missed.
    pub contributions: usize,
    /// Paths that have ended on a surface, in the queue of their own.
    pub ended: usize,
}

impl Intersected {
    /// The paths of a tile's primary rays, as [`super::generate()`] leaves them: in the order of their
    /// pixels, those that missed too.
    pub fn all(paths: Range<usize>) -> Self {
        Self { hits: paths, contributions: 0, ended: 0 }
    }
}

/// Finds the nearest hits of paths after a bounce. Those that go on are compressed to the front of their
/// range, so that shading has full packets; these end here:
/// - Under a sky ([`ends_missed`]), paths that miss. They add the environment's radiance. Without one,
///   shading finds them.
/// - Where emitters are textured ([`ends_at_emitters`]), paths that hit one. They move to the queue of ended
///   paths, and all that are left after the last segment follow them.
pub fn intersect<L: Lane, const N: u32>(
    context: &TraceContext,
    scratch: &mut Scratch,
    segment: Segment,
) -> Intersected {
    let (paths, ended) = (segment.paths.clone(), segment.ended);
    let mut result = Intersected { hits: paths.start..paths.start, contributions: 0, ended };
    intersect_queue::<L>(context, None, scratch, paths, RayKind::Bounce);
    end_paths::<L, N>(context, scratch, segment, &mut result);
    result
}

/// Which primitives are textured emitters, if paths end at those.
#[inline(always)]
pub fn ending_emitters<const N: u32>(context: &TraceContext) -> Option<&[f32; 16]> {
    context.buffers.emitters.as_deref().filter(|_| ends_at_emitters(N))
}

/// Ends the paths that end here, and compresses the others and their hits.
///
/// It is not one loop with the tests of primitives: in short loops the processor works on several packets at
/// a time.
#[inline(always)]
fn end_paths<L: Lane, const N: u32>(
    context: &TraceContext,
    scratch: &mut Scratch,
    Segment { paths, is_last, .. }: Segment,
    result: &mut Intersected,
) {
    let (columns, triangles) = (context.columns::<N>(), has(N, Features::TRIANGLES));
    let emitters = ending_emitters::<N>(context);
    if !ends_missed(N) && emitters.is_none() {
        result.hits = paths;
        return;
    }
    for at in paths.clone().step_by(L::WIDTH) {
        let hit: Hit<L> = scratch.queue.hit(at);
        let active = L::Mask::first(paths.end - at);
        let found = hit.found() & active;
        let nothing = L::Mask::splat(false);
        let missed = if ends_missed(N) { active & !found } else { nothing };
        let ended = match emitters {
            None => nothing,
            Some(_) if is_last => active & !missed,
            Some(emits) => found & L::zero().lt(L::pick_of_16(emits, hit.primitive)),
        };
        let going_on = active & !(missed | ended);
        if going_on.all() && result.hits.end == at {
            result.hits.end += L::WIDTH;
            continue;
        }
        let path = scratch.queue.path(at, columns);
        if missed.any() {
            let radiance = missed_radiance::<L, N, false>(context, &path, missed);
            result.contributions =
                scratch.push_contribution(result.contributions, missed, path.slot, radiance);
        }
        if ended.any() {
            scratch.ended.store_path(result.ended, &path.compress(ended, columns), columns);
            scratch.ended.store_hit(result.ended, &compress_hit(&hit, ended), triangles);
            result.ended += ended.count();
        }
        // In place: no more paths are left than were read, so nothing unread is overwritten.
        if going_on.any() {
            scratch.queue.store_path(result.hits.end, &path.compress(going_on, columns), columns);
            scratch.queue.store_hit(result.hits.end, &compress_hit(&hit, going_on), triangles);
            result.hits.end += going_on.count();
        }
    }
}

/// The lanes of `mask`, moved to the front.
#[inline(always)]
fn compress_hit<L: Lane>(hit: &Hit<L>, mask: L::Mask) -> Hit<L> {
    Hit {
        t: hit.t.compress(mask),
        primitive: hit.primitive.compress(mask),
        u: hit.u.compress(mask),
        v: hit.v.compress(mask),
    }
}

/// Finds the nearest hits of a range of the path queue, by whatever traversal was chosen; without a
/// hierarchy only `visible` primitives are tested. Primary rays start at the camera: only with a hierarchy
/// their origins are read from the queue.
#[inline(always)]
pub fn intersect_queue<L: Lane>(
    context: &TraceContext,
    visible: Option<&PrimitiveList>,
    scratch: &mut Scratch,
    paths: Range<usize>,
    kind: RayKind,
) {
    match context.primitives.hierarchy() {
        Some((hierarchy, traversal)) => scratch.intersect_hierarchy(hierarchy, traversal, paths, kind),
        None => {
            let source = match kind {
                RayKind::Primary => RaySource::Camera(context.camera),
                _ => RaySource::Paths,
            };
            let mut rays = LinearRays { source, queue: &mut scratch.queue, range: paths };
            context.primitives.trace_linear::<L>(&context.buffers, visible, &mut rays);
        }
    }
}
