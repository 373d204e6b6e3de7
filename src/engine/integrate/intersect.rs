//! The second stage: finds the nearest hit of every path of the queue, and ends the paths that miss.

use super::context::TraceContext;
use super::context::{ends_missed, has};
use super::emission::missed_radiance;
use super::opacity::pass_through;
use super::scratch::Scratch;
use super::stats::RayKind;
use crate::buffers::Features;
use crate::lane::{Bits, Lane, Mask};
use crate::math::Hit;
use crate::rays::Candidates;
use std::ops::Range;

/// The result of [`intersect`].
pub struct Intersected {
    /// The indices in the queue of the paths to shade.
    pub hits: Range<usize>,
    /// The number of contributions of paths that missed.
    pub contributions: usize,
}

impl Intersected {
    /// Returns the paths of a tile's primary rays, as [`super::generate()`] leaves them: in the order of
    /// their pixels, including those that missed.
    pub fn all(paths: Range<usize>) -> Self {
        Self { hits: paths, contributions: 0 }
    }
}

/// Finds the nearest hits of paths after `bounce` bounces, or the first that they do not pass. Under a sky
/// ([`ends_missed`]) paths that miss add the environment's radiance and end, and the others are compressed to
/// the front of their range, so that shading has full packets. Without a sky, shading finds the paths that
/// miss.
///
/// This loop is separate from the tests of primitives, because in short loops the processor works on several
/// packets at a time.
pub fn intersect<L: Lane, const N: u64>(
    context: &TraceContext,
    scratch: &mut Scratch,
    paths: Range<usize>,
    bounce: u32,
) -> Intersected {
    closest_of_queue(context, None, scratch, paths.clone(), RayKind::Bounce);
    if context.has_opacity::<N>() {
        pass_through(context, scratch, paths.clone(), bounce, false);
    }
    if !ends_missed(N) {
        return Intersected::all(paths);
    }
    let mut result = Intersected::all(paths.start..paths.start);
    let (columns, triangles) = (context.columns::<N>(), has(N, Features::TRIANGLES));
    for at in paths.clone().step_by(L::WIDTH) {
        let hit: Hit<L> = scratch.queue.hit(at);
        let active = L::Mask::first(paths.end - at);
        let found = hit.found() & active;
        if found.all() && result.hits.end == at {
            result.hits.end += L::WIDTH;
            continue;
        }
        let (path, missed) = (scratch.queue.path(at, columns), active & !found);
        if missed.any() {
            let radiance = missed_radiance::<L, N, false>(context, &path, missed);
            result.contributions = scratch.radiance.push(result.contributions, missed, path.slot, radiance);
        }
        // In place: no more paths are left than were read, so nothing unread is overwritten.
        if found.any() {
            scratch.queue.store_path(result.hits.end, &path.compress(found, columns), columns);
            scratch.queue.store_hit(result.hits.end, &compress_hit(&hit, found), triangles);
            result.hits.end += found.count();
        }
    }
    result
}

/// Moves the lanes of `mask` to the front.
#[inline(always)]
fn compress_hit<L: Lane>(hit: &Hit<L>, mask: L::Mask) -> Hit<L> {
    Hit {
        t: hit.t.compress(mask),
        primitive: hit.primitive.compress(mask),
        u: hit.u.compress(mask),
        v: hit.v.compress(mask),
    }
}

/// Finds the nearest hits of a range of the path queue. `visible` holds all primitives that the rays can hit,
/// if they are known.
#[inline(always)]
pub fn closest_of_queue(
    context: &TraceContext,
    visible: Option<&Candidates>,
    scratch: &mut Scratch,
    paths: Range<usize>,
    kind: RayKind,
) {
    let Scratch { queue, tracer, observer, .. } = scratch;
    let origin = context.camera.common_origin().filter(|_| kind == RayKind::Primary);
    let (rays, mut hits) = queue.queries(paths, origin);
    tracer.closest_in_scene(&context.structure, &rays.among(visible), &mut hits);
    observer.add_tests(kind, tracer);
}
