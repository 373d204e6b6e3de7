//! The results of lobes: sampled directions and values for given ones.

use crate::lane::{Lane, Mask};
use crate::math::Vec3;

/// A sampled direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample<L: Lane> {
    /// The direction of the next segment.
    pub wi: Vec3<L>,
    /// f · cos θ / pdf without the material's colour, which multiplies it.
    pub weight: L,
    /// The pdf per solid angle; `f32::INFINITY` for delta lobes.
    pub pdf: L,
    /// False in lanes that absorb the light; the other fields are then unspecified.
    pub alive: L::Mask,
}

impl<L: Lane> BsdfSample<L> {
    /// Creates a sample of weight 1.
    #[inline(always)]
    pub(super) fn lossless(wi: Vec3<L>, pdf: L) -> Self {
        Self { wi, weight: L::one(), pdf, alive: L::Mask::splat(true) }
    }
}

/// A lobe's value for a given direction, without the material's colour.
#[derive(Clone, Copy, Debug)]
pub struct LobeEval<L: Lane> {
    /// f · cos θ.
    pub value: L,
    /// The pdf with which *sample* draws the direction.
    pub pdf: L,
}

impl<L: Lane> LobeEval<L> {
    /// Returns value and pdf, zero outside `mask`.
    #[inline(always)]
    pub(super) fn within(mask: L::Mask, value: L, pdf: L) -> Self {
        Self { value: value.only(mask), pdf: pdf.only(mask) }
    }
}

/// A BSDF's value for a given direction, with the material's colour.
#[derive(Clone, Copy, Debug)]
pub struct BsdfEval<L: Lane> {
    /// f · cos θ.
    pub value: Vec3<L>,
    /// The pdf with which *sample* draws the direction.
    pub pdf: L,
}
