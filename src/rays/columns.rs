//! Rays and hits as columns, the input and the output of every traversal.

use crate::lane::{Bits, F32x8, Lane, Mask, Mask8};
use crate::math::{Hit, MISS, Ray, Vec3};
use crate::numbering::Candidates;
use std::ops::Range;

/// A set of rays as columns.
#[derive(Clone, Copy)]
pub struct Rays<'a> {
    origin: Origin<'a>,
    /// The x, y and z of the directions, of unit length except in queries in world coordinates.
    pub direction: [&'a [f32]; 3],
    /// Only hits before it count; `None` means infinity. A ray whose t_max is NaN or ≤ 0 hits nothing.
    t_max: Option<&'a [f32]>,
    candidates: Option<&'a Candidates>,
    lower_bound: Option<LowerBounds<'a>>,
    count: usize,
}

/// The exclusive lower bounds of rays: only hits at a greater t count, and those at the same t of primitives
/// with a higher number.
#[derive(Clone, Copy)]
pub(crate) struct LowerBounds<'a> {
    t: &'a [f32],
    primitive: &'a [u32],
}

impl LowerBounds<'_> {
    /// Tests whether a ray's hit is beyond its bound.
    pub fn are_below(&self, at: usize, t: f32, primitive: u32) -> bool {
        t > self.t[at] || t == self.t[at] && primitive > self.primitive[at]
    }
}

/// The origins of rays: columns of x, y and z, or one point.
#[derive(Clone, Copy)]
enum Origin<'a> {
    Each([&'a [f32]; 3]),
    Common(glam::Vec3),
}

/// Hits as columns. A miss has [`crate::math::MISS`] as primitive and the ray's t_max as t. Barycentric
/// weights are unspecified except on triangles.
pub struct Hits<'a> {
    /// The distances.
    pub t: &'a mut [f32],
    /// The indices of the primitives.
    pub primitive: &'a mut [u32],
    /// The barycentric weights of the second vertex.
    pub u: &'a mut [f32],
    /// The barycentric weights of the third vertex.
    pub v: &'a mut [f32],
}

#[inline(always)]
fn load<L: Lane>([x, y, z]: &[&[f32]; 3], at: usize) -> Vec3<L> {
    Vec3::new(L::load(&x[at..]), L::load(&y[at..]), L::load(&z[at..]))
}

impl<'a> Rays<'a> {
    /// Creates as many rays as the columns are long.
    pub fn new(origin: [&'a [f32]; 3], direction: [&'a [f32]; 3]) -> Self {
        Self {
            origin: Origin::Each(origin),
            direction,
            t_max: None,
            candidates: None,
            lower_bound: None,
            count: direction[0].len(),
        }
    }
    /// Creates rays that share one origin.
    pub fn from_one(origin: glam::Vec3, direction: [&'a [f32]; 3]) -> Self {
        Self {
            origin: Origin::Common(origin),
            direction,
            t_max: None,
            candidates: None,
            lower_bound: None,
            count: direction[0].len(),
        }
    }
    /// Restricts the rays to the first `count` of longer columns. Tests of a list read and write whole
    /// packets, so the columns of rays and hits must extend to the end of the last packet.
    pub fn first(self, count: usize) -> Self {
        Self { count, ..self }
    }
    /// Sets the t_max of each ray, in units of its direction's length: only hits before it count. A ray whose
    /// t_max is NaN or ≤ 0 hits nothing.
    pub fn until(self, t_max: &'a [f32]) -> Self {
        Self { t_max: Some(t_max), ..self }
    }
    /// Sets an exclusive lower bound for the hits of each ray: hits count at a greater t and, at this t, on
    /// primitives with a higher number. A ray with its last hit as the bound finds the next hit, also that on
    /// the other side of a sphere; a bound of 0 admits the first. Such rays are traced one by one.
    ///
    /// # Panics
    /// In queries, if a column is shorter than the rays, or the structure has [`crate::PrimitiveTests`].
    pub fn beyond(self, t: &'a [f32], primitive: &'a [u32]) -> Self {
        Self { lower_bound: Some(LowerBounds { t, primitive }), ..self }
    }
    /// Sets the candidates, all primitives that the rays can hit, if they are known. Only
    /// [`crate::Tracer::closest_in_scene`] reads them, and only for structures for which
    /// [`crate::Structure::accepts_candidates`] holds and rays without lower bounds; other queries test all.
    pub fn among(self, candidates: Option<&'a Candidates>) -> Self {
        Self { candidates, ..self }
    }
    /// Returns the candidates, all primitives that the rays can hit, if they are known.
    pub(crate) fn candidates(&self) -> Option<&'a Candidates> {
        self.candidates
    }
    /// Returns the lower bounds of the rays' hits.
    pub(crate) fn lower_bound(&self) -> Option<LowerBounds<'a>> {
        self.lower_bound
    }
    /// Returns the number of rays.
    pub fn len(&self) -> usize {
        self.count
    }
    /// Tests whether there are no rays.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }
    /// Returns the `WIDTH` rays that start at index `at`.
    #[inline(always)]
    pub fn packet<L: Lane>(&self, at: usize) -> Ray<L> {
        let origin = match &self.origin {
            Origin::Each(columns) => load(columns, at),
            Origin::Common(point) => Vec3::splat(*point),
        };
        Ray { origin, direction: load(&self.direction, at) }
    }
    /// Returns the t_max of the `WIDTH` rays that start at index `at`.
    #[inline(always)]
    pub(crate) fn t_max<L: Lane>(&self, at: usize) -> L {
        self.t_max.map_or(L::splat(f32::INFINITY), |t_max| L::load(&t_max[at..]))
    }
    /// Tests whether all rays begin at this point.
    pub(crate) fn begin_at(&self, point: [f32; 3]) -> bool {
        match &self.origin {
            Origin::Common(origin) => origin.to_array() == point,
            Origin::Each(columns) => columns.iter().zip(point).all(|(column, x)| {
                let (packets, rest) = column[..self.count].as_chunks::<{ F32x8::WIDTH }>();
                let same = |all, packet: &[f32; 8]| all & F32x8::load(packet).eq(F32x8::splat(x));
                packets.iter().fold(Mask8::splat(true), same).all() && rest.iter().all(|&o| o == x)
            }),
        }
    }
    /// Returns the ranges of whole packets of `lanes` rays, and of the rest, in packets of one ray.
    pub(crate) fn in_packets(&self, lanes: usize) -> [(Range<usize>, usize); 2] {
        let packets = self.count - self.count % lanes;
        [(0..packets, lanes), (packets..self.count, 1)]
    }
    /// Returns the rays with these indices.
    pub fn range(&self, range: Range<usize>) -> Rays<'a> {
        let columns = |columns: [&'a [f32]; 3]| columns.map(|column| &column[range.clone()]);
        let origin = match self.origin {
            Origin::Each(origin) => Origin::Each(columns(origin)),
            common => common,
        };
        let t_max = self.t_max.map(|column| &column[range.clone()]);
        let bound = |LowerBounds { t, primitive }| LowerBounds {
            t: &t[range.clone()],
            primitive: &primitive[range.clone()],
        };
        let lower_bound = self.lower_bound.map(bound);
        let direction = columns(self.direction);
        Self { origin, direction, t_max, lower_bound, count: range.len(), ..*self }
    }
}

