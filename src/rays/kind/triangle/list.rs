//! Intersects rays with a list of triangles.

use super::leaf::visit_found;
use crate::columns::{Hits, Rays};
use crate::kernel::ray_box::{BoxRay, Padding, own_box};
use crate::kernel::ray_triangle::{PairHit, TriangleHit, WoopRay, WoopTriangle};
use crate::kind::Kind;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, MISS, Ray, Vec3};
use crate::numbering::Candidates;
use crate::prepared::SingleRay;

/// All triangles, in the order of their numbers.
pub struct List {
    /// The triangles, linked in pairs where two share an edge.
    triangles: Vec<WoopTriangle>,
    /// The number of the first triangle.
    first: u32,
    pub(crate) padding: Padding,
}

impl List {
    /// Stores all triangles; the first has the number `first`.
    pub fn new((first, triangles): (usize, &[[glam::Vec3; 3]]), padding: Padding) -> Self {
        let mut triangles: Vec<_> = triangles.iter().map(|&vertices| WoopTriangle::new(vertices)).collect();
        WoopTriangle::link_pairs(&mut triangles);
        Self { triangles, first: first as u32, padding }
    }

    /// Returns the number of triangles.
    pub(crate) fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Calls `visit` with each hit of a ray.
    pub fn visit(&self, ray: &SingleRay, visit: &mut impl FnMut(Hit<f32>)) {
        for (number, triangle) in (self.first..).zip(&self.triangles) {
            if let Some(found) = ray.woop.test(triangle) {
                let [lo, hi] = triangle.own_box().map(Vec3::splat);
                visit_found(&found, (lo, hi), number, &ray.box_ray, visit);
            }
        }
    }

    /// Finds the nearest hit of each ray among all triangles or the `listed` ones. With `has_hits`, an
    /// earlier hit stays unless a triangle is strictly nearer; without it, the hits are overwritten.
    pub fn trace<L: Lane>(&self, rays: &Rays, hits: (bool, &mut Hits), listed: Option<&Candidates>) {
        let all = &self.triangles;
        match listed {
            None => trace_triangles::<L>((self.first..).zip(all), self.padding, rays, hits),
            Some(candidates) => {
                let listed = candidates.of_kind(Kind::Triangle).iter();
                let listed = listed.map(|&index| (self.first + index, &all[index as usize]));
                trace_triangles::<L>(listed, self.padding, rays, hits);
            }
        }
    }
}

/// Finds the nearest triangle that each ray hits; with `has_hits`, an earlier hit stays unless a triangle is
/// strictly nearer. The triangles come from an iterator and not from a closure, which would be too large to
/// be inlined into the loop (4 % more instructions in boxes).
///
/// Shapes: packets of `WIDTH` rays; one triangle, or two that share an edge, at a time is broadcast to all
/// lanes.
#[inline(never)]
fn trace_triangles<'a, L: Lane>(
    triangles: impl Iterator<Item = (u32, &'a WoopTriangle)> + Clone,
    padding: Padding,
    rays: &Rays,
    (has_hits, hits): (bool, &mut Hits),
) {
    for at in (0..rays.len()).step_by(L::WIDTH) {
        let (t, primitive) = match has_hits {
            true => hits.nearest(at),
            false => (rays.t_max(at), L::Bits::splat(MISS)),
        };
        let (ray, mut hit) = (rays.packet::<L>(at), Hit { t, primitive, u: L::zero(), v: L::zero() });
        let woop = WoopRay::new(&ray);
        let mut triangles = triangles.clone().peekable();
        while let Some((number, triangle)) = triangles.next() {
            if triangle.is_linked()
                && let Some(&(next, second)) = triangles.peek()
                && next == number + 1
                && let Some(found) = woop.test_pair([triangle, second])
            {
                triangles.next();
                keep_pair_if_nearer(&mut hit, &ray, padding, number, [triangle, second], found);
            } else if let Some(found) = woop.test(triangle) {
                let corners = triangle.own_box().map(Vec3::splat);
                keep_if_nearer(&mut hit, &ray, padding, L::Bits::splat(number), corners, found);
            }
        }
        hits.store(at, &hit);
    }
}

/// Keeps the hits of a pair of triangles that are nearer than those found before.
#[inline(always)]
fn keep_pair_if_nearer<L: Lane>(
    hit: &mut Hit<L>,
    ray: &Ray<L>,
    padding: Padding,
    number: u32,
    [first, second]: [&WoopTriangle; 2],
    PairHit { hit: found, is_second }: PairHit<L>,
) {
    if !found.mask.any() {
        return;
    }
    let of = |first: f32, second: f32| L::select(is_second, L::splat(second), L::splat(first));
    let corner = |first: glam::Vec3, second: glam::Vec3| {
        Vec3::new(of(first.x, second.x), of(first.y, second.y), of(first.z, second.z))
    };
    let [first, second] = [first.own_box(), second.own_box()];
    let corners = [corner(first[0], second[0]), corner(first[1], second[1])];
    let number = L::Bits::select(is_second, L::Bits::splat(number + 1), L::Bits::splat(number));
    keep_if_nearer(hit, ray, padding, number, corners, found);
}

/// Keeps the hits of `found` that are nearer than earlier ones, restricted to the triangles' own boxes.
#[inline(always)]
fn keep_if_nearer<L: Lane>(
    hit: &mut Hit<L>,
    ray: &Ray<L>,
    padding: Padding,
    number: L::Bits,
    [lo, hi]: [Vec3<L>; 2],
    found: TriangleHit<L>,
) {
    // The box ray is computed here and not once per packet: few packets hit a triangle's plane inside its
    // edges.
    let (mask, t) = own_box(&BoxRay::new(ray, padding), (lo, hi), found.mask, found.t, hit.t);
    hit.replace(mask, &Hit { t, primitive: number, u: found.u, v: found.v });
}
