//! The diffuse (Lambertian) lobe.

use super::lobe_normals::LobeNormals;
use super::{BsdfSample, LobeEval};
use crate::lane::Lane;
use crate::math::Vec3;
use crate::sampling::warp;
use std::f32::consts::FRAC_1_PI;

/// Samples with pdf cos θ / π and weight 1, and never below the surface. With a shading normal the lobe may
/// absorb, and the weight is that of [`crate::kernel::normals::shadow_terminator`].
#[inline(always)]
pub fn sample<L: Lane>(normals: &LobeNormals<L>, u: L, v: L) -> BsdfSample<L> {
    let wi = warp::sample_cosine_hemisphere(normals.diffuse, u, v);
    let mut sample = BsdfSample::lossless(wi, pdf(normals.diffuse, wi));
    if let Some(horizon) = &normals.horizon {
        sample.weight = horizon.fade(wi, normals.diffuse);
        sample.alive = L::zero().lt(sample.weight);
    }
    sample
}

/// Evaluates value and pdf, both cos θ / π, zero below the surface; shading normals fade the value.
#[inline(always)]
pub fn evaluate<L: Lane>(normals: &LobeNormals<L>, wi: Vec3<L>) -> LobeEval<L> {
    let pdf = pdf(normals.diffuse, wi);
    let Some(horizon) = &normals.horizon else { return LobeEval { value: pdf, pdf } };
    let fade = horizon.fade(wi, normals.diffuse);
    LobeEval::within(L::zero().lt(fade), pdf * fade, pdf)
}

#[inline(always)]
fn pdf<L: Lane>(n: Vec3<L>, wi: Vec3<L>) -> L {
    wi.dot(n).max(L::zero()) * L::splat(FRAC_1_PI)
}
