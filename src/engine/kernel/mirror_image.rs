//! The image of a light in a mirror sphere: a cone of directions that holds most of it.

use crate::lane::{Lane, functions};
use crate::math::Vec3;
use crate::sampling::warp;
use std::f32::consts::TAU;

/// A mirror sphere, and the sphere that stands for the light it shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MirrorImage {
    center: glam::Vec3,
    radius: f32,
    light: glam::Vec3,
    light_radius: f32,
    /// The unit vector from the mirror's centre to the light's.
    to_light: glam::Vec3,
}

/// The directions around a unit vector, from one point.
#[derive(Clone, Copy, Debug)]
pub struct Cone<L: Lane> {
    axis: Vec3<L>,
    /// 1 − the cosine of the half angle.
    one_minus_cos: L,
    /// One over it; 0 where the image is not seen.
    inverse: L,
}

/// 1 − cos of the narrowest cone, of 0.8°: rounding moves its edge by a thousandth of it.
const MIN_ONE_MINUS_COS: f32 = 1e-4;

impl MirrorImage {
    /// The image in a mirror sphere of a light within `light_radius` of `light`.
    pub fn new((center, radius): (glam::Vec3, f32), (light, light_radius): (glam::Vec3, f32)) -> Self {
        Self { center, radius, light, light_radius, to_light: (light - center).normalize() }
    }

    /// The cone from `origin` around the point of the mirror that shows the light's centre.
    ///
    /// There the normal halves the angle between the directions to `origin` and to the light. As seen from
    /// the centre of the sphere it halves them nearly; one step of fixed-point iteration goes on from there
    /// (Alhazen's problem has no short solution). A direction that is turned by δ meets the sphere δ d
    /// farther, d being the distance, where the normal is turned by δ d / r, and the reflection by
    /// 2 cos θ δ d / r + δ, across the plane of incidence; in it by more. So the half angle is that of the
    /// light, seen from the mirror, over 1 + 2 d cos θ / r. Wherever the cone lies, no expectation changes:
    /// approximate square roots are good enough.
    #[inline(always)]
    pub fn cone<L: Lane>(&self, origin: Vec3<L>) -> Cone<L> {
        let unit = |v: Vec3<L>| v * functions::approximate_rsqrt(v.dot(v));
        let (center, light) = (Vec3::splat(self.center), Vec3::splat(self.light));
        let point = |normal: Vec3<L>| normal.mul_add(L::splat(self.radius), center);
        let near = point(unit(unit(origin - center) + Vec3::splat(self.to_light)));
        let to_light = light - near;
        let to_light2 = to_light.dot(to_light);
        let normal = unit(to_light * functions::approximate_rsqrt(to_light2) + unit(origin - near));
        let to = point(normal) - origin;
        let distance = to.dot(to).sqrt();
        let axis = to * (L::one() / distance);
        let magnified = to.dot(normal).neg_mul_add(L::splat(2.0 / self.radius), L::one());
        // 1 − cos of the small angle a is a² / 2.
        let scale = L::splat(2.0 / (self.light_radius * self.light_radius));
        let inverse = magnified * magnified * (scale * to_light2);
        // False where a length is 0, too.
        let is_seen = L::one().lt(magnified) & L::zero().le(inverse);
        let inverse = inverse.max(L::one()).min(L::splat(1.0 / MIN_ONE_MINUS_COS));
        Cone { axis, one_minus_cos: L::one() / inverse, inverse: inverse.only(is_seen) }
    }
}

impl<L: Lane> Cone<L> {
    /// No directions: of an image that is not computed yet.
    #[inline(always)]
    pub fn none() -> Self {
        Self { axis: Vec3::zero(), one_minus_cos: L::zero(), inverse: L::zero() }
    }
    /// The lanes in which it has directions.
    #[inline(always)]
    pub fn is_seen(&self) -> L::Mask {
        L::zero().lt(self.inverse)
    }
    /// A direction of the cone, uniform by solid angle.
    ///
    /// Domain: u and v in [0, 1).
    #[inline(always)]
    pub fn sample(&self, u: L, v: L) -> Vec3<L> {
        warp::sample_uniform_cone(self.axis, self.one_minus_cos, u, v).0
    }
    /// The pdf of `wi`, in 1/sr; 0 outside of the cone. The lanes of `sampled` are inside, whatever rounding
    /// says: outside, their weights would be those of directions that are hardly ever sampled.
    #[inline(always)]
    pub fn pdf(&self, wi: Vec3<L>, sampled: L::Mask) -> L {
        let is_inside = sampled | (L::one() - self.axis.dot(wi)).le(self.one_minus_cos);
        (L::splat(1.0 / TAU) * self.inverse).only(is_inside)
    }
}
