//! Rays against triangles: the engine's test, and others.

use crate::kernel::ray_triangle::{TriangleHit, WoopRay, WoopTriangle};
use crate::lane::{Lane, Mask};
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

/// A vertex and the two edges that leave it.
#[derive(Clone, Copy, Debug)]
pub struct Edges {
    a: glam::Vec3,
    ab: glam::Vec3,
    ac: glam::Vec3,
}

/// Möller and Trumbore's test: solves for t and the barycentrics by Cramer's rule.
///
/// Error: loses 16 % of the rays aimed at edges that two triangles share and 23 % of those aimed at vertices;
/// without FMA 10 % and 8 % (`mesh-edges` and `mesh-vertices` of `octray stability`).
/// Source: Möller, Trumbore, "Fast, Minimum Storage Ray/Triangle Intersection", JGT 2(1), 1997 (non-culling
/// branch, without an epsilon on the determinant, which would make small triangles vanish).
pub type MollerTrumbore = CramersRule<false>;

/// [`MollerTrumbore`] with an epsilon: determinants between −1e-6 and 1e-6 count as parallel. For charts.
///
/// Error: as [`MollerTrumbore`]; it also misses all triangles with edges below some 1e-3, because the
/// determinant is an area and not an angle.
/// Source: the listing in the same paper.
pub type MollerTrumboreEpsilon = CramersRule<true>;

/// Möller and Trumbore's test, with an epsilon on the determinant or without.
pub struct CramersRule<const EPSILON: bool>;

impl<const EPSILON: bool> TriangleMethod for CramersRule<EPSILON> {
    type Stored = Edges;
    type Precalculated<L: Lane> = Ray<L>;

    fn store([a, b, c]: [glam::Vec3; 3]) -> Edges {
        Edges { a, ab: b - a, ac: c - a }
    }
    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>) -> Ray<L> {
        *ray
    }
    #[inline(always)]
    fn test<L: Lane>(ray: &Ray<L>, triangle: &Edges, limit: L) -> TriangleHit<L> {
        let (ab, ac) = (Vec3::splat(triangle.ab), Vec3::splat(triangle.ac));
        let p = ray.direction.cross(ac);
        let determinant = ab.dot(p);
        let inverse = L::one() / determinant;
        let from_a = ray.origin - Vec3::splat(triangle.a);
        let u = from_a.dot(p) * inverse;
        let mut inside = L::zero().le(u) & u.le(L::one());
        if EPSILON {
            inside = inside & L::splat(1e-6).le(determinant.abs());
        }
        if !inside.any() {
            return TriangleHit::none(limit);
        }
        let q = from_a.cross(ab);
        let v = ray.direction.dot(q) * inverse;
        let t = ac.dot(q) * inverse;
        let mask = inside & L::zero().le(v) & (u + v).le(L::one()) & L::zero().lt(t) & t.lt(limit);
        TriangleHit { mask, t, u, v }
    }
}

/// Baldwin and Weber's test: an affine map, stored in 12 floats, takes each triangle to the unit triangle.
///
/// Error: each triangle rounds its own map, so shared edges leak; far from the origin it loses accuracy.
/// Source: Baldwin, Weber, "Fast Ray-Triangle Intersections by Coordinate Transformation", JCGT 5(3), 2016.
pub struct BaldwinWeber;

/// Three rows of an affine map; row 2 gives the distance from the plane.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct AffineMap {
    rows: [[f32; 4]; 3],
}

impl TriangleMethod for BaldwinWeber {
    type Stored = AffineMap;
    type Precalculated<L: Lane> = Ray<L>;

    fn store(vertices: [glam::Vec3; 3]) -> AffineMap {
        // In f64, because the rounding of the map is the method's largest error; it is computed once per
        // triangle.
        let [a, b, c] = vertices.map(|v| v.as_dvec3());
        let (ab, ac) = (b - a, c - a);
        let normal = ab.cross(ac);
        // The inverse of the matrix with columns ab, ac, n, where n is `normal` scaled to a useful length.
        let scale = 1.0 / normal.length_squared();
        let row_u = ac.cross(normal) * scale;
        let row_v = normal.cross(ab) * scale;
        let row_n = normal / normal.length();
        let row = |r: glam::DVec3| [r.x as f32, r.y as f32, r.z as f32, -r.dot(a) as f32];
        AffineMap { rows: [row(row_u), row(row_v), row(row_n)] }
    }
    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>) -> Ray<L> {
        *ray
    }
    #[inline(always)]
    fn test<L: Lane>(ray: &Ray<L>, triangle: &AffineMap, limit: L) -> TriangleHit<L> {
        let rotate = |row: &[f32; 4], v: Vec3<L>| {
            Vec3::new(L::splat(row[0]), L::splat(row[1]), L::splat(row[2])).dot(v)
        };
        let [row_u, row_v, row_n] = &triangle.rows;
        let t = -(rotate(row_n, ray.origin) + L::splat(row_n[3])) / rotate(row_n, ray.direction);
        let in_front = L::zero().lt(t) & t.lt(limit);
        if !in_front.any() {
            return TriangleHit::none(limit);
        }
        let point = ray.at(t);
        let u = rotate(row_u, point) + L::splat(row_u[3]);
        let v = rotate(row_v, point) + L::splat(row_v[3]);
        let mask = in_front & L::zero().le(u) & L::zero().le(v) & (u + v).le(L::one());
        TriangleHit { mask, t, u, v }
    }
}

/// The test in Plücker coordinates: the ray passes the three edges on the same side.
///
/// Error: both triangles of an edge compute the same number, so edges do not leak; vertices leak 1.7 % of the
/// rays aimed at them, without FMA 0.3 % (`mesh-vertices` of `octray stability`).
/// Source: Shevtsov et al., "Ray-Triangle Intersection Algorithm for Modern CPU Architectures", GraphiCon
/// 2007.
pub struct Plucker;

impl TriangleMethod for Plucker {
    type Stored = [glam::Vec3; 3];
    type Precalculated<L: Lane> = Ray<L>;

    fn store(vertices: [glam::Vec3; 3]) -> [glam::Vec3; 3] {
        vertices
    }
    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>) -> Ray<L> {
        *ray
    }
    #[inline(always)]
    fn test<L: Lane>(ray: &Ray<L>, vertices: &[glam::Vec3; 3], limit: L) -> TriangleHit<L> {
        let [a, b, c] = vertices.map(|v| Vec3::splat(v) - ray.origin);
        // The volume spanned by the direction and an edge: both triangles of the edge compute exactly
        // opposite numbers.
        let side = |p: Vec3<L>, q: Vec3<L>| ray.direction.dot((q - p).cross(q + p));
        let (u, v, w) = (side(b, c), side(c, a), side(a, b));
        let (least, most) = (u.min(v).min(w), u.max(v).max(w));
        let inside = L::zero().le(least) | most.le(L::zero());
        if !inside.any() {
            return TriangleHit::none(limit);
        }
        let normal = (b - a).cross(c - a);
        let t = normal.dot(a) / normal.dot(ray.direction);
        let inverse = L::one() / (u + v + w);
        let mask = inside & L::zero().lt(t) & t.lt(limit);
        TriangleHit { mask, t, u: v * inverse, v: w * inverse }
    }
}
