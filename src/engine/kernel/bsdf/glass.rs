//! A smooth dielectric: two delta lobes.
//!
//! Source: Born, Wolf, Principles of Optics, §1.5; Pharr et al., PBR 4ed §9.5.

use super::BsdfSample;
use crate::lane::{Lane, Mask};
use crate::math::Vec3;

/// What a smooth boundary does to light that arrives at an angle.
#[derive(Clone, Copy, Debug)]
pub struct Boundary<L: Lane> {
    /// Share of unpolarised light that is reflected, unless `total`.
    pub fresnel: L,
    /// Everything is reflected.
    pub total: L::Mask,
    /// Cosine of the refracted direction; 0 where there is none.
    pub cos_t: L,
}

/// The boundary met at the cosine `cos_i`, in [0, 1]; `eta` is the index of the side from which light comes over that of the other.
#[inline(always)]
pub fn boundary<L: Lane>(eta: L, cos_i: L) -> Boundary<L> {
    let sin2_t = eta * eta * (cos_i.neg_mul_add(cos_i, L::one()));
    let total = L::one().le(sin2_t);
    let cos_t = (L::one() - sin2_t).max(L::zero()).sqrt();
    let parallel = (cos_i - eta * cos_t) / eta.mul_add(cos_t, cos_i);
    let perpendicular = eta.mul_add(cos_i, -cos_t) / eta.mul_add(cos_i, cos_t);
    let fresnel = L::splat(0.5) * perpendicular.mul_add(perpendicular, parallel * parallel);
    Boundary { fresnel, total, cos_t }
}

/// Reflects with probability F (Fresnel), else refracts.
///
/// `outside`: d arrives from the vacuum side. `choose` uniform in [0, 1). The weight of refracted radiance is η² (radiance is
/// denser in a denser medium); it cancels when the path leaves.
#[inline(always)]
pub fn sample<L: Lane>(d: Vec3<L>, n: Vec3<L>, outside: L::Mask, ior: L, choose: L) -> BsdfSample<L> {
    let eta = L::select(outside, L::one() / ior, ior);
    let cos_i = (-d.dot(n)).min(L::one()).max(L::zero());
    let Boundary { fresnel, total, cos_t } = boundary(eta, cos_i);
    let reflects = total | choose.lt(fresnel);
    let refracted = d * eta + n * eta.mul_add(cos_i, -cos_t);
    let direction = Vec3::select(reflects, d.reflect(n), refracted);
    let weight = L::select(reflects, L::one(), eta * eta);
    BsdfSample { direction, weight, pdf: L::splat(f32::INFINITY), alive: L::Mask::splat(true) }
}
