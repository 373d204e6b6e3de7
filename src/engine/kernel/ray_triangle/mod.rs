//! Rays against a triangle, by several methods side by side. Both sides count.

mod baldwin_weber;
mod moller_trumbore;
mod plucker;
mod woop;

pub use baldwin_weber::{AffineMap, BaldwinWeber};
pub use moller_trumbore::{Edges, MollerTrumbore, MollerTrumboreEpsilon};
pub use plucker::Plucker;
pub use woop::{EightTriangles, Woop, WoopContracted, WoopRay, WoopTriangle};

use crate::lane::{Lane, Mask};
use crate::math::Ray;

/// What a triangle test answers: the lanes that hit, t, and the barycentric weights of the second and third vertex; the
/// numbers are unspecified where nothing is hit.
#[derive(Clone, Copy, Debug)]
pub struct TriangleHit<L: Lane> {
    pub mask: L::Mask,
    pub t: L,
    pub u: L,
    pub v: L,
}

impl<L: Lane> TriangleHit<L> {
    #[inline(always)]
    fn none(limit: L) -> Self {
        Self { mask: L::Mask::splat(false), t: limit, u: L::zero(), v: L::zero() }
    }
}

/// A way to intersect rays with a triangle.
///
/// Shapes: a packet of `WIDTH` rays against one triangle, as `Stored` keeps it in memory.
/// Units: t in multiples of the direction's length, in (0, `limit`).
/// Domain: any direction length between 1e-15 and 1e15. A zero or NaN direction misses. Inactive lanes: give them a `limit`
/// of 0 and they miss.
pub trait TriangleMethod: Send + Sync + 'static {
    /// What memory holds of one triangle.
    type Stored: Copy + Send + Sync;
    /// What is computed once per ray.
    type Prepared<L: Lane>: Copy;

    fn store(vertices: [glam::Vec3; 3]) -> Self::Stored;
    fn prepare<L: Lane>(ray: &Ray<L>) -> Self::Prepared<L>;
    fn test<L: Lane>(ray: &Self::Prepared<L>, triangle: &Self::Stored, limit: L) -> TriangleHit<L>;

    /// The lower and upper corner of the triangle's box, where hits are held to it: see [`super::ray_box::own_box`]. Such a method
    /// is asked without a limit, which is for the t that was moved into the box: so the order of the tests cannot matter.
    fn own_box(_: &Self::Stored) -> Option<[glam::Vec3; 2]> {
        None
    }
}
