//! Ray streams: many rays traverse the tree together. Each node is read once for all rays that reach it.
//!
//! At a node each ray of its list is tested against the boxes of all children; the masks are compressed into
//! a list of rays for each child. Leaves are visited first, then nodes in the order of their mean entry
//! distance, or in slot order where any hit will do. Single rays, of which no list would pay, are traced as
//! such.
//!
//! Rays of all octants share a list: an entry holds the ray's octant, from which follow the rows of the
//! planes that it meets first, unless `SELECTS_PLANES`. A batch sorted by octant, as in the source, saves
//! that, but its lists have an eighth of the rays, and bounces are 1.1 times slower on 4,000 triangles, 1.6
//! times on 48,000. Only in batches within one octant, as most of primary rays, the planes stay in registers:
//! up to 1.1 times faster.
//!
//! Source: Tsakok, "Faster Incoherent Rays: Multi-BVH Ray Stream Tracing", HPG 2009.

mod listed;
mod record;

use super::counter::CounterSink;
use super::frustum::Boxes;
use super::hierarchy::Hierarchy;
use super::leaf::TriangleLeaf;
use super::prepared::{SingleRay, splat_slabs};
use super::rays::{Hits, Rays};
use super::single;
use super::stack::Stack;
use crate::bvh::{Child, WIDE, WideNode, slots};
use crate::kernel::ray_box::Padding;
use crate::lane::{Bits, F32x8, Lane, Mask, NATIVE_WIDTH, Native, NativeBits, set_bits};
use crate::math::{Ray, Vec3};
pub use listed::BATCH;
use listed::{AXIS_SHIFT, ListedRay, OCTANT_SHIFT, SLOT_SHIFT, update_hit, update_hits};
use record::Record;

/// Pieces of a batch, one bit of a mask each.
const PIECES: usize = u32::BITS as usize;
/// Rays of a piece.
pub const PIECE: usize = BATCH / PIECES;
/// Entries of a list that are read and written at once.
const PACKET: usize = NATIVE_WIDTH;
/// Lists of at most this many rays are traced one by one.
const MAX_SINGLE: usize = 1;
/// From this many pairs of a ray and a leaf on, triangles are tested in two loops. From 16 to 128 are alike
/// within 2 %.
const MIN_LONG: usize = 24;
/// Any-hit rays of which those at a node reach more of its leaves than this, on average, are tested in one
/// loop: there a hit spares the tests of the other leaves.
const MAX_LEAVES: usize = 2;

/// Whether each ray selects its planes by the signs of its direction, or loads them by its octant. AMD's
/// processors, which alone have SSE4a, select in one operation and load fewer vectors a cycle: shadow rays
/// are 1.06 to 1.11 times as fast so (Zen 4). On Intel's they are 0.91 to 0.95 times as fast.
const SELECTS_PLANES: bool = cfg!(target_feature = "sse4a");

/// Working memory of a thread: about a MiB.
pub struct Stream {
    records: Box<[Record; BATCH]>,
    /// The axes of the rays' triangle tests, shifted to their place in list entries.
    axes: Box<[u32; BATCH]>,
    /// Lists of rays, one after the other: a stack of lists.
    lists: Vec<u32>,
    /// For each ray of a list, the boxes that it passes, one bit each; then the triangles of its leaf that it
    /// may hit.
    masks: Vec<u32>,
    /// List entries of the rays whose mask of triangles is not zero.
    found: Vec<u32>,
    /// Room for the leaves of a node, expanded.
    leaves: Box<[TriangleLeaf; WIDE]>,
    stack: Stack,
}

impl Default for Stream {
    fn default() -> Self {
        Self::new()
    }
}

impl Stream {
    /// Empty, with room for a batch.
    pub fn new() -> Self {
        Self {
            records: bytemuck::zeroed_box(),
            axes: bytemuck::zeroed_box(),
            lists: vec![0; 16 * BATCH],
            masks: vec![0; BATCH + PACKET],
            found: vec![0; BATCH],
            leaves: Box::new([TriangleLeaf::EMPTY; WIDE]),
            stack: Stack::new(),
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
            let all = u32::MAX >> (PIECES - batch.len().div_ceil(PIECE));
            let (rays, hits) = (&rays.range(batch.clone()), &mut hits.range(batch));
            self.trace_pieces::<ANY>(hierarchy, rays, hits, all, counter);
        }
    }

