//! Camera rays by the tile.
//!
//! The frustum around a whole tile goes down the tree first, level by level, until its [`CUT`] is full of entries that together hold all
//! that the tile can see, nearest first. No entry, and the tile is empty. Then each packet, with a frustum of its own, takes those
//! entries in order that lie between its sides; below them it goes down nearest first. In a leaf the triangles outside the frustum are
//! left out, and the packet meets the rest one by one.
//!
//! Source: Reshetov, Soupikov, Hurley, "Multi-Level Ray Tracing Algorithm", SIGGRAPH 2005: entry points for tiles.

use super::frustum::{Boxes, Frustum, Stem, lowest};
use super::hierarchy::{Hierarchy, Packet};
use super::rays::{Hits, Rays};
use super::single::Stack;
use super::tally::Tally;
use crate::bvh::{Child, WIDE};
use crate::lane::{Bits, F32x8, Lane, Mask, U32x8, set_bits};
use crate::math::Hit;

/// Most rays of a tile.
pub const TILE: usize = 256;
/// Most packets of a tile.
const PACKETS: usize = TILE / 8;
/// Most entries of a cut.
pub const CUT: usize = 64;
// Bits of a mask, in whole nodes.
const _: () = assert!(CUT == u64::BITS as usize && CUT.is_multiple_of(WIDE));

/// Entries that together hold all that a tile can see, nearest first; a bit of a mask each.
struct Cut {
    boxes: [Boxes; CUT / WIDE],
    children: [Child; CUT],
    /// How far along the tile's axis each begins, ascending.
    near: [f32; CUT],
    filled: usize,
}

/// A box of a node that the tile meets.
#[derive(Clone, Copy)]
struct Entry {
    near: f32,
    child: Child,
    /// Where the box stands.
    node: u32,
    slot: u32,
}

