//! The numbers of a hit: t within two units in the last place, and the barycentric weights within 2⁻⁵².
//!
//! N, D and the weights times D are sums in pairs of doubles; where their bound of error is too large, they
//! are expansions. With q = A × d the weights are (C − A) · q and −(B − A) · q: the edges keep them accurate
//! far from the origin.

use super::expansion::{fast_two_sum, two_product, two_sum};
use super::ray::ExactRay;
use crate::lane::F64x8;
use glam::DVec3;

/// The number of hits that are computed together.
pub const WIDTH: usize = 8;

/// A number as the sum of two doubles, in each lane; the second is at most half a unit of the first.
type Pair = (F64x8, F64x8);

/// The error of a determinant of pairs, relative to |p|₁ |q|∞ |r|∞. Each product is off by 2⁻¹⁰³ of itself
/// and each sum by 2⁻¹⁰⁴: two factors and three sums are below 2⁻¹⁰⁰, of at most twice that product.
const BOUND: f64 = f64::EPSILON * f64::EPSILON * 64.0;
/// The error of N, D and the weights that leaves the quotients accurate enough.
const ACCURATE: f64 = f64::EPSILON / 16.0;

#[inline(always)]
fn product(a: Pair, b: Pair) -> Pair {
    let (high, low) = two_product(a.0, b.0);
    fast_two_sum(high, low + (a.0 * b.1 + a.1 * b.0))
}

#[inline(always)]
fn sum(a: Pair, b: Pair) -> Pair {
    let ((high, low), (second, rest)) = (two_sum(a.0, b.0), two_sum(a.1, b.1));
    let (high, low) = fast_two_sum(high, low + second);
    fast_two_sum(high, low + rest)
}

#[inline(always)]
fn negated((high, low): Pair) -> Pair {
    (-high, -low)
}

#[inline(always)]
fn differences(p: [F64x8; 3], q: [F64x8; 3]) -> [Pair; 3] {
    [two_sum(p[0], -q[0]), two_sum(p[1], -q[1]), two_sum(p[2], -q[2])]
}

#[inline(always)]
fn dot(p: [Pair; 3], q: [Pair; 3]) -> Pair {
    sum(sum(product(p[0], q[0]), product(p[1], q[1])), product(p[2], q[2]))
}

#[inline(always)]
fn cross(p: [Pair; 3], q: [Pair; 3]) -> [Pair; 3] {
    let component = |i: usize, j: usize| sum(product(p[i], q[j]), negated(product(p[j], q[i])));
    [component(1, 2), component(2, 0), component(0, 1)]
}

/// Returns a / b, half a unit and little more off.
#[inline(always)]
fn quotient(a: Pair, b: Pair) -> F64x8 {
    let first = a.0 / b.0;
    let (high, low) = two_product(first, b.0);
    first + (((a.0 - high) - low) + a.1 - first * b.1) / b.0
}

/// Returns the largest absolute component of the high parts.
#[inline(always)]
fn largest([x, y, z]: [Pair; 3]) -> F64x8 {
    x.0.abs().fast_max(y.0.abs()).fast_max(z.0.abs())
}

/// Returns the sum of the absolute components of the high parts.
#[inline(always)]
fn length_1([x, y, z]: [Pair; 3]) -> F64x8 {
    x.0.abs() + y.0.abs() + z.0.abs()
}

/// Returns t, the weights of the second and the third corner, and whether they are accurate enough, for rays
/// and triangles by component and lane.
#[inline(always)]
fn quotients(
    origin: [F64x8; 3],
    direction: [F64x8; 3],
    [a, b, c]: [[F64x8; 3]; 3],
) -> ([F64x8; 3], [bool; 8]) {
    let (from, ab, ac) = (differences(a, origin), differences(b, a), differences(c, a));
    let direction = direction.map(|component| (component, F64x8::ZERO));
    let (normal, q) = (cross(ab, ac), cross(from, direction));
    let (n, d) = (dot(from, normal), dot(direction, normal));
    let (v, w) = (dot(ac, q), negated(dot(ab, q)));
    let edge = largest(ab).fast_max(largest(ac));
    let bound = F64x8::splat(BOUND) * edge;
    let of_d = bound * edge * length_1(direction);
    let of_n = bound * edge * length_1(from);
    let of_weights = bound * largest(from) * length_1(direction);
    let (d_accurate, n_accurate) = (d.0.abs() * F64x8::splat(ACCURATE), n.0.abs() * F64x8::splat(ACCURATE));
    let [of_d, of_n, of_weights] = [of_d, of_n, of_weights].map(F64x8::to_array);
    let (for_d, for_n) = (d_accurate.to_array(), n_accurate.to_array());
    let are = std::array::from_fn(|lane| {
        of_d[lane].max(of_weights[lane]) <= for_d[lane] && of_n[lane] <= for_n[lane]
    });
    ([quotient(n, d), quotient(v, d), quotient(w, d)], are)
}

/// Returns the x, y and z of points.
#[inline(always)]
fn columns(points: [DVec3; WIDTH]) -> [F64x8; 3] {
    [0, 1, 2].map(|axis| F64x8::from(points.each_ref().map(|point| point[axis])))
}

/// Returns t and the barycentric weights of the second and the third corner, for rays and triangles that they
/// hit.
#[inline(never)]
pub fn solve(rays: &[ExactRay; WIDTH], triangles: &[[DVec3; 3]; WIDTH]) -> [[f64; 3]; WIDTH] {
    let corners = [0, 1, 2].map(|corner| columns(triangles.each_ref().map(|triangle| triangle[corner])));
    let origin = columns(rays.each_ref().map(|ray| ray.origin));
    let direction = columns(rays.each_ref().map(|ray| ray.direction));
    let ([t, v, w], are_accurate) = quotients(origin, direction, corners);
    let (t, v, w) = (t.to_array(), v.to_array(), w.to_array());
    std::array::from_fn(|lane| {
        let ray = &rays[lane];
        let numbers =
            if are_accurate[lane] { [t[lane], v[lane], w[lane]] } else { expanded(ray, &triangles[lane]) };
        // Exact values obey these limits; rounding must not leave them. Adding 0 makes −0 a 0.
        let [t, v, w] = numbers;
        [t.clamp(ray.t_min, ray.t_max), v.clamp(0.0, 1.0), w.clamp(0.0, 1.0)].map(|number| number + 0.0)
    })
}

#[cold]
#[inline(never)]
fn expanded(ray: &ExactRay, triangle: &[DVec3; 3]) -> [f64; 3] {
    let pair = |(high, low): (f64, f64)| (F64x8::splat(high), F64x8::splat(low));
    let ([n, d], [v, w]) = (ray.terms(triangle), ray.weights(triangle));
    let d = pair(d.leading());
    [n, v, w].map(|number| quotient(pair(number.leading()), d).to_array()[0])
}
