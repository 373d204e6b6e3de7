//! The nodes and leaves that traversals read, and the limits that traversals rely on.

use super::bounds::Bounds;
use crate::kind::Kind;
use crate::lane::{Bits, Mask, NATIVE_WIDTH, NativeBits, prefetch, set_bits};
use bytemuck::{Pod, Zeroable};
use glam::Vec3;

/// The number of children of a wide node: as many as one vector tests at once.
pub const WIDE: usize = NATIVE_WIDTH;
/// The largest number of levels from the root to a leaf. Splits by cost may be lopsided; if they would lead
/// deeper, sets are halved, which takes 27 levels for [`super::MAX_PRIMITIVES`].
pub const MAX_DEPTH: u32 = 48;
/// The largest stack of a traversal of the wide tree: each level leaves all but one child behind.
pub const MAX_STACK: usize = (WIDE - 1) * MAX_DEPTH as usize + 1;

/// The reference of a child slot: to a node, to a leaf of a kind of primitive, or to nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
#[repr(transparent)]
pub struct Child(pub u32);

impl Child {
    /// Set in leaves.
    pub const LEAF: u32 = 1 << 31;
    /// The position of the kind of a leaf's primitives, in bits.
    const KIND_SHIFT: u32 = (Kind::ALL.len() - 1).leading_zeros() - (usize::BITS - 31);
    /// Masks the index of a leaf among those of its kind.
    pub(super) const INDEX: u32 = (1 << Self::KIND_SHIFT) - 1;
    /// No child; its box is empty, so no ray reaches it. The leaf bits are set, and the index is out of
    /// range.
    pub const NONE: Self = Self(u32::MAX);

    /// Returns the reference to a leaf, by its index among those of its kind.
    pub const fn leaf(kind: Kind, index: usize) -> Self {
        Self(Self::LEAF | (kind as u32) << Self::KIND_SHIFT | index as u32)
    }
    /// Tests whether the reference is to a leaf.
    #[inline(always)]
    pub fn is_leaf(self) -> bool {
        self.0 & Self::LEAF != 0
    }
    /// Returns the kind of a leaf's primitives.
    #[inline(always)]
    pub const fn kind(self) -> Kind {
        Kind::ALL[((self.0 & !Self::LEAF) >> Self::KIND_SHIFT) as usize]
    }
    /// Returns the index of a node, or of a leaf among those of its kind.
    #[inline(always)]
    pub fn index(self) -> usize {
        (self.0 & Self::INDEX) as usize
    }
}

/// The boxes and the references of the children: four or eight cache lines.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct WideNode {
    planes: [[f32; WIDE]; 6],
    children: [Child; WIDE],
    /// Padding, so that every node starts a cache line.
    unused: [u32; WIDE],
}

/// Iterates over the slots that are set in `bits`, in ascending order. The mask saves bounds checks.
#[inline(always)]
pub fn slots(bits: u32) -> impl Iterator<Item = usize> {
    set_bits(bits).map(|slot| slot & (WIDE - 1))
}

impl WideNode {
    /// A node without children.
    pub const EMPTY: Self = {
        let (lo, hi) = ([f32::INFINITY; WIDE], [f32::NEG_INFINITY; WIDE]);
        Self { planes: [lo, lo, lo, hi, hi, hi], children: [Child::NONE; WIDE], unused: [0; WIDE] }
    };

    pub(super) fn set(&mut self, slot: usize, bounds: Bounds, child: Child) {
        for axis in 0..3 {
            self.planes[axis][slot] = bounds.lo[axis];
            self.planes[3 + axis][slot] = bounds.hi[axis];
        }
        self.children[slot] = child;
    }
    /// Returns the slots; filled slots come first.
    #[inline(always)]
    pub fn children(&self) -> &[Child; WIDE] {
        &self.children
    }
    /// Returns the slots of nodes, one bit each.
    #[inline(always)]
    pub fn nodes(&self) -> u32 {
        self.slots_of(0)
    }
    /// Returns the slots of leaves of triangles, one bit each.
    #[inline(always)]
    pub fn triangle_leaves(&self) -> u32 {
        self.slots_of(Child::leaf(Kind::Triangle, 0).0)
    }
    /// Returns the slots whose references have exactly these bits outside [`Child::INDEX`].
    #[inline(always)]
    fn slots_of(&self, flags: u32) -> u32 {
        let children = NativeBits::load(bytemuck::cast_slice(&self.children));
        (children & NativeBits::splat(!Child::INDEX)).equals(NativeBits::splat(flags)).bitmask()
    }
    /// Returns the number of filled slots.
    pub fn filled(&self) -> usize {
        self.children.iter().filter(|&&child| child != Child::NONE).count()
    }
    /// Returns the planes of the children's boxes, one per slot: the lower ones along x, y, z, then the upper
    /// ones. Empty slots have lower planes of +∞ and upper planes of −∞.
    #[inline(always)]
    pub fn planes(&self) -> &[[f32; WIDE]; 6] {
        &self.planes
    }
    /// Returns six rows of planes and, behind them, the two rows of references and padding: a power of two,
    /// so that `& 7` keeps a row index inside without a bounds check.
    #[inline(always)]
    pub fn boxes(&self) -> &[[f32; WIDE]; 8] {
        bytemuck::cast_ref(self)
    }
    /// Fetches the cache lines that a traversal reads.
    #[inline(always)]
    pub fn prefetch(&self) {
        // The last row is unused.
        prefetch(&self.planes);
        prefetch(&self.children);
    }
    /// Returns the box of a child.
    pub fn bounds(&self, slot: usize) -> Bounds {
        let [a, b, c, x, y, z] = self.planes.each_ref().map(|plane| plane[slot]);
        Bounds { lo: Vec3::new(a, b, c), hi: Vec3::new(x, y, z) }
    }
}

/// A node of the binary tree, half a cache line. Nodes are in depth-first order: the left child of an inner
/// node is the next node.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C, align(32))]
pub struct BinaryNode {
    lo: [f32; 3],
    /// The right child of an inner node, or the reference of a leaf.
    child: Child,
    hi: [f32; 3],
    /// The axis along which the centres of the children's boxes are furthest apart; bit 2 is set if the left
    /// child is the upper one.
    order: u32,
}

impl BinaryNode {
    pub(super) fn new(bounds: Bounds, child: Child, order: u32) -> Self {
        Self { lo: bounds.lo.to_array(), child, hi: bounds.hi.to_array(), order }
    }
    /// Returns the right child of an inner node, or the reference of a leaf.
    #[inline(always)]
    pub fn child(&self) -> Child {
        self.child
    }
    /// Returns the node's box.
    #[inline(always)]
    pub fn bounds(&self) -> Bounds {
        Bounds { lo: self.lo.into(), hi: self.hi.into() }
    }
    /// Tests whether a ray meets the left child first. Bit `axis` of `upwards` is set if the ray's direction
    /// is positive along that axis.
    #[inline(always)]
    pub fn left_first(&self, upwards: u32) -> bool {
        (upwards >> (self.order & 3) & 1) != (self.order >> 2)
    }
}
