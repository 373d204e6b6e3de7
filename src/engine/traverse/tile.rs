//! Packet traversal of primary rays, a tile at a time.
//!
//! The frustum around the whole tile traverses the tree first, level by level, until it has up to
//! [`MAX_ENTRY_POINTS`] entry points: nodes and leaves that together hold all that the tile can see, sorted
//! by distance. Without entry points the tile is empty. Then each packet, with a frustum of its own,
//! traverses in order the entry points that its frustum meets, and below them nearest first. In a leaf the
//! triangles outside the frustum are culled; the packet is tested against the rest one by one.
//!
//! A packet pays for a triangle that one of its rays meets as for one that all meet. Tiles that see leaves so
//! small, or so thin, that few rays of a packet would share each are left to streams: [`Packets`].
//!
//! Source: Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005: entry points for
//! tiles.

use super::counter::CounterSink;
use super::frustum::{Boxes, Frustum, FrustumAxis, greatest};
use super::hierarchy::Hierarchy;
use super::prepared::Packet;
use super::rays::{Hits, Rays};
use super::stack::{Stack, pop_within};
use crate::bvh::{Child, WIDE};
use crate::lane::{Bits, F32x8, F32x16, Lane, Mask, Native, NativeMask, U32x8, set_bits};
use crate::math::Hit;

/// Most rays of a tile.
pub const TILE: usize = 256;
/// Most rows of slopes of a tile.
const ROWS: usize = TILE / ROW;
/// Slopes of a row.
const ROW: usize = F32x8::WIDTH;
/// Most entry points of a tile.
pub const MAX_ENTRY_POINTS: usize = 64;
// One bit of a mask each, in whole blocks of boxes.
const _: () = assert!(MAX_ENTRY_POINTS == u64::BITS as usize && MAX_ENTRY_POINTS.is_multiple_of(WIDE));

/// Which tiles are traced in packets.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Packets {
    /// All that can be.
    Always,
    /// Those for which that is faster than streams, by an estimate.
    WherePaying,
}

/// Most inner nodes among the entry points of a tile for which packets pay.
const MAX_INNER: usize = 24;
/// Up to so many leaves, and no inner nodes, packets pay, whatever the estimate would say.
const FEW_LEAVES: usize = 30;
/// The least number of rays of a packet that meet a leaf that it visits, by the estimate, for packets to pay:
/// of 16 rays in a full tile, whatever the width. Measured with 16 lanes on knots, terrains and scans of
/// 4,000 to 1,000,000 triangles: `perf/README.md`.
const MIN_SHARING: f32 = 4.5;

/// Entry points: nodes and leaves that together hold all that a tile can see, nearest first; one bit of a
/// mask each.
struct EntryPoints {
    boxes: [Boxes; MAX_ENTRY_POINTS / WIDE],
    children: [Child; MAX_ENTRY_POINTS],
    /// The distance along the frustum axis at which each begins, ascending.
    near: [f32; MAX_ENTRY_POINTS],
    filled: usize,
}

/// A child of a node whose box the tile's frustum meets.
#[derive(Clone, Copy)]
struct Entry {
    near: f32,
    child: Child,
    /// The node and the slot that hold its box.
    node: u32,
    slot: u32,
}

