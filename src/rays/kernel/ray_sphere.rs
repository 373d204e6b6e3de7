//! Rays against spheres.
//!
//! The discriminant comes from the perpendicular, the distance at which the line passes the centre, and not
//! from b² − 4ac.
//!
//! Domain: directions of unit length within 1e-5, which the integrator ensures (`tests/laws/long_paths.rs`).
//! With a length of 1 + e the perpendicular contains 2eD of the way to the centre: spheres farther away than
//! r / 2e are missed. t is off by less than e r from outside and 3 e r from inside. Other lengths are not
//! supported: hits may lie outside the boxes of a hierarchy, which then differs from the list; a zero
//! direction from inside a sphere "hits".
//! Error, unit sphere at distance D (`spheres-far` of `octray stability`): hit or miss differs from f64 in
//! none of 400,000 rays at D = 10⁴, in 0.0015 % at 10⁵, in 0.11 % at 10⁶ (b² − 4ac: 41 %). Without FMA the
//! perpendicular is rounded once more, at the size of o: 0.010 %, 0.12 %, 1.2 %. The rounding of o − c
//! dominates: |Δt| ≤ ε · |o − c| · a small number. Within about √(ε · D · r) of the silhouette, hit and miss
//! are undecided, and so they are for rays that start within about ε r of the surface and run along it, where
//! both roots are close to zero: a hit found there is close by. Confirmed by `tests/pictures/stability.rs`; t
//! is never too small by more than the padding of boxes allows (`tests/laws/kernel_sphere_box.rs`).
//! Source: Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing
//! Gems ch. 7, 2019.

use crate::lane::{Lane, Mask};
use crate::math::{Ray, Vec3};

/// The coefficients of t² |d|² − 2bt + c = 0 before a square root is taken: one equation per lane.
#[derive(Clone, Copy, Debug)]
pub struct QuadraticEquation<L> {
    /// Half the linear coefficient, negated.
    b: L,
    /// Positive if the ray starts outside the sphere.
    c: L,
    /// Not negative if the line meets the sphere.
    discriminant: L,
}

impl<L: Lane> QuadraticEquation<L> {
    /// Returns the lanes that may hit, and their equations, unspecified in other lanes.
    ///
    /// Shapes: `WIDTH` rays against `WIDTH` spheres, lane by lane; a packet against one sphere passes it
    /// splatted.
    #[inline(always)]
    pub fn new(ray: &Ray<L>, center: Vec3<L>, radius2: L) -> (L::Mask, Self) {
        let from_center = ray.origin - center;
        let c = from_center.dot(from_center) - radius2;
        let b = -from_center.dot(ray.direction);
        let perpendicular = ray.direction.mul_add(b, from_center);
        let discriminant = radius2 - perpendicular.dot(perpendicular);
        (may_hit(b, c, !discriminant.to_bits()), Self { b, c, discriminant })
    }

    /// Returns the lanes of `may_hit` that hit, and the nearest t of each in (0, `limit`). In the other lanes
    /// t is unspecified.
    #[inline(always)]
    pub fn solve(&self, may_hit: L::Mask, limit: L) -> (L::Mask, L) {
        let t = self.root();
        (may_hit & L::zero().lt(t) & t.lt(limit), t)
    }

    /// Returns the roots in front of the ray's origin, the nearest first; a number ≤ 0 or NaN means that
    /// there is none.
    pub fn roots(&self) -> [L; 2] {
        // From outside the other root is q; from inside it is behind the origin.
        let q = self.b + self.discriminant.sqrt().flip_sign(self.b);
        [self.root(), q.only(L::zero().lt(self.c))]
    }

    /// Returns the nearest root in front of the ray's origin; a number ≤ 0 or NaN means that there is none.
    #[inline(always)]
    fn root(&self) -> L {
        let &Self { b, c, discriminant } = self;
        // The roots are c/q and q. Neither cancels, because q is a sum of two numbers with the sign of b.
        // From outside the nearer root is c/q. From inside, the root in front is q if the centre lies ahead,
        // and c/q if it lies behind.
        let q = b + discriminant.sqrt().flip_sign(b);
        // The comparison is with q and not with b, which at the centre is a zero of either sign. The minimum
        // keeps the nearer root from exceeding the other on the surface, where both are close to zero and c
        // is rounding error.
        let ahead_from_inside = c.le(L::zero()) & L::zero().lt(q);
        L::select(ahead_from_inside, q, (c / q).min(q.abs()))
    }
}

/// Returns the lanes that hit, and the nearest t of each in (0, `limit`); elsewhere t is unspecified.
/// Inactive lanes have a `limit` of 0 and miss, as do rays with a NaN direction.
///
/// Units: distances in multiples of the direction's length.
#[inline(always)]
pub fn intersect<L: Lane>(ray: &Ray<L>, center: Vec3<L>, radius2: L, limit: L) -> (L::Mask, L) {
    let (may_hit, equation) = QuadraticEquation::new(ray, center, radius2);
    if may_hit.any() { equation.solve(may_hit, limit) } else { (may_hit, limit) }
}

/// Returns the lanes whose lines meet the sphere, where the sign bit of `meets` is set, except rays that
/// start outside and move away: both roots are behind them. b and c are those of [`QuadraticEquation`].
///
/// Signs are combined instead of comparisons, which share their execution ports with multiplications. The
/// result differs only for zeros: from a point of the surface away from the centre no root is above 0.
#[inline(always)]
pub(super) fn may_hit<L: Lane>(b: L, c: L, meets: L::Bits) -> L::Mask {
    L::from_bits(meets & (!b.to_bits() | c.to_bits())).is_sign_negative()
}
