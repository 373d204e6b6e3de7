//! The fuzzy mirror, the lobe of the thesis: wi = normalize(reflected + roughness · s), with s uniform on the
//! unit sphere; it absorbs if the sum points below the surface or is zero. Samples have weight 1, so f · cos
//! θ equals the pdf.
//!
//! # The pdf
//! The sums are uniformly distributed on the surface of a sphere of radius ρ (the roughness) around the tip
//! of the unit vector R of the mirror direction: 1 / 4πρ² per area. A ray from the origin along ω, at the
//! angle γ to R, meets that sphere at
//!
//! ```text
//! |t ω − R|² = ρ²   ⇒   t = c ± q,   c = cos γ,   q² = c² − 1 + ρ² = ρ² − sin² γ
//! ```
//!
//! and an area dA there, whose normal (t ω − R) / ρ has the cosine (t − c) / ρ = ± q / ρ with the ray, covers
//! the solid angle dA (q / ρ) / t². Each crossing with t > 0 therefore adds t² / 4πρq:
//!
//! - ρ < 1: the origin is outside. Both crossings count, within the cone sin γ < ρ, c > 0; the pdf is zero
//!   outside it.
//! - ρ ≥ 1: the origin is inside (or on it). One crossing counts, t = c + q. At ρ = 1 that is Lambert's c / π
//!   around R.
//!
//! # The rim
//! For ρ < 1 the pdf grows as 1 / q towards the rim of the cone: integrable but unbounded, and rounding puts
//! some samples outside. Therefore x = q² / ρ² is clamped to at least η = `RIM`, and the cone is widened to
//! x > −η. To first order the ring adds as much as the clamp removes, c √η / 2, so that the pdf still
//! integrates to 1; the rim moves by at most η ρ / 2c, 0.002°.
//! Error: x is off by a few 2⁻²⁴ / ρ, less than η down to [`NARROW`].

use super::{BsdfSample, LobeEval};
use crate::lane::Lane;
use crate::math::Vec3;
use crate::sampling::warp;
use std::f32::consts::PI;

/// Below this roughness (a cone of 0.9°) the lobe counts as a delta lobe.
pub const NARROW: f32 = 1.0 / 64.0;
/// The η of the section "The rim" at the top of this file.
const RIM: f32 = 1.0 / 16_384.0;

/// Samples a direction around the reflected one.
#[inline(always)]
pub fn sample<L: Lane>(d: Vec3<L>, n: Vec3<L>, roughness: L, u: L, v: L) -> BsdfSample<L> {
    let reflected = d.reflect(n);
    let sum = warp::sample_uniform_sphere(u, v).mul_add(roughness, reflected);
    // Absorbs the zero vector and vectors so short that their direction is rounding noise, which is far below
    // 2⁻²⁰.
    let alive = L::splat(1e-12).lt(sum.dot(sum)) & L::zero().lt(sum.dot(n));
    let wi = Vec3::select(alive, sum, n).normalize();
    // A sample has a positive pdf, even if rounding makes it zero.
    let pdf = pdf(reflected, roughness, wi).max(L::splat(f32::MIN_POSITIVE));
    let pdf = L::select(roughness.lt(L::splat(NARROW)), L::splat(f32::INFINITY), pdf);
    BsdfSample { wi, weight: L::one(), pdf, alive }
}

/// Evaluates value and pdf, which are equal; zero below the surface and for narrow lobes.
#[inline(always)]
pub fn evaluate<L: Lane>(d: Vec3<L>, n: Vec3<L>, roughness: L, wi: Vec3<L>) -> LobeEval<L> {
    let pdf = pdf(d.reflect(n), roughness, wi);
    let valid = L::splat(NARROW).le(roughness) & L::zero().lt(wi.dot(n));
    LobeEval::within(valid, pdf, pdf)
}

/// Returns the pdf derived at the top of this file; finite everywhere.
///
/// Domain: roughness from [`NARROW`] to 1e18.
#[inline(always)]
fn pdf<L: Lane>(reflected: Vec3<L>, roughness: L, wi: Vec3<L>) -> L {
    let c = wi.dot(reflected);
    let across = wi.cross(reflected);
    // The sine comes from the cross product: 1 − c² cancels in narrow cones.
    let inverse = L::one() / roughness;
    let sine = across * inverse;
    let x = L::one() - sine.dot(sine);
    let q = roughness * x.max(L::splat(RIM)).sqrt();
    let outside = roughness.lt(L::one());
    // If ρ ≥ 1, q ≥ |c|: for c < 0 the sum c + q cancels; the product of the roots, 1 − ρ², does not.
    let product = roughness.mul_add(roughness, -L::one());
    let behind = product / (q - c);
    let far = L::select(!outside & c.lt(L::zero()), behind, c + q);
    let near = (c - q).only(outside);
    // As ratios: ρ² q would overflow.
    let squares = (far * inverse).mul_add(far, (near * inverse) * near);
    let pdf = squares / (L::splat(4.0 * PI) * q);
    let beyond = outside & (x.lt(L::splat(-RIM)) | c.lt(L::zero()));
    L::select(beyond, L::zero(), pdf)
}
