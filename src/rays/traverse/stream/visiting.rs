//! Visits leaves of triangles with rays in streams, for queries about more than the nearest hit.

use super::hit_batch::HitBatch;
use super::leaf_tests::{AcceptHits, LeafTests, places_of_masks};
use super::listed::{BATCH, ListedRay};
use super::stream_ray::StreamRay;
use super::{Padded, Stream, StreamTraversal};
use crate::bvh::{WIDE, WideNode};
use crate::columns::{Hits, Rays};
use crate::kind::triangle::TriangleLeaf;
use crate::math::Hit;
use crate::traverse::counter::CounterSink;

/// Visits rays and leaves of triangles whose boxes they pass.
pub trait VisitLeaf {
    /// Returns the triangles of a leaf to visit, one bit each.
    fn candidates(&self, listed: &ListedRay, leaf: &TriangleLeaf) -> u32;
    /// Visits these candidates; returns a new end of the ray, below 0 to end its search, or `None` to keep
    /// the end.
    fn visit(&mut self, listed: &ListedRay, leaf: &TriangleLeaf, candidates: u32) -> Option<f32>;
    /// Ends the visits of one node; calls `set_end` with rays and new ends.
    fn finish(&mut self, _set_end: impl FnMut(usize, f32)) {}
}

/// The leaf tests that a visitor makes.
struct Visiting<V>(V);

/// The leaf tests for every hit.
struct EveryHit<V>(V);

impl Stream {
    /// Visits the leaves of triangles whose boxes up to [`BATCH`] rays pass before their `t_max`. With `ANY`,
    /// the order of nodes is arbitrary.
    pub fn visit_leaves<const ANY: bool>(
        &mut self,
        padded: Padded,
        rays: &Rays,
        t_max: &mut [f32],
        visitor: impl VisitLeaf,
    ) {
        self.test_leaves::<ANY>(padded, rays, t_max, Visiting(visitor));
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
        self.test_leaves::<false>(padded, rays, t_max, EveryHit(&mut visit));
        if !self.candidates.is_empty() {
            self.candidates.visit(&self.stream_rays, &mut visit);
        }
    }

    /// Runs the tests of leaves that up to [`BATCH`] rays reach before their `t_max`.
    fn test_leaves<const ANY: bool>(
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
}

impl<V: VisitLeaf> LeafTests for Visiting<V> {
    #[inline(never)]
    fn triangle_leaves<const ANY: bool>(
        rays: &mut StreamTraversal<'_, '_, impl CounterSink, Self>,
        node: &WideNode,
        reached: u32,
        start: usize,
        paired: usize,
        _: usize,
    ) {
        let StreamTraversal { stream, hierarchy, tests, .. } = rays;
        let Stream { stream_rays, lists, slots, masks, found, iota, leaves, .. } = &mut **stream;
        let leaves = hierarchy.triangle_leaves(node, reached, leaves);
        let leaf_of = |slot: u8| leaves[usize::from(slot) & (WIDE - 1)];
        // The two loops are those of `triangles_then_hits`.
        for (entries, slots) in lists[start..start + paired].chunks(BATCH).zip(slots.chunks(BATCH)) {
            for ((mask, &entry), &slot) in masks.iter_mut().zip(entries).zip(slots) {
                *mask = tests.0.candidates(&ListedRay::new(entry, stream_rays), leaf_of(slot)) as u16;
            }
            for &place in places_of_masks(entries.len(), masks, iota, found) {
                let place = usize::from(place) & (BATCH - 1);
                let listed = ListedRay::new(entries[place], stream_rays);
                if ANY && listed.stream_ray.t < 0.0 {
                    continue;
                }
                let (ray, leaf) = (listed.ray(), leaf_of(slots[place]));
                if let Some(end) = tests.0.visit(&listed, leaf, masks[place].into()) {
                    stream_rays[ray].t = end;
                }
            }
        }
        tests.0.finish(|ray, end| stream_rays[ray].t = end);
    }
}

impl<V: FnMut(usize, Hit<f32>)> LeafTests for EveryHit<V> {
    #[inline(always)]
    fn triangle_leaves<const ANY: bool>(
        rays: &mut StreamTraversal<'_, '_, impl CounterSink, Self>,
        node: &WideNode,
        reached: u32,
        start: usize,
        paired: usize,
        _: usize,
    ) {
        if paired > 0 {
            rays.triangles_then_hits::<ANY>(node, reached, start, paired);
        }
    }
}

impl<V: FnMut(usize, Hit<f32>)> AcceptHits for EveryHit<V> {
    const END_RAYS: bool = false;

    #[inline(always)]
    fn accept<const ANY: bool>(
        &mut self,
        candidates: &mut HitBatch,
        stream_rays: &mut [StreamRay; BATCH],
        _: &mut Hits,
    ) {
        candidates.visit(stream_rays, &mut self.0);
    }
}
