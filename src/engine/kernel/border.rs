//! The strip around a light: points on it, uniform by area, and the pdf of directions to them.

use crate::lane::Lane;
use crate::math::Vec3;

/// The points a + x ab + y ac of the outer parallelogram, −m ≤ x ≤ 1 + m and −m' ≤ y ≤ 1 + m', outside the
/// inner one, 0 ≤ x, y ≤ 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Strip {
    a: glam::Vec3,
    ab: glam::Vec3,
    ac: glam::Vec3,
    /// m and m'.
    margins: [f32; 2],
    normal: glam::Vec3,
    /// x = `to_x` · (point − a), and y likewise.
    to_x: glam::Vec3,
    to_y: glam::Vec3,
    /// The area of the strip in units of the inner parallelogram's, and one over it in scene units.
    area: f32,
    inverse_area: f32,
}

impl Strip {
    /// The strip around a parallelogram at `a` with edges `ab` and `ac`; margins in shares of the edges.
    pub fn new(a: glam::Vec3, ab: glam::Vec3, ac: glam::Vec3, margins: [f64; 2]) -> Self {
        let (x, y) = (ab.as_dvec3(), ac.as_dvec3());
        let cross = x.cross(y);
        let inner = cross.length();
        let [mx, my] = margins;
        let area = 2.0 * (mx + my) + 4.0 * mx * my;
        Self {
            a,
            ab,
            ac,
            margins: margins.map(|margin| margin as f32),
            normal: (cross / inner).as_vec3(),
            to_x: (y.cross(cross) / (inner * inner)).as_vec3(),
            to_y: (cross.cross(x) / (inner * inner)).as_vec3(),
            area: area as f32,
            inverse_area: (1.0 / (area * inner)) as f32,
        }
    }

    /// A point of the strip, uniform by area: the two sides along ab first, corners included.
    ///
    /// Domain: u and v in [0, 1).
    #[inline(always)]
    pub fn point<L: Lane>(&self, u: L, v: L) -> Vec3<L> {
        let [mx, my] = self.margins;
        let at = u * L::splat(self.area);
        let (long, short) = ((1.0 + 2.0 * mx) * my, mx);
        let is_short = L::splat(2.0 * long).le(at);
        let at = at - L::splat(2.0 * long).only(is_short);
        let size = L::select(is_short, L::splat(short), L::splat(long));
        let far = size.le(at);
        let along = (at - size.only(far)) / size;
        let margin = L::select(is_short, L::splat(mx), L::splat(my));
        let across = L::select(far, margin.mul_add(v, L::one()), margin * v - margin);
        let long_way = along.mul_add(L::splat(1.0 + 2.0 * mx), L::splat(-mx));
        let x = L::select(is_short, across, long_way);
        let y = L::select(is_short, along, across);
        Vec3::splat(self.ab).mul_add(x, Vec3::splat(self.ac).mul_add(y, Vec3::splat(self.a)))
    }

    /// The pdf of directions to the strip, in 1/sr; 0 in others.
    #[inline(always)]
    pub fn pdf<L: Lane>(&self, origin: Vec3<L>, wi: Vec3<L>) -> L {
        let normal = Vec3::splat(self.normal);
        let from = origin - Vec3::splat(self.a);
        let cosine = normal.dot(wi);
        let t = -normal.dot(from) / cosine;
        let point = wi.mul_add(t, from);
        let (x, y) = (Vec3::splat(self.to_x).dot(point), Vec3::splat(self.to_y).dot(point));
        let half = L::splat(0.5);
        // The distances from the centre.
        let (x, y) = ((x - half).abs(), (y - half).abs());
        let [mx, my] = self.margins;
        let in_outer = x.le(L::splat(0.5 + mx)) & y.le(L::splat(0.5 + my));
        let in_inner = x.le(half) & y.le(half);
        let inside = L::zero().lt(t) & in_outer & !in_inner;
        (t * t * L::splat(self.inverse_area) / cosine.abs()).only(inside)
    }
}
