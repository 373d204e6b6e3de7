//! Finds the entry points of a tile with its frustum, level by level, and decides whether packets pay.

use super::sharing::{EMPTY, Entry, SeenTile};
use crate::bvh::{Child, WIDE};
use crate::lane::{Lane, Mask};
use crate::traverse::counter::CounterSink;
use crate::traverse::frustum::{Boxes, Frustum};
use crate::traverse::hierarchy::Hierarchy;

/// The largest number of entry points of a tile.
pub const MAX_ENTRY_POINTS: usize = 64;
// Each entry point is one bit of a mask, and they fill whole blocks of boxes.
const _: () = assert!(MAX_ENTRY_POINTS == u64::BITS as usize && MAX_ENTRY_POINTS.is_multiple_of(WIDE));

/// The tiles to trace in packets.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Packets {
    /// All tiles that packets can trace.
    Always,
    /// The tiles for which packets are faster than streams, by an estimate.
    WherePaying,
}

/// The largest number of inner nodes among the entry points of a tile for which packets pay.
const MAX_INNER: usize = 32;
/// Up to this many leaves without inner nodes, packets pay; the estimate is skipped.
const FEW_LEAVES: usize = 30;

/// Entry points: nodes and leaves that together hold all that a tile can see, nearest first, and one bit of a
/// mask each.
pub struct EntryPoints {
    boxes: [Boxes; MAX_ENTRY_POINTS / WIDE],
    pub children: [Child; MAX_ENTRY_POINTS],
    /// The distances along the frustum axis at which the entry points begin, ascending.
    pub near: [f32; MAX_ENTRY_POINTS],
    pub filled: usize,
}

impl EntryPoints {
    /// Finds the entry points; returns `None` if packets do not pay, early if that is probable.
    pub fn of(
        hierarchy: &Hierarchy,
        tile: &SeenTile,
        packets: Packets,
        counter: impl CounterSink,
    ) -> Option<Self> {
        let frustum = &tile.frustum;
        let mut entries = [Entry { near: 0.0, child: Child(0), node: 0, slot: 0 }; MAX_ENTRY_POINTS];
        let mut filled = 1;
        // Level by level, as long as there is room: each round opens the nodes that the previous one found.
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
                    let (near, parent, child) = (near.get(slot), child.index() as u32, node.children()[slot]);
                    if !child.is_leaf() {
                        // The next round may open it.
                        hierarchy.prefetch(child);
                    }
                    entries[filled] = Entry { near, child, node: parent, slot: slot as u32 };
                    filled += 1;
                }
                opened = true;
            }
        }
        let entries = &entries[..filled];
        let are_few = inner(entries) == 0 && filled <= FEW_LEAVES;
        if packets == Packets::WherePaying && !are_few && !tile.packets_pay(hierarchy, entries) {
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

    /// Fetches the cache lines of the next of the `entries`, if there is one.
    #[inline(always)]
    pub fn prefetch_next(&self, hierarchy: &Hierarchy, entries: &mut impl Iterator<Item = usize>) {
        if let Some(entry) = entries.next() {
            hierarchy.prefetch(self.children[entry & (MAX_ENTRY_POINTS - 1)]);
        }
    }

    /// Returns the entry points whose boxes reach between the sides of a packet's frustum, one bit each.
    #[inline(always)]
    pub fn across(&self, frustum: &Frustum) -> u64 {
        let boxes = self.boxes[..self.filled.div_ceil(WIDE)].iter();
        boxes.zip((0..).step_by(WIDE)).fold(0, |meets, (boxes, first)| {
            meets | u64::from(frustum.across_boxes(boxes).bitmask()) << first
        })
    }
}
