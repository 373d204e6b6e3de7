//! Hits at silhouette edges: of two triangles that a ray meets at one distance, the near one is hit.

use super::context::TraceContext;
use super::scratch::Scratch;
use crate::buffers::TriangleRow;
use crate::kernel::surface::inset;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{EPSILON, Hit, MISS};
use crate::rays::{Hits, Kind, Rays};
use crate::traverse::Tracer;
use std::ops::Range;

/// The share of [`crate::kernel::surface::near_edge`] within which hits are looked at, by the error of a hit
/// instead of the offset: two of those from an edge, where rounding moves a hit by half of one.
const SHARE: f32 = 0.25;
/// The largest barycentric weight at which hits are looked at: one packet of sixteen in twenty has such a hit
/// by chance. Only triangles smaller than a 2,000th of their coordinates, or of a ray's length, would need
/// more.
const MOST: f32 = 1.0 / 1024.0;

/// Corrects hits next to edges that rays pass within rounding, where two triangles meet and one hides the
/// other: both are at one distance there, and the far one, met from behind, may come first. A path that went
/// on from it would be inside what the edge belongs to, outside of a room.
///
/// From where the ray began, a point a little inside the triangle and before it must be in sight; what is
/// before that point is hit instead. Such looks are not counted as rays.
///
/// `FIRST`: the queue holds primary rays.
#[inline(never)]
pub fn correct_hits<L: Lane, const N: u32, const FIRST: bool>(
    context: &TraceContext,
    scratch: &mut Scratch,
    paths: Range<usize>,
) {
    let ranges = context.buffers.ranges;
    for at in paths.clone().step_by(L::WIDTH) {
        let hit: Hit<L> = scratch.queue.hit(at);
        let on_triangle = hit.found() & ranges.are_of_kind(Kind::Triangle, hit.primitive);
        let on_triangle = on_triangle & L::Mask::first(paths.end - at);
        let near = on_triangle & hit.least_weight().lt(L::splat(MOST));
        if !near.any() {
            continue;
        }
        let ray = context.path::<L, N, FIRST>(&scratch.queue, at).ray;
        let index = ranges.index_in_kind(Kind::Triangle, hit.primitive);
        let triangle = L::Bits::select(near, index, L::Bits::splat(0));
        let TriangleRow { a, edges, ng, offset, near_edge, .. } =
            TriangleRow::fetch(&context.buffers.triangle_rows, triangle, false);
        // As `triangle_offset`, of a ray that comes from far away.
        let error = L::splat(16.0 * EPSILON).mul_add(hit.t, offset);
        let at_edge = near & (hit.least_weight() * offset).lt(near_edge * L::splat(SHARE) * error);
        if !at_edge.any() {
            continue;
        }
        let (u, v) = inset((hit.u, hit.v), edges, error);
        let point = edges[0].mul_add(u, edges[1].mul_add(v, a));
        let before = ng.flip_sign(-ray.direction.dot(ng)).mul_add(error, point);
        for lane in at_edge.lanes() {
            let ends = [ray.origin.get(lane), before.get(lane)];
            let nearer = first_between(context, &mut scratch.tracer, ends);
            if nearer.primitive != MISS {
                scratch.queue.other_hits().set(at + lane, &nearer);
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
    tracer.without_counting(|tracer| {
        tracer.closest_one_by_one(&context.structure, &rays.until(&[length]), &mut hits);
    });
    hits.get(0)
}
