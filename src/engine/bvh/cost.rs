//! The cost of a hierarchy, and which binary nodes become wide nodes and leaves so that the cost is least.
//!
//! The cost of a wide hierarchy is the sum of the half surface areas of its nodes and leaves, each times the
//! cost of its test ([`TestCosts`]): the expected cost of a random ray. Dynamic programming from the leaves
//! upwards finds, for each binary node and each j up to [`WIDE`], the cheapest forest of at most j wide
//! subtrees; a wide node over a binary node has the cheapest forest of [`WIDE`] as its children, or of
//! [`SHORT`] where that costs less.
//!
//! Source: Ylitie, Karras, Laine, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs",
//! 2017, section 3.1.

use super::node::{SHORT, WIDE};
use crate::lane::COMPUTES_IN_HALVES;

/// Costs of testing one ray against the boxes of a node or the primitives of a leaf, in tests of a node of
/// [`WIDE`] children.
pub(super) struct TestCosts {
    node: f64,
    leaf: f64,
    /// Of a node of at most [`SHORT`] children, and of such a leaf.
    short_node: f64,
    short_leaf: f64,
}

/// Most triangles of a hierarchy that counts short nodes and leaves as cheaper. It has more of them, which
/// shadow rays and bounces gain by, and packets of camera rays lose by: frames of 100 to 700 triangles are
/// 0.98 to 1.05 times as fast, frames of 1,000 to 16,000 0.93 to 1.01 times. From 50,000 on bounces lose,
/// too, as more nodes and leaves take more memory. A sphere takes half the memory of a triangle: frames of
/// 300 to 5,000 are 0.99 to 1.08 times as fast, and bounces among 100,000 gain.
const MAX_TRIANGLES: usize = 1000;

impl TestCosts {
    /// For a hierarchy over so many triangles and any number of spheres.
    pub fn of(triangles: usize) -> Self {
        let (node, leaf) = (1.0, 1.3);
        let (short_node, short_leaf) =
            if COMPUTES_IN_HALVES && triangles <= MAX_TRIANGLES { (0.7, 1.0) } else { (node, leaf) };
        Self { node, leaf, short_node, short_leaf }
    }
    pub fn of_node(&self, children: usize) -> f64 {
        if children <= SHORT { self.short_node } else { self.node }
    }
    pub fn of_leaf(&self, primitives: usize) -> f64 {
        if primitives <= SHORT { self.short_leaf } else { self.leaf }
    }
}

/// `costs[j − 1]`: the cost of the cheapest forest of at most j trees for a binary node.
///
/// In f64: squares of mixed scales leave f32's range.
pub(super) struct Costs([f64; WIDE - 1]);

/// The composition of the cheapest forests of a binary node.
///
/// `plan[0]`: 0 if the node as one tree is a leaf, else it is a wide node and the number counts those of its
/// children that come from the left, plus [`SHORT_NODE`] for a short one. `plan[j − 1]`: how many of at most
/// j trees come from the left child; 0 where one tree fewer is as good.
#[derive(Clone, Copy)]
pub(super) struct Plan([u8; WIDE - 1]);

/// Marks the plan of a short node.
const SHORT_NODE: u8 = 0x80;

impl Plan {
    pub const LEAF: Self = Self([0; WIDE - 1]);

    pub fn is_leaf(self) -> bool {
        self.0[0] == 0
    }
    /// Most children that the wide node over this node takes from its left child, and most that it takes in
    /// all.
    pub fn left_of_node(self) -> (usize, usize) {
        let all = if self.0[0] & SHORT_NODE != 0 { SHORT } else { WIDE };
        ((self.0[0] & !SHORT_NODE) as usize, all)
    }
    /// How many of at most `trees` trees come from the left child, and how many there are in all; `None` for
    /// a single tree.
    pub fn left_of_forest(self, trees: usize) -> Option<(usize, usize)> {
        let fewest = (2..=trees).rev().find(|&j| self.0[j - 1] > 0)?;
        Some((self.0[fewest - 1] as usize, fewest))
    }
}

impl Costs {
    /// The cost of the cheapest single tree.
    #[cfg(test)]
    pub fn of_tree(&self) -> f64 {
        self.0[0]
    }
    pub fn of_leaf(cost: f64, half_area: f64) -> Self {
        Self([cost * half_area; WIDE - 1])
    }
    /// Whether two leaves of this cost whose half surface areas sum to `halves` are cheaper than this leaf.
    pub fn improved_by_split(&self, cost: f64, halves: f64) -> bool {
        cost * halves < self.0[0]
    }

    /// For an inner binary node: from its half surface area, the costs of its children, and those of the leaf
    /// that it may become.
    pub fn of_inner(
        tests: &TestCosts,
        half_area: f64,
        (left, right): (&Self, &Self),
        leaf: Option<Self>,
    ) -> (Self, Plan) {
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
        (costs[0], plan[0]) = (tests.node * half_area + children, of_left as u8);
        if tests.short_node < tests.node {
            let (children, of_left) = cheapest(SHORT);
            let cost = tests.short_node * half_area + children;
            if cost < costs[0] {
                (costs[0], plan[0]) = (cost, of_left as u8 | SHORT_NODE);
            }
        }
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