impl EntryPoints {
    /// `None` if packets do not pay. Gives up early where that is probable.
    fn of(
        hierarchy: &Hierarchy,
        tile: &SeenTile,
        packets: Packets,
        counter: impl CounterSink,
    ) -> Option<Self> {
        let frustum = &tile.frustum;
        let mut entries = [Entry { near: 0.0, child: Child(0), node: 0, slot: 0 }; MAX_ENTRY_POINTS];
        let mut filled = 1;
        // Level by level, as long as there is room: each round opens the nodes that the one before found.
        let mut opened = true;
        let inner = |entries: &[Entry]| entries.iter().filter(|entry| !entry.child.is_leaf()).count();
        while opened {
            if packets == Packets::WherePaying && inner(&entries[..filled]) > MAX_INNER {
                return None;
            }
            opened = false;
            for at in (0..filled).rev() {
                let Entry { child, .. } = entries[at];
                if child.is_leaf() {
                    continue;
                }
                let node = &hierarchy.bvh.wide[child.index()];
                counter.node(node, 1);
                let (near, meets) = frustum.pass_boxes(node.boxes(), f32::INFINITY);
                if filled - 1 + meets.count() > MAX_ENTRY_POINTS {
                    continue;
                }
                filled -= 1;
                entries[at] = entries[filled];
                for slot in meets.lanes() {
                    let (near, parent) = (near.get(slot), child.index() as u32);
                    entries[filled] =
                        Entry { near, child: node.children()[slot], node: parent, slot: slot as u32 };
                    filled += 1;
                }
                opened = true;
            }
        }
        let entries = &entries[..filled];
        let are_few = inner(entries) == 0 && filled <= FEW_LEAVES;
        if packets == Packets::WherePaying && !are_few && tile.sharing(hierarchy, entries) < MIN_SHARING {
            return None;
        }
        // Sorted as integers: the bits of non-negative floats have the order of the floats.
        let mut order = [0u64; MAX_ENTRY_POINTS];
        let order = &mut order[..filled];
        for ((order, entry), at) in order.iter_mut().zip(entries).zip(0..) {
            *order = u64::from(entry.near.max(0.0).to_bits()) << 32 | at;
        }
        order.sort_unstable();
        let mut sorted = Self {
            boxes: [EMPTY; MAX_ENTRY_POINTS / WIDE],
            children: [Child::NONE; MAX_ENTRY_POINTS],
            near: [0.0; MAX_ENTRY_POINTS],
            filled,
        };
        for (at, order) in order.iter().enumerate() {
            let entry = &entries[*order as u32 as usize];
            let from = hierarchy.bvh.wide[entry.node as usize].boxes();
            let to = &mut sorted.boxes[at / WIDE];
            for plane in 0..6 {
                to[plane][at % WIDE] = from[plane][entry.slot as usize];
            }
            sorted.children[at] = entry.child;
            sorted.near[at] = f32::from_bits((order >> 32) as u32);
        }
        Some(sorted)
    }

    /// The entry points whose boxes reach between the sides of a packet's frustum, one bit each.
    #[inline(always)]
    fn across(&self, frustum: &Frustum) -> u64 {
        let boxes = self.boxes[..self.filled.div_ceil(WIDE)].iter();
        boxes.zip((0..).step_by(WIDE)).fold(0, |meets, (boxes, first)| {
            meets | u64::from(frustum.across_boxes(boxes).bitmask()) << first
        })
    }
}

/// A tile, as boxes are seen in it.
struct SeenTile<'a> {
    axis: &'a FrustumAxis,
    /// The least and the greatest slopes along each of the other axes.
    span: [[F32x8; 2]; 2],
    frustum: Frustum,
}

impl SeenTile<'_> {
    /// An estimate of the rays of a packet that meet a leaf which the packet visits, in the mean over the
    /// leaves of all entries. What hides what is not looked at.
    fn sharing(&self, hierarchy: &Hierarchy, entries: &[Entry]) -> f32 {
        let nodes = &hierarchy.bvh.wide;
        let mut sharing = Sharing { rays: Native::zero(), visits: Native::zero() };
        let (mut boxes, mut gathered) = (EMPTY, 0);
        for &Entry { child, node, slot, .. } in entries {
            if child.is_leaf() {
                let from = nodes[node as usize].boxes();
                for plane in 0..6 {
                    boxes[plane][gathered] = from[plane][slot as usize & (WIDE - 1)];
                }
                gathered += 1;
                if gathered == WIDE {
                    sharing.add(self.axis.covered(&self.span, &boxes), Native::one());
                    (boxes, gathered) = (EMPTY, 0);
                }
            } else {
                let node = &nodes[child.index()];
                let (_, meets) = self.frustum.pass_boxes(node.boxes(), f32::INFINITY);
                let leaves = node.children().map(|child| if child.is_leaf() { 1.0 } else { INNER_LEAVES });
                let covered = self.axis.covered(&self.span, node.boxes());
                sharing.add(covered, Native::load(&leaves).only(meets));
            }
        }
        // Boxes behind the last one are NaN, of which the estimate would make boxes that cover all.
        let last = Native::one().only(NativeMask::first(gathered));
        sharing.add(self.axis.covered(&self.span, &boxes), last);
        let sum = |x: Native| (0..WIDE).map(|lane| x.get(lane)).sum::<f32>();
        sum(sharing.rays) / sum(sharing.visits).max(f32::MIN_POSITIVE)
    }
}

/// Leaves that an inner node which is not opened counts for.
const INNER_LEAVES: f32 = 8.0;

/// Sums of [`SeenTile::sharing`]: rays that meet leaves, and visits of packets to leaves.
struct Sharing {
    rays: Native,
    visits: Native,
}

