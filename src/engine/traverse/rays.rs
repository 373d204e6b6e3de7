//! Rays and hits as columns: what every traversal reads and writes.

use super::prepared::SingleRay;
use crate::kernel::ray_box::Padding;
use crate::lane::{Bits, Lane};
use crate::math::{Hit, Ray, Vec3};
use std::ops::Range;

/// Rays as columns.
#[derive(Clone, Copy)]
pub struct Rays<'a> {
    /// x, y and z of where they begin.
    pub origin: [&'a [f32]; 3],
    /// x, y and z of their directions, of unit length.
    pub direction: [&'a [f32]; 3],
    count: usize,
}

/// Hits as columns. Before a traversal `t` holds each ray's t_max (a ray with NaN, 0 or less hits nothing)
/// and `primitive` [`crate::math::MISS`]; or both hold an earlier hit. Barycentric weights are unspecified
/// but on triangles.
pub struct Hits<'a> {
    /// Distances.
    pub t: &'a mut [f32],
    /// Indices of primitives.
    pub primitive: &'a mut [u32],
    /// Barycentric weights of the second vertex.
    pub u: &'a mut [f32],
    /// Barycentric weights of the third vertex.
    pub v: &'a mut [f32],
}

#[inline(always)]
fn load<L: Lane>([x, y, z]: &[&[f32]; 3], at: usize) -> Vec3<L> {
    Vec3::new(L::load(&x[at..]), L::load(&y[at..]), L::load(&z[at..]))
}

impl<'a> Rays<'a> {
    /// As many rays as the columns are long.
    pub fn new(origin: [&'a [f32]; 3], direction: [&'a [f32]; 3]) -> Self {
        Self { origin, direction, count: origin[0].len() }
    }
    /// The first `count` rays of longer columns. A [`super::List`] reads and writes whole packets: there the
    /// columns of rays and hits go on to the end of the last one.
    pub fn first(count: usize, origin: [&'a [f32]; 3], direction: [&'a [f32]; 3]) -> Self {
        Self { origin, direction, count }
    }
    /// The number of rays.
    pub fn len(&self) -> usize {
        self.count
    }
    /// Whether there is no ray.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }
    /// `WIDTH` rays from `at` on.
    #[inline(always)]
    pub fn packet<L: Lane>(&self, at: usize) -> Ray<L> {
        Ray { origin: load(&self.origin, at), direction: load(&self.direction, at) }
    }
    /// One ray, prepared.
    #[inline(always)]
    pub fn single(&self, at: usize, padding: Padding) -> SingleRay {
        SingleRay::new(self.packet::<f32>(at), padding)
    }
    /// Some of the rays.
    pub fn range(&self, range: Range<usize>) -> Rays<'a> {
        Rays::new(
            self.origin.map(|column| &column[range.clone()]),
            self.direction.map(|column| &column[range.clone()]),
        )
    }
}

impl Hits<'_> {
    /// One hit.
    #[inline(always)]
    pub fn get(&self, at: usize) -> Hit<f32> {
        Hit { t: self.t[at], primitive: self.primitive[at], u: self.u[at], v: self.v[at] }
    }
    /// Replaces one hit.
    #[inline(always)]
    pub fn set(&mut self, at: usize, hit: &Hit<f32>) {
        (self.t[at], self.primitive[at], self.u[at], self.v[at]) = (hit.t, hit.primitive, hit.u, hit.v);
    }
    /// `WIDTH` hits from `at` on.
    #[inline(always)]
    pub fn packet<L: Lane>(&self, at: usize) -> Hit<L> {
        let (t, primitive) = self.nearest(at);
        Hit { t, primitive, u: L::load(&self.u[at..]), v: L::load(&self.v[at..]) }
    }
    /// Replaces `WIDTH` hits.
    #[inline(always)]
    pub fn store<L: Lane>(&mut self, at: usize, hit: &Hit<L>) {
        self.store_nearest(at, hit.t, hit.primitive);
        hit.u.store(&mut self.u[at..]);
        hit.v.store(&mut self.v[at..]);
    }
    /// Distance and primitive of `WIDTH` hits.
    #[inline(always)]
    pub(super) fn nearest<L: Lane>(&self, at: usize) -> (L, L::Bits) {
        (L::load(&self.t[at..]), L::Bits::load(&self.primitive[at..]))
    }
    /// Replaces distance and primitive of `WIDTH` hits.
    #[inline(always)]
    pub(super) fn store_nearest<L: Lane>(&mut self, at: usize, t: L, primitive: L::Bits) {
        t.store(&mut self.t[at..]);
        primitive.store(&mut self.primitive[at..]);
    }
    /// Some of the hits.
    pub fn range(&mut self, range: Range<usize>) -> Hits<'_> {
        Hits {
            t: &mut self.t[range.clone()],
            primitive: &mut self.primitive[range.clone()],
            u: &mut self.u[range.clone()],
            v: &mut self.v[range],
        }
    }
}
