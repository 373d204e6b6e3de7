//! From the draft to what traversals read: wide nodes, leaves, and the binary tree over the same leaves.

use super::bounds::{Bounds, PackedBox};
use super::draft::Draft;
use super::node::{BinaryNode, Child, Leaf, WIDE, WideNode};

/// The finished parts, growing in depth-first order.
pub(super) struct Collapse<'a> {
    drafts: &'a [Draft],
    boxes: &'a [PackedBox],
    is_sphere: &'a (dyn Fn(u32) -> bool + Sync),
    pub wide: Vec<WideNode>,
    pub binary: Vec<BinaryNode>,
    pub triangle_leaves: Vec<Leaf>,
    pub sphere_leaves: Vec<Leaf>,
}

/// The children of a wide node in the making.
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
        drafts: &'a [Draft],
        boxes: &'a [PackedBox],
        is_sphere: &'a (dyn Fn(u32) -> bool + Sync),
    ) -> Self {
        let (wide, binary) = (vec![WideNode::EMPTY], Vec::with_capacity(drafts.len()));
        let (triangle_leaves, sphere_leaves) = (Vec::new(), Vec::new());
        let mut collapse = Self { drafts, boxes, is_sphere, wide, binary, triangle_leaves, sphere_leaves };
        let mut root = Slots::new();
        if boxes.is_empty() {
            collapse.binary.push(BinaryNode::new(Bounds::EMPTY, Child::NONE, 0));
        } else if drafts[0].plan.is_leaf() {
            collapse.tree(0, &mut root);
        } else {
            collapse.children(0, drafts[0].plan.left_of_node(), WIDE, &mut root);
        }
        collapse.wide[0] = root.node;
        collapse
    }

    /// Puts the binary node and what is below it into the slots, as at most `trees` trees.
    fn forest(&mut self, node: usize, trees: usize, slots: &mut Slots) {
        match self.drafts[node].plan.left_of_forest(trees) {
            None => self.tree(node, slots),
            Some((of_left, trees)) => self.children(node, of_left, trees, slots),
        }
    }

    /// The same of both children: `of_left` trees for the left one, the rest for the right one.
    fn children(&mut self, node: usize, of_left: usize, trees: usize, slots: &mut Slots) {
        let draft = self.drafts[node];
        let (left, right) = (node + 1, node + draft.at as usize);
        let here = self.binary.len();
        let order = order_of(self.drafts[left].bounds, self.drafts[right].bounds);
        self.binary.push(BinaryNode::new(draft.bounds, Child::NONE, order));
        self.forest(left, of_left, slots);
        let second = Child(self.binary.len() as u32);
        self.binary[here] = BinaryNode::new(draft.bounds, second, order);
        self.forest(right, trees - of_left, slots);
    }

    /// The binary node as one slot: a leaf or a wide node of its own.
    fn tree(&mut self, node: usize, slots: &mut Slots) {
        let draft = self.drafts[node];
        if draft.plan.is_leaf() {
            let leaf = self.leaf(node);
            self.binary.push(BinaryNode::new(draft.bounds, leaf, 0));
            slots.push(draft.bounds, leaf);
            return;
        }
        let index = self.wide.len();
        self.wide.push(WideNode::EMPTY);
        slots.push(draft.bounds, Child(index as u32));
        let mut own = Slots::new();
        self.children(node, draft.plan.left_of_node(), WIDE, &mut own);
        self.wide[index] = own.node;
    }

    /// Makes a leaf of all boxes below a node.
    fn leaf(&mut self, node: usize) -> Child {
        let (mut first, mut last) = (node, node);
        while self.drafts[first].count == 0 {
            first += 1;
        }
        while self.drafts[last].count == 0 {
            last += self.drafts[last].at as usize;
        }
        let from = self.drafts[first].at as usize;
        let to = (self.drafts[last].at + self.drafts[last].count) as usize;
        let mut leaf = Leaf { primitives: [Leaf::NONE; _] };
        for (slot, one) in leaf.primitives.iter_mut().zip(&self.boxes[from..to]) {
            *slot = one.number();
        }
        leaf.primitives.sort_unstable();
        let spheres = (self.is_sphere)(leaf.primitives[0]);
        let leaves = if spheres { &mut self.sphere_leaves } else { &mut self.triangle_leaves };
        leaves.push(leaf);
        let kind = if spheres { Child::SPHERES } else { 0 };
        Child(Child::LEAF | kind | (leaves.len() - 1) as u32)
    }
}

/// How two children lie, as [`BinaryNode::left_first`] wants it.
fn order_of(left: Bounds, right: Bounds) -> u32 {
    // Halved first, so that no sum overflows.
    let way = (left.lo * 0.5 + left.hi * 0.5) - (right.lo * 0.5 + right.hi * 0.5);
    let axis = way.abs().max_position();
    let left_is_above = u32::from(way[axis] > 0.0);
    axis as u32 | left_is_above << 2
}
