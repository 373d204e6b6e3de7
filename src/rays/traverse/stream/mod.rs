//! Ray streams: many rays traverse the tree together. Each node is read once for all rays that reach it.
//!
//! At a node each ray of its list is tested against the boxes of all children; the masks are compressed into
//! a list of rays for each child. Leaves are visited first, then nodes in the order of their mean entry
//! distance, or in slot order for any-hit queries.
//!
//! Rays of all octants share a list. Sorting a batch by octant, as in the source, saves the ordering of
//! planes, but lists have an eighth of the rays, and bounces are 1.1 times slower on 4,000 triangles, 1.6
//! times on 48,000. Planes are ordered once per list only in batches within one octant, as most batches of
//! primary rays are.
//!
//! Source: Tsakok, "Faster Incoherent Rays: Multi-BVH Ray Stream Tracing", HPG 2009.

mod boxes;
mod hit_batch;
mod leaf_tests;
mod listed;
mod stream_ray;
mod visiting;

use super::counter::CounterSink;
use super::hierarchy::Hierarchy;
use crate::bvh::{Child, WIDE, slots};
use crate::columns::{Hits, Rays};
use crate::kernel::ray_box::Padding;
use crate::kind::triangle::TriangleLeaf;
use crate::lane::compaction::{CHUNK, compress_where};
use crate::lane::{Bits, F32x8, Lane};
use crate::math::Ray;
use boxes::pass_boxes;
use hit_batch::HitBatch;
use leaf_tests::Nearest;
pub use leaf_tests::{BatchHits, LeafTests};
pub use listed::{BATCH, ListedRay};
use listed::{entry_of, update_hit};
use stream_ray::StreamRay;

/// The working memory of a thread: two MiB.
pub struct Stream {
    stream_rays: Box<[StreamRay; BATCH]>,
    /// The axes of the rays' triangle tests and, from bit 8 on, the octants.
    axes: Box<[u32; BATCH]>,
    /// The rays' octants: one bit for each axis along which a ray runs backwards.
    octants: Box<[u8; BATCH]>,
    /// A stack of lists of rays, end to end.
    lists: Vec<u16>,
    /// For each pair of a ray and a leaf of triangles, the leaf's slot in its node.
    slots: Vec<u8>,
    /// For each ray of a list, the boxes that it passes, one bit each; later, for each pair of a ray and a
    /// leaf, the triangles that the ray may hit.
    masks: Vec<u16>,
    /// The indices of the pairs whose mask of triangles is not zero.
    found: Vec<u16>,
    /// The numbers 0, 1, 2, …
    iota: Box<[u16; BATCH]>,
    /// Memory for the expanded leaves of a node.
    leaves: Box<[TriangleLeaf; WIDE]>,
    /// Rays and triangles still to be accepted as hits; empty between batches.
    candidates: Box<HitBatch>,
}

/// A tree, and the padding of its boxes that a traversal asks for.
pub struct Padded<'a> {
    pub hierarchy: &'a Hierarchy,
    pub padding: Padding,
}

impl Default for Stream {
    fn default() -> Self {
        Self::new()
    }
}

impl Stream {
    /// Creates empty lists with room for a batch.
    pub fn new() -> Self {
        Self {
            stream_rays: bytemuck::zeroed_box(),
            axes: bytemuck::zeroed_box(),
            octants: bytemuck::zeroed_box(),
            lists: vec![0; 16 * BATCH],
            slots: vec![0; 16 * BATCH],
            masks: vec![0; BATCH + CHUNK],
            found: vec![0; BATCH + CHUNK],
            iota: Box::new(std::array::from_fn(|place| place as u16)),
            leaves: Box::new([TriangleLeaf::EMPTY; WIDE]),
            candidates: Box::new(HitBatch::EMPTY),
        }
    }

