//! A smooth dielectric: two delta lobes.
//!
//! Source: Pharr et al., PBR 4ed §9.5.

use super::fresnel::{self, Fresnel};
use super::sample::BsdfSample;
use crate::lane::{Lane, Mask};
use crate::math::Vec3;

/// Reflects with probability F (Fresnel), else refracts.
///
/// The weight of refracted radiance is η² (radiance scales with the square of the index); it cancels when the
/// path leaves the dielectric.
///
/// Domain: `ior` > 0 is the index inside; `outside` says that d arrives from the vacuum side.
#[inline(always)]
pub fn sample<L: Lane>(d: Vec3<L>, n: Vec3<L>, outside: L::Mask, ior: L, uc: L) -> BsdfSample<L> {
    let eta = L::select(outside, L::one() / ior, ior);
    let cos_i = (-d.dot(n)).min(L::one()).max(L::zero());
    let Fresnel { reflectance, total, cos_t } = fresnel::dielectric(eta, cos_i);
    let reflects = total | uc.lt(reflectance);
    let refracted = d * eta + n * eta.mul_add(cos_i, -cos_t);
    let wi = Vec3::select(reflects, d.reflect(n), refracted);
    let weight = L::select(reflects, L::one(), eta * eta);
    BsdfSample { wi, weight, pdf: L::splat(f32::INFINITY), alive: L::Mask::splat(true) }
}
