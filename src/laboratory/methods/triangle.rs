//! Rays against triangles: what a method is, and the engine's.

use crate::kernel::ray_triangle::{TriangleHit, WoopRay, WoopTriangle};
use crate::lane::Lane;
use crate::math::{Ray, Vec3};

/// A method of intersecting rays with triangles.
///
/// Shapes: a packet of `WIDTH` rays against one triangle, as `Stored` keeps it in memory.
/// Units: t in multiples of the direction's length, in (0, `limit`).
/// Domain: direction lengths between 1e-15 and 1e15. A zero or NaN direction misses. Inactive lanes have a
/// `limit` of 0, with which they miss.
pub trait TriangleMethod: Send + Sync + 'static {
    /// One triangle in memory.
    type Stored: Copy + Send + Sync;
    /// The values that are computed once per ray.
    type Precalculated<L: Lane>: Copy;

    /// Returns a triangle as it is kept in memory.
    fn store(vertices: [glam::Vec3; 3]) -> Self::Stored;
    /// Precalculates a ray for all triangles.
    fn precalculate<L: Lane>(ray: &Ray<L>) -> Self::Precalculated<L>;
    /// Returns the hit of each lane before its `limit`.
    fn test<L: Lane>(ray: &Self::Precalculated<L>, triangle: &Self::Stored, limit: L) -> TriangleHit<L>;

    /// Returns the lower and upper corner of the triangle's own box, of methods whose hits are restricted to
    /// it: see [`crate::kernel::ray_box::own_box`].
    fn own_box(_: &Self::Stored) -> Option<[glam::Vec3; 2]> {
        None
    }
}

/// The engine's test: [`crate::kernel::ray_triangle`].
pub struct Woop;

impl TriangleMethod for Woop {
    type Stored = WoopTriangle;
    type Precalculated<L: Lane> = WoopRay<L>;

    fn store(vertices: [glam::Vec3; 3]) -> WoopTriangle {
        WoopTriangle::new(vertices)
    }
    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>) -> WoopRay<L> {
        WoopRay::new(ray)
    }
    #[inline(always)]
    fn test<L: Lane>(ray: &WoopRay<L>, triangle: &WoopTriangle, limit: L) -> TriangleHit<L> {
        let found = ray.test(triangle).unwrap_or_else(|| TriangleHit::none(limit));
        TriangleHit { mask: found.mask & found.t.lt(limit), ..found }
    }
    #[inline(always)]
    fn own_box(triangle: &WoopTriangle) -> Option<[glam::Vec3; 2]> {
        Some(triangle.own_box())
    }
}

/// [`Woop`] with FMA in its edge functions, as a contracting compiler would make it.
///
/// Error: leaks 0.5 % of the rays aimed at edges, none without FMA (`mesh-edges` of `octray stability`).
pub struct WoopContracted;

impl TriangleMethod for WoopContracted {
    type Stored = [glam::Vec3; 3];
    type Precalculated<L: Lane> = WoopRay<L>;

    fn store(vertices: [glam::Vec3; 3]) -> [glam::Vec3; 3] {
        vertices
    }
    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>) -> WoopRay<L> {
        WoopRay::new(ray)
    }
    #[inline(always)]
    fn test<L: Lane>(ray: &WoopRay<L>, vertices: &[glam::Vec3; 3], limit: L) -> TriangleHit<L> {
        let (_, origin, shear) = ray.into_parts();
        let [a, b, c] = vertices.map(|vertex| origin - ray.in_order(Vec3::splat(vertex)));
        let sheared = |v: Vec3<L>| (shear.x.mul_add(v.z, -v.x), shear.y.mul_add(v.z, -v.y));
        let (pa, pb, pc) = (sheared(a), sheared(b), sheared(c));
        let edge = |p: (L, L), q: (L, L)| p.1.neg_mul_add(q.0, p.0 * q.1);
        let (u, v, w) = (edge(pc, pb), edge(pa, pc), edge(pb, pa));
        let (least, most) = (u.min(v).min(w), u.max(v).max(w));
        let inside = L::zero().le(least) | most.le(L::zero());
        let inverse = L::one() / (u + v + w);
        let t = u.mul_add(a.z, v.mul_add(b.z, w * c.z)) * shear.z * inverse;
        let mask = inside & L::zero().lt(t) & t.lt(limit) & t.lt(L::splat(f32::INFINITY));
        TriangleHit { mask, t, u: v * inverse, v: w * inverse }
    }
}
