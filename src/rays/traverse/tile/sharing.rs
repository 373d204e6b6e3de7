//! Decides whether packets pay, by an estimate of how many rays of a packet share a leaf, from the extents of
//! boxes on the tile.

use crate::bvh::{Child, WIDE};
use crate::lane::{F32x8, Lane, Mask, Native, NativeMask};
use crate::traverse::frustum::{Boxes, Frustum, FrustumAxis};
use crate::traverse::hierarchy::Hierarchy;

/// A child of a node whose box the tile's frustum meets.
#[derive(Clone, Copy)]
pub struct Entry {
    pub near: f32,
    pub child: Child,
    /// The node and the slot that hold its box.
    pub node: u32,
    pub slot: u32,
}

/// A tile, and the boxes seen in it.
pub struct SeenTile<'a> {
    pub axis: &'a FrustumAxis,
    /// The least and the greatest slopes along each of the other axes.
    pub span: [[F32x8; 2]; 2],
    pub frustum: Frustum,
}

impl SeenTile<'_> {
    /// Tests whether packets are probably faster than streams, by the leaves of all entries. Occlusion
    /// between leaves is ignored.
    pub fn packets_pay(&self, hierarchy: &Hierarchy, entries: &[Entry]) -> bool {
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
        // Boxes behind the last one are NaN, which the estimate would treat as boxes that cover everything.
        let last = Native::one().only(NativeMask::first(gathered));
        sharing.add(self.axis.covered(&self.span, &boxes), last);
        let sum = |x: Native| (0..WIDE).map(|lane| x.get(lane)).sum::<f32>();
        let shared = sum(sharing.rays) / sum(sharing.visits).max(f32::MIN_POSITIVE);
        are_shared_enough(shared, entries.len())
    }
}

/// The number of packets along each side of a full tile, as if all packets had 16 rays.
const PACKETS_A_SIDE: f32 = 4.0;
const PACKET: f32 = 16.0;
/// The number of rays of a full tile.
const RAYS: f32 = PACKETS_A_SIDE * PACKETS_A_SIDE * PACKET;

/// Tests whether packets pay: if (rays that share a leaf)³ is at least (entry points / 23)⁴, which is one ray
/// with 23 entry points and 3.9 with 64, of 16 rays at any width. With more entry points a stream saves more,
/// because it tests a ray against many boxes at once.
///
/// The exponent is fitted to 13,500 tiles of 15 views of knots, terrains and scans of 4,000 to 1,000,000
/// triangles, traced in both ways (16 lanes, AMD Zen 4), the 23 to the later speed of streams:
/// `perf/README.md`.
fn are_shared_enough(shared: f32, entry_points: usize) -> bool {
    let entry_points = entry_points as f32 / 23.0;
    shared * shared * shared >= entry_points * entry_points * entry_points * entry_points
}

/// The number of leaves that an unopened inner node counts for.
const INNER_LEAVES: f32 = 8.0;

/// The sums of [`SeenTile::packets_pay`]: rays that meet leaves, and visits of packets to leaves.
struct Sharing {
    rays: Native,
    visits: Native,
}

impl Sharing {
    /// Adds boxes that cover these shares of the tile's sides, each with its number of leaves. A leaf is
    /// visited by the packets that it covers and, for the part of its edge, by one more per side.
    #[inline(always)]
    fn add(&mut self, [a, b]: [Native; 2], leaves: Native) {
        let side = Native::splat(PACKETS_A_SIDE);
        let split = Native::one() / leaves.max(Native::one()).sqrt();
        let packets = |share: Native| (share * split).mul_add(side, Native::one()).min(side);
        let met = Native::zero().lt(leaves);
        self.rays = self.rays + (a * b * Native::splat(RAYS)).only(met);
        self.visits = self.visits + (packets(a) * packets(b) * leaves).only(met);
    }
}

/// A block without boxes: NaN passes no bound, not even an infinite one.
pub const EMPTY: Boxes = [[f32::NAN; WIDE]; 8];

#[cfg(test)]
mod tests {
    use super::are_shared_enough;

    #[test]
    fn more_entry_points_ask_for_more_rays_that_share_a_leaf() {
        assert!(are_shared_enough(1.0, 23) && !are_shared_enough(1.0, 24));
        assert!(are_shared_enough(4.0, 64) && !are_shared_enough(3.9, 64));
    }
}
