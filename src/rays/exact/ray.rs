//! The verdicts: whether a ray hits a triangle, and which of two hits is nearer.

use super::expansion::{Expansion, sign};
use super::{BOUND, largest, length_1};
use glam::DVec3;
use std::cmp::Ordering::{self, Equal, Greater, Less};

/// The rule by which rays hit edges and vertices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rule {
    /// Triangles contain their edges and vertices.
    Closed,
    /// The ray is moved by an infinitesimal vector (ε, ε², ε³), so that it meets neither edges nor vertices,
    /// and neither starts nor ends in a plane: closed surfaces are crossed in turn from outside and inside.
    /// Moving d · (P × Q) by e adds e · ((P − Q) × d): the first component that is not 0 decides. All are 0
    /// only if the edge is parallel to the ray, and then D = 0.
    ///
    /// Source: H. Edelsbrunner, E. Mücke, "Simulation of Simplicity", ACM Transactions on Graphics 9, 1990.
    Once,
}

/// A ray in doubles, all finite, its direction not zero.
#[derive(Clone, Copy, Debug)]
pub struct ExactRay {
    /// The point at t = 0.
    pub origin: DVec3,
    /// The vector from there to the point at t = 1.
    pub direction: DVec3,
    /// Hits count at a greater t.
    pub t_min: f64,
    /// Hits count at a lower t.
    pub t_max: f64,
}

/// Where a ray hits a triangle: bounds of t.
#[derive(Clone, Copy, Debug)]
pub struct Crossing {
    lo: f64,
    hi: f64,
}

impl ExactRay {
    /// Returns the crossing with a triangle if the ray hits it.
    #[inline]
    pub fn hit(&self, triangle: &[DVec3; 3], rule: Rule) -> Option<Crossing> {
        let [a, b, c] = *triangle;
        let (a, b, c) = (a - self.origin, b - self.origin, c - self.origin);
        let largest = largest(a).max(largest(b)).max(largest(c));
        let bound = BOUND * length_1(self.direction) * (largest * largest);
        let edge = |p: DVec3, q: DVec3| self.direction.dot(p.cross(q));
        let edges = [edge(b, c), edge(c, a), edge(a, b)];
        let least = edges[0].min(edges[1]).min(edges[2]);
        let most = edges[0].max(edges[1]).max(edges[2]);
        if least < -bound && most > bound {
            return None;
        }
        if least <= bound && most >= -bound && !self.passes(triangle, edges, bound, rule) {
            return None;
        }
        let crossing = self.crossing(triangle);
        let Crossing { lo, hi } = crossing;
        let follows =
            lo > self.t_min || hi >= self.t_min && self.order(triangle, self.t_min, rule) == Greater;
        let precedes = hi < self.t_max || lo <= self.t_max && self.order(triangle, self.t_max, rule) == Less;
        (follows && precedes).then_some(crossing)
    }

    /// Tests whether the line passes a triangle; some of the `edges` are within their `bound` of 0.
    #[cold]
    #[inline(never)]
    fn passes(&self, triangle: &[DVec3; 3], edges: [f64; 3], bound: f64, rule: Rule) -> bool {
        let corners = |edge: usize| (triangle[(edge + 1) % 3], triangle[(edge + 2) % 3]);
        let signs: [Ordering; 3] = std::array::from_fn(|edge| match edges[edge].abs() > bound {
            true => sign(edges[edge]),
            false => self.side(corners(edge)).sign(),
        });
        if signs == [Equal; 3] || signs.contains(&Less) && signs.contains(&Greater) {
            return false;
        }
        let moved = |edge: usize| signs[edge].then_with(|| self.moved_side(corners(edge)));
        rule == Rule::Closed || (moved(0) == moved(1) && moved(1) == moved(2))
    }

    fn direction(&self) -> [Expansion; 3] {
        differences(self.direction, DVec3::ZERO)
    }

    /// Returns d · (P × Q) for the ends of an edge.
    fn side(&self, (p, q): (DVec3, DVec3)) -> Expansion {
        let [p, q] = [p, q].map(|point| differences(point, self.origin));
        exact_dot(&self.direction(), &exact_cross(&p, &q))
    }

    /// Returns the sign that d · (P × Q) = 0 takes if the origin is moved.
    fn moved_side(&self, (p, q): (DVec3, DVec3)) -> Ordering {
        first_sign(&exact_cross(&differences(p, q), &self.direction()))
    }

