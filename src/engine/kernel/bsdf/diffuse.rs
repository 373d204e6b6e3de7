//! Lambert's law.

use super::{BsdfSample, LobeEval};
use crate::lane::Lane;
use crate::math::Vec3;
use crate::sampling::warp;
use std::f32::consts::FRAC_1_PI;

/// Density cos θ / π, weight 1. Never absorbs, never points below the surface.
#[inline(always)]
pub fn sample<L: Lane>(n: Vec3<L>, u: L, v: L) -> BsdfSample<L> {
    let direction = warp::sample_cosine_hemisphere(n, u, v);
    BsdfSample::whole(direction, evaluate(n, direction).pdf)
}

/// Value and density cos θ / π; zero below the surface.
#[inline(always)]
pub fn evaluate<L: Lane>(n: Vec3<L>, towards: Vec3<L>) -> LobeEval<L> {
    let pdf = towards.dot(n).max(L::zero()) * L::splat(FRAC_1_PI);
    LobeEval { value: pdf, pdf }
}
