//! The first form of a hierarchy: a binary tree by the surface area heuristic, each node with a plan of how to collapse it.
//!
//! Nodes stand in depth-first order and refer to each other by distance, so that subtrees built by several threads are joined by copying.

use super::bounds::{Bounds, PackedBox};
use super::cost::{Costs, Plan};
use super::split::{self, Set};
use super::{LEAF, MAX_DEPTH};
use crate::lane::{Mask, Mask8};
use rayon::join;

/// Smallest set whose halves are built by two threads.
const FORK: usize = 1024;

/// A node; its left child stands behind it.
#[derive(Clone, Copy)]
pub(super) struct Draft {
    pub bounds: Bounds,
    /// Of an inner node, how far behind it its right child stands; of a leaf, where its boxes start.
    pub at: u32,
    /// Boxes of a leaf; 0 in inner nodes.
    pub count: u32,
    pub plan: Plan,
}

/// What stays the same through a build.
pub(super) struct Builder<'a> {
    /// Is this the number of a sphere? Leaves hold one kind.
    pub is_sphere: &'a (dyn Fn(u32) -> bool + Sync),
    /// Sets of so many are not cut any more.
    pub finest: usize,
}

/// Levels of cuts in the middle until each part fits a leaf.
fn levels(count: usize) -> u32 {
    count.div_ceil(LEAF).next_power_of_two().ilog2()
}

impl Builder<'_> {
    pub fn build(&self, boxes: &mut [PackedBox]) -> Vec<Draft> {
        let mut drafts = Vec::with_capacity(boxes.len() / 2);
        let set = Set::of(boxes);
        self.subtree(boxes, 0, set, 0, &mut drafts);
        drafts
    }

    /// Appends the tree over `boxes`, which start at `first` of all and are described by `set`; `depth` levels are above it.
    fn subtree(
        &self,
        boxes: &mut [PackedBox],
        first: u32,
        set: Set,
        depth: u32,
        drafts: &mut Vec<Draft>,
    ) -> Costs {
        let count = boxes.len();
        let leaf = Costs::of_leaf(set.bounds.half_area());
        let cut = self.cut(boxes, &set, depth, &leaf);
        let Some((middle, low, high)) = cut else {
            let count = count as u32;
            let bounds = set.bounds.bounds();
            drafts.push(Draft { bounds, at: first, count, plan: Plan::LEAF });
            return leaf;
        };
        let node = drafts.len();
        drafts.push(Draft { bounds: set.bounds.bounds(), at: 0, count: 0, plan: Plan::LEAF });
        let (left, right) = boxes.split_at_mut(middle);
        let second = first + middle as u32;
        let (left, right) = if count > FORK {
            let mut behind = Vec::new();
            let (left, right) = join(
                || self.subtree(left, first, low, depth + 1, drafts),
                || self.subtree(right, second, high, depth + 1, &mut behind),
            );
            drafts[node].at = (drafts.len() - node) as u32;
            drafts.append(&mut behind);
            (left, right)
        } else {
            let left = self.subtree(left, first, low, depth + 1, drafts);
            drafts[node].at = (drafts.len() - node) as u32;
            (left, self.subtree(right, second, high, depth + 1, drafts))
        };
        let one_leaf = (count <= LEAF && self.homogeneous(boxes)).then_some(leaf);
        let (costs, plan) = Costs::of_inner(set.bounds.half_area(), &left, &right, one_leaf);
        drafts[node].plan = plan;
        costs
    }

    fn homogeneous(&self, boxes: &[PackedBox]) -> bool {
        let mut kinds = boxes.iter().map(|one| (self.is_sphere)(one.number()));
        let first = kinds.next();
        kinds.all(|kind| Some(kind) == first)
    }

    /// Cuts the set in two, or makes it a leaf.
    fn cut(&self, boxes: &mut [PackedBox], set: &Set, depth: u32, leaf: &Costs) -> Option<(usize, Set, Set)> {
        let count = boxes.len();
        if count > LEAF {
            // After a cut by cost, cuts in the middle and one by kind must still fit.
            let by_cost = depth + levels(count) + 2 <= MAX_DEPTH;
            let cut = if by_cost { split::cheapest_cut(boxes, set, LEAF as u32) } else { None };
            return Some(match cut {
                Some(cut) => split::partition(boxes, set, &cut),
                None => split::halve(boxes, set, LEAF),
            });
        }
        if count > self.finest && depth + 2 <= MAX_DEPTH {
            let cut = split::cheapest_cut(boxes, set, LEAF as u32);
            if let Some(cut) = cut.filter(|cut| leaf.improved_by_cut(cut.cost)) {
                return Some(split::partition(boxes, set, &cut));
            }
        }
        if self.homogeneous(boxes) {
            return None;
        }
        Some(split::partition_by(boxes, &|one| Mask8::splat((self.is_sphere)(one.number()))))
    }
}
