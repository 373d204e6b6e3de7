//! Queries in [`super::Precision::Exact`]: a conservative descent in f32 finds few triangles, and
//! [`crate::exact`] decides.

use super::input::OneRay;
use super::surfaces::Surfaces;
use crate::columns::Rays;
use crate::exact::{Crossing, ExactRay, Rule};
use crate::traverse::stack::Stack;
use crate::traverse::stream::Stream;
use crate::traverse::{RoundedRay, Structure, VisitCandidates, visit_candidates_of_batch};
use std::cmp::Ordering;

/// The end of a ray that is done, in the structure.
const DONE: f32 = f32::NEG_INFINITY;

/// Triangles, and the hierarchy over them.
#[derive(Clone, Copy)]
pub(super) struct Exact<'a> {
    pub surfaces: &'a Surfaces,
    pub structure: &'a Structure,
}

/// The closest hit so far, and the number of the triangle.
type Closest = Option<(Crossing, u32)>;

/// Rays that are traced together.
#[derive(Default)]
pub(super) struct ExactBatch {
    /// Two MiB, allocated at first use.
    stream: Option<Box<Stream>>,
    /// The x, y and z of the origins and of the directions, in f32, and the ends.
    columns: [Vec<f32>; 6],
    ends: Vec<f32>,
    /// The rays, and what they hit.
    rays: Vec<(ExactRay, RoundedRay)>,
    hits: Vec<Closest>,
    /// For each ray of a query the index of the batched ray, if it can hit anything.
    indices: Vec<Option<usize>>,
}

impl Exact<'_> {
    /// Improves the closest hit by a triangle. Returns the new end of the ray if there is one.
    #[inline]
    fn improve<const ANY: bool>(
        &self,
        (ray, rounded): (&ExactRay, &RoundedRay),
        closest: &mut Closest,
        number: u32,
    ) -> Option<f32> {
        let corners = |number: u32| self.surfaces.corners(number as usize);
        let triangle = corners(number);
        let crossing = ray.hit(&triangle, Rule::Closed)?;
        let is_nearer = closest.is_none_or(|(nearest, of_nearest)| {
            let order = crossing.compare(&nearest, ray, || [triangle, corners(of_nearest)]);
            order.then(number.cmp(&of_nearest)) == Ordering::Less
        });
        if !is_nearer {
            return None;
        }
        *closest = Some((crossing, number));
        Some(if ANY { DONE } else { rounded.end(crossing.upper().min(ray.t_max)) })
    }

    /// Finds the closest hit of each ray, with `ANY` only whether there is one; `None` is a ray that hits
    /// nothing.
    pub fn trace<const ANY: bool>(
        &self,
        batch: &mut ExactBatch,
        stack: &mut Stack,
        rays: impl Iterator<Item = Option<OneRay>>,
    ) {
        let ExactBatch { stream, columns, ends, rays: of_batch, hits, indices } = batch;
        columns.iter_mut().chain([&mut *ends]).for_each(Vec::clear);
        of_batch.clear();
        hits.clear();
        indices.clear();
        for ray in rays {
            let rounded = ray.and_then(|ray| {
                Some((ray.exact(), RoundedRay::new(self.structure, ray.origin, ray.direction)?))
            });
            indices.push(rounded.is_some().then_some(of_batch.len()));
            let Some((ray, rounded)) = rounded else { continue };
            let (o, d) = (rounded.ray.origin, rounded.ray.direction);
            columns.iter_mut().zip([o.x, o.y, o.z, d.x, d.y, d.z]).for_each(|(column, x)| column.push(x));
            let (end, mut closest) = (rounded.end(ray.t_max), None);
            let suits = rounded.suits_batch(self.structure);
            if !suits {
                rounded.visit_candidates(self.structure, stack, end, |number| {
                    self.improve::<ANY>((&ray, &rounded), &mut closest, number)
                });
            }
            ends.push(if suits { end } else { DONE });
            hits.push(closest);
            of_batch.push((ray, rounded));
        }
        let [x, y, z, dx, dy, dz] = &*columns;
        let rays = Rays::new([x, y, z], [dx, dy, dz]);
        let visitor = Visitor::<ANY> { exact: *self, rays: of_batch, hits };
        let stream = stream.get_or_insert_default();
        visit_candidates_of_batch::<ANY>(self.structure, stream, &rays, ends, visitor);
    }

    /// Calls `visit` with each hit of a ray, in no order.
    fn visit(&self, ray: &ExactRay, rule: Rule, stack: &mut Stack, mut visit: impl FnMut(Crossing, u32)) {
        let Some(rounded) = RoundedRay::new(self.structure, ray.origin, ray.direction) else { return };
        rounded.visit_candidates(self.structure, stack, rounded.end(ray.t_max), |number| {
            visit(ray.hit(&self.surfaces.corners(number as usize), rule)?, number);
            None
        });
    }

    /// Returns how many triangles the ray crosses, edges and vertices once.
    pub fn count(&self, ray: &OneRay, stack: &mut Stack) -> u32 {
        let mut count = 0;
        self.visit(&ray.exact(), Rule::Once, stack, |_, _| count += 1);
        count
    }

    /// Calls `push` with t, weights and number of each hit, in order.
    pub fn every_hit(&self, ray: &OneRay, stack: &mut Stack, mut push: impl FnMut([f64; 3], u32)) {
        let (ray, mut hits) = (ray.exact(), Vec::new());
        self.visit(&ray, Rule::Closed, stack, |crossing, number| hits.push((crossing, number)));
        let corners = |number: u32| self.surfaces.corners(number as usize);
        hits.sort_unstable_by(|&(a, of_a), &(b, of_b)| {
            a.compare(&b, &ray, || [corners(of_a), corners(of_b)]).then(of_a.cmp(&of_b))
        });
        let mut last = 0.0;
        for (_, number) in hits {
            // Two hits less than a rounding apart stay in order.
            let [t, u, v] = ray.solve(&corners(number));
            last = t.max(last);
            push([last, u, v], number);
        }
    }
}

