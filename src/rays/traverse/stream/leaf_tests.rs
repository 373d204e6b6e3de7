//! Tests the rays of a node against its leaves of triangles, in two loops; for the nearest hit of a few rays,
//! in one.

use super::hit_batch::HitBatch;
use super::listed::{BATCH, ListedRay, update_hit};
use super::stream_ray::StreamRay;
use super::{Stream, StreamTraversal};
use crate::bvh::{WIDE, WideNode};
use crate::columns::Hits;
use crate::kind::triangle::TriangleLeaf;
use crate::lane::compaction::{CHUNK, compress_where};
use crate::lane::set_bits;
use crate::traverse::counter::CounterSink;

/// From this many pairs of a ray and a leaf on, triangles are tested in two loops. The speeds of
/// values from 16 to 128 differ by less than 2 %.
const MIN_LONG: usize = 24;
/// If any-hit rays reach more leaves of a node than this, on average, they are tested in one loop: a hit
/// there saves the tests of the other leaves.
const MAX_LEAVES: usize = 2;

/// The tests of rays that reach leaves of triangles.
pub trait LeafTests: Sized {
    /// Tests the `paired` rays listed from `start` on, each against the leaf of triangles in its slot. The
    /// rays come from `_count` rays of a node. By default all lists are tested in two loops.
    #[inline(always)]
    fn triangle_leaves<const ANY: bool>(
        rays: &mut StreamTraversal<'_, '_, impl CounterSink, Self>,
        (node, reached): (&WideNode, u32),
        (start, paired): (usize, usize),
        _count: usize,
    ) {
        if paired > 0 {
            rays.masks_then_hits::<ANY>((node, reached), (start, paired));
        }
    }
    /// Returns the triangles of a leaf that a ray may hit, one bit each.
    #[inline(always)]
    fn candidates(&self, listed: &ListedRay, leaf: &TriangleLeaf) -> u32 {
        leaf.candidates(listed.stored_woop())
    }
    /// Takes the candidates of a ray, given by its entry, in a leaf.
    fn take<const ANY: bool>(&mut self, entry: u16, leaf: (&TriangleLeaf, u32), batch: &mut BatchHits);
    /// Ends the tests of a node that had any.
    fn finish<const ANY: bool>(&mut self, batch: &mut BatchHits);
}

/// The rays of a batch, their hits so far, and pairs of rays and triangles still to be accepted.
pub struct BatchHits<'a, 'b> {
    pub stream_rays: &'a mut [StreamRay; BATCH],
    pub hits: &'a mut Hits<'b>,
    pub pairs: &'a mut HitBatch,
}

impl BatchHits<'_, '_> {
    /// Adds candidates to the pairs; calls `accept` when all lanes are filled.
    #[inline(always)]
    pub fn push(
        &mut self,
        entry: u16,
        (leaf, candidates): (&TriangleLeaf, u32),
        mut accept: impl FnMut(&mut Self),
    ) {
        for triangle in set_bits(candidates) {
            if self.pairs.push(entry, leaf, triangle) {
                accept(self);
            }
        }
    }

    #[inline(always)]
    fn accept<const ANY: bool>(&mut self) {
        self.pairs.accept::<ANY>(self.stream_rays, self.hits);
    }
}

/// The tests that keep the nearest hit of each ray.
pub(super) struct Nearest;

impl LeafTests for Nearest {
    #[inline(always)]
    fn triangle_leaves<const ANY: bool>(
        rays: &mut StreamTraversal<'_, '_, impl CounterSink, Self>,
        leaves: (&WideNode, u32),
        (start, paired): (usize, usize),
        count: usize,
    ) {
        if paired >= MIN_LONG && !(ANY && paired > MAX_LEAVES * count) {
            rays.masks_then_hits::<ANY>(leaves, (start, paired));
        } else if paired > 0 {
            rays.triangles::<ANY>(leaves, (start, paired));
        }
    }
    #[inline(always)]
    fn take<const ANY: bool>(&mut self, entry: u16, leaf: (&TriangleLeaf, u32), batch: &mut BatchHits) {
        batch.push(entry, leaf, BatchHits::accept::<ANY>);
    }
    // Pairs are accepted before the next node, because hits end rays.
    #[inline(always)]
    fn finish<const ANY: bool>(&mut self, batch: &mut BatchHits) {
        if !batch.pairs.is_empty() {
            batch.accept::<ANY>();
        }
    }
}