    /// Improves the hits of all rays; with `ANY`, each ends at the first hit found.
    pub fn trace<const ANY: bool>(
        &mut self,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        counter: impl CounterSink,
    ) {
        for first in (0..rays.len()).step_by(BATCH) {
            let batch = first..rays.len().min(first + BATCH);
            let (rays, hits) = (&rays.range(batch.clone()), &mut hits.range(batch));
            let padded = Padded { hierarchy, padding: hierarchy.padding };
            self.trace_batch::<ANY, _>(padded, rays, hits, counter, Nearest);
        }
    }

    /// Traces 1 to [`BATCH`] rays, which end at the t of their hits.
    fn trace_batch<const ANY: bool, T: LeafTests>(
        &mut self,
        Padded { hierarchy, padding }: Padded,
        rays: &Rays,
        hits: &mut Hits,
        counter: impl CounterSink,
        tests: T,
    ) {
        self.prepare_all(padding, rays, hits);
        let count = rays.len();
        let (mut of_all, mut of_any) = (u8::MAX, 0);
        let entries = self.lists[..count].iter_mut().zip(&mut self.octants[..count]);
        for (ray, ((entry, octant), &axis)) in (0..).zip(entries.zip(&self.axes[..count])) {
            *entry = entry_of(ray, axis as u8);
            *octant = (axis >> 8) as u8;
            (of_all, of_any) = (of_all & *octant, of_any | *octant);
        }
        let mut rays = StreamTraversal { stream: self, hierarchy, rays, hits, counter, tests };
        if !ANY && of_all == of_any {
            rays.node::<ANY, true>(0, 0, count, count + CHUNK);
        } else {
            rays.node::<ANY, false>(0, 0, count, count + CHUNK);
        }
    }

    fn prepare_all(&mut self, padding: Padding, rays: &Rays, hits: &Hits) {
        let whole = rays.len() - rays.len() % F32x8::WIDTH;
        for at in (0..whole).step_by(F32x8::WIDTH) {
            self.prepare(at, &rays.packet(at), padding, F32x8::load(&hits.t[at..]));
        }
        if whole < rays.len() {
            // An incomplete last packet is filled with its first ray.
            let rest = rays.len() - whole;
            let at = |lane: usize| whole + if lane < rest { lane } else { 0 };
            let lanes: [Ray<f32>; F32x8::WIDTH] = std::array::from_fn(|lane| rays.packet(at(lane)));
            self.prepare(whole, &Ray::from_lanes(&lanes), padding, F32x8::from_fn(|lane| hits.t[at(lane)]));
        }
    }

    #[inline(always)]
    fn prepare(&mut self, at: usize, ray: &Ray<F32x8>, padding: Padding, t: F32x8) {
        let (stream_rays, axes, octants) = StreamRay::of_packet(ray, padding, t);
        self.stream_rays[at..at + F32x8::WIDTH].copy_from_slice(&stream_rays);
        (axes | octants.shl(8)).store(&mut self.axes[at..]);
    }
}

/// Extends a vector to at least this length.
#[inline(always)]
fn grow<T: Copy + Default>(vector: &mut Vec<T>, length: usize) {
    if vector.len() < length {
        vector.resize(length, T::default());
    }
}

/// The traversal of rays of a batch that are traced together.
pub struct StreamTraversal<'a, 'b, C, T> {
    stream: &'a mut Stream,
    hierarchy: &'a Hierarchy,
    rays: &'a Rays<'a>,
    hits: &'a mut Hits<'b>,
    counter: C,
    tests: T,
}

