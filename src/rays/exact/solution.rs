//! The numbers of a hit: t within two units in the last place, and the barycentric weights within 2⁻⁵².
//!
//! N, D and the weights times D are sums in pairs of doubles; where their bound of error is too large, they
//! are expansions. With q = A × d the weights are (C − A) · q and −(B − A) · q: the edges keep them accurate
//! far from the origin.

use super::expansion::{fast_two_sum, two_product, two_sum};
use super::ray::ExactRay;
use super::{Point, largest, length_1};

/// A number as the sum of two doubles; the second is at most half a unit of the first.
type Pair = (f64, f64);

/// The error of a determinant of pairs, relative to |p|₁ |q|∞ |r|∞. Each product is off by 2⁻¹⁰³ of itself
/// and each sum by 2⁻¹⁰⁴: two factors and three sums are below 2⁻¹⁰⁰, of at most twice that product.
const BOUND: f64 = f64::EPSILON * f64::EPSILON * 64.0;
/// The error of N, D and the weights that leaves the quotients accurate enough.
const ACCURATE: f64 = f64::EPSILON / 16.0;

fn product(a: Pair, b: Pair) -> Pair {
    let (high, low) = two_product(a.0, b.0);
    fast_two_sum(high, low + (a.0 * b.1 + a.1 * b.0))
}

fn sum(a: Pair, b: Pair) -> Pair {
    let ((high, low), (second, rest)) = (two_sum(a.0, b.0), two_sum(a.1, b.1));
    let (high, low) = fast_two_sum(high, low + second);
    fast_two_sum(high, low + rest)
}

fn negated((high, low): Pair) -> Pair {
    (-high, -low)
}

fn differences(p: Point, q: Point) -> [Pair; 3] {
    [two_sum(p[0], -q[0]), two_sum(p[1], -q[1]), two_sum(p[2], -q[2])]
}

fn dot(p: [Pair; 3], q: [Pair; 3]) -> Pair {
    sum(sum(product(p[0], q[0]), product(p[1], q[1])), product(p[2], q[2]))
}

fn cross(p: [Pair; 3], q: [Pair; 3]) -> [Pair; 3] {
    let component = |i: usize, j: usize| sum(product(p[i], q[j]), negated(product(p[j], q[i])));
    [component(1, 2), component(2, 0), component(0, 1)]
}

/// Returns a / b, half a unit and little more off.
fn quotient(a: Pair, b: Pair) -> f64 {
    let first = a.0 / b.0;
    let (high, low) = two_product(first, b.0);
    first + (((a.0 - high) - low) + a.1 - first * b.1) / b.0
}

impl ExactRay {
    /// Returns t and the barycentric weights of the second and the third corner of a triangle that the ray
    /// hits.
    pub fn solve(&self, triangle: &[Point; 3]) -> [f64; 3] {
        let ([n, d], [v, w]) = self.pairs(triangle).unwrap_or_else(|| self.expanded(triangle));
        // Exact values obey these limits; rounding must not leave them.
        let weight = |of_corner| quotient(of_corner, d).clamp(0.0, 1.0);
        [quotient(n, d).clamp(self.t_min, self.t_max), weight(v), weight(w)]
    }

    /// Returns N and D, and the weights times D, if they are accurate enough.
    fn pairs(&self, &[a, b, c]: &[Point; 3]) -> Option<([Pair; 2], [Pair; 2])> {
        let (from, ab, ac) = (differences(a, self.origin), differences(b, a), differences(c, a));
        let direction = self.direction.map(|component| (component, 0.0));
        let (normal, q) = (cross(ab, ac), cross(from, direction));
        let (n, d) = (dot(from, normal), dot(direction, normal));
        let weights = [dot(ac, q), negated(dot(ab, q))];
        let high = |pairs: [Pair; 3]| pairs.map(|(high, _)| high);
        let edge = largest(high(ab)).max(largest(high(ac)));
        let of_d = BOUND * length_1(self.direction) * (edge * edge);
        let of_n = BOUND * length_1(high(from)) * (edge * edge);
        let of_weights = BOUND * length_1(self.direction) * (edge * largest(high(from)));
        let is_accurate = of_d.max(of_weights) <= ACCURATE * d.0.abs() && of_n <= ACCURATE * n.0.abs();
        is_accurate.then_some(([n, d], weights))
    }

    #[cold]
    #[inline(never)]
    fn expanded(&self, triangle: &[Point; 3]) -> ([Pair; 2], [Pair; 2]) {
        let pairs = |[a, b]: [super::expansion::Expansion; 2]| [a.leading(), b.leading()];
        (pairs(self.terms(triangle)), pairs(self.weights(triangle)))
    }
}
