//! The interface of ray/triangle methods.

use crate::lane::{Lane, Mask};
use crate::math::Ray;

/// The result of a triangle test: the lanes that hit, t, and the barycentrics of the second and third vertex.
/// The numbers are unspecified outside of `mask`.
#[derive(Clone, Copy, Debug)]
pub struct TriangleHit<L: Lane> {
    /// The lanes that hit.
    pub mask: L::Mask,
    /// The distance in multiples of the direction's length.
    pub t: L,
    /// The barycentric weight of the second vertex.
    pub u: L,
    /// The barycentric weight of the third vertex.
    pub v: L,
}

impl<L: Lane> TriangleHit<L> {
    /// No hit.
    #[inline(always)]
    pub fn none(limit: L) -> Self {
        Self { mask: L::Mask::splat(false), t: limit, u: L::zero(), v: L::zero() }
    }
}

/// The result of testing a pair of triangles of which each ray hits at most one.
#[derive(Clone, Copy, Debug)]
pub struct PairHit<L: Lane> {
    /// The hits.
    pub hit: TriangleHit<L>,
    /// The lanes whose hit is of the second triangle.
    pub is_second: L::Mask,
}

/// A method of intersecting rays with triangles.
///
/// Shapes: a packet of `WIDTH` rays against one triangle, as `Stored` keeps it in memory.
/// Units: t in multiples of the direction's length, in (0, `limit`).
/// Domain: direction lengths between 1e-15 and 1e15. A zero or NaN direction misses. Inactive lanes have a
/// `limit` of 0, with which they miss.
pub trait TriangleMethod: Send + Sync + 'static {
    /// One triangle in memory.
    type Stored: Copy + Send + Sync;
    /// What is computed once per ray.
    type Precalculated<L: Lane>: Copy;

    /// A triangle as it is kept in memory.
    fn store(vertices: [glam::Vec3; 3]) -> Self::Stored;
    /// Precalculates a ray for all triangles.
    fn precalculate<L: Lane>(ray: &Ray<L>) -> Self::Precalculated<L>;
    /// The hit of each lane before its `limit`.
    fn test<L: Lane>(ray: &Self::Precalculated<L>, triangle: &Self::Stored, limit: L) -> TriangleHit<L>;

    /// Finds triangles whose successor continues them: a, b, c before a, c, d, as polygons are cut. No
    /// triangle is in two such pairs.
    fn link_pairs(_: &mut [Self::Stored]) {}

    /// Does the successor continue this triangle? Then [`TriangleMethod::test_pair`] takes both.
    #[inline(always)]
    fn is_linked(_: &Self::Stored) -> bool {
        false
    }

    /// [`TriangleMethod::test`] of a linked triangle and its successor without a limit, or `None` if some ray
    /// may hit both: it passes their common edge, or they are degenerate. Then test one after the other.
    #[inline(always)]
    fn test_pair<L: Lane>(_: &Self::Precalculated<L>, _: [&Self::Stored; 2]) -> Option<PairHit<L>> {
        None
    }

    /// The lower and upper corner of the triangle's own box, of methods whose hits are restricted to it: see
    /// [`crate::kernel::ray_box::own_box`]. The caller gives such a method no `limit`, and compares the t
    /// that is clamped to the box: so the order of tests does not change the closest hit.
    fn own_box(_: &Self::Stored) -> Option<[glam::Vec3; 2]> {
        None
    }
}
