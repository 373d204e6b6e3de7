//! Intersection kernels alone: a fixed set of rays and primitives, all tested against all.
//!
//! Rays come in coherent packets, like those of cameras and mirrors; most tests miss, as they do in scenes.
//! Every lane's result is used. No ray passes within 1e-6 of an edge or a silhouette, so rounding decides
//! nothing: hits equal those of double precision.

use crate::kernel::ray_box::Padding;
use crate::lane::{F32x8, Lane, Mask};
use crate::math::{Ray, Vec3};
use crate::methods::{BoxMethod, SphereMethod, TriangleMethod};
use glam::Vec3 as Point;

/// Rays: 64 packets of eight.
pub const RAYS: usize = 512;
/// Primitives of each kind, as in a small scene; all fit into the first-level cache.
pub(crate) const PRIMITIVES: usize = 64;
/// Largest absolute coordinate of a box.
const EXTENT: f32 = 2.0;
/// Tests of one ray against one primitive.
pub const TESTS: usize = RAYS * PRIMITIVES;

/// Returns the spheres: centre and squared radius.
pub fn spheres() -> Vec<(Point, f32)> {
    (0..PRIMITIVES as u32).map(sphere).collect()
}

/// Returns the triangles, as a method stores them.
pub fn triangles<T: TriangleMethod>() -> Vec<T::Stored> {
    (0..PRIMITIVES as u32).map(triangle).map(T::store).collect()
}

/// Result of all tests of a set.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    /// Tests that hit, of [`TESTS`].
    pub hits: usize,
    /// Sum of t over the hits.
    pub distance: f32,
}

/// Tests every ray against every sphere.
pub fn all_spheres<L: Lane, S: SphereMethod>(rays: &[Ray<L>], spheres: &[(Point, f32)]) -> Found {
    test_all(rays, spheres, S::precalculate, |ray, &(center, radius2)| {
        S::test(ray, Vec3::splat(center), L::splat(radius2), L::splat(f32::INFINITY))
    })
}

/// Tests every ray against every triangle.
pub fn all_triangles<L: Lane, T: TriangleMethod>(rays: &[Ray<L>], triangles: &[T::Stored]) -> Found {
    test_all(rays, triangles, T::precalculate, |ray, triangle| {
        let hit = T::test(ray, triangle, L::splat(f32::INFINITY));
        (hit.mask, hit.t)
    })
}

/// Returns the boxes, by their lower and upper corners: those of the triangles.
pub(crate) fn boxes() -> Vec<[Point; 2]> {
    let of = |[a, b, c]: [Point; 3]| [a.min(b).min(c), a.max(b).max(c)];
    (0..PRIMITIVES as u32).map(|index| of(triangle(index))).collect()
}

/// Tests every ray against every box; t is the entry point.
pub(crate) fn all_boxes<L: Lane, B: BoxMethod>(rays: &[Ray<L>], boxes: &[[Point; 2]]) -> Found {
    let prepare = |ray: &Ray<L>| B::precalculate(ray, Padding::new(EXTENT));
    test_all(rays, boxes, prepare, |ray, &[lo, hi]| {
        let (near, far) = B::pass(ray, Vec3::splat(lo), Vec3::splat(hi));
        (near.le(far) & L::zero().le(far), near)
    })
}

/// Sums the hits and the distances of all tests, over every lane, so that no test is optimised away.
#[inline(always)]
fn test_all<L: Lane, R, P>(
    rays: &[Ray<L>],
    primitives: &[P],
    prepare: impl Fn(&Ray<L>) -> R,
    test: impl Fn(&R, &P) -> (L::Mask, L),
) -> Found {
    let (mut hits, mut distance) = (0, L::zero());
    for ray in rays {
        let ray = prepare(ray);
        for primitive in primitives {
            let (mask, t) = test(&ray, primitive);
            hits += mask.count();
            distance = distance + t.only(mask);
        }
    }
    Found { hits, distance: (0..L::WIDTH).map(|lane| distance.get(lane)).sum() }
}

/// Returns random number `number` of item `item`, uniform in [0, 1): the same in every run, and independent
/// of the engine's generator (SplitMix64's mixer).
fn random(item: u32, number: u32) -> f32 {
    let mut x =
        (u64::from(item) << 32 | u64::from(number)).wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    (x >> 40) as f32 / (1 << 24) as f32
}

/// Returns a point in the cube [−1, 1]³, from three numbers.
fn point(item: u32, first: u32) -> Point {
    Point::from_array(std::array::from_fn(|axis| 2.0 * random(item, first + axis as u32) - 1.0))
}

/// Returns the rays in packets: from outside through the cube of primitives, eight neighbours a packet.
pub fn rays<L: Lane>() -> Vec<Ray<L>> {
    let ray = |index: usize| {
        // Item numbers that no primitive has.
        let (packet, lane) = ((1 << 16) + (index / F32x8::WIDTH) as u32, (1 << 17) + index as u32);
        let origin = 4.0 * (point(packet, 0) + Point::splat(1e-3)).normalize();
        let direction = (point(packet, 3) + 0.05 * point(lane, 0) - origin).normalize();
        Ray { origin: Vec3::splat(origin), direction: Vec3::splat(direction) }
    };
    let rays: Vec<Ray<f32>> = (0..RAYS).map(ray).collect();
    rays.chunks_exact(L::WIDTH).map(Ray::from_lanes).collect()
}

/// Returns a sphere in the cube: centre and squared radius.
fn sphere(index: u32) -> (Point, f32) {
    let radius = 0.05 + 0.25 * random(index, 3);
    (point(index, 0), radius * radius)
}

/// Returns a triangle in the cube.
fn triangle(index: u32) -> [Point; 3] {
    let center = point(index, 0);
    [3, 6, 9].map(|first| center + 0.5 * point(index, first))
}
