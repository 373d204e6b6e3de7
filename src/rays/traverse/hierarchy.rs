//! The hierarchy that all traversals share: nodes, and the intersection of rays with a leaf.

use crate::bvh::{Bounds, Bvh, Child, Trees, WIDE, WideNode, slots};
use crate::coordinates::Coordinates;
use crate::kernel::ray_box::Padding;
use crate::kind::triangle::{Layout, TriangleLeaf};
use crate::kind::{Geometry, Leaves};
use crate::lane::Lane;
use crate::math::{Hit, Ray};
use crate::prepared::SingleRay;

/// The bounding volume hierarchy, and the primitives of its leaves in the form that tests read.
pub struct Hierarchy {
    /// The trees.
    pub bvh: Bvh,
    /// The padding of box tests.
    pub padding: Padding,
    /// The place of the primitives' coordinates in the world.
    pub(super) coordinates: Coordinates,
    leaves: Leaves,
}

impl Hierarchy {
    /// Builds the hierarchy. Only the scalar traversal reads the binary tree of [`Trees::WideAndBinary`].
    pub fn new(geometry: &Geometry, trees: Trees) -> Self {
        Self::in_layout(geometry, trees, None)
    }

    /// Builds the hierarchy with a given layout of triangle leaves; `None` chooses by their size.
    pub fn in_layout(geometry: &Geometry, trees: Trees, layout: Option<Layout>) -> Self {
        let (bvh, padding) = rayon::join(|| Bvh::new(geometry, trees), || geometry.padding());
        Self::over(geometry, bvh, padding, layout)
    }

    /// Returns a hierarchy with the same tree over primitives that have moved.
    pub fn refitted(&self, geometry: &Geometry) -> Self {
        let mut bvh = self.bvh.clone();
        bvh.refit(|number| Bounds::new(geometry.shape(number).bounds()));
        Self::over(geometry, bvh, geometry.padding(), None)
    }

    fn over(geometry: &Geometry, bvh: Bvh, padding: Padding, layout: Option<Layout>) -> Self {
        let leaves = Leaves::new(geometry, &bvh.leaves, size_of_val(bvh.wide.as_slice()), layout);
        Self { leaves, coordinates: geometry.coordinates, padding, bvh }
    }

    /// Returns the size of nodes and leaves in bytes.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + self.leaves.bytes()
    }

    /// Returns the number of primitives of a leaf.
    pub fn filled(&self, leaf: Child) -> usize {
        self.bvh.leaf(leaf).primitives().len()
    }

    /// Tests one ray against all primitives of a leaf at once.
    #[inline(always)]
    pub fn intersect_leaf(&self, leaf: Child, ray: &SingleRay, hit: &mut Hit<f32>) {
        self.leaves.intersect(leaf.kind(), leaf.index(), ray, hit);
    }

    /// Calls `visit` with each hit of a ray with the primitives of a leaf, in no order.
    pub fn visit_leaf(&self, leaf: Child, ray: &SingleRay, visit: &mut impl FnMut(Hit<f32>)) {
        self.leaves.visit(leaf.kind(), leaf.index(), ray, visit);
    }

    /// Tests one ray against the primitives of a leaf, one after the other: for the scalar baseline.
    #[inline(always)]
    pub fn intersect_leaf_one_by_one(&self, leaf: Child, ray: &SingleRay, hit: &mut Hit<f32>) {
        let place = (leaf.kind(), leaf.index());
        self.leaves.intersect_one_by_one(place, self.bvh.leaf(leaf), ray, hit);
    }

    /// Calls `visit` with a leaf of triangles.
    #[inline(always)]
    pub fn with_triangles<R>(&self, leaf: usize, visit: impl FnOnce(&TriangleLeaf) -> R) -> R {
        self.leaves.triangles.with(leaf, visit)
    }

    /// Returns the leaves of triangles in the slots `reached` of a node, one bit each, and an empty leaf for
    /// other slots. Compact leaves are expanded into `room`.
    #[inline(always)]
    pub fn triangle_leaves<'a>(
        &'a self,
        node: &WideNode,
        reached: u32,
        room: &'a mut [TriangleLeaf; WIDE],
    ) -> [&'a TriangleLeaf; WIDE] {
        let mut leaves = [const { &TriangleLeaf::EMPTY }; WIDE];
        for (slot, room) in slots(reached).zip(room) {
            leaves[slot] = self.leaves.triangles.expanded(node.children()[slot].index(), room);
        }
        leaves
    }

    /// Fetches the cache lines of a node or a leaf ahead of its visit.
    #[inline(always)]
    pub fn prefetch(&self, child: Child) {
        match child.is_leaf() {
            true => self.leaves.prefetch(child.kind(), child.index()),
            false => self.bvh.wide[child.index()].prefetch(),
        }
    }

    /// Improves the hits of a packet with the primitives of a leaf, one after the other. Returns whether any
    /// hit was nearer. Domain: not for leaves of triangles.
    #[inline(never)]
    pub fn intersect_packet<L: Lane>(&self, leaf: Child, ray: &Ray<L>, hit: &mut Hit<L>) -> bool {
        self.leaves.intersect_packet(leaf.kind(), leaf.index(), ray, hit)
    }

    /// Improves the hit of one ray with the primitives of a leaf. Domain: not for leaves of triangles.
    pub fn intersect_ray(&self, leaf: Child, ray: &Ray<f32>, hit: &mut Hit<f32>) {
        self.leaves.intersect_ray(leaf.kind(), leaf.index(), ray, hit);
    }
}
