//! Baldwin and Weber's method: an affine map per triangle.

use super::triangle::TriangleMethod;
use crate::kernel::ray_triangle::TriangleHit;
use crate::lane::{Lane, Mask};
use crate::math::{Ray, Vec3};

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
