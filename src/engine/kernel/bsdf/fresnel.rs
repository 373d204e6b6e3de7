//! The Fresnel equations of a smooth dielectric interface.
//!
//! Source: Born, Wolf, Principles of Optics, §1.5; Pharr et al., PBR 4ed §9.3.5.

use crate::lane::Lane;
use std::ops::{Div, Mul, Neg, Sub};

/// Reflection and refraction at an interface.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fresnel<L: Lane> {
    /// The reflected share of unpolarised light; unspecified if `total`.
    pub reflectance: L,
    /// The lanes with total internal reflection.
    pub total: L::Mask,
    /// The cosine of the refracted direction; 0 if there is none.
    pub cos_t: L,
}

/// Solves the Fresnel equations at the cosine `cos_i`; `eta` is the index of refraction on the incident side
/// over that on the other.
///
/// Domain: `cos_i` in [0, 1].
#[inline(always)]
pub(super) fn dielectric<L: Lane>(eta: L, cos_i: L) -> Fresnel<L> {
    let sin2_t = eta * eta * (cos_i.neg_mul_add(cos_i, L::one()));
    let total = L::one().le(sin2_t);
    let cos_t = (L::one() - sin2_t).max(L::zero()).sqrt();
    Fresnel { reflectance: reflectance(eta, cos_i, cos_t), total, cos_t }
}

/// Returns the reflected share of unpolarised light from the cosines on both sides.
#[inline(always)]
pub(super) fn reflectance<L: Lane>(eta: L, cos_i: L, cos_t: L) -> L {
    L::splat(0.5) * reflectances(eta, cos_i, cos_t, L::mul_add)
}

/// Returns the reflected share of unpolarised light in f64, outside an interface of index 1 / `eta` ≥ 1.
pub(super) fn reflectance_f64(eta: f64, cos_i: f64) -> f64 {
    let cos_t = (1.0 - eta * eta * (1.0 - cos_i * cos_i)).sqrt();
    0.5 * reflectances(eta, cos_i, cos_t, |a, b, c| a * b + c)
}

/// Returns the sum of the reflectances of both polarisations.
#[inline(always)]
fn reflectances<T>(eta: T, cos_i: T, cos_t: T, mul_add: impl Fn(T, T, T) -> T) -> T
where
    T: Copy + Sub<Output = T> + Mul<Output = T> + Div<Output = T> + Neg<Output = T>,
{
    let parallel = (cos_i - eta * cos_t) / mul_add(eta, cos_t, cos_i);
    let perpendicular = mul_add(eta, cos_i, -cos_t) / mul_add(eta, cos_i, cos_t);
    mul_add(perpendicular, perpendicular, parallel * parallel)
}
