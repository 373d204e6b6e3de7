//! Rays against spheres, by the default method and the textbook's.

use crate::lane::{Lane, Mask};
use crate::math::{Ray, Vec3};

/// A method of intersecting rays with spheres.
///
/// Shapes: `WIDTH` rays against `WIDTH` spheres, lane by lane; a packet against one sphere passes it
/// splatted.
/// Units: distances in multiples of the direction's length.
/// Domain: direction lengths as the method says. A NaN direction misses, and a zero one too unless the method
/// excludes it. Inactive lanes have a `limit` of 0, with which they miss.
pub trait SphereMethod: Send + Sync + 'static {
    /// What is computed once per ray.
    type Precalculated<L: Lane>: Copy;
    /// Whether spheres may be culled by [`super::sphere_culling`]: only if the method finds no hit on those.
    const MAY_CULL: bool;

    /// Precalculates a ray for all spheres.
    fn precalculate<L: Lane>(ray: &Ray<L>) -> Self::Precalculated<L>;

    /// The lanes that may hit, and their equations, unspecified in other lanes.
    fn equation<L: Lane>(
        ray: &Self::Precalculated<L>,
        center: Vec3<L>,
        radius2: L,
    ) -> (L::Mask, QuadraticEquation<L>);

    /// The nearest root in front of the ray's origin; not above 0, or NaN, where there is none.
    fn root<L: Lane>(ray: &Self::Precalculated<L>, equation: &QuadraticEquation<L>) -> L;

    /// The lanes that hit, and the nearest t of each in (0, `limit`); t is unspecified where nothing is hit.
    #[inline(always)]
    fn test<L: Lane>(ray: &Self::Precalculated<L>, center: Vec3<L>, radius2: L, limit: L) -> (L::Mask, L) {
        let (meets, equation) = Self::equation(ray, center, radius2);
        if !meets.any() {
            return (meets, limit);
        }
        Self::solve(ray, (meets, equation), limit)
    }

    /// The same of what [`SphereMethod::equation`] gives.
    #[inline(always)]
    fn solve<L: Lane>(
        ray: &Self::Precalculated<L>,
        (meets, equation): (L::Mask, QuadraticEquation<L>),
        limit: L,
    ) -> (L::Mask, L) {
        let t = Self::root(ray, &equation);
        (meets & L::zero().lt(t) & t.lt(limit), t)
    }
}

/// What a method computes of t² |d|² − 2bt + c = 0 before it takes a square root: one equation a lane.
#[derive(Clone, Copy, Debug)]
pub struct QuadraticEquation<L> {
    /// Half the linear coefficient, negated; of [`Naive`], the whole one, not negated.
    pub b: L,
    /// Above 0 where the ray starts outside of the sphere. Not used by [`Naive`].
    pub c: L,
    /// Not below 0 where the line meets the sphere.
    pub discriminant: L,
}

/// The discriminant from the perpendicular, the distance at which the line passes the centre, and not from
/// b² − 4ac.
///
/// Domain: directions of unit length within 1e-5, as the integrator keeps them (`tests/laws/long_paths.rs`).
/// With a length of 1 + e the perpendicular contains 2eD of the way to the centre: spheres farther away than
/// r / 2e are missed. t is off by less than e r from outside and 3 e r from inside. Other lengths are not
/// supported: their hits may lie outside the boxes of a hierarchy, whose result then differs from testing
/// everything; a zero direction from inside a sphere "hits".
/// Error, unit sphere at distance D (`spheres-far` of `octray stability`): hit or miss differs from f64 in
/// none of 400,000 rays at D = 10⁴, in 0.0015 % at 10⁵, in 0.11 % at 10⁶ ([`Naive`]: 41 %). Without FMA the
/// perpendicular is rounded once more, at the size of o: 0.010 %, 0.12 %, 1.2 %. The rounding of o − c
/// dominates: |Δt| ≤ ε · |o − c| · a small number, and within about √(ε · D · r) of the silhouette hit and
/// miss are undecided. So they are for rays that start within about ε r of the surface and run along it,
/// where both roots are close to zero: a hit found there is close by. Confirmed by
/// `tests/pictures/stability.rs`; t is never too small by more than the padding of boxes allows
/// (`tests/laws/kernel_sphere_box.rs`).
/// Source: Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing
/// Gems ch. 7, 2019.
pub struct Robust;

