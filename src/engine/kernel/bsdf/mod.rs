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
//! Lobes have no colour; the material multiplies it. Only [`plastic`] and [`metal_rough`] hold one, because
//! their reflection is white, or whiter, over a base that is not.
//!
//! A lobe too narrow for single precision to evaluate its pdf is sampled like any other but counts as a delta
//! lobe: the pdf of its samples is infinite, and *evaluate* returns zero.

pub mod albedo;
pub mod diffuse;
mod fresnel;
pub mod fuzzy_mirror;
pub mod ggx;
pub mod glass;
mod lobe_normals;
pub mod metal_rough;
pub mod mirror;
pub mod plastic;
mod sample;

pub use lobe_normals::{Horizon, LobeNormals};
pub use sample::{BsdfEval, BsdfSample, LobeEval};
