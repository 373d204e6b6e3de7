//! Packets of rays and of hits.

use super::vec3::Vec3;
use crate::lane::{Bits, Lane};

/// The primitive index of a miss.
pub const MISS: u32 = u32::MAX;

/// A packet of rays: points `origin + t · direction` with t > 0. Directions need not have unit length.
#[derive(Clone, Copy, Debug)]
pub struct Ray<L> {
    /// The point where the ray begins.
    pub origin: Vec3<L>,
    /// The direction, of unit length unless stated otherwise.
    pub direction: Vec3<L>,
}

impl<L: Lane> Ray<L> {
    /// Builds a packet from rays, one per lane.
    #[inline]
    pub fn from_lanes(rays: &[Ray<f32>]) -> Self {
        let lanes = |of: fn(&Ray<f32>) -> Vec3<f32>| {
            Vec3::new(
                L::from_fn(|i| of(&rays[i]).x),
                L::from_fn(|i| of(&rays[i]).y),
                L::from_fn(|i| of(&rays[i]).z),
            )
        };
        Self { origin: lanes(|ray| ray.origin), direction: lanes(|ray| ray.direction) }
    }
    /// Returns the point at `t`.
    #[inline(always)]
    pub fn at(&self, t: L) -> Vec3<L> {
        self.direction.mul_add(t, self.origin)
    }
}

/// The closest hit of each ray so far.
///
/// `primitive` counts the scene's spheres first, then its triangles. For a ray without a hit it is [`MISS`],
/// and t is the ray's t_max. `u` and `v` are the barycentric weights of a triangle's second and third vertex;
/// on spheres they are 0.
#[derive(Clone, Copy, Debug)]
pub struct Hit<L: Lane> {
    /// The distance in multiples of the direction's length.
    pub t: L,
    /// The index of the primitive, or [`MISS`].
    pub primitive: L::Bits,
    /// The barycentric weight of a triangle's second vertex.
    pub u: L,
    /// The barycentric weight of a triangle's third vertex.
    pub v: L,
}

impl<L: Lane> Hit<L> {
    /// Returns the lanes with a hit.
    #[inline(always)]
    pub fn found(&self) -> L::Mask {
        !self.primitive.equals(L::Bits::splat(MISS))
    }
    /// Returns the least of a triangle's three barycentric weights: a measure of the distance from its edges.
    #[inline(always)]
    pub fn least_weight(&self) -> L {
        self.u.min(self.v).min(L::one() - self.u - self.v)
    }
    /// Copies the hits of `other` in the lanes of `mask`.
    #[inline(always)]
    pub fn replace(&mut self, mask: L::Mask, other: &Self) {
        self.t = L::select(mask, other.t, self.t);
        self.primitive = L::Bits::select(mask, other.primitive, self.primitive);
        self.u = L::select(mask, other.u, self.u);
        self.v = L::select(mask, other.v, self.v);
    }
}
