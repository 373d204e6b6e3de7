//! The engine's methods changed in one point, as other programs have them.

use crate::kernel::ray_sphere::{QuadraticEquation, SphereMethod};
use crate::kernel::ray_triangle::{Edges, MollerTrumbore, TriangleHit, TriangleMethod, Woop, WoopRay};
use crate::lane::Lane;
use crate::math::{Ray, Vec3};

/// [`Robust`](crate::kernel::ray_sphere::Robust) for directions of any length between 1e-15 and 1e15, at the
/// cost of one division per ray and three products per test.
pub struct RobustAnyLength;

/// A ray, its direction's squared length, and one over that.
#[derive(Clone, Copy)]
pub struct Scaled<L> {
    ray: Ray<L>,
    a: L,
    inverse_a: L,
}

impl SphereMethod for RobustAnyLength {
    type Precalculated<L: Lane> = Scaled<L>;
    const MAY_CULL: bool = false;

    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>) -> Scaled<L> {
        let a = ray.direction.dot(ray.direction);
        Scaled { ray: *ray, a, inverse_a: L::one() / a }
    }
    #[inline(always)]
    fn equation<L: Lane>(
        Scaled { ray, inverse_a, .. }: &Scaled<L>,
        center: Vec3<L>,
        radius2: L,
    ) -> (L::Mask, QuadraticEquation<L>) {
        let from_center = ray.origin - center;
        let c = from_center.dot(from_center) - radius2;
        let b = -from_center.dot(ray.direction);
        let perpendicular = ray.direction.mul_add(b * *inverse_a, from_center);
        let discriminant = radius2 - perpendicular.dot(perpendicular);
        (L::zero().le(discriminant), QuadraticEquation { b, c, discriminant })
    }
    #[inline(always)]
    fn root<L: Lane>(
        Scaled { a, inverse_a, .. }: &Scaled<L>,
        &QuadraticEquation { b, c, discriminant }: &QuadraticEquation<L>,
    ) -> L {
        let q = b + (*a * discriminant).sqrt().flip_sign(b);
        let far = q * *inverse_a;
        let ahead_from_inside = c.le(L::zero()) & L::zero().lt(q);
        L::select(ahead_from_inside, far, (c / q).min(far.abs()))
    }
}

/// [`MollerTrumbore`] with an epsilon: determinants between −1e-6 and 1e-6 count as parallel. For charts.
///
/// Error: as [`MollerTrumbore`]; it also misses all triangles with edges below some 1e-3, because the
/// determinant is an area and not an angle.
/// Source: the listing in the same paper.
pub struct MollerTrumboreEpsilon;

impl TriangleMethod for MollerTrumboreEpsilon {
    type Stored = Edges;
    type Precalculated<L: Lane> = Ray<L>;

    fn store(vertices: [glam::Vec3; 3]) -> Edges {
        MollerTrumbore::store(vertices)
    }
    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>) -> Ray<L> {
        *ray
    }
    #[inline(always)]
    fn test<L: Lane>(ray: &Ray<L>, triangle: &Edges, limit: L) -> TriangleHit<L> {
        triangle.test(ray, limit, |determinant| L::splat(1e-6).le(determinant.abs()))
    }
}

/// [`Woop`] with FMA in its edge functions, as a contracting compiler
/// would make it.
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
        Woop::precalculate(ray)
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