impl Sharing {
    /// Adds boxes that cover these shares of the tile's sides and stand for so many leaves each. A full tile
    /// has four packets of 16 a side; a leaf is visited by those that it covers and, with the part of its
    /// edge, by one more a side.
    #[inline(always)]
    fn add(&mut self, [a, b]: [Native; 2], leaves: Native) {
        let four = Native::splat(4.0);
        let split = Native::one() / leaves.max(Native::one()).sqrt();
        let packets = |share: Native| (share * split).mul_add(four, Native::one()).min(four);
        let met = Native::zero().lt(leaves);
        self.rays = self.rays + (a * b * Native::splat(TILE as f32)).only(met);
        self.visits = self.visits + (packets(a) * packets(b) * leaves).only(met);
    }
}

/// No box: NaN passes no bound, not even an infinite one.
const EMPTY: Boxes = [[f32::NAN; WIDE]; 8];

/// The traversal of one packet.
struct PacketTraversal<'a, L: Lane, C> {
    hierarchy: &'a Hierarchy,
    axis: &'a FrustumAxis,
    frustum: &'a Frustum,
    packet: Packet<L>,
    hit: Hit<L>,
    /// The distance along the frustum axis beyond which there is no nearer hit.
    limit: f32,
    /// Whether any ray found a nearer hit.
    closer: bool,
    counter: C,
}

impl<'a, L: Lane, C: CounterSink> PacketTraversal<'a, L, C> {
    #[inline(always)]
    fn new(
        hierarchy: &'a Hierarchy,
        axis: &'a FrustumAxis,
        frustum: &'a Frustum,
        rays: &Rays,
        hits: &Hits,
        at: usize,
        counter: C,
    ) -> Self {
        let hit = Hit {
            t: L::load(&hits.t[at..]),
            primitive: L::Bits::load(&hits.primitive[at..]),
            u: L::load(&hits.u[at..]),
            v: L::load(&hits.v[at..]),
        };
        let packet = Packet::new(rays.packet::<L>(at));
        Self { hierarchy, axis, frustum, packet, hit, limit: f32::INFINITY, closer: false, counter }
    }

    /// Visits the entry points that are set in `meets`.
    #[inline(always)]
    fn run(mut self, entry_points: &EntryPoints, meets: u64, hits: &mut Hits, at: usize, stack: &mut Stack) {
        // The mask lets the compiler drop the bounds checks.
        for entry in set_bits(meets).map(|entry| entry & (MAX_ENTRY_POINTS - 1)) {
            // The tile's frustum and the packet's have one axis, so the distances hold for the packet; they
            // ascend.
            if entry_points.near[entry] > self.limit {
                break;
            }
            self.visit(entry_points.children[entry], stack);
        }
        if self.closer {
            self.hit.t.store(&mut hits.t[at..]);
            self.hit.primitive.store(&mut hits.primitive[at..]);
            self.hit.u.store(&mut hits.u[at..]);
            self.hit.v.store(&mut hits.v[at..]);
        }
    }

    /// Visits a child of a node and its subtree.
    #[inline(always)]
    fn visit(&mut self, child: Child, stack: &mut Stack) {
        if child.is_leaf() {
            self.leaf(child);
        } else {
            self.subtree(child, stack);
        }
    }

    fn subtree(&mut self, child: Child, stack: &mut Stack) {
        let mut next = child;
        let mut len = 0;
        loop {
            if next.is_leaf() {
                self.leaf(next);
            } else {
                let node = &self.hierarchy.bvh.wide[next.index()];
                self.counter.node(node, 1);
                let (near, meets) = self.frustum.pass_boxes(node.boxes(), self.limit);
                if meets.any() {
                    len += stack.push(len, node.children(), near, meets);
                }
            }
            match pop_within(&mut len, self.limit, |at| stack.get(at)) {
                Some(child) => next = child,
                None => return,
            }
        }
    }

    #[inline(always)]
    fn leaf(&mut self, leaf: Child) {
        if leaf.is_spheres() {
            self.counter.packet_spheres(self.hierarchy, leaf, L::WIDTH);
            if self.hierarchy.intersect_spheres_packet(leaf.index(), &self.packet.ray, &mut self.hit) {
                self.shorten();
            }
            return;
        }
        let closer = self.hierarchy.with_triangles(leaf.index(), |triangles| {
            let main = triangles.planes(self.frustum.axis());
            let (_, meets) =
                self.frustum.pass(|upper| main[upper & 1], |axis| triangles.planes(axis), self.limit);
            self.counter.packet_triangles(self.hierarchy, leaf, L::WIDTH, meets);
            let mut closer = false;
            for lane in meets.lanes() {
                closer |=
                    triangles.intersect_packet(lane, self.hierarchy.padding, &mut self.packet, &mut self.hit);
            }
            closer
        });
        if closer {
            self.shorten();
        }
    }