impl<C: CounterSink, T: LeafTests> StreamTraversal<'_, '_, C, T> {
    /// Traces the `count` rays listed from `start` on through a node; new lists start at `free`. With `ONE`
    /// all rays run into one octant.
    fn node<const ANY: bool, const ONE: bool>(
        &mut self,
        node: usize,
        start: usize,
        count: usize,
        free: usize,
    ) {
        let node = &self.hierarchy.bvh.wide[node];
        self.counter.node(node, count);
        let Stream { stream_rays, octants, lists, slots: tags, masks, .. } = &mut *self.stream;
        let mut distances = [0.0; WIDE];
        let (list, rays) = (&lists[start..start + count], (&**stream_rays, &**octants));
        let all = pass_boxes::<ANY, ONE>(node.boxes(), list, rays, masks, &mut distances);
        if all == 0 {
            return;
        }
        // The cache lines arrive while the lists are written.
        slots(all).for_each(|slot| self.hierarchy.prefetch(node.children()[slot]));
        // Lists are stored end to end, in whole chunks: first one of the rays that reach leaves of triangles,
        // then one for each other child.
        let most = (all.count_ones() as usize) * (count + CHUNK);
        grow(lists, free + most);
        grow(tags, most);
        // The list is read in whole chunks; the masks behind its end are cleared, so that entries there join
        // no list.
        masks[count..count + CHUNK].fill(0);
        let chunks = count.div_ceil(CHUNK);
        let (read, write) = lists.split_at_mut(free);
        let from = read[start..start + chunks * CHUNK].as_chunks::<CHUNK>().0;
        let masks = &masks.as_chunks::<CHUNK>().0[..chunks];
        let mut top = free;
        let mut list = |slot: usize| {
            let begin = top;
            for (masks, rays) in masks.iter().zip(from) {
                let to = write[top - free..].first_chunk_mut().expect("lists have room for all rays");
                top += compress_where(rays, masks, 1 << slot, to);
            }
            (begin, top - begin)
        };
        let (nodes, triangles) = (all & node.nodes(), all & node.triangle_leaves());
        let mut paired = 0;
        for slot in slots(triangles) {
            let count = list(slot).1;
            // A whole chunk at first, because most lists are short.
            tags[paired..paired + CHUNK].fill(slot as u8);
            if count > CHUNK {
                tags[paired + CHUNK..paired + count].fill(slot as u8);
            }
            paired += count;
        }
        let mut spans = [(0, 0); WIDE];
        for slot in slots(all & !triangles) {
            spans[slot] = list(slot);
        }
        // Leaves first, because hits in them save tests of the nodes' children.
        T::triangle_leaves::<ANY>(self, (node, triangles), (free, paired), count);
        for slot in slots(all & !triangles & !nodes) {
            let (start, count) = spans[slot];
            self.other_leaf::<ANY>(node.children()[slot], start, count);
        }
        let mut order = [0u64; WIDE];
        let order = &mut order[..nodes.count_ones() as usize];
        for (order, slot) in order.iter_mut().zip(slots(nodes)) {
            // Sorted as integers: the bits of non-negative floats have the order of the floats.
            let distance = if ANY { 0.0 } else { distances[slot] / spans[slot].1 as f32 };
            *order = u64::from(distance.to_bits()) << 32 | slot as u64;
        }
        if !ANY {
            order.sort_unstable();
        }
        for &order in order.iter() {
            let slot = order as usize & (WIDE - 1);
            let (child, (start, count)) = (node.children()[slot], spans[slot]);
            self.node::<ANY, ONE>(child.index(), start, count, top + CHUNK);
        }
    }

    /// Tests the `count` rays listed from `start` on, one by one, against a leaf without triangles.
    fn other_leaf<const ANY: bool>(&mut self, leaf: Child, start: usize, count: usize) {
        let Self { stream, hierarchy, rays, hits, counter, .. } = self;
        let Stream { stream_rays, lists, .. } = &mut **stream;
        for &entry in &lists[start..start + count] {
            update_hit::<ANY>(entry, stream_rays, hits, |listed, hits| {
                counter.leaf(hierarchy, leaf, 1);
                let mut hit = listed.hit(hits);
                hierarchy.intersect_ray(leaf, &rays.packet(listed.ray()), &mut hit);
                Some(hit)
            });
        }
    }
}
