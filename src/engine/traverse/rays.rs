//! Rays and hits in structure-of-arrays form: what traversals of whole batches read and write.

use super::linear::Batch;
use super::prepared::SingleRay;
use crate::kernel::ray_box::Padding;
use crate::lane::{Bits, Lane};
use crate::math::{Hit, Ray, Vec3};

/// Rays as columns of equal length.
#[derive(Clone, Copy)]
pub struct Rays<'a> {
    /// x, y and z of where they begin.
    pub origin: [&'a [f32]; 3],
    /// x, y and z of their directions, of unit length.
    pub direction: [&'a [f32]; 3],
}

/// Hits as columns. Before a traversal `t` holds each ray's t_max (a ray with NaN, 0 or less hits nothing)
/// and `primitive` [`crate::math::MISS`]; or both hold an earlier hit.
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
    /// The number of rays.
    pub fn len(&self) -> usize {
        self.origin[0].len()
    }
    /// Whether there is no ray.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
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
    pub fn range(&self, range: std::ops::Range<usize>) -> Rays<'a> {
        Rays {
            origin: self.origin.map(|column| &column[range.clone()]),
            direction: self.direction.map(|column| &column[range.clone()]),
        }
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
    /// Some of the hits.
    pub fn range(&mut self, range: std::ops::Range<usize>) -> Hits<'_> {
        Hits {
            t: &mut self.t[range.clone()],
            primitive: &mut self.primitive[range.clone()],
            u: &mut self.u[range.clone()],
            v: &mut self.v[range],
        }
    }
}

/// Rays and their hits as columns, to test every primitive against.
///
/// Domain: whole packets; the last one would be read beyond the columns' ends, a panic.
pub struct RaysAndHits<'a, 'b> {
    /// The rays.
    pub rays: Rays<'a>,
    /// Their hits; before, each ray's t_max.
    pub hits: Hits<'b>,
}

impl<L: Lane> Batch<L> for RaysAndHits<'_, '_> {
    #[inline(always)]
    fn range(&self) -> std::ops::Range<usize> {
        0..self.rays.len()
    }
    #[inline(always)]
    fn ray(&self, at: usize) -> Ray<L> {
        self.rays.packet(at)
    }
    #[inline(always)]
    fn t_max(&self, at: usize) -> L {
        L::load(&self.hits.t[at..])
    }
    #[inline(always)]
    fn nearest(&self, at: usize) -> (L, L::Bits) {
        (L::load(&self.hits.t[at..]), L::Bits::load(&self.hits.primitive[at..]))
    }
    #[inline(always)]
    fn store_nearest(&mut self, at: usize, t: L, primitive: L::Bits) {
        t.store(&mut self.hits.t[at..]);
        primitive.store(&mut self.hits.primitive[at..]);
    }
    #[inline(always)]
    fn store_barycentrics(&mut self, at: usize, u: L, v: L) {
        u.store(&mut self.hits.u[at..]);
        v.store(&mut self.hits.v[at..]);
    }
}
