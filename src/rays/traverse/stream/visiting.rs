//! Visits leaves of triangles with rays in streams, for queries about more than the nearest hit.

use super::leaf_tests::{BatchHits, LeafTests};
use super::listed::BATCH;
use super::{Padded, Stream};
use crate::columns::{Hits, Rays};
use crate::kind::triangle::TriangleLeaf;
use crate::math::Hit;

/// The leaf tests for every hit.
struct EveryHit<V>(V);

impl Stream {
    /// Runs the tests of leaves of triangles that up to [`BATCH`] rays reach before their `t_max`. With
    /// `ANY`, the order of nodes is arbitrary.
    pub fn visit_leaves<const ANY: bool>(
        &mut self,
        padded: Padded,
        rays: &Rays,
        t_max: &mut [f32],
        tests: impl LeafTests,
    ) {
        assert!(rays.len() <= BATCH, "{} rays in a batch of {BATCH}", rays.len());
        if !rays.is_empty() {
            let mut hits = Hits { t: t_max, primitive: &mut [], u: &mut [], v: &mut [] };
            self.trace_batch::<ANY, _>(padded, rays, &mut hits, (), tests);
        }
    }

    /// Calls `visit` with up to [`BATCH`] rays, by index, and each of their hits with triangles before
    /// `t_max`, in no order.
    pub fn visit_hits(
        &mut self,
        padded: Padded,
        rays: &Rays,
        t_max: &mut [f32],
        mut visit: impl FnMut(usize, Hit<f32>),
    ) {
        self.visit_leaves::<false>(padded, rays, t_max, EveryHit(&mut visit));
        if !self.candidates.is_empty() {
            self.candidates.visit(&self.stream_rays, &mut visit);
        }
    }
}

impl<V: FnMut(usize, Hit<f32>)> LeafTests for EveryHit<V> {
    #[inline(always)]
    fn take<const ANY: bool>(&mut self, entry: u16, leaf: (&TriangleLeaf, u32), batch: &mut BatchHits) {
        batch.push(entry, leaf, |batch| batch.pairs.visit(batch.stream_rays, &mut self.0));
    }
    // Pairs wait for those of the next nodes, because no hit ends a ray.
    #[inline(always)]
    fn finish<const ANY: bool>(&mut self, _: &mut BatchHits) {}
}
