//! Hits at silhouette edges: of two triangles that a ray meets at one distance, the near one is hit.
//!
//! For: [`correct_hits`].

use super::context::TraceContext;
use super::scratch::Scratch;
use super::surface::Surface;
use crate::buffers::Features;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, MISS};
use crate::traverse::Tracer;
use crate::traverse::rays::{Hits, Rays};
use std::ops::Range;

/// What a triangle's place takes.
const TRIANGLES: u32 = Features::TRIANGLES.with(Features::MANY_TRIANGLES).0;

/// The share of [`crate::kernel::surface::near_edge`] within which hits are looked at: two offsets from an
/// edge, where rounding moves a hit by half of one.
const SHARE: f32 = 0.25;
/// The largest barycentric coordinate at which hits are looked at. One packet of sixteen in twenty has such a
/// hit by chance. Only triangles smaller than a 2,000th of their largest coordinates would need more.
const MOST: f32 = 1.0 / 1024.0;

/// Corrects hits next to edges that rays pass within rounding, where two triangles meet and one hides the
/// other: both are at one distance there, and the far one, met from behind, may come first. A path that went
/// on from it would be inside what the edge belongs to, outside of a room.
///
/// From where the ray began, the point that the path goes on from must be in sight; what is before it is hit
/// instead.
///
/// `FIRST`: the queue holds primary rays.
#[inline(never)]
pub fn correct_hits<L: Lane, const N: u32, const FIRST: bool>(
    context: &TraceContext,
    scratch: &mut Scratch,
    paths: Range<usize>,
) {
    let first_triangle = L::Bits::splat(context.buffers.first_triangle);
    let most = L::splat((context.buffers.near_edge * SHARE).min(MOST));
    for at in paths.clone().step_by(L::WIDTH) {
        let hit: Hit<L> = scratch.queue.hit(at);
        let on_triangle = hit.found() & !hit.primitive.less(first_triangle) & L::Mask::first(paths.end - at);
        let least = hit.u.min(hit.v).min(L::one() - hit.u - hit.v);
        let near = on_triangle & least.lt(most);
        if !near.any() {
            continue;
        }
        let path = context.path::<L, N, FIRST>(&scratch.queue, at);
        let surface = Surface::of::<TRIANGLES>(context, &path, &hit, near);
        let at_edge = near & least.lt(surface.near_edge * L::splat(SHARE));
        let start = surface.ng.flip_sign(surface.facing).mul_add(surface.offset, surface.point);
        for lane in at_edge.lanes() {
            let ends = [path.ray.origin.get(lane), start.get(lane)];
            let before = first_between(context, &mut scratch.tracer, ends);
            if before.primitive != MISS {
                scratch.queue.other_hits().set(at + lane, &before);
            }
        }
    }
}

/// The nearest hit between two points.
fn first_between(context: &TraceContext, tracer: &mut Tracer, [from, to]: [glam::Vec3; 2]) -> Hit<f32> {
    let (direction, length) = (to - from).normalize_and_length();
    let [from, direction] = [from, direction].map(|v| v.to_array().map(|x| [x]));
    let rays = Rays::new(from.each_ref().map(|x| &x[..]), direction.each_ref().map(|x| &x[..]));
    let [mut t, mut u, mut v] = [[length]; 3];
    let mut hits = Hits { t: &mut t, primitive: &mut [MISS], u: &mut u, v: &mut v };
    context.primitives.closest_one_by_one(&rays.until(&[length]), &mut hits, None, tracer, None);
    hits.get(0)
}
