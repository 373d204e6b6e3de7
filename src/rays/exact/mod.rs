//! Rays against triangles, both given in doubles, decided as in real arithmetic.
//!
//! With A, B, C the corners relative to the ray's origin, d its direction and n = (B − A) × (C − A), the
//! line passes the closed triangle where d · (B × C), d · (C × A) and d · (A × B) have no two signs. Their
//! sum is D = d · n; with D = 0 the ray is parallel to the plane and misses. The hit is at t = N / D, N =
//! A · n, and the first two of the next three terms over D are the weights of the corners.
//!
//! Each sign is first that of a sum in f64, if that is above its bound of error, and else that of an
//! expansion. A determinant of three vectors, whose components are doubles or rounded differences of two, is
//! eight roundings off at most (three differences, two products, a difference, two sums), relative to the sum
//! of its products' absolute values, which is at most 2 |p|₁ |q|∞ |r|∞: sixteen roundings of this product.
//! `BOUND` has twice as many.

mod expansion;
mod ray;
mod solution;

pub use ray::{Crossing, ExactRay, Rule};
pub use solution::{WIDTH, solve};

use glam::DVec3;

/// The least and the greatest absolute value of a coordinate, except 0, for which answers are exact.
///
/// Differences of such numbers are multiples of 2⁻¹⁷² below 2¹²². The greatest product, N₁ D₂, has six of
/// them: it is a multiple of 2⁻¹⁰³² below 2⁷⁴⁰, and no expansion underflows or overflows.
pub const DOMAIN: [f64; 2] = [1.0 / (1_u128 << 120) as f64, (1_u128 << 120) as f64];

/// The least absolute value of a direction's component, except 0, for which answers are exact: of these six
/// factors, one at most is of a direction, and it may be a multiple of 2⁻²¹⁴.
pub const LEAST_DIRECTION: f64 = DOMAIN[0] / (1_u64 << 42) as f64;

/// The error of a determinant in f64, relative to |p|₁ |q|∞ |r|∞.
const BOUND: f64 = 16.0 * f64::EPSILON;

/// Returns the largest absolute component.
#[inline(always)]
fn largest(p: DVec3) -> f64 {
    p.abs().max_element()
}

/// Returns the sum of the absolute components.
#[inline(always)]
fn length_1(p: DVec3) -> f64 {
    p.abs().element_sum()
}
