//! A perfect mirror: a delta lobe.

use super::BsdfSample;
use crate::lane::Lane;
use crate::math::Vec3;

/// Returns the reflected direction.
#[inline(always)]
pub fn sample<L: Lane>(d: Vec3<L>, n: Vec3<L>) -> BsdfSample<L> {
    BsdfSample::lossless(d.reflect(n), L::splat(f32::INFINITY))
}