    /// The same for some pieces of up to [`BATCH`] rays: bit p of `pieces` stands for the up to [`PIECE`]
    /// rays from p · [`PIECE`] on. Domain: no bit of an empty piece is set.
    pub fn trace_pieces<const ANY: bool>(
        &mut self,
        hierarchy: &Hierarchy,
        rays: &Rays,
        hits: &mut Hits,
        pieces: u32,
        counter: impl CounterSink,
    ) {
        debug_assert!(rays.len() <= BATCH);
        let of_piece = |piece: usize| piece * PIECE..rays.len().min((piece + 1) * PIECE);
        let (mut count, mut octants) = (0, [u32::MAX, 0]);
        for piece in set_bits(pieces).map(of_piece) {
            self.prepare_piece(piece.clone(), hierarchy.padding, rays, hits);
            let entries = self.lists[count..].iter_mut().zip(&self.axes[piece.clone()]);
            for ((entry, axis), at) in entries.zip(piece.start as u32..) {
                *entry = at | axis;
                octants = [octants[0] & axis, octants[1] | axis];
            }
            count += piece.len();
        }
        if count > 0 {
            let mut rays = StreamTraversal { stream: self, hierarchy, rays, hits, counter };
            // The bits of the octant are the highest of `axes`.
            let [all, any] = octants.map(|bits| bits >> OCTANT_SHIFT);
            if !ANY && all == any {
                rays.node::<ANY, true>(0, 0, count, count + PACKET);
            } else {
                rays.node::<ANY, false>(0, 0, count, count + PACKET);
            }
        }
    }

    /// Prepares the rays of a piece.
    fn prepare_piece(&mut self, piece: std::ops::Range<usize>, padding: Padding, rays: &Rays, hits: &Hits) {
        let whole = piece.end - piece.len() % F32x8::WIDTH;
        for at in (piece.start..whole).step_by(F32x8::WIDTH) {
            self.prepare(at, &rays.packet(at), padding, F32x8::load(&hits.t[at..]));
        }
        if whole < piece.end {
            // An incomplete last packet is filled with its first ray.
            let lane =
                |column: &[f32]| F32x8::from_fn(|lane| *column[whole..].get(lane).unwrap_or(&column[whole]));
            let vector =
                |columns: [&[f32]; 3]| Vec3::new(lane(columns[0]), lane(columns[1]), lane(columns[2]));
            let ray = Ray { origin: vector(rays.origin), direction: vector(rays.direction) };
            self.prepare(whole, &ray, padding, lane(hits.t));
        }
    }

    #[inline(always)]
    fn prepare(&mut self, at: usize, ray: &Ray<F32x8>, padding: Padding, t: F32x8) {
        let (records, axes, octants) = Record::of_packet(ray, padding, t);
        self.records[at..at + F32x8::WIDTH].copy_from_slice(&records);
        (axes.shl(AXIS_SHIFT) | octants.shl(OCTANT_SHIFT)).store(&mut self.axes[at..]);
    }
}

/// The planes that a ray meets first along each axis, and those that it meets second.
type Planes = (Vec3<Native>, Vec3<Native>);

/// Chosen by the octant in the entry of a list: rows of the boxes, of which `& 7` keeps the index inside.
#[inline(always)]
fn planes_by_octant(boxes: &Boxes, entry: u32) -> Planes {
    let row = |row: u32| Native::load(&boxes[row as usize & 7]);
    let upper = |axis: u32| 3 * (entry >> (OCTANT_SHIFT + axis) & 1);
    let (x, y, z) = (upper(0), upper(1), upper(2));
    (Vec3::new(row(x), row(1 + y), row(2 + z)), Vec3::new(row(3 - x), row(4 - y), row(5 - z)))
}

/// The same planes, chosen by the signs of the direction's inverse.
#[inline(always)]
fn planes_by_sign(boxes: &Boxes, inverse: Vec3<Native>) -> Planes {
    let row = |row: usize| Native::load(&boxes[row]);
    let pair = |axis: usize, inverse: Native| {
        let (backwards, lower, upper) = (inverse.is_sign_negative(), row(axis), row(axis + 3));
        (Native::select(backwards, upper, lower), Native::select(backwards, lower, upper))
    };
    let (x, y, z) = (pair(0, inverse.x), pair(1, inverse.y), pair(2, inverse.z));
    (Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1))
}