    /// Shortens the limit to the furthest of the rays' nearest hits.
    #[inline(never)]
    fn shorten(&mut self) {
        self.closer = true;
        // Rounding is monotone: no box that a ray meets before its hit begins beyond this limit.
        self.limit = greatest(self.axis.depth(self.packet.ray.direction, self.hit.t));
    }
}

/// The least and the greatest of the slopes of each of eight packets, from rows of eight slopes, one or two
/// rows a packet. What stands for packets behind the last row is not to be used.
#[inline(always)]
fn spans<L: Lane>(rows: &[F32x8]) -> [F32x8; 2] {
    let each = L::WIDTH / ROW;
    let order = U32x8::from_fn(|lane| lane as u32);
    // The packets' least and greatest slopes by lane, then over the lanes.
    let [mut lows, mut highs] = [[F32x8::zero(); 8]; 2];
    for (packet, (low, high)) in lows.iter_mut().zip(&mut highs).enumerate() {
        let row = |row: usize| rows[(packet * each + row).min(rows.len() - 1)];
        (*low, *high) = (row(0), row(0));
        for more in 1..each {
            (*low, *high) = (low.min(row(more)), high.max(row(more)));
        }
    }
    let transposed = |rows: &[F32x8; 8]| F32x8::gather_rows::<8>(bytemuck::cast_slice(rows), order);
    let low = transposed(&lows).into_iter().reduce(F32x8::min);
    let high = transposed(&highs).into_iter().reduce(F32x8::max);
    [low, high].map(|span| span.expect("eight rows"))
}

/// Improves the hits of up to [`TILE`] primary rays, whose `t` come in as the rays' t_max. Returns false and
/// does nothing if the rays are not whole packets or do not run together from one origin, or if packets do
/// not pay.
#[inline(never)]
pub fn trace(
    hierarchy: &Hierarchy,
    rays: &Rays,
    hits: &mut Hits,
    stack: &mut Stack,
    packets: Packets,
    counter: impl CounterSink,
) -> bool {
    let count = rays.len();
    if !count.is_multiple_of(ROW) || !(ROW..=TILE).contains(&count) {
        return false;
    }
    let Some(axis) = FrustumAxis::of(&rays.packet::<f32>(0), hierarchy.padding) else { return false };
    let mut slopes = [[F32x8::zero(); ROWS]; 2];
    let Some(span) = axis.slopes(rays, &mut slopes) else { return false };
    let tile = SeenTile { axis: &axis, span, frustum: axis.frustum(&axis.frusta(span), 0) };
    let Some(entry_points) = EntryPoints::of(hierarchy, &tile, packets, counter) else { return false };
    if entry_points.filled == 0 {
        return true;
    }
    let rows = slopes.each_ref().map(|rows| &rows[..count / ROW]);
    let traversal = TileTraversal { hierarchy, axis: &axis, entry_points: &entry_points, counter };
    if cfg!(target_feature = "avx512f") && count.is_multiple_of(F32x16::WIDTH) {
        traversal.packets::<F32x16>(rays, rows, hits, stack);
    } else {
        traversal.packets::<F32x8>(rays, rows, hits, stack);
    }
    true
}

/// The traversal of the packets of a tile.
struct TileTraversal<'a, C> {
    hierarchy: &'a Hierarchy,
    axis: &'a FrustumAxis,
    entry_points: &'a EntryPoints,
    counter: C,
}

impl<C: CounterSink> TileTraversal<'_, C> {
    /// `slopes` has rows of eight rays.
    #[inline(always)]
    fn packets<L: Lane>(&self, rays: &Rays, slopes: [&[F32x8]; 2], hits: &mut Hits, stack: &mut Stack) {
        let Self { hierarchy, axis, entry_points, counter } = *self;
        let packets = rays.len() / L::WIDTH;
        // Frusta are made eight at a time.
        for first in (0..packets).step_by(8) {
            let rows = slopes.map(|rows| &rows[first * (L::WIDTH / ROW)..]);
            let frusta = axis.frusta(rows.map(|rows| spans::<L>(rows)));
            for packet in first..packets.min(first + 8) {
                let (frustum, at) = (axis.frustum(&frusta, packet - first), packet * L::WIDTH);
                counter.boxes(entry_points.filled.div_ceil(WIDE), entry_points.filled);
                let meets = entry_points.across(&frustum);
                // Many packets of tiles at silhouettes meet no entry point, and are not prepared.
                if meets != 0 {
                    let packet =
                        PacketTraversal::<L, C>::new(hierarchy, axis, &frustum, rays, hits, at, counter);
                    packet.run(entry_points, meets, hits, at, stack);
                }
            }
        }
    }
}
