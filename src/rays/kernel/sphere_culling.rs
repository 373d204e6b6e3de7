//! A conservative culling test for spheres, cheaper than the test of [`super::ray_sphere`].

use super::ray_sphere::may_hit;
use crate::lane::Lane;
use crate::math::{Ray, Vec3};
use bytemuck::{Pod, Zeroable};

/// Twice the sum of the errors below, as a multiple of |o|² + |c|² + r².
const MARGIN: f64 = 128.0 * (f32::EPSILON / 2.0) as f64;

/// Beyond this squared distance from the origin, in squared scene units, nothing is culled: below it, squares
/// of coordinates stay far from overflow.
const LARGEST: f32 = 1e30;

/// A margin for squares that are so small that their errors are no longer relative.
const SMALLEST: f64 = 64.0 * f32::MIN_POSITIVE as f64;

/// A sphere as [`SphereCulling`] reads it.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(16))]
pub struct CulledSphere {
    center: [f32; 3],
    /// |c|² − r², less its share of the margin; −∞ for a sphere that is never culled, with its centre at 0.
    power: f32,
}

impl CulledSphere {
    /// Prepares a sphere given in scene units.
    pub fn new(center: glam::Vec3, radius: f32) -> Self {
        let (c2, r2) = (center.as_dvec3().length_squared(), f64::from(radius).powi(2));
        let power = c2 - r2 - MARGIN * (c2 + r2) - SMALLEST;
        let (center, power) = match c2 + r2 < f64::from(LARGEST) {
            true => (center.to_array(), power as f32),
            false => ([0.0; 3], f32::NEG_INFINITY),
        };
        Self { center, power }
    }
}

/// A packet of rays, prepared for the culling of many spheres.
///
/// With the ray's origin o and direction d, a sphere's centre c and radius r: b = d · (c − o) and
/// e = |c − o|² − r². The line misses the sphere if b² < e; the sphere lies behind if b < 0 < e. Since e is
/// (|c|² − r²) + |o|² − 2 o · c, both take eight operations on prepared rays and spheres, the exact test 20.
///
/// Domain: that of [`super::ray_sphere`], directions of unit length within 1e-5.
/// Bounds: with ε = 2⁻²⁴ and S = |o| + |c|, rounding errors are at most 10 ε (S² + r²) in e and 10 ε S in b,
/// hence at most 32 ε (S² + r²) in b² − e. The discriminant of the exact test is at most 16 ε (S² + r²) too
/// large. With S² ≤ 2 (|o|² + |c|²) a margin of 128 ε (|o|² + |c|² + r²) covers both. Where rounding
/// `tests/laws/kernel_sphere_box.rs`.
#[derive(Clone, Copy)]
pub struct SphereCulling<L: Lane> {
    direction: Vec3<L>,
    /// −d · o.
    along: L,
    /// −2 o.
    minus_twice_origin: Vec3<L>,
    /// |o|², less its share of the margin.
    power: L,
}

impl<L: Lane> SphereCulling<L> {
    /// Prepares a packet.
    #[inline(always)]
    pub fn new(ray: &Ray<L>) -> Self {
        let (length2, distance2) = (ray.direction.dot(ray.direction), ray.origin.dot(ray.origin));
        // Outside the range of squares, and for rays with NaN, all products are 0 and e is −∞: nothing is
        // culled.
        let largest = L::splat(LARGEST);
        let near = length2.lt(largest) & distance2.lt(largest);
        let only_near = |v: Vec3<L>| Vec3::select(near, v, Vec3::zero());
        // The exact test computes b² (2 − |d|²) − e. A direction times 1 − (|d|² − 1) / 2 gives the same b².
        let scale = length2.neg_mul_add(L::splat(0.5), L::splat(1.5));
        let (origin, direction) = (only_near(ray.origin), only_near(ray.direction * scale));
        let power = distance2 * L::splat((1.0 - MARGIN) as f32);
        Self {
            direction,
            along: -direction.dot(origin),
            minus_twice_origin: origin * L::splat(-2.0),
            power: L::select(near, power, L::splat(f32::NEG_INFINITY)),
        }
    }

    /// Returns the rays that may hit the sphere: all rays that do, and few others.
    #[inline(always)]
    pub fn may_hit(&self, sphere: &CulledSphere) -> L::Mask {
        let [x, y, z] = sphere.center.map(L::splat);
        let b =
            x.mul_add(self.direction.x, y.mul_add(self.direction.y, z.mul_add(self.direction.z, self.along)));
        let Vec3 { x: ox, y: oy, z: oz } = self.minus_twice_origin;
        let e = x.mul_add(ox, y.mul_add(oy, z.mul_add(oz, self.power + L::splat(sphere.power))));
        // The margins keep e and b² − e away from 0 for rays that hit the sphere.
        may_hit(b, e, b.neg_mul_add(b, e).to_bits())
    }
}
