//! A smooth dielectric: two delta lobes.
//!
//! Source: Pharr et al., PBR 4ed §9.5; of thin glass §9.5.1, `ThinDielectricBxDF`.

use super::fresnel::{self, Fresnel};
use super::sample::BsdfSample;
use crate::lane::{Lane, Mask};
use crate::math::Vec3;

/// Reflects with probability F (Fresnel), else refracts.
///
/// The weight of refracted radiance is η² (radiance scales with the square of the index); it cancels when the
/// path leaves the dielectric.
///
/// Thin glass is two parallel surfaces at no distance. Light goes back and forth between them, so it reflects
/// F′ = F + (1 − F)² F (1 + F² + F⁴ + …) = 2 F / (1 + F), and transmits the rest straight on.
///
/// Domain: |`ior`| > 0 is the index inside, negative of thin glass; `outside` says that d arrives from the
/// vacuum side.
#[inline(always)]
pub fn sample<L: Lane>(d: Vec3<L>, n: Vec3<L>, outside: L::Mask, ior: L, uc: L) -> BsdfSample<L> {
    let (thin, ior) = (is_thin(ior), ior.abs());
    let eta = L::select(outside | thin, L::one() / ior, ior);
    let cos_i = (-d.dot(n)).min(L::one()).max(L::zero());
    let Fresnel { reflectance, total, cos_t } = fresnel::dielectric(eta, cos_i);
    // uc < 2 F / (1 + F), without a division.
    let half = L::splat(0.5);
    let uc = L::select(thin, uc * half.mul_add(reflectance, half), uc);
    let reflects = total | uc.lt(reflectance);
    let refracted = Vec3::select(thin, d, d * eta + n * eta.mul_add(cos_i, -cos_t));
    let wi = Vec3::select(reflects, d.reflect(n), refracted);
    let weight = L::select(reflects | thin, L::one(), eta * eta);
    BsdfSample { wi, weight, pdf: L::splat(f32::INFINITY), alive: L::Mask::splat(true) }
}

/// Whether the index of refraction is that of thin glass, of which `color` tints transmission alone.
#[inline(always)]
pub fn is_thin<L: Lane>(ior: L) -> L::Mask {
    ior.lt(L::zero())
}