    /// Returns the crossing of the line and the plane of a triangle, which are not parallel.
    #[inline]
    pub fn crossing(&self, triangle: &[DVec3; 3]) -> Crossing {
        let [a, b, c] = *triangle;
        let (ab, ac, a) = (b - a, c - a, a - self.origin);
        let normal = ab.cross(ac);
        let (n, d) = (a.dot(normal), self.direction.dot(normal));
        let edge = largest(ab).max(largest(ac));
        let bound = BOUND * (edge * edge);
        let (of_n, of_d) = (bound * length_1(a), bound * length_1(self.direction));
        let (t, error) = if d.abs() > 2.0 * of_d {
            // |N* / D* − N / D| ≤ (|ΔN| + |N / D| |ΔD|) / |D*|, and four roundings.
            let t = n / d;
            (t, (of_n + t.abs() * of_d) / (d.abs() - of_d) * (1.0 + 8.0 * f64::EPSILON))
        } else {
            let ((n, _), (d, _)) = self.exact(triangle);
            (n / d, 0.0)
        };
        let error = error + t.abs() * (4.0 * f64::EPSILON);
        Crossing { lo: t - error, hi: t + error }
    }

    #[cold]
    #[inline(never)]
    fn exact(&self, triangle: &[DVec3; 3]) -> ((f64, f64), (f64, f64)) {
        let [n, d] = self.terms(triangle);
        (n.leading(), d.leading())
    }

    /// Compares the t at which the ray crosses the planes of two triangles.
    #[cold]
    #[inline(never)]
    fn compare(&self, [first, second]: &[[DVec3; 3]; 2]) -> Ordering {
        if first == second {
            return Equal;
        }
        let ([n, d], [other_n, other_d]) = (self.terms(first), self.terms(second));
        let difference = n.times(&other_d).minus(&other_n.times(&d));
        times(times(difference.sign(), d.sign()), other_d.sign())
    }

    /// Compares t with a number by the sign of N − t D, scaled by a power of two so that nothing overflows or
    /// underflows.
    #[cold]
    #[inline(never)]
    fn order(&self, triangle: &[DVec3; 3], bound: f64, rule: Rule) -> Ordering {
        let [n, d] = self.terms(triangle);
        let scale = match bound {
            bound if bound > f64::powi(2.0, 500) => f64::powi(0.5, 500),
            bound if bound > 0.0 && bound < f64::powi(0.5, 440) => f64::powi(2.0, 600),
            _ => 1.0,
        };
        let order = times(n.scaled(scale).minus(&d.scaled(bound * scale)).sign(), d.sign());
        // Moving the origin by e moves N by −e · n.
        let moved = || times(first_sign(&normal(triangle)).reverse(), d.sign());
        if rule == Rule::Once { order.then_with(moved) } else { order }
    }

    /// Returns N and D.
    pub(super) fn terms(&self, triangle: &[DVec3; 3]) -> [Expansion; 2] {
        let normal = normal(triangle);
        let n = exact_dot(&differences(triangle[0], self.origin), &normal);
        [n, exact_dot(&self.direction(), &normal)].map(Expansion::compressed)
    }

    /// Returns the weights of the second and the third corner, times D.
    pub(super) fn weights(&self, &[a, b, c]: &[DVec3; 3]) -> [Expansion; 2] {
        [self.side((c, a)), self.side((a, b))].map(Expansion::compressed)
    }
}

/// Returns the exact differences of the components of two points.
fn differences(p: DVec3, q: DVec3) -> [Expansion; 3] {
    std::array::from_fn(|axis| Expansion::difference(p[axis], q[axis]))
}

/// Returns a triangle's exact normal.
fn normal(&[a, b, c]: &[DVec3; 3]) -> [Expansion; 3] {
    exact_cross(&differences(b, a), &differences(c, a)).map(Expansion::compressed)
}

fn exact_dot(p: &[Expansion; 3], q: &[Expansion; 3]) -> Expansion {
    p[0].times(&q[0]).plus(&p[1].times(&q[1])).plus(&p[2].times(&q[2]))
}

fn exact_cross(p: &[Expansion; 3], q: &[Expansion; 3]) -> [Expansion; 3] {
    [(1, 2), (2, 0), (0, 1)].map(|(i, j)| p[i].times(&q[j]).minus(&p[j].times(&q[i])))
}

/// Returns the first sign that is not 0.
fn first_sign(vector: &[Expansion; 3]) -> Ordering {
    vector.iter().fold(Equal, |sign, component| sign.then_with(|| component.sign()))
}

/// Returns the product of two signs.
fn times(a: Ordering, b: Ordering) -> Ordering {
    if b == Less { a.reverse() } else { a }
}

impl Crossing {
    /// Returns a number that is not above t, and one that is not below it.
    pub fn bounds(&self) -> [f64; 2] {
        [self.lo, self.hi]
    }

    /// Compares the t of two crossings of the same ray, given the triangles.
    #[inline]
    pub fn compare(
        &self,
        other: &Self,
        ray: &ExactRay,
        triangles: impl FnOnce() -> [[DVec3; 3]; 2],
    ) -> Ordering {
        match () {
            () if self.hi < other.lo => Less,
            () if self.lo > other.hi => Greater,
            () => ray.compare(&triangles()),
        }
    }
}
