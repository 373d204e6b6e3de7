//! GGX reflection with visible normals and height-correlated shadowing; what is reflected more than once is lost.
//!
//! With o = −d, i the direction drawn, h = o + i, and all cosines against n:
//!
//! ```text
//! D = α² / π (h⊥² + α² h∥²)² · |h|⁴         f cos θ = D / 4 cos o · 1 / (1 + Λ(o) + Λ(i))
//! Λ(w) = (√(1 + α² tan² w) − 1) / 2          pdf     = D / 4 cos o · 1 / (1 + Λ(o))
//! ```
//!
//! Source: Dupuy, Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023; Heitz, "Understanding the
//! Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 2014, eq. 72 and 99.

use super::{BsdfSample, LobeEval};
use crate::lane::{Lane, functions::sin_cos_turns};
use crate::math::Vec3;
use crate::sampling::warp;
use std::f32::consts::FRAC_1_PI;

/// Below this alpha (a roughness of 0.011) the lobe counts as a delta lobe: h⊥ is off by some 2⁻²⁴, and D is as sharp as α.
pub const NARROW: f32 = 1.0 / 8192.0;

/// The cosine of −d. Rounding may put a grazing ray on or below the horizon; the lobe needs it above.
#[inline(always)]
pub(super) fn cos_out<L: Lane>(d: Vec3<L>, n: Vec3<L>) -> L {
    (-d.dot(n)).max(L::splat(1e-6))
}

/// Weight G₂/G₁, absorbed below the surface. `alpha` in [0, 1]; 0 is a mirror.
#[inline(always)]
pub fn sample<L: Lane>(d: Vec3<L>, n: Vec3<L>, alpha: L, u: L, v: L) -> BsdfSample<L> {
    let (tangent, bitangent) = warp::orthonormal_basis(n);
    let out = Vec3::new(-d.dot(tangent), -d.dot(bitangent), cos_out(d, n));
    let stretched = Vec3::new(alpha * out.x, alpha * out.y, out.z).normalize();
    let (sin, cos) = sin_cos_turns(v);
    let z = (L::one() - u).mul_add(L::one() + stretched.z, -stretched.z);
    let radius = z.neg_mul_add(z, L::one()).max(L::zero()).sqrt();
    let half = Vec3::new(radius * cos, radius * sin, z) + stretched;
    let normal = Vec3::new(alpha * half.x, alpha * half.y, half.z).normalize();
    let incident = normal * (L::splat(2.0) * out.dot(normal)) - out;
    let alive = L::zero().lt(incident.z);
    let weight = shadowing(alpha, out.z, incident.z).only(alive);
    let direction = tangent.mul_add(incident.x, bitangent.mul_add(incident.y, n * incident.z));
    let pdf = L::select(is_narrow(alpha), L::splat(f32::INFINITY), density(d, n, alpha, direction));
    BsdfSample { direction, weight, pdf, alive }
}

/// Zero below the surface and for narrow lobes.
#[inline(always)]
pub fn evaluate<L: Lane>(d: Vec3<L>, n: Vec3<L>, alpha: L, towards: Vec3<L>) -> LobeEval<L> {
    let cos = towards.dot(n);
    let pdf = density(d, n, alpha, towards);
    let value = pdf * shadowing(alpha, cos_out(d, n), cos);
    LobeEval::within(L::zero().lt(cos) & !is_narrow(alpha), value, pdf)
}

#[inline(always)]
pub fn is_narrow<L: Lane>(alpha: L) -> L::Mask {
    alpha.lt(L::splat(NARROW))
}

/// G₂/G₁ of two directions by their cosines, above 0.
#[inline(always)]
fn shadowing<L: Lane>(alpha: L, cos_out: L, cos_in: L) -> L {
    let lambda = |cos: L| {
        let tan2 = (L::one() / (cos * cos) - L::one()).max(L::zero());
        L::splat(0.5) * ((alpha * alpha).mul_add(tan2, L::one()).sqrt() - L::one())
    };
    let out = L::one() + lambda(cos_out);
    out / (out + lambda(cos_in))
}

/// The density of a direction above the surface. Domain: alpha from [`NARROW`] to 1.
///
/// D's slope needs the tangent of h: from the cross product, because 1 − cos² cancels. cos o (1 + Λ(o)) is written out, so that
/// grazing angles divide by nothing small.
#[inline(always)]
fn density<L: Lane>(d: Vec3<L>, n: Vec3<L>, alpha: L, towards: Vec3<L>) -> L {
    let across = (towards - d).cross(n);
    let cos = cos_out(d, n);
    // Never 0: a grazing ray that goes straight on has no half vector.
    let along = cos + towards.dot(n).max(L::zero());
    let (along2, across2) = (along * along, across.dot(across));
    let alpha2 = alpha * alpha;
    let ratio = alpha * (along2 + across2) / alpha2.mul_add(along2, across2);
    let sin2 = cos.neg_mul_add(cos, L::one()).max(L::zero());
    let visible = cos + cos.mul_add(cos, alpha2 * sin2).sqrt();
    L::splat(0.5 * FRAC_1_PI) * (ratio * ratio) / visible
}