impl<C: CounterSink> StreamTraversal<'_, '_, C, Nearest> {
    /// Tests the `count` rays listed from `start` on, each against the leaf of triangles in its slot: one
    /// loop over all leaves, because most lists of large hierarchies hold two or three rays.
    #[inline(never)]
    fn triangles<const ANY: bool>(
        &mut self,
        (node, reached): (&WideNode, u32),
        (start, count): (usize, usize),
    ) {
        let Self { stream, hierarchy, hits, counter, .. } = self;
        let Stream { stream_rays, lists, slots, leaves, .. } = &mut **stream;
        let leaves = hierarchy.triangle_leaves(node, reached, leaves);
        for (&entry, &slot) in lists[start..start + count].iter().zip(&*slots) {
            let slot = usize::from(slot) & (WIDE - 1);
            update_hit::<ANY>(entry, stream_rays, hits, |listed, hits| {
                counter.leaf(hierarchy, node.children()[slot], 1);
                let candidates = leaves[slot].candidates(listed.stored_woop());
                (candidates != 0).then(|| listed.accept(leaves[slot], candidates, hits))
            });
        }
    }
}

impl<C: CounterSink, T: LeafTests> StreamTraversal<'_, '_, C, T> {
    /// Tests a list in two loops: the first tests all pairs, without a branch; the second takes its
    /// results. One test in ten finds a hit; a branch for it is often mispredicted. The tests begun behind it
    /// are then lost, which costs some 110 cycles, as much as four tests.
    #[inline(never)]
    fn masks_then_hits<const ANY: bool>(
        &mut self,
        (node, reached): (&WideNode, u32),
        (start, count): (usize, usize),
    ) {
        let Self { stream, hierarchy, hits, counter, tests, .. } = self;
        let Stream { stream_rays, lists, slots: tags, masks, found, iota, leaves, candidates, .. } =
            &mut **stream;
        let leaves = hierarchy.triangle_leaves(node, reached, leaves);
        let slot_of = |slot: u8| usize::from(slot) & (WIDE - 1);
        let mut batch = BatchHits { stream_rays, hits, pairs: candidates };
        let pairs = lists[start..start + count].chunks(BATCH).zip(tags.chunks(BATCH));
        for (entries, slots) in pairs {
            for ((mask, &entry), &slot) in masks.iter_mut().zip(entries).zip(slots) {
                let (slot, listed) = (slot_of(slot), ListedRay::new(entry, batch.stream_rays));
                counter.leaf(hierarchy, node.children()[slot], 1);
                *mask = tests.candidates(&listed, leaves[slot]) as u16;
            }
            for &place in places_of_masks(entries.len(), masks, iota, found) {
                let place = usize::from(place) & (BATCH - 1);
                let leaf = (leaves[slot_of(slots[place])], masks[place].into());
                tests.take::<ANY>(entries[place], leaf, &mut batch);
            }
        }
        tests.finish::<ANY>(&mut batch);
    }
}

/// Writes the places of those of the first `count` masks that are not 0 into `found`; returns them.
#[inline(always)]
fn places_of_masks<'a>(
    count: usize,
    masks: &mut [u16],
    iota: &[u16; BATCH],
    found: &'a mut [u16],
) -> &'a [u16] {
    masks[count..count + CHUNK].fill(0);
    let chunks = iota.as_chunks::<CHUNK>().0.iter().zip(masks.as_chunks::<CHUNK>().0);
    let mut top = 0;
    for (iota, masks) in chunks.take(count.div_ceil(CHUNK)) {
        let to = found[top..].first_chunk_mut().expect("`found` has room for all pairs");
        top += compress_where(iota, masks, u16::MAX, to);
    }
    &found[..top]
}
