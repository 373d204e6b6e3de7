//! Corrects hits at silhouette edges: if a ray meets two triangles at one distance, it hits the near one.

use super::context::TraceContext;
use super::opacity::{Decision, first_stop};
use super::queue::Path;
use super::scratch::Scratch;
use crate::kernel::surface::inset;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{EPSILON, Hit, MISS, Ray, Vec3};
use crate::primitives::TriangleRow;
use crate::rays::{Hits, Kind, Rays, Tracer};
use std::ops::Range;

/// The share of [`crate::kernel::surface::near_edge`] within which hits are tested, with the error of a hit
/// in place of the offset: two errors from an edge, where rounding moves a hit by half of one.
const SHARE: f32 = 0.25;
/// Hits whose least barycentric weight is larger are skipped. By chance, one packet of sixteen in twenty has
/// a hit below it. Only triangles smaller than a 2,000th of their coordinates, or of a ray's length, would
/// need more.
const MOST: f32 = 1.0 / 1024.0;

/// Corrects hits next to edges that rays pass within rounding, where two triangles meet and one hides the
/// other: both are at one distance there, and the far one, met from behind, may come first. A path that
/// continued from it would be inside the edge's body, or outside of a room.
///
/// A ray from the original origin to a point a little inside the triangle and before it must be unoccluded;
/// anything before that point that the path does not pass becomes the hit. These visibility rays are not
/// included in the ray count.
///
/// With `FIRST`, the queue holds primary rays.
#[inline(never)]
pub fn correct_hits<L: Lane, const N: u64, const FIRST: bool>(
    context: &TraceContext,
    scratch: &mut Scratch,
    paths: Range<usize>,
    bounce: u32,
) {
    let ranges = context.primitives.ranges;
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
            TriangleRow::fetch(&context.primitives.triangles.rows, triangle, false);
        // Like `triangle_offset`, for a ray that comes from far away.
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
            let mut nearer = first_between(context, &mut scratch.tracer, ends);
            if context.has_opacity::<N>() {
                let path = context.path::<f32, N, FIRST>(&scratch.queue, at + lane);
                nearer = first_stop_between(context, scratch, path, (ends, nearer), bounce);
            }
            if nearer.primitive != MISS {
                scratch.queue.other_hits().set(at + lane, &nearer);
            }
        }
    }
}

/// Returns the first hit between two points that a path does not pass; `nearest` is the nearest one.
#[inline(never)]
fn first_stop_between(
    context: &TraceContext,
    scratch: &mut Scratch,
    path: Path<f32>,
    (ends, nearest): ([glam::Vec3; 2], Hit<f32>),
    bounce: u32,
) -> Hit<f32> {
    let [from, to] = ends;
    let (direction, length) = (to - from).normalize_and_length();
    let path = Path { ray: Ray { origin: Vec3::splat(from), direction: Vec3::splat(direction) }, ..path };
    let decision = Decision::of_sample(scratch, bounce);
    scratch
        .tracer
        .without_counting(|tracer| first_stop(context, tracer, &path, (nearest, length), decision).hit)
}

/// Returns the nearest hit between two points.
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