/// The traversal of those rays of a batch that are traced together.
struct StreamTraversal<'a, 'b, C> {
    stream: &'a mut Stream,
    hierarchy: &'a Hierarchy,
    rays: &'a Rays<'a>,
    hits: &'a mut Hits<'b>,
    counter: C,
}

impl<C: CounterSink> StreamTraversal<'_, '_, C> {
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
        let Stream { records, lists, masks, .. } = &mut *self.stream;
        let boxes = node.boxes();
        let of_first_ray = planes_by_octant(boxes, lists[start]);
        let mut distances = Native::zero();
        let mut all = 0;
        for (mask, &entry) in masks.iter_mut().zip(&lists[start..start + count]) {
            let record = ListedRay::new(entry, records).record;
            let slabs = splat_slabs(&record.slabs());
            let (first, second) = if ONE {
                of_first_ray
            } else if SELECTS_PLANES {
                planes_by_sign(boxes, slabs.inverse)
            } else {
                planes_by_octant(boxes, entry)
            };
            let (near, far) = slabs.interval(first, second);
            // A NaN is in both near and far; max or min keeps it, and it passes no box, not even an empty
            // one.
            let (near, far) = (Native::zero().max(near), Native::splat(record.t).min(far));
            let passes = near.le(far);
            if !ANY {
                distances = distances + near.only(passes);
            }
            *mask = passes.bitmask();
            all |= *mask;
        }
        if all == 0 {
            return;
        }
        if self.hierarchy.is_large() {
            // The lines of all children are fetched while the lists are written.
            let touched = slots(all)
                .map(|slot| self.hierarchy.touch(node.children()[slot]))
                .fold(0, |sum, word| sum ^ word);
            std::hint::black_box(touched);
        }
        // Lists lie end to end, written by whole packets: first one of rays that reach leaves of triangles,
        // with the leaves' slots, then one for each other child.
        let most = (all.count_ones() as usize) * (count + PACKET);
        if lists.len() < free + most {
            lists.resize(free + most, 0);
        }
        // The list is read in whole packets; the masks behind its end are cleared, so that entries there join
        // no list.
        masks[count..count + PACKET].fill(0);
        let packets = count.div_ceil(PACKET);
        let (read, write) = lists.split_at_mut(free);
        let from = &read[start..start + packets * PACKET].as_chunks::<PACKET>().0;
        let masks = &masks.as_chunks::<PACKET>().0[..packets];
        let mut top = free;
        let mut list = |slot: usize, tag: u32| {
            let (bit, tag) = (NativeBits::splat(1 << slot), NativeBits::splat(tag));
            let begin = top;
            for (masks, rays) in masks.iter().zip(*from) {
                let passes = (NativeBits::load(masks) & bit).equals(bit);
                (NativeBits::load(rays).compress(passes) | tag).store(&mut write[top - free..]);
                top += passes.count();
            }
            (begin, top - begin)
        };
        let (nodes, triangles) = (all & node.nodes(), all & node.triangle_leaves());
        let paired = slots(triangles).map(|slot| list(slot, (slot as u32) << SLOT_SHIFT).1).sum();
        let mut spans = [(0, 0); WIDE];
        for slot in slots(all & !triangles) {
            spans[slot] = list(slot, 0);
        }
        // Leaves first, as hits in them spare tests of the nodes' children.
        if paired >= MIN_LONG && !(ANY && paired > MAX_LEAVES * count) {
            self.triangles_then_hits::<ANY>(node, triangles, free, paired);
        } else if paired > 0 {
            self.triangles::<ANY>(node, triangles, free, paired);
        }
        for slot in slots(all & !triangles & !nodes) {
            let (start, count) = spans[slot];
            self.spheres::<ANY>(node.children()[slot], start, count);
        }
        let mut order = [0u64; WIDE];
        let order = &mut order[..nodes.count_ones() as usize];
        for (order, slot) in order.iter_mut().zip(slots(nodes)) {
            // Sorted as integers: the bits of non-negative floats have the order of the floats.
            let distance = if ANY { 0.0 } else { distances.get(slot) / spans[slot].1 as f32 };
            *order = u64::from(distance.to_bits()) << 32 | slot as u64;
        }
        if !ANY {
            order.sort_unstable();
        }
        for &order in order.iter() {
            let slot = order as usize & (WIDE - 1);
            let (child, (start, count)) = (node.children()[slot], spans[slot]);
            if count <= MAX_SINGLE {
                self.one_by_one::<ANY>(child, start, count);
            } else {
                self.node::<ANY, ONE>(child.index(), start, count, top + PACKET);
            }
        }
    }

    /// Tests the `count` rays listed from `start` on, each against the leaf of triangles whose slot is in its
    /// entry: one loop over all leaves, as most lists of large hierarchies hold two rays or three.
    #[inline(never)]
    fn triangles<const ANY: bool>(&mut self, node: &WideNode, slots: u32, start: usize, count: usize) {
        let Self { stream, hierarchy, hits, counter, .. } = self;
        let Stream { records, lists, leaves, .. } = &mut **stream;
        let leaves = hierarchy.triangle_leaves(node, slots, leaves);
        update_hits::<ANY>(&lists[start..start + count], records, hits, |listed, hits| {
            counter.leaf(hierarchy, node.children()[listed.slot()], 1);
            let leaf = leaves[listed.slot()];
            let ahead = leaf.ahead(&listed.woop());
            (ahead != 0).then(|| listed.accept(leaf, ahead, hits))
        });
    }

    /// The same for long lists, in two loops: the first tests all, without a branch, the second accepts what
    /// it found. One test in ten finds a hit; a branch for it is often predicted wrong, and then the tests
    /// begun behind it are lost: some 110 cycles, as much as four tests.
    #[inline(never)]
    fn triangles_then_hits<const ANY: bool>(
        &mut self,
        node: &WideNode,
        slots: u32,
        start: usize,
        count: usize,
    ) {
        let Self { stream, hierarchy, hits, counter, .. } = self;
        let Stream { records, lists, masks, found, leaves, .. } = &mut **stream;
        let leaves = hierarchy.triangle_leaves(node, slots, leaves);
        for first in (start..start + count).step_by(BATCH) {
            let tests = BATCH.min(start + count - first);
            for (mask, &entry) in masks.iter_mut().zip(&lists[first..first + tests]) {
                let listed = ListedRay::new(entry, records);
                counter.leaf(hierarchy, node.children()[listed.slot()], 1);
                *mask = leaves[listed.slot()].ahead(&listed.woop());
            }
            masks[tests..tests + PACKET].fill(0);
            let mut top = 0;
            for at in (0..tests).step_by(PACKET) {
                let mask = NativeBits::load(&masks[at..]);
                let hit = !mask.equals(NativeBits::splat(0));
                NativeBits::load(&lists[first + at..]).compress(hit).store(&mut found[top..]);
                mask.compress(hit).store(&mut masks[top..]);
                top += hit.count();
            }
            for (&entry, &ahead) in found[..top].iter().zip(&*masks) {
                update_hit::<ANY>(entry, records, hits, |listed, hits| {
                    Some(listed.accept(leaves[listed.slot()], ahead, hits))
                });
            }
        }
    }

    fn spheres<const ANY: bool>(&mut self, leaf: Child, start: usize, count: usize) {
        let Self { stream, hierarchy, rays, hits, counter, .. } = self;
        let Stream { records, lists, .. } = &mut **stream;
        update_hits::<ANY>(&lists[start..start + count], records, hits, |listed, hits| {
            counter.leaf(hierarchy, leaf, 1);
            let mut hit = listed.hit(hits);
            hierarchy.intersect_spheres(leaf.index(), &rays.packet(listed.ray()), &mut hit);
            Some(hit)
        });
    }

    fn one_by_one<const ANY: bool>(&mut self, child: Child, start: usize, count: usize) {
        let Self { stream, hierarchy, rays, hits, counter, .. } = self;
        let Stream { records, lists, stack, .. } = &mut **stream;
        update_hits::<ANY>(&lists[start..start + count], records, hits, |listed, hits| {
            let (slabs, woop) = (listed.record.slabs(), listed.woop());
            let single = SingleRay { ray: rays.packet(listed.ray()), slabs, woop };
            let mut hit = listed.hit(hits);
            single::trace_from::<ANY>(hierarchy, child, &single, stack, &mut hit, *counter);
            Some(hit)
        });
    }
}
