//! The thesis's lobe: normalize(reflected + roughness · s), s uniform on the unit sphere; absorbed where that points below the surface,
//! or nowhere. What is drawn keeps all its light, so f · cos θ is the density itself.
//!
//! # The density
//! The drawn points lie uniformly on the surface of a sphere of radius ρ (the roughness) around the tip of the unit vector R of
//! the mirror direction: 1 / 4πρ² per area. A ray from the origin along ω, at the angle γ to R, meets that sphere at
//!
//! ```text
//! |t ω − R|² = ρ²   ⇒   t = c ± q,   c = cos γ,   q² = c² − 1 + ρ² = ρ² − sin² γ
//! ```
//!
//! and an area dA there, whose normal (t ω − R) / ρ makes an angle with the ray whose cosine is (t − c) / ρ = ± q / ρ, covers the solid
//! angle dA (q / ρ) / t². Each crossing with t > 0 so adds t² / 4πρq:
//!
//! - ρ < 1: the origin is outside. Both crossings count, within the cone sin γ < ρ, c > 0; beyond it nothing is drawn.
//! - ρ ≥ 1: the origin is inside (or on it). One crossing counts, t = c + q. At ρ = 1 that is Lambert's c / π around R.
//!
//! # The rim
//! For ρ < 1 the density grows as 1 / q towards the rim of the cone: integrably, but without bound, and rounding puts some drawn
//! directions beyond it. So x = q² / ρ² is kept above η = `RIM`, and the cone widened to x > −η. To first order the ring that this adds
//! holds what the floor takes away, c √η / 2 each, so that the density's integral stays 1; it is moved by η ρ / 2c at most,
//! 0.002°. Error: x is off by a few 2⁻²⁴ / ρ, below η down to [`NARROW`].

use super::{BsdfSample, LobeEval};
use crate::lane::Lane;
use crate::math::Vec3;
use crate::sampling::warp;
use std::f32::consts::PI;

/// Below this roughness (a cone of 0.9°) the lobe counts as a delta lobe.
pub const NARROW: f32 = 1.0 / 64.0;
/// See "the rim".
const RIM: f32 = 1.0 / 16_384.0;

#[inline(always)]
pub fn sample<L: Lane>(d: Vec3<L>, n: Vec3<L>, roughness: L, u: L, v: L) -> BsdfSample<L> {
    let reflected = d.reflect(n);
    let towards = warp::sample_uniform_sphere(u, v).mul_add(roughness, reflected);
    // A vector so short that its direction is rounding noise is absorbed with the zero vector: 2⁻²⁰ is far above the noise.
    let alive = L::splat(1e-12).lt(towards.dot(towards)) & L::zero().lt(towards.dot(n));
    let direction = Vec3::select(alive, towards, n).normalize();
    // What was drawn has some density, whatever rounding says.
    let density = density(reflected, roughness, direction).max(L::splat(f32::MIN_POSITIVE));
    let pdf = L::select(roughness.lt(L::splat(NARROW)), L::splat(f32::INFINITY), density);
    BsdfSample { direction, weight: L::one(), pdf, alive }
}

/// Value and density, which are the same; zero below the surface and for narrow lobes.
#[inline(always)]
pub fn evaluate<L: Lane>(d: Vec3<L>, n: Vec3<L>, roughness: L, towards: Vec3<L>) -> LobeEval<L> {
    let pdf = density(d.reflect(n), roughness, towards);
    let somewhere = L::splat(NARROW).le(roughness) & L::zero().lt(towards.dot(n));
    LobeEval::within(somewhere, pdf, pdf)
}

/// Domain: roughness from [`NARROW`] to 1e18; finite everywhere.
#[inline(always)]
fn density<L: Lane>(reflected: Vec3<L>, roughness: L, towards: Vec3<L>) -> L {
    let c = towards.dot(reflected);
    let across = towards.cross(reflected);
    // Not from c: 1 − c² cancels in narrow cones.
    let inverse = L::one() / roughness;
    let sine = across * inverse;
    let x = L::one() - sine.dot(sine);
    let q = roughness * x.max(L::splat(RIM)).sqrt();
    let outside = roughness.lt(L::one());
    // Where ρ ≥ 1, q ≥ |c|: for c < 0 the sum cancels, and the product of the roots, 1 − ρ², does not.
    let product = roughness.mul_add(roughness, -L::one());
    let behind = product / (q - c);
    let far = L::select(!outside & c.lt(L::zero()), behind, c + q);
    let near = (c - q).only(outside);
    // As ratios, because ρ² q would overflow.
    let squares = (far * inverse).mul_add(far, (near * inverse) * near);
    let density = squares / (L::splat(4.0 * PI) * q);
    let beyond = outside & (x.lt(L::splat(-RIM)) | c.lt(L::zero()));
    L::select(beyond, L::zero(), density)
}
