//! Finds the triangles that rays in doubles may hit, for rays in streams: see [`super::super::RoundedRay`].

use super::listed::{BATCH, ListedRay};
use super::{LeafTests, Padded, Stream, StreamTraversal};
use crate::bvh::{LEAF, WIDE, WideNode};
use crate::columns::{Hits, Rays};
use crate::lane::set_bits;
use crate::traverse::counter::CounterSink;

/// Visits rays and triangles that they may hit.
pub trait VisitCandidates {
    /// Fetches the place of a triangle's vertices into the cache.
    fn prefetch_face(&self, triangle: u32);
    /// Fetches the vertices of a triangle, whose place has been fetched.
    fn prefetch_vertices(&self, triangle: u32);
    /// Visits a triangle that a ray, by its index, may hit; returns a new end of the ray, below 0 to end its
    /// search, or `None` to keep the end.
    fn visit(&mut self, ray: usize, triangle: u32) -> Option<f32>;
}

/// Calls [`VisitCandidates::visit`] with rays and the triangles that they may hit.
pub struct Conservative<V> {
    /// The error of the test in leaves.
    delta: f32,
    visitor: V,
    /// The rays and triangles of a node.
    found: Vec<(u16, u32)>,
}

/// The number of visits between the prefetch of vertices and their use.
const AHEAD: usize = 6;

impl<V: VisitCandidates> Conservative<V> {
    pub fn new(delta: f32, visitor: V) -> Self {
        Self { delta, visitor, found: Vec::new() }
    }

    /// Visits the triangles that up to [`BATCH`] rays may hit before their `t_max`. With `ANY`, the order of
    /// nodes is arbitrary.
    pub fn trace<const ANY: bool>(self, stream: &mut Stream, padded: Padded, rays: &Rays, t_max: &mut [f32]) {
        assert!(rays.len() <= BATCH, "{} rays in a batch of {BATCH}", rays.len());
        if !rays.is_empty() {
            let mut hits = Hits { t: t_max, primitive: &mut [], u: &mut [], v: &mut [] };
            stream.trace_batch::<ANY, _>(padded, rays, &mut hits, (), self);
        }
    }
}

impl<V: VisitCandidates> LeafTests for Conservative<V> {
    #[inline(never)]
    fn triangle_leaves<const ANY: bool>(
        rays: &mut StreamTraversal<'_, '_, impl CounterSink, Self>,
        node: &WideNode,
        reached: u32,
        start: usize,
        [paired, _]: [usize; 2],
    ) {
        let StreamTraversal { stream, hierarchy, tests, .. } = rays;
        let Stream { stream_rays, lists, slots, leaves, .. } = &mut **stream;
        let leaves = hierarchy.triangle_leaves(node, reached, leaves);
        tests.found.clear();
        for (&entry, &slot) in lists[start..start + paired].iter().zip(&*slots) {
            let leaf = leaves[usize::from(slot) & (WIDE - 1)];
            let listed = ListedRay::new(entry, stream_rays);
            let (woop, end) = (listed.stored_woop(), listed.stream_ray.t);
            for lane in set_bits(leaf.conservative_candidates(woop, &tests.delta, end)) {
                let primitive = leaf.primitives.primitives[lane & (LEAF - 1)];
                tests.found.push((listed.ray() as u16, primitive));
                tests.visitor.prefetch_face(primitive);
            }
        }
        let found = &tests.found;
        found.iter().take(AHEAD).for_each(|&(_, primitive)| tests.visitor.prefetch_vertices(primitive));
        for (at, &(ray, primitive)) in found.iter().enumerate() {
            if let Some(&(_, next)) = found.get(at + AHEAD) {
                tests.visitor.prefetch_vertices(next);
            }
            let end = &mut stream_rays[usize::from(ray)].t;
            if *end >= 0.0
                && let Some(new) = tests.visitor.visit(ray.into(), primitive)
            {
                *end = new;
            }
        }
    }
}
