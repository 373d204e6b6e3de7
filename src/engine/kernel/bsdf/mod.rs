//! How surfaces scatter. Each lobe has *sample*, which draws a direction and returns it with the weight f · cos θ / pdf, and, where it
//! is no delta lobe, *evaluate*, which says f · cos θ and the density of a direction that was found some other way.
//!
//! Shapes: `WIDTH` scattering events, one per lane. Directions are unit vectors within a few ε; `d` arrives at the surface;
//! `n` is the unit normal on the side from which it arrives (n · d < 0), `towards` leaves it; u and v are uniform in [0, 1).
//! Units: densities per solid angle. Nothing here is coloured but [`plastic`], whose coat is white over a base that is not.
//!
//! A lobe too narrow for single precision to tell its density is drawn like any other, and called a delta lobe: it has an
//! infinite density where it was drawn, and none for the directions of others.

pub mod diffuse;
pub mod ggx;
pub mod glass;
pub mod mirror;
pub mod plastic;
pub mod scatter;

use crate::lane::{Lane, Mask};
use crate::math::Vec3;

/// A drawn direction.
#[derive(Clone, Copy, Debug)]
pub struct BsdfSample<L: Lane> {
    pub direction: Vec3<L>,
    /// f · cos θ / pdf without the material's colour, which multiplies it.
    pub weight: L,
    /// Density of the direction; `f32::INFINITY` of delta lobes.
    pub pdf: L,
    /// False where the surface absorbed the light; there the rest means nothing.
    pub alive: L::Mask,
}

impl<L: Lane> BsdfSample<L> {
    /// A direction of which nothing is lost.
    #[inline(always)]
    fn whole(direction: Vec3<L>, pdf: L) -> Self {
        Self { direction, weight: L::one(), pdf, alive: L::Mask::splat(true) }
    }
}

/// What a lobe passes on from d to a given direction, without the material's colour.
#[derive(Clone, Copy, Debug)]
pub struct LobeEval<L: Lane> {
    /// f · cos θ.
    pub value: L,
    /// Density with which *sample* draws the direction.
    pub pdf: L,
}

impl<L: Lane> LobeEval<L> {
    /// Zero outside of `mask`.
    #[inline(always)]
    fn within(mask: L::Mask, value: L, pdf: L) -> Self {
        Self { value: value.only(mask), pdf: pdf.only(mask) }
    }
}

/// What a surface passes on from d to a given direction, colour included.
#[derive(Clone, Copy, Debug)]
pub struct BsdfEval<L: Lane> {
    /// f · cos θ.
    pub value: Vec3<L>,
    /// Density with which *sample* draws the direction.
    pub pdf: L,
}
