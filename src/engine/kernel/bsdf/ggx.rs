//! GGX reflection: visible-normal sampling, height-correlated masking and shadowing, single scattering.
//! [`super::albedo`] compensates for the light lost between facets.
//!
//! With o = wo = −d, i = wi, h = o + i, h∥ and h⊥ its parts along and across n, and all cosines against n:
//!
//! ```text
//! D = α² / π (h⊥² + α² h∥²)² · |h|⁴         f cos θ = D / 4 cos o · 1 / (1 + Λ(o) + Λ(i))
//! Λ(w) = (√(1 + α² tan² w) − 1) / 2          pdf     = D / 4 cos o · 1 / (1 + Λ(o))
//! ```
//!
//! With s(w) = cos w √(1 + α² tan² w) these are, without quotients of cosines,
//!
//! ```text
//! pdf = D / (2 (cos o + s(o)))          f cos θ / pdf = cos i (cos o + s(o)) / (cos i s(o) + cos o s(i))
//! ```
//!
//! Source: Dupuy, Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023; Heitz,
//! "Understanding the Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 2014, eq. 72 and 99.

use super::{BsdfSample, LobeEval};
use crate::lane::{Lane, functions::sin_cos_turns};
use crate::math::Vec3;
use crate::sampling::warp;
use std::f32::consts::FRAC_1_PI;

/// Below this alpha (a roughness of 0.011) the lobe counts as a delta lobe: h⊥ has an error of some 2⁻²⁴, and
/// D varies over a width of α.
pub const NARROW: f32 = 1.0 / 8192.0;

/// Returns the cosine of wo, made positive: rounding may put a grazing ray on or below the horizon.
#[inline(always)]
pub fn cos_o<L: Lane>(d: Vec3<L>, n: Vec3<L>) -> L {
    (-d.dot(n)).max(L::splat(1e-6))
}

/// Samples a visible normal and reflects; the weight is G₂/G₁. Absorbs directions below the surface.
///
/// Domain: `alpha` in [0, 1]; 0 is a mirror.
#[inline(always)]
pub fn sample<L: Lane>(d: Vec3<L>, n: Vec3<L>, alpha: L, u: L, v: L) -> BsdfSample<L> {
    let (wi, cos) = sample_direction(d, n, alpha, u, v);
    let alive = L::zero().lt(cos);
    let weight = shadowing(alpha, cos_o(d, n), cos).only(alive);
    let pdf = L::select(is_narrow(alpha), L::splat(f32::INFINITY), pdf(d, n, alpha, wi));
    BsdfSample { wi, weight, pdf, alive }
}

/// Returns the direction of [`sample`] and its cosine; a cosine ≤ 0 means that it is absorbed.
#[inline(always)]
pub(super) fn sample_direction<L: Lane>(d: Vec3<L>, n: Vec3<L>, alpha: L, u: L, v: L) -> (Vec3<L>, L) {
    let (tangent, bitangent) = warp::orthonormal_basis(n);
    let wo = Vec3::new(-d.dot(tangent), -d.dot(bitangent), cos_o(d, n));
    let normal = visible_normal(wo, alpha, u, v);
    let twice = L::splat(2.0) * wo.dot(normal) / normal.dot(normal);
    let local = normal * twice - wo;
    (tangent.mul_add(local.x, bitangent.mul_add(local.y, n * local.z)), local.z)
}

/// Returns a visible unit normal.
#[inline(always)]
pub(super) fn sample_normal<L: Lane>(d: Vec3<L>, n: Vec3<L>, alpha: L, u: L, v: L) -> Vec3<L> {
    let (tangent, bitangent) = warp::orthonormal_basis(n);
    let wo = Vec3::new(-d.dot(tangent), -d.dot(bitangent), cos_o(d, n));
    let local = visible_normal(wo, alpha, u, v);
    tangent.mul_add(local.x, bitangent.mul_add(local.y, n * local.z)).normalize()
}

/// Samples a visible normal, not of unit length, in the frame of the surface's normal.
#[inline(always)]
fn visible_normal<L: Lane>(wo: Vec3<L>, alpha: L, u: L, v: L) -> Vec3<L> {
    let stretched = Vec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    let (sin, cos) = sin_cos_turns(v);
    let z = (L::one() - u).mul_add(L::one() + stretched.z, -stretched.z);
    let radius = z.neg_mul_add(z, L::one()).max(L::zero()).sqrt();
    let half = Vec3::new(radius * cos, radius * sin, z) + stretched;
    Vec3::new(alpha * half.x, alpha * half.y, half.z)
}

/// Evaluates the lobe; zero below the surface and for narrow lobes.
#[inline(always)]
pub fn evaluate<L: Lane>(d: Vec3<L>, n: Vec3<L>, alpha: L, wi: Vec3<L>) -> LobeEval<L> {
    let cos = wi.dot(n);
    let pdf = pdf(d, n, alpha, wi);
    let value = pdf * shadowing(alpha, cos_o(d, n), cos);
    LobeEval::within(L::zero().lt(cos) & !is_narrow(alpha), value, pdf)
}

/// Returns the lanes whose lobe is too narrow to evaluate.
#[inline(always)]
pub fn is_narrow<L: Lane>(alpha: L) -> L::Mask {
    alpha.lt(L::splat(NARROW))
}

/// Returns s of the formulas at the top of this file.
#[inline(always)]
pub(super) fn stretched_cosine<L: Lane>(alpha: L, cos: L) -> L {
    let sin2 = cos.neg_mul_add(cos, L::one()).max(L::zero());
    cos.mul_add(cos, alpha * alpha * sin2).sqrt()
}

/// Returns G₂/G₁ from the cosines of wo and wi, both above 0.
#[inline(always)]
pub(super) fn shadowing<L: Lane>(alpha: L, cos_o: L, cos_i: L) -> L {
    let (s_o, s_i) = (stretched_cosine(alpha, cos_o), stretched_cosine(alpha, cos_i));
    cos_i * (cos_o + s_o) / cos_i.mul_add(s_o, cos_o * s_i)
}

/// Returns the pdf of a direction above the surface.
///
/// D needs the tangent of h: h⊥ comes from the cross product, because 1 − cos² cancels.
///
/// Domain: alpha from [`NARROW`] to 1.
#[inline(always)]
pub(super) fn pdf<L: Lane>(d: Vec3<L>, n: Vec3<L>, alpha: L, wi: Vec3<L>) -> L {
    let across = (wi - d).cross(n);
    let cos = cos_o(d, n);
    // Kept above 0: a grazing ray that continues straight ahead has no half vector.
    let along = cos + wi.dot(n).max(L::zero());
    let (along2, across2) = (along * along, across.dot(across));
    let ratio = alpha * (along2 + across2) / (alpha * alpha).mul_add(along2, across2);
    L::splat(0.5 * FRAC_1_PI) * (ratio * ratio) / (cos + stretched_cosine(alpha, cos))
}
