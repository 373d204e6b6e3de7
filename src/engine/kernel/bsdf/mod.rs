//! Scattering of light at surfaces (BSDFs). Each lobe has *sample*, which draws a direction and returns it
//! with the weight f · cos θ / pdf, and, unless it is a delta lobe, *evaluate*, which returns f · cos θ and
//! the pdf of a given direction.
//!
//! Shapes: `WIDTH` scattering events, one per lane.
//! Units: pdfs per solid angle, in 1/sr.
//! Domain: directions are unit vectors within a few ε. `d` is the arriving ray's direction, so wo = −d; `wi`
//! leaves the surface, towards the light. `n` is the unit normal on the side of wo (n · d < 0). u, v and
//! `uc`, which chooses between lobes, are uniform in [0, 1).
//!
//! Lobes have no colour; the material multiplies it. Only [`plastic`], [`metal_rough`] and [`layered`] hold
//! one, because their reflection is white, or whiter, over a base that is not. [`glass`] and [`rough_glass`]
//! also transmit: their wi may be on the other side.
//!
//! A lobe too narrow for single precision to evaluate its pdf is sampled like any other but counts as a delta
//! lobe: the pdf of its samples is infinite, and *evaluate* returns zero.

pub mod albedo;
pub mod diffuse;
mod fresnel;
pub mod fuzzy_mirror;
pub mod ggx;
pub mod glass;
pub mod glass_albedo;
pub mod layered;
mod lobe_normals;
pub mod metal_rough;
pub mod mirror;
pub mod plastic;
pub mod rough_glass;

pub use lobe_normals::{Horizon, LobeNormals};

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
    fn lossless(wi: Vec3<L>, pdf: L) -> Self {
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
    fn within(mask: L::Mask, value: L, pdf: L) -> Self {
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