impl Hits<'_> {
    /// Resets every hit to a miss at the ray's t_max.
    pub(crate) fn reset(&mut self, rays: &Rays) {
        let t = &mut self.t[..rays.count];
        match rays.t_max {
            Some(t_max) => t.copy_from_slice(&t_max[..rays.count]),
            None => t.fill(f32::INFINITY),
        }
        self.primitive[..rays.count].fill(MISS);
    }
    /// Returns one hit.
    #[inline(always)]
    pub fn get(&self, at: usize) -> Hit<f32> {
        Hit { t: self.t[at], primitive: self.primitive[at], u: self.u[at], v: self.v[at] }
    }
    /// Replaces one hit.
    #[inline(always)]
    pub fn set(&mut self, at: usize, hit: &Hit<f32>) {
        (self.t[at], self.primitive[at], self.u[at], self.v[at]) = (hit.t, hit.primitive, hit.u, hit.v);
    }
    /// Returns the `WIDTH` hits that start at index `at`.
    #[inline(always)]
    pub fn packet<L: Lane>(&self, at: usize) -> Hit<L> {
        let (t, primitive) = self.nearest(at);
        Hit { t, primitive, u: L::load(&self.u[at..]), v: L::load(&self.v[at..]) }
    }
    /// Replaces the `WIDTH` hits that start at index `at`.
    #[inline(always)]
    pub fn store<L: Lane>(&mut self, at: usize, hit: &Hit<L>) {
        self.store_nearest(at, hit.t, hit.primitive);
        hit.u.store(&mut self.u[at..]);
        hit.v.store(&mut self.v[at..]);
    }
    /// Returns the distances and primitives of `WIDTH` hits.
    #[inline(always)]
    pub(crate) fn nearest<L: Lane>(&self, at: usize) -> (L, L::Bits) {
        (L::load(&self.t[at..]), L::Bits::load(&self.primitive[at..]))
    }
    /// Replaces the distances and primitives of `WIDTH` hits.
    #[inline(always)]
    pub(crate) fn store_nearest<L: Lane>(&mut self, at: usize, t: L, primitive: L::Bits) {
        t.store(&mut self.t[at..]);
        primitive.store(&mut self.primitive[at..]);
    }
    /// Returns the hits with these indices.
    pub fn range(&mut self, range: Range<usize>) -> Hits<'_> {
        Hits {
            t: &mut self.t[range.clone()],
            primitive: &mut self.primitive[range.clone()],
            u: &mut self.u[range.clone()],
            v: &mut self.v[range],
        }
    }
}
