//! Builds a binary tree by the surface area heuristic; each node has a plan of how to collapse it.
//!
//! Nodes are in depth-first order and refer to each other by distance, so that subtrees built by several
//! threads are joined by copying.

use super::bounds::{Bounds, PackedBox};
use super::cost::{Costs, Plan};
use super::node::MAX_DEPTH;
use super::split::{self, Set};
use crate::kind::{Kind, KindCounts, LEAF};
use crate::lane::{Mask, Mask8};
use rayon::join;

/// Sets larger than this have their halves built by two threads.
const FORK: usize = 1024;

/// The largest set that becomes a leaf without trying a split by cost.
const MAX_UNSPLIT: usize = LEAF / 2;

/// A node of the build tree; its left child is the next node.
#[derive(Clone, Copy)]
pub(super) struct BuildNode {
    pub bounds: Bounds,
    /// In an inner node, the distance to its right child; in a leaf, the index of its first box.
    pub at: u32,
    /// The number of boxes of a leaf; 0 in inner nodes.
    pub count: u32,
    pub plan: Plan,
}

/// The parameters of a build.
pub(super) struct Builder {
    /// The primitives by kind: a leaf holds primitives of one kind.
    pub counts: KindCounts,
}

/// Returns how often a set must be halved until each part fits a leaf.
fn levels(count: usize) -> u32 {
    count.div_ceil(LEAF).next_power_of_two().ilog2()
}

impl Builder {
    /// Builds the tree over the boxes; returns it and its costs.
    pub fn build(&self, boxes: &mut [PackedBox]) -> (Vec<BuildNode>, Costs) {
        let mut nodes = Vec::with_capacity(boxes.len() / 2);
        let set = Set::of(boxes);
        let costs = self.subtree(boxes, 0, set, 0, &mut nodes);
        (nodes, costs)
    }

    /// Appends the tree over `boxes`, which start at index `first` of all boxes and have the bounds in `set`;
    /// `depth` levels are above it.
    fn subtree(
        &self,
        boxes: &mut [PackedBox],
        first: u32,
        set: Set,
        depth: u32,
        nodes: &mut Vec<BuildNode>,
    ) -> Costs {
        let count = boxes.len();
        let leaf = Costs::of_leaf(set.bounds.half_area());
        let Some((middle, low, high)) = self.split(boxes, &set, depth, &leaf) else {
            let count = count as u32;
            let bounds = set.bounds.bounds();
            nodes.push(BuildNode { bounds, at: first, count, plan: Plan::LEAF });
            return leaf;
        };
        let node = nodes.len();
        nodes.push(BuildNode { bounds: set.bounds.bounds(), at: 0, count: 0, plan: Plan::LEAF });
        let (left, right) = boxes.split_at_mut(middle);
        let second = first + middle as u32;
        let (left, right) = if count > FORK {
            let mut right_nodes = Vec::new();
            let (left, right) = join(
                || self.subtree(left, first, low, depth + 1, nodes),
                || self.subtree(right, second, high, depth + 1, &mut right_nodes),
            );
            nodes[node].at = (nodes.len() - node) as u32;
            nodes.append(&mut right_nodes);
            (left, right)
        } else {
            let left = self.subtree(left, first, low, depth + 1, nodes);
            nodes[node].at = (nodes.len() - node) as u32;
            (left, self.subtree(right, second, high, depth + 1, nodes))
        };
        let one_leaf = (count <= LEAF && self.homogeneous(boxes)).then_some(leaf);
        let (costs, plan) = Costs::of_inner(set.bounds.half_area(), (&left, &right), one_leaf);
        nodes[node].plan = plan;
        costs
    }

    fn kind_of(&self, one: PackedBox) -> Kind {
        self.counts.kind_of(one.number() as usize)
    }

    fn homogeneous(&self, boxes: &[PackedBox]) -> bool {
        let mut kinds = boxes.iter().map(|one| self.kind_of(*one));
        let first = kinds.next();
        kinds.all(|kind| Some(kind) == first)
    }

    /// Splits the set in two; returns `None` if it should be a leaf.
    fn split(
        &self,
        boxes: &mut [PackedBox],
        set: &Set,
        depth: u32,
        leaf: &Costs,
    ) -> Option<(usize, Set, Set)> {
        let count = boxes.len();
        if count > LEAF {
            // After a split by cost, halving and the splits by kind must still fit below the largest depth.
            let by_cost = depth + levels(count) + Kind::ALL.len() as u32 <= MAX_DEPTH;
            let split = if by_cost { split::cheapest_split(boxes, set, LEAF as u32) } else { None };
            return Some(match split {
                Some(split) => split::partition(boxes, set, &split),
                None => split::halve(boxes, set, LEAF),
            });
        }
        if count > MAX_UNSPLIT && depth + Kind::ALL.len() as u32 <= MAX_DEPTH {
            let split = split::cheapest_split(boxes, set, LEAF as u32);
            if let Some(split) = split.filter(|split| leaf.improved_by_split(split.cost)) {
                return Some(split::partition(boxes, set, &split));
            }
        }
        if self.homogeneous(boxes) {
            return None;
        }
        let least = boxes.iter().map(|one| one.number()).min()?;
        let kind = self.counts.kind_of(least as usize);
        Some(split::partition_by(boxes, &|one| Mask8::splat(self.kind_of(one) == kind)))
    }
}