/// Improves the closest hits of the rays of a batch.
struct Visitor<'a, const ANY: bool> {
    exact: Exact<'a>,
    rays: &'a [(ExactRay, RoundedRay)],
    hits: &'a mut [Closest],
}

impl<const ANY: bool> VisitCandidates for Visitor<'_, ANY> {
    #[inline(always)]
    fn prefetch_face(&self, triangle: u32) {
        self.exact.surfaces.prefetch_face(triangle);
    }
    #[inline(always)]
    fn prefetch_vertices(&self, triangle: u32) {
        self.exact.surfaces.prefetch_vertices(triangle);
    }
    #[inline(always)]
    fn visit(&mut self, ray: usize, triangle: u32) -> Option<f32> {
        let (exact, rounded) = &self.rays[ray];
        self.exact.improve::<ANY>((exact, rounded), &mut self.hits[ray], triangle)
    }
}

impl ExactBatch {
    /// Fetches what [`ExactBatch::hit`] reads for a ray: in two steps, the second with `is_near`.
    pub fn prefetch(&self, at: usize, surfaces: &Surfaces, is_near: bool) {
        let index = self.indices.get(at).copied().flatten();
        match index.and_then(|index| self.hits[index]) {
            Some((_, number)) if is_near => surfaces.prefetch_vertices(number),
            Some((_, number)) => surfaces.prefetch_face(number),
            None => {}
        }
    }

    /// Returns t, the weights and the triangle of a ray's hit after [`Exact::trace`].
    pub fn hit(&self, at: usize, surfaces: &Surfaces) -> Option<([f64; 3], u32)> {
        let index = self.indices[at]?;
        let (_, number) = self.hits[index]?;
        Some((self.rays[index].0.solve(&surfaces.corners(number as usize)), number))
    }

    /// Tests whether a ray hits anything, after [`Exact::trace`].
    pub fn is_hit(&self, at: usize) -> bool {
        self.indices[at].is_some_and(|index| self.hits[index].is_some())
    }
}

impl OneRay {
    fn exact(&self) -> ExactRay {
        let Self { origin, direction, t_min, t_max } = *self;
        ExactRay { origin, direction, t_min, t_max }
    }
}
