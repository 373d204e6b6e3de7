//! Whether a single-precision hit is as accurate as single precision allows.
//!
//! Below, ε = 2⁻²⁴ is the largest relative error of one rounding in f32. Origin and direction are f32 numbers
//! and so exact; centres, radii and vertices are those of the scene's file, where the reference has them, so
//! that what their rounding moves by more than these bounds is wrong. Distances are in scene units: `t` times
//! the length of the direction. The bounds add the first-order errors of a kernel's steps; they hold while no
//! product of lengths over- or underflows (lengths from 10⁻¹⁸ to 10¹⁸).
//!
//! # Errors are measured from the surface, not along the ray
//! Where a ray grazes a surface, a small sideways error of the ray moves its hit far along it: on a sphere of
//! radius r by √(2re) for an error e. No bound on t that suits a head-on ray can hold there. The *distance of
//! the computed point from the surface* is proportional to e at any angle, so this distance is bounded.
//!
//! # Sphere: bound e = 40 ε (|f| + r), where f = origin − centre
//! For the kernel of Haines et al. (Ray Tracing Gems, 2019, ch. 7):
//! - f has an error of ε|f| (one subtraction); f·d and d·d have 3 ε each, their quotient and the way to
//!   l = f − (f·d / d·d) d some more: |δl| ≤ 11 ε|f|. The comparison of l² with r² adds 3 ε r.
//! - The computed half chord h obeys h² = r² − (l + δl)². With the true l it ends at the distance √(r² − (l +
//!   δl)² + l²) from the centre, which differs from r by at most √2 |δl| = 16 ε|f|, for every l that is taken
//!   for a hit.
//! - The middle of the chord is off by 8 ε|f| along the ray, the last additions and the division by 2 ε(|f| +
//!   r).
//! - The root c/q: c = |f|² − r² has an error δc = (5|f|² + 2r²) ε, t one of δc/q, at an incidence whose
//!   cosine is at most q/r. From far (|f| > 2r), δc/c ≤ 8 ε and t ≤ |f|: 8 ε|f|. From near, δc/2r ≤ (5|f| +
//!   r) ε.
//! - Sum: 34 ε|f| + 7 ε r, rounded up to 40 ε (|f| + r).
//!
//! The second-order term (δc/q)²/2r is left out. It is below the first-order ones while q² > δc, that is
//! while the ray does not touch the sphere within √ε r of its own origin; origins offset from the surface by
//! some ε r fulfil this.
//!
//! # Triangle: bound e = 40 ε m + min(40 ε |a'| |b'| |c'| / det, √3 max(|a'|, |b'|, |c'|))
//! where m is the largest distance of a vertex from the origin, and a', b', c' are the vertices as seen along
//! the ray (their components across it), det twice the area they span. For the kernel of Woop et al. (JCGT
//! 2013):
//! - A sheared vertex is off by 5 ε m in each coordinate, 7 ε m together. This is as if the triangle's
//!   vertices were elsewhere by as much: the computed point is a weighted mean of the vertices that misses
//!   the ray by 7 ε m.
//! - An edge function is off by 2 ε|b'||c'|; the three of them move the weighted mean by 6 ε|a'||b'||c'| /
//!   det across the ray. Twice that for the error of det itself, three times because the shear measures not
//!   across the ray but across an axis, where lengths are longer by up to √3: 36 ε. This is what makes
//!   slivers, and triangles seen edge-on, inaccurate. The weights being of one sign, the mean never leaves
//!   the triangle: however small det is, it misses the ray by no more than the farthest vertex does, times
//!   √3.
//! - z, products, sums and the division: 10 ε of the largest z, which the ray's slope may stretch by √3: 17 ε
//!   m.
//! - Sum: 24 ε m, rounded up to the sphere's 40.
//!
//! Whether a ray passes an edge is off by 7 ε m + 8 ε times the edge across the ray: 40 ε m covers it,
//! whatever the shape.
//!
//! # Where on the triangle: the same bound, from the ray
//! The computed point as a weighted mean of the vertices misses the ray by 7 ε m and the edge functions'
//! term, above. Dividing by det, and taking the first weight as 1 − u − v, moves it by 5 ε along two edges,
//! each at most 2 m long: 10 ε m. Sum: 17 ε m. The weights, of one sign before the division, are off by 5 ε
//! after it.
//!
//! Roundings seldom all add up: of 2·10⁵ random rays the worst stays below a tenth of these sums
//! (`rounding_of_a_good_kernel_is_right` also passes with 4 for 40, and fails with 2).

