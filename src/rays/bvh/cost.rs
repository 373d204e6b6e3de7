//! Chooses the binary nodes that become wide nodes and leaves so that the hierarchy's cost is least.
//!
//! The cost of a wide hierarchy is the sum of the half surface areas of its nodes and leaves, each times the
//! cost of its test ([`LEAF_COST`]): the expected cost of a random ray. Dynamic programming from the leaves
//! upwards finds, for each binary node and each j up to [`WIDE`], the cheapest forest of at most j wide
//! subtrees; a wide node over a binary node has the cheapest forest of [`WIDE`] as its children.
//!
//! Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs",
//! 2017, section 3.1.

use super::node::WIDE;

/// The cost of testing one ray against the primitives of a leaf, in tests of the boxes of a node.
pub(super) const LEAF_COST: f64 = 1.3;

/// `costs[j − 1]`: the cost of the cheapest forest of at most j trees for a binary node.
///
/// Stored in f64, because squares of mixed scales leave f32's range.
pub(super) struct Costs([f64; WIDE - 1]);

/// The composition of the cheapest forests of a binary node.
///
/// `plan[0]` is 0 if the node as one tree is a leaf; else it is a wide node, and the number counts its
/// children that come from the left. `plan[j − 1]` counts how many of at most j trees come from the left
/// child; it is 0 if one tree fewer is as good.
#[derive(Clone, Copy)]
pub(super) struct Plan([u8; WIDE - 1]);

impl Plan {
    pub const LEAF: Self = Self([0; WIDE - 1]);

    pub fn is_leaf(self) -> bool {
        self.0[0] == 0
    }
    /// Returns how many children at most the wide node over this node takes from its left child.
    pub fn left_of_node(self) -> usize {
        self.0[0] as usize
    }
    /// Returns how many of at most `trees` trees come from the left child, and how many there are in all;
    /// `None` means a single tree.
    pub fn left_of_forest(self, trees: usize) -> Option<(usize, usize)> {
        let fewest = (2..=trees).rev().find(|&j| self.0[j - 1] > 0)?;
        Some((self.0[fewest - 1] as usize, fewest))
    }
}

impl Costs {
    /// Returns the cost of the cheapest single tree.
    #[cfg(test)]
    pub fn of_tree(&self) -> f64 {
        self.0[0]
    }
    pub fn of_leaf(half_area: f64) -> Self {
        Self([LEAF_COST * half_area; WIDE - 1])
    }
    /// Tests whether two leaves whose half surface areas sum to `halves` are cheaper than this leaf.
    pub fn improved_by_split(&self, halves: f64) -> bool {
        LEAF_COST * halves < self.0[0]
    }

    /// Returns the costs and the plan of an inner binary node, from its half surface area, the costs of its
    /// children, and the costs of the leaf that it may become.
    pub fn of_inner(half_area: f64, (left, right): (&Self, &Self), leaf: Option<Self>) -> (Self, Plan) {
        let cheapest = |trees: usize| {
            let mut best = (f64::INFINITY, 0);
            for of_left in 1..trees {
                let cost = left.0[of_left - 1] + right.0[trees - of_left - 1];
                if cost < best.0 {
                    best = (cost, of_left);
                }
            }
            best
        };
        let (mut costs, mut plan) = ([0.0; WIDE - 1], [0; WIDE - 1]);
        let (children, of_left) = cheapest(WIDE);
        (costs[0], plan[0]) = (half_area + children, of_left as u8);
        if let Some(leaf) = leaf
            && leaf.0[0] <= costs[0]
        {
            (costs[0], plan[0]) = (leaf.0[0], 0);
        }
        for trees in 2..WIDE {
            let (cost, of_left) = cheapest(trees);
            (costs[trees - 1], plan[trees - 1]) =
                if cost < costs[trees - 2] { (cost, of_left as u8) } else { (costs[trees - 2], 0) };
        }
        (Self(costs), Plan(plan))
    }
}
