//! Collapses the build tree into wide nodes, leaves, and the binary tree over the same leaves.

use super::bounds::{Bounds, PackedBox};
use super::build::BuildNode;
use super::node::{BinaryNode, Child, WIDE, WideNode};
use crate::kind::{Kind, KindCounts, Leaf};

/// The finished parts, appended in depth-first order.
pub(super) struct Collapse<'a> {
    nodes: &'a [BuildNode],
    boxes: &'a [PackedBox],
    counts: KindCounts,
    pub wide: Vec<WideNode>,
    /// The binary tree; `None` with [`super::tree::Trees::Wide`].
    pub binary: Option<Vec<BinaryNode>>,
    /// The leaves of each kind.
    pub leaves: [Vec<Leaf>; Kind::ALL.len()],
}

/// A wide node whose slots are being filled.
struct Slots {
    node: WideNode,
    filled: usize,
}

impl Slots {
    fn new() -> Self {
        Self { node: WideNode::EMPTY, filled: 0 }
    }
    fn push(&mut self, bounds: Bounds, child: Child) {
        self.node.set(self.filled, bounds, child);
        self.filled += 1;
    }
}

impl<'a> Collapse<'a> {
    pub fn new(
        nodes: &'a [BuildNode],
        boxes: &'a [PackedBox],
        counts: KindCounts,
        keep_binary: bool,
    ) -> Self {
        let (wide, binary) = (vec![WideNode::EMPTY], keep_binary.then(|| Vec::with_capacity(nodes.len())));
        let mut collapse = Self { nodes, boxes, counts, wide, binary, leaves: Default::default() };
        let mut root = Slots::new();
        if boxes.is_empty() {
            collapse.push_binary(BinaryNode::new(Bounds::EMPTY, Child::NONE, 0));
        } else if nodes[0].plan.is_leaf() {
            collapse.tree(0, &mut root);
        } else {
            collapse.children(0, (nodes[0].plan.left_of_node(), WIDE), &mut root);
        }
        collapse.wide[0] = root.node;
        collapse
    }

    /// Appends a node to the binary tree, if there is one; returns its index.
    fn push_binary(&mut self, node: BinaryNode) -> usize {
        let Some(binary) = &mut self.binary else { return 0 };
        binary.push(node);
        binary.len() - 1
    }

    /// Puts the subtree of a build node into the slots, as at most `trees` trees.
    fn forest(&mut self, node: usize, trees: usize, slots: &mut Slots) {
        match self.nodes[node].plan.left_of_forest(trees) {
            None => self.tree(node, slots),
            Some(plan) => self.children(node, plan, slots),
        }
    }

    /// Puts both children into the slots: `of_left` trees for the left one, the rest for the right one.
    fn children(&mut self, node: usize, (of_left, trees): (usize, usize), slots: &mut Slots) {
        let BuildNode { bounds, at, .. } = self.nodes[node];
        let (left, right) = (node + 1, node + at as usize);
        let order = order_of(self.nodes[left].bounds, self.nodes[right].bounds);
        let here = self.push_binary(BinaryNode::new(bounds, Child::NONE, order));
        self.forest(left, of_left, slots);
        if let Some(binary) = &mut self.binary {
            binary[here] = BinaryNode::new(bounds, Child(binary.len() as u32), order);
        }
        self.forest(right, trees - of_left, slots);
    }

    /// Puts a build node into one slot, as a leaf or as a wide node.
    fn tree(&mut self, node: usize, slots: &mut Slots) {
        let BuildNode { bounds, plan, .. } = self.nodes[node];
        if plan.is_leaf() {
            let leaf = self.leaf(node);
            self.push_binary(BinaryNode::new(bounds, leaf, 0));
            slots.push(bounds, leaf);
            return;
        }
        let index = self.wide.len();
        self.wide.push(WideNode::EMPTY);
        slots.push(bounds, Child(index as u32));
        let mut own = Slots::new();
        self.children(node, (plan.left_of_node(), WIDE), &mut own);
        self.wide[index] = own.node;
    }

    /// Makes a leaf of all boxes below a build node.
    fn leaf(&mut self, node: usize) -> Child {
        let (mut first, mut last) = (node, node);
        while self.nodes[first].count == 0 {
            first += 1;
        }
        while self.nodes[last].count == 0 {
            last += self.nodes[last].at as usize;
        }
        let from = self.nodes[first].at as usize;
        let to = (self.nodes[last].at + self.nodes[last].count) as usize;
        let mut leaf = Leaf { primitives: [Leaf::NONE; _] };
        for (slot, one) in leaf.primitives.iter_mut().zip(&self.boxes[from..to]) {
            *slot = one.number();
        }
        leaf.primitives.sort_unstable();
        let kind = self.counts.kind_of(leaf.primitives[0] as usize);
        let leaves = &mut self.leaves[kind as usize];
        leaves.push(leaf);
        Child::leaf(kind, leaves.len() - 1)
    }
}

/// Returns the order of two children, in the form of [`BinaryNode::left_first`].
fn order_of(left: Bounds, right: Bounds) -> u32 {
    // The corners are halved first, so that no sum overflows.
    let offset = (left.lo * 0.5 + left.hi * 0.5) - (right.lo * 0.5 + right.hi * 0.5);
    let axis = offset.abs().max_position();
    let left_is_above = u32::from(offset[axis] > 0.0);
    axis as u32 | left_is_above << 2
}