impl Cut {
    /// `None` if more than `most_nodes` of its entries are nodes that find no room to be opened, or so many wait on the way that more would
    /// probably be left.
    fn of(hierarchy: &Hierarchy, frustum: &Frustum, most_nodes: usize, tally: impl Tally) -> Option<Self> {
        let mut entries = [Entry { near: 0.0, child: Child(0), node: 0, slot: 0 }; CUT];
        let mut filled = 1;
        // Level by level, as long as there is room: each round opens what the one before found.
        let mut opened = true;
        let nodes = |entries: &[Entry]| entries.iter().filter(|entry| !entry.child.is_leaf()).count();
        while opened {
            // Opened, a node becomes about four entries: of more than twice as many there is no room to open enough.
            if nodes(&entries[..filled]) > 2 * most_nodes {
                return None;
            }
            opened = false;
            for at in (0..filled).rev() {
                let Entry { child, .. } = entries[at];
                if child.is_leaf() {
                    continue;
                }
                let node = &hierarchy.bvh.wide[child.index()];
                tally.node(node, 1);
                let (near, meets) = frustum.pass_boxes(node.boxes(), f32::INFINITY);
                if filled - 1 + meets.count() > CUT {
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
        if nodes(&entries[..filled]) > most_nodes {
            return None;
        }
        // Sorted as whole numbers: distances that are not negative stand in the order of their bits.
        let mut order = [0u64; CUT];
        let order = &mut order[..filled];
        for ((order, entry), at) in order.iter_mut().zip(&entries).zip(0..) {
            *order = u64::from(entry.near.max(0.0).to_bits()) << 32 | at;
        }
        order.sort_unstable();
        let mut cut =
            Self { boxes: [EMPTY; CUT / WIDE], children: [Child::NONE; CUT], near: [0.0; CUT], filled };
        for (at, order) in order.iter().enumerate() {
            let entry = entries[*order as usize & (CUT - 1)];
            let from = hierarchy.bvh.wide[entry.node as usize].boxes();
            let to = &mut cut.boxes[at / WIDE];
            for plane in 0..6 {
                to[plane][at % WIDE] = from[plane][entry.slot as usize];
            }
            cut.children[at] = entry.child;
            cut.near[at] = f32::from_bits((order >> 32) as u32);
        }
        Some(cut)
    }

    /// The entries that reach between the sides of a packet's frustum, a bit each.
    #[inline(always)]
    fn across(&self, frustum: &Frustum) -> u64 {
        let boxes = self.boxes[..self.filled.div_ceil(WIDE)].iter();
        boxes.zip((0..).step_by(WIDE)).fold(0, |meets, (boxes, first)| {
            meets | u64::from(frustum.across_boxes(boxes).bitmask()) << first
        })
    }
}

/// No box: no side's bound, not even an infinite one, lets NaN pass.
const EMPTY: Boxes = [[f32::NAN; 8]; 8];

/// A packet on its way down.
struct Walk<'a, T> {
    hierarchy: &'a Hierarchy,
    stem: &'a Stem,
    frustum: &'a Frustum,
    packet: Packet,
    hit: Hit<F32x8>,
    /// How far along the frustum's axis there may be nearer hits.
    limit: f32,
    /// Found a hit.
    closer: bool,
    tally: T,
}

impl<'a, T: Tally> Walk<'a, T> {
    #[inline(always)]
    fn new(
        hierarchy: &'a Hierarchy,
        stem: &'a Stem,
        frustum: &'a Frustum,
        rays: &Rays,
        hits: &Hits,
        at: usize,
        tally: T,
    ) -> Self {
        let hit = Hit {
            t: F32x8::load(&hits.t[at..]),
            primitive: U32x8::load(&hits.primitive[at..]),
            u: F32x8::load(&hits.u[at..]),
            v: F32x8::load(&hits.v[at..]),
        };
        let packet = Packet::new(rays.packet::<F32x8>(at));
        Self { hierarchy, stem, frustum, packet, hit, limit: f32::INFINITY, closer: false, tally }
    }

    /// Visits those of the cut's entries that are set in `meets`.
    #[inline(always)]
    fn run(mut self, cut: &Cut, meets: u64, hits: &mut Hits, at: usize, stack: &mut Stack) {
        for entry in set_bits(meets).map(|entry| entry & (CUT - 1)) {
            // The tile's distances are the packet's, as both frusta stand on one stem; those that follow are no nearer.
            if cut.near[entry] > self.limit {
                break;
            }
            self.visit(cut.children[entry], stack);
        }
        if self.closer {
            self.hit.t.store(&mut hits.t[at..]);
            self.hit.primitive.store(&mut hits.primitive[at..]);
            self.hit.u.store(&mut hits.u[at..]);
            self.hit.v.store(&mut hits.v[at..]);
        }
    }

    /// Visits a child of a node, and what is below it.
    #[inline(always)]
    fn visit(&mut self, child: Child, stack: &mut Stack) {
        if child.is_leaf() {
            self.leaf(child);
        } else {
            self.below(child, stack);
        }
    }

    fn below(&mut self, child: Child, stack: &mut Stack) {
        let mut next = child;
        let mut waiting = 0;
        loop {
            if next.is_leaf() {
                self.leaf(next);
            } else {
                let node = &self.hierarchy.bvh.wide[next.index()];
                self.tally.node(node, 1);
                let (near, meets) = self.frustum.pass_boxes(node.boxes(), self.limit);
                if meets.any() {
                    waiting += stack.put(waiting, node.children(), near, meets);
                }
            }
            loop {
                if waiting == 0 {
                    return;
                }
                waiting -= 1;
                let (child, near) = stack.get(waiting);
                if near <= self.limit {
                    next = child;
                    break;
                }
            }
        }
    }

    #[inline(always)]
    fn leaf(&mut self, leaf: Child) {
        if leaf.is_spheres() {
            self.tally.packet_at_spheres(self.hierarchy, leaf);
            if self.hierarchy.packet_meets_spheres(leaf.index(), &self.packet.ray, &mut self.hit) {
                self.shorten();
            }
            return;
        }
        let triangles = self.hierarchy.triangle_leaf(leaf.index());
        let main = triangles.planes(self.frustum.axis());
        let (_, meets) =
            self.frustum.pass(|upper| main[upper & 1], |axis| triangles.planes(axis), self.limit);
        self.tally.packet_at_triangles(self.hierarchy, leaf, meets);
        let mut closer = false;
        for lane in meets.lanes() {
            closer |= triangles.packet_meets(lane, self.hierarchy.padding, &mut self.packet, &mut self.hit);
        }
        if closer {
            self.shorten();
        }
    }

    /// Measures again how far the packet's rays reach along the axis: to their furthest hit.
    #[inline(never)]
    fn shorten(&mut self) {
        self.closer = true;
        // Rounding is monotone: no box that a ray meets within its hit begins beyond this.
        self.limit = -lowest(-self.stem.depth(self.packet.ray.direction, self.hit.t));
    }
}

/// The lowest and highest lane of each of eight rows.
#[inline(always)]
fn spans(rows: &[F32x8]) -> [F32x8; 2] {
    let order = U32x8::from_fn(|lane| lane as u32);
    let [first, rest @ ..] = F32x8::gather_rows::<8>(bytemuck::cast_slice(rows), order);
    rest.into_iter().fold([first, first], |[low, high], x| [low.min(x), high.max(x)])
}

/// Improves the hits of up to [`TILE`] camera rays, which come in with the rays' reach. Says no and does nothing if they are not whole
/// packets or do not run together from one origin, or if more than about `most_nodes` entries of their cut are nodes that find no room
/// to be opened.
#[inline(never)]
pub fn trace(
    hierarchy: &Hierarchy,
    rays: &Rays,
    hits: &mut Hits,
    stack: &mut Stack,
    most_nodes: usize,
    tally: impl Tally,
) -> bool {
    let count = rays.len();
    if !count.is_multiple_of(8) || !(8..=TILE).contains(&count) {
        return false;
    }
    let packets = count / 8;
    let Some(stem) = Stem::of(&rays.packet::<f32>(0), hierarchy.padding) else { return false };
    let mut slopes = [[F32x8::zero(); PACKETS]; 2];
    let Some(span) = stem.slopes(rays, &mut slopes) else { return false };
    let Some(cut) = Cut::of(hierarchy, &stem.frustum(&stem.frusta(span), 0), most_nodes, tally) else {
        return false;
    };
    if cut.filled == 0 {
        return true;
    }
    for first in (0..packets).step_by(8) {
        let frusta = stem.frusta(slopes.each_ref().map(|rows| spans(&rows[first..first + 8])));
        for at in first..packets.min(first + 8) {
            let frustum = stem.frustum(&frusta, at - first);
            tally.boxes(cut.filled.div_ceil(WIDE), cut.filled);
            let meets = cut.across(&frustum);
            // Many packets of a tile at the edge of things meet nothing, and are not made ready.
            if meets != 0 {
                let walk = Walk::new(hierarchy, &stem, &frustum, rays, hits, at * 8, tally);
                walk.run(&cut, meets, hits, at * 8, stack);
            }
        }
    }
    true
}