impl SphereMethod for Robust {
    type Precalculated<L: Lane> = Ray<L>;
    const MAY_CULL: bool = true;

    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>) -> Ray<L> {
        *ray
    }

    #[inline(always)]
    fn equation<L: Lane>(ray: &Ray<L>, center: Vec3<L>, radius2: L) -> (L::Mask, QuadraticEquation<L>) {
        let from_center = ray.origin - center;
        let c = from_center.dot(from_center) - radius2;
        let b = -from_center.dot(ray.direction);
        let perpendicular = ray.direction.mul_add(b, from_center);
        let discriminant = radius2 - perpendicular.dot(perpendicular);
        (may_hit(b, c, !discriminant.to_bits()), QuadraticEquation { b, c, discriminant })
    }
    #[inline(always)]
    fn root<L: Lane>(_: &Ray<L>, &QuadraticEquation { b, c, discriminant }: &QuadraticEquation<L>) -> L {
        // The roots are c/q and q. Neither cancels, because q is a sum of two numbers of the sign of b. From
        // outside the nearer one is c/q; from inside the one in front is q where the centre lies ahead, c/q
        // where it lies behind.
        let q = b + discriminant.sqrt().flip_sign(b);
        // The comparison is with q and not b, which at the centre is a zero of either sign. The minimum keeps
        // the nearer root from exceeding the other on the surface, where both are close to zero and c is
        // rounding error.
        let ahead_from_inside = c.le(L::zero()) & L::zero().lt(q);
        L::select(ahead_from_inside, q, (c / q).min(q.abs()))
    }
}

/// The lanes whose lines meet the sphere, where the sign bit of `meets` is set, but those of rays that start
/// outside and move away: both roots are behind them. b and c as in [`QuadraticEquation`].
///
/// By signs and not by comparisons, which share their execution ports with multiplications. Only zeros
/// differ: from a point of the surface away from the centre no root is above 0.
#[inline(always)]
pub(super) fn may_hit<L: Lane>(b: L, c: L, meets: L::Bits) -> L::Mask {
    L::from_bits(meets & (!b.to_bits() | c.to_bits())).is_sign_negative()
}

/// A ray and the reciprocal of its direction's squared length.
#[derive(Clone, Copy)]
pub struct Scaled<L> {
    ray: Ray<L>,
    a: L,
    inverse_a: L,
}

impl<L: Lane> Scaled<L> {
    #[inline(always)]
    fn new(ray: &Ray<L>) -> Self {
        let a = ray.direction.dot(ray.direction);
        Self { ray: *ray, a, inverse_a: L::one() / a }
    }
}

/// The textbook discriminant, b² − 4ac. For charts, beside [`Robust`].
///
/// Error (`spheres-far` of `octray stability`): misjudges 0.055 % of rays at a unit sphere at distance 100,
/// 3.5 % at 1,000, 29 % at 4,096; without FMA 0.050 %, 4.6 %, 30 %.
pub struct Naive;

impl SphereMethod for Naive {
    type Precalculated<L: Lane> = Scaled<L>;
    const MAY_CULL: bool = false;

    #[inline(always)]
    fn precalculate<L: Lane>(ray: &Ray<L>) -> Scaled<L> {
        Scaled::new(ray)
    }

    #[inline(always)]
    fn equation<L: Lane>(
        Scaled { ray, a, .. }: &Scaled<L>,
        center: Vec3<L>,
        radius2: L,
    ) -> (L::Mask, QuadraticEquation<L>) {
        let from_center = ray.origin - center;
        let c = from_center.dot(from_center) - radius2;
        let b = L::splat(2.0) * from_center.dot(ray.direction);
        let discriminant = b * b - L::splat(4.0) * *a * c;
        (L::zero().le(discriminant), QuadraticEquation { b, c, discriminant })
    }
    #[inline(always)]
    fn root<L: Lane>(precalculated: &Scaled<L>, equation: &QuadraticEquation<L>) -> L {
        let (b, root) = (equation.b, equation.discriminant.sqrt());
        let half = L::splat(0.5) * precalculated.inverse_a;
        let near = (-b - root) * half;
        L::select(L::zero().lt(near), near, (root - b) * half)
    }
}