use super::geometry::{Crossing, Reference};
use glam::DVec3;

/// Largest excess of a weight beyond [0, 1].
const WEIGHT_BOUND: f64 = 5.0 / 16_777_216.0;

/// The reference's classification of a single-precision hit. Distances are in scene units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// As accurate as single precision allows.
    Right,
    /// No valid hit: no such primitive, t not a positive number, or a hit along a direction that is zero or
    /// not finite.
    Invalid,
    /// The point of these barycentric weights lies off the ray.
    OffRay {
        /// From the ray.
        distance: f64,
        /// What single precision explains.
        bound: f64,
    },
    /// The point at t lies off the primitive.
    OffSurface {
        /// From the surface.
        distance: f64,
        /// What single precision explains.
        bound: f64,
    },
    /// Another primitive is in front of the hit by more than `slack`.
    Overlooked {
        /// Spheres first, in the scene's order, then triangles.
        primitive: u32,
        /// Of the crossing from the origin.
        distance: f64,
        /// Error bound of the crossing along the ray.
        slack: f64,
    },
}

impl Reference {
    /// Checks the hit of `primitive` at `t` (`u32::MAX`: a miss, whatever t is) of a ray whose direction need
    /// not have unit length.
    ///
    /// - *Sound*: the point at t lies on the primitive within its bound.
    /// - *Complete*: nothing in front of t was overlooked. A crossing of a primitive counts as overlooked if
    ///   it is nearer than t by more than its slack, unless the ray passes within the bound of the
    ///   primitive's outline (a miss is then as right), or the origin lies within the slack of the crossing
    ///   (the crossing may then count as behind).
    ///
    /// Slack: a point within e of a plane is within e / cos θ of the crossing along the ray (θ from the
    /// normal). On a sphere, whose depth s cos θ − s²/2r falls behind the plane's, 2 e / cos θ for every ray
    /// that passes the outline by more than e.
    ///
    /// Not detected: a ray through the common edge of two triangles may miss both. Watertightness is a
    /// property of a mesh, not of one answer.
    pub fn check_primary(&self, origin: [f32; 3], direction: [f32; 3], t: f32, primitive: u32) -> Verdict {
        let origin = DVec3::from_array(origin.map(f64::from));
        let direction = DVec3::from_array(direction.map(f64::from));
        let length = direction.length();
        let unit = direction / length;
        let mut t_max = f64::INFINITY;
        if primitive != u32::MAX {
            if !(t > 0.0 && t.is_finite() && unit.is_finite() && origin.is_finite()) {
                return Verdict::Invalid;
            }
            t_max = f64::from(t) * length;
            let point = origin + unit * t_max;
            let Some(primitive) = self.primitive(primitive) else { return Verdict::Invalid };
            let (distance, bound) = (primitive.distance(point), primitive.bound(origin, unit));
            if distance > bound {
                return Verdict::OffSurface { distance, bound };
            }
        }
        let is_in_front = |&(_, Crossing { distance, slack }): &(u32, Crossing)| {
            distance > slack && distance + slack < t_max
        };
        match self.crossings(origin, unit).find(is_in_front) {
            Some((primitive, Crossing { distance, slack })) => {
                Verdict::Overlooked { primitive, distance, slack }
            }
            None => Verdict::Right,
        }
    }

    /// Checks the barycentric weights of the second and third vertex in a hit of `primitive`: their point
    /// must lie on the triangle, and on the ray within its bound. Right for misses and spheres, which have no
    /// weights.
    pub fn check_weights(
        &self,
        origin: [f32; 3],
        direction: [f32; 3],
        primitive: u32,
        [u, v]: [f32; 2],
    ) -> Verdict {
        let origin = DVec3::from_array(origin.map(f64::from));
        let unit = DVec3::from_array(direction.map(f64::from)).normalize();
        let (u, v) = (f64::from(u), f64::from(v));
        let Some(primitive) = self.primitive(primitive) else { return Verdict::Right };
        let Some(distance) = primitive.off_ray(origin, unit, u, v) else { return Verdict::Right };
        // Written so that a NaN is invalid.
        if !([u, v, 1.0 - u - v].into_iter().all(|weight| weight >= -WEIGHT_BOUND) && unit.is_finite()) {
            return Verdict::Invalid;
        }
        let bound = primitive.bound(origin, unit);
        if distance > bound { Verdict::OffRay { distance, bound } } else { Verdict::Right }
    }
}
