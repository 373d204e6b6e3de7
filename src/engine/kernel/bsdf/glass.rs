//! A smooth dielectric: two delta lobes.
//!
//! Source: Pharr et al., PBR 4ed §9.5; for thin glass §9.5.1, `ThinDielectricBxDF`.

use super::BsdfSample;
use super::fresnel::{self, Fresnel};
use super::lobe_normals::{Horizon, LobeNormals};
use crate::lane::{Lane, Mask};
use crate::math::Vec3;

/// Reflects with probability F (Fresnel), else refracts.
///
/// The weight of refracted radiance is η² (radiance scales with the square of the index); it cancels when the
/// path leaves the dielectric.
///
/// Thin glass is two parallel surfaces without a distance. Light goes back and forth between them, so it
/// reflects F′ = F + (1 − F)² F (1 + F² + F⁴ + …) = 2 F / (1 + F), and transmits the rest straight on.
///
/// Light that a coarse mesh lets in would be reflected in total at shading normals for ever. The geometric
/// normal replaces them unless it reflects in total itself; then it replaces them for one `uc` in eight.
/// Light that leaves to the wrong side of the geometric normal is mirrored to the right one.
///
/// Domain: |`ior`| > 0 is the index inside, negated for thin glass; `outside` holds the lanes whose d arrives
/// from the vacuum side.
#[inline(always)]
pub fn sample<L: Lane>(
    d: Vec3<L>,
    normals: &LobeNormals<L>,
    outside: L::Mask,
    ior: L,
    uc: L,
) -> BsdfSample<L> {
    let (thin, ior) = (is_thin(ior), ior.abs());
    let eta = L::select(outside | thin, L::one() / ior, ior);
    let cos_i = |n: Vec3<L>| (-d.dot(n)).min(L::one()).max(L::zero());
    let mut n = normals.specular;
    if let Some(Horizon { bent, ng, .. }) = normals.horizon {
        let total = |n: Vec3<L>| fresnel::dielectric(eta, cos_i(n)).total;
        let keeps_round = total(ng) & !uc.lt(L::splat(0.125));
        n = Vec3::select(bent & !thin & total(n) & !keeps_round, ng, n);
    }
    let cos_i = cos_i(n);
    let Fresnel { reflectance, total, cos_t } = fresnel::dielectric(eta, cos_i);
    // Tests uc < 2 F / (1 + F) without a division.
    let half = L::splat(0.5);
    let uc = L::select(thin, uc * half.mul_add(reflectance, half), uc);
    let reflects = total | uc.lt(reflectance);
    let refracted = Vec3::select(thin, d, d * eta + n * eta.mul_add(cos_i, -cos_t));
    let mut wi = Vec3::select(reflects, d.reflect(n), refracted);
    if let Some(Horizon { bent, ng, .. }) = normals.horizon {
        let wrong = reflects ^ L::zero().lt(wi.dot(ng));
        wi = Vec3::select(bent & wrong, wi.reflect(ng), wi);
    }
    let weight = L::select(reflects | thin, L::one(), eta * eta);
    BsdfSample { wi, weight, pdf: L::splat(f32::INFINITY), alive: L::Mask::splat(true) }
}

/// Tests whether the index of refraction is that of thin glass, whose `color` tints only transmission.
#[inline(always)]
pub fn is_thin<L: Lane>(ior: L) -> L::Mask {
    ior.lt(L::zero())
}
