//! The diffuse (Lambertian) lobe.

use super::sample::{BsdfSample, LobeEval};
use crate::lane::Lane;
use crate::math::Vec3;
use crate::sampling::warp;
use std::f32::consts::FRAC_1_PI;

/// Samples with pdf cos θ / π and weight 1. Never absorbs, never points below the surface.
#[inline(always)]
pub fn sample<L: Lane>(n: Vec3<L>, u: L, v: L) -> BsdfSample<L> {
    let wi = warp::sample_cosine_hemisphere(n, u, v);
    BsdfSample::lossless(wi, evaluate(n, wi).pdf)
}

/// Value and pdf are both cos θ / π; zero below the surface.
#[inline(always)]
pub fn evaluate<L: Lane>(n: Vec3<L>, wi: Vec3<L>) -> LobeEval<L> {
    let pdf = wi.dot(n).max(L::zero()) * L::splat(FRAC_1_PI);
    LobeEval { value: pdf, pdf }
}
