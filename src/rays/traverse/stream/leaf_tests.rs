//! Tests the rays of a node against its leaves of triangles: a few rays in one loop, many in two.

use super::hit_batch::HitBatch;
use super::listed::{BATCH, ListedRay, update_hit};
use super::stream_ray::StreamRay;
use super::{Stream, StreamTraversal};
use crate::bvh::{WIDE, WideNode};
use crate::columns::Hits;
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
pub(super) trait LeafTests: Sized {
    /// Tests the `paired` rays listed from `start` on, each against the leaf of triangles in its slot. The
    /// rays come from the `count` rays of a node.
    fn triangle_leaves<const ANY: bool>(
        rays: &mut StreamTraversal<'_, '_, impl CounterSink, Self>,
        node: &WideNode,
        reached: u32,
        start: usize,
        paired: usize,
        count: usize,
    );
}

/// A use of hits, which are found many at a time.
pub(super) trait AcceptHits {
    /// Is true if hits end rays: the candidates of a node are then tested before those of the next.
    const END_RAYS: bool;
    /// Accepts the hits of candidates.
    fn accept<const ANY: bool>(
        &mut self,
        candidates: &mut HitBatch,
        stream_rays: &mut [StreamRay; BATCH],
        hits: &mut Hits,
    );
}

/// The tests that keep the nearest hit of each ray.
pub(super) struct Nearest;

impl LeafTests for Nearest {
    #[inline(always)]
    fn triangle_leaves<const ANY: bool>(
        rays: &mut StreamTraversal<'_, '_, impl CounterSink, Self>,
        node: &WideNode,
        reached: u32,
        start: usize,
        paired: usize,
        count: usize,
    ) {
        if paired >= MIN_LONG && !(ANY && paired > MAX_LEAVES * count) {
            rays.triangles_then_hits::<ANY>(node, reached, start, paired);
        } else if paired > 0 {
            rays.triangles::<ANY>(node, reached, start, paired);
        }
    }
}

impl AcceptHits for Nearest {
    const END_RAYS: bool = true;

    #[inline(always)]
    fn accept<const ANY: bool>(
        &mut self,
        candidates: &mut HitBatch,
        stream_rays: &mut [StreamRay; BATCH],
        hits: &mut Hits,
    ) {
        candidates.accept::<ANY>(stream_rays, hits);
    }
}

impl<C: CounterSink> StreamTraversal<'_, '_, C, Nearest> {
    /// Tests the `count` rays listed from `start` on, each against the leaf of triangles in its slot: one
    /// loop over all leaves, because most lists of large hierarchies hold two or three rays.
    #[inline(never)]
    fn triangles<const ANY: bool>(&mut self, node: &WideNode, reached: u32, start: usize, count: usize) {
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

impl<C: CounterSink, T: AcceptHits> StreamTraversal<'_, '_, C, T> {
    /// Tests long lists in two loops: the first tests all pairs, without a branch; the second accepts its
    /// results, as many at a time as a vector has lanes. One test in ten finds a hit; a branch for it is
    /// often mispredicted. The tests begun behind it are then lost, which costs some 110 cycles, as much as
    /// four tests.
    #[inline(never)]
    pub(super) fn triangles_then_hits<const ANY: bool>(
        &mut self,
        node: &WideNode,
        reached: u32,
        start: usize,
        count: usize,
    ) {
        let Self { stream, hierarchy, hits, counter, tests, .. } = self;
        let Stream { stream_rays, lists, slots: tags, masks, found, iota, leaves, candidates, .. } =
            &mut **stream;
        let leaves = hierarchy.triangle_leaves(node, reached, leaves);
        let slot_of = |slot: u8| usize::from(slot) & (WIDE - 1);
        let pairs = lists[start..start + count].chunks(BATCH).zip(tags.chunks(BATCH));
        for (entries, slots) in pairs {
            for ((mask, &entry), &slot) in masks.iter_mut().zip(entries).zip(slots) {
                let (slot, listed) = (slot_of(slot), ListedRay::new(entry, stream_rays));
                counter.leaf(hierarchy, node.children()[slot], 1);
                *mask = leaves[slot].candidates(listed.stored_woop()) as u16;
            }
            for &place in places_of_masks(entries.len(), masks, iota, found) {
                let place = usize::from(place) & (BATCH - 1);
                let leaf = leaves[slot_of(slots[place])];
                for triangle in set_bits(u32::from(masks[place])) {
                    if candidates.push(entries[place], leaf, triangle) {
                        tests.accept::<ANY>(candidates, stream_rays, hits);
                    }
                }
            }
            if T::END_RAYS && !candidates.is_empty() {
                tests.accept::<ANY>(candidates, stream_rays, hits);
            }
        }
    }
}

/// Writes the places of those of the first `count` masks that are not 0 into `found`; returns them.
#[inline(always)]
pub(super) fn places_of_masks<'a>(
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
