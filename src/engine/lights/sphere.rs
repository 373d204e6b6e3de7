//! Spheres as lights: sampled uniformly in the cone that they subtend.

use super::choose::bounded_importance;
use super::power::{BlockMeans, GRID};
use super::table::{KindCode, LightRow};
use super::{LightSample, valid_pdf};
use crate::lane::Lane;
use crate::math::{Vec3, portable};
use crate::sampling::warp;
use crate::scene::Sphere;
use glam::{DVec2, DVec3};
use std::f32::consts::{PI, TAU};

/// Returns the power that a sphere emits, on all sides, at a radiance of 1.
pub(super) fn unit_power(sphere: &Sphere) -> f64 {
    let radius = f64::from(sphere.radius);
    4.0 * f64::from(PI) * f64::from(PI) * radius * radius
}

/// Returns the weighted sum of a texture's texels over a sphere, and the sum of the weights: the
/// circumferences of its circles of latitude.
pub(super) fn sum_of_texels(texture: &BlockMeans) -> (DVec3, f64) {
    let (level, points) = texture.points([DVec2::X, DVec2::Y], GRID);
    points.fold((DVec3::ZERO, 0.0), |(sum, weights), at| {
        let circle = portable::sin_cos(f64::from(PI) * at.y).0;
        (sum + circle * texture.mean(level, at), weights + circle)
    })
}

/// Returns the rows of a sphere with this power.
pub(super) fn light(sphere: &Sphere, power: f64) -> (LightRow, [f32; 8]) {
    let &Sphere { center, radius, .. } = sphere;
    let row = LightRow { kind: KindCode::Sphere, at: center, radius, ..LightRow::default() };
    (row, bounded_importance(center, radius, None, 0.25 * (power / f64::from(PI))))
}

/// The cone that a sphere subtends.
struct Cone<L: Lane> {
    /// The squared distance of the centre, and one over the distance.
    distance2: L,
    per_distance: L,
    /// 1 − cos θ of the cone's half angle; NaN from inside the sphere.
    one_minus_cos: L,
}

impl<L: Lane> Cone<L> {
    #[inline(always)]
    fn new(center: Vec3<L>, radius: L) -> Self {
        let distance2 = center.dot(center);
        let per_distance = L::one() / distance2.sqrt();
        let sine = radius * per_distance;
        let sin2 = sine * sine;
        // 1 − cos θ = sin² θ / (1 + cos θ), which does not cancel at any distance.
        let one_minus_cos = sin2 / (L::one() + (L::one() - sin2).sqrt());
        Self { distance2, per_distance, one_minus_cos }
    }
    /// Returns one over the solid angle; 0 from inside the sphere and on it.
    #[inline(always)]
    fn pdf(&self) -> L {
        valid_pdf(L::splat(1.0 / TAU) / self.one_minus_cos)
    }
}

/// Returns the pdf of directions towards a sphere: one over its solid angle; 0 inside it and on it.
///
/// Domain: a radius of at least 1e-15 distances.
#[inline(always)]
pub fn pdf<L: Lane>(center: Vec3<L>, radius: L) -> L {
    Cone::new(center, radius).pdf()
}

/// Samples a direction uniform in the cone that a sphere subtends, and the first point of the sphere there.
/// The normal has unit length within 4 ε times the distance over the radius; for spheres more than 2²⁰ radii
/// away it is shorter, at most about 1.
#[inline(always)]
pub fn sample<L: Lane>(center: Vec3<L>, radius: L, u: L, v: L) -> LightSample<L> {
    let cone = Cone::new(center, radius);
    let Cone { distance2, per_distance, one_minus_cos } = cone;
    let (wi, cos, sin2) = warp::sample_uniform_cone(center * per_distance, one_minus_cos, u, v);
    // The smaller root of t² − 2 t d cos θ + d² − r², from the product of the roots: the difference would
    // cancel.
    let radius2 = radius * radius;
    let half_chord = (sin2.neg_mul_add(distance2, radius2)).max(L::zero()).sqrt();
    let distance = distance2 * per_distance;
    let t = (distance2 - radius2) / distance.mul_add(cos, half_chord);
    // Farther away, the difference is rounding error, longer than the radius.
    let length = radius.max(distance * L::splat(f32::powi(0.5, 20)));
    let n = (wi * t - center) * (L::one() / length);
    LightSample { wi, t, n, pdf: cone.pdf() }
}
