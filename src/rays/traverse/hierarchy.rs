//! The primitives in the leaves of a hierarchy, and the intersection of rays with a leaf, shared by all
//! traversals.

use super::compact::{Layout, MIN_LEAVES_PER_THREAD, TriangleLeaves};
use super::leaf::{TriangleLeaf, intersect_one};
use super::precalculated::SingleRay;
use super::quadrics::QuadricLeaf;
use crate::bvh::{Bvh, Child, Trees, WIDE, WideNode, slots};
use crate::coordinates::Coordinates;
use crate::geometry::Geometry;
use crate::kernel::ray_box::Padding;
use crate::lane::Lane;
use crate::math::{Hit, Ray};
use rayon::prelude::*;

/// The bounding volume hierarchy, and the primitives of its leaves as intersection reads them.
pub struct Hierarchy {
    /// The trees.
    pub bvh: Bvh,
    /// What box tests are padded by.
    pub padding: Padding,
    /// Where the coordinates of the primitives are in the world.
    pub(super) coordinates: Coordinates,
    triangles: TriangleLeaves,
    pub(super) quadrics: Vec<QuadricLeaf>,
}

impl Hierarchy {
    /// [`Trees::WideAndBinary`] for the scalar traversal, which alone reads the binary tree.
    pub fn new(geometry: &Geometry, trees: Trees) -> Self {
        Self::in_layout(geometry, trees, None)
    }

    /// The same with the leaves of triangles in a given layout; `None` chooses by their size.
    pub fn in_layout(geometry: &Geometry, trees: Trees, layout: Option<Layout>) -> Self {
        let (bvh, padding) = rayon::join(|| Bvh::new(geometry, trees), || geometry.padding());
        let quadrics = bvh.quadric_leaves.par_iter().with_min_len(MIN_LEAVES_PER_THREAD);
        Self {
            triangles: TriangleLeaves::new(geometry, &bvh, layout),
            quadrics: quadrics.map(|leaf| QuadricLeaf::new(geometry, leaf)).collect(),
            coordinates: geometry.coordinates,
            padding,
            bvh,
        }
    }

    /// Bytes of nodes and leaves.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + self.triangles.bytes() + size_of_val(self.quadrics.as_slice())
    }

    /// Number of primitives of a leaf.
    pub fn filled(&self, leaf: Child) -> usize {
        self.bvh.leaf(leaf).primitives().len()
    }

    /// One ray against all primitives of a leaf at once.
    #[inline(always)]
    pub fn intersect_leaf(&self, leaf: Child, ray: &SingleRay, hit: &mut Hit<f32>) {
        if leaf.is_quadrics() {
            self.quadrics[leaf.index()].intersect(&ray.ray, hit);
        } else {
            self.with_triangles(leaf.index(), |leaf| {
                leaf.accept(leaf.candidates(ray.woop.stored()), &ray.woop, &ray.box_ray, hit);
            });
        }
    }

    /// One ray against the primitives of a leaf, one after the other: for the scalar baseline.
    #[inline(always)]
    pub fn intersect_leaf_one_by_one(&self, leaf: Child, ray: &SingleRay, hit: &mut Hit<f32>) {
        if leaf.is_quadrics() {
            self.quadrics[leaf.index()].intersect_packet(&ray.ray, hit);
        } else {
            let triangles = &self.triangles;
            for (lane, &primitive) in self.bvh.triangle_leaves[leaf.index()].primitives().iter().enumerate() {
                let corners = triangles.corners(leaf.index(), lane);
                intersect_one(corners, primitive, &ray.woop, &ray.box_ray, hit);
            }
        }
    }

    /// Visits a leaf of triangles.
    #[inline(always)]
    pub fn with_triangles<R>(&self, leaf: usize, visit: impl FnOnce(&TriangleLeaf) -> R) -> R {
        self.triangles.with(leaf, visit)
    }

    /// The leaves of triangles in these slots of a node, one bit each; other slots refer to an empty leaf.
    /// Compact ones are expanded into `room`.
    #[inline(always)]
    pub fn triangle_leaves<'a>(
        &'a self,
        node: &WideNode,
        reached: u32,
        room: &'a mut [TriangleLeaf; WIDE],
    ) -> [&'a TriangleLeaf; WIDE] {
        let mut leaves = [const { &TriangleLeaf::EMPTY }; WIDE];
        for (slot, room) in slots(reached).zip(room) {
            leaves[slot] = self.triangles.expanded(node.children()[slot].index(), room);
        }
        leaves
    }

    /// Fetches the cache lines of a node or of a leaf of triangles ahead of its visit. Leaves of quadrics are
    /// few, and not fetched.
    #[inline(always)]
    pub fn prefetch(&self, child: Child) {
        if !child.is_leaf() {
            self.bvh.wide[child.index()].prefetch();
        } else if !child.is_quadrics() {
            self.triangles.prefetch(child.index());
        }
    }

    /// A packet against the quadrics of a leaf, one after the other.
    #[inline(never)]
    pub fn intersect_quadrics_packet<L: Lane>(&self, leaf: usize, ray: &Ray<L>, hit: &mut Hit<L>) -> bool {
        self.quadrics[leaf].intersect_packet(ray, hit)
    }
}
