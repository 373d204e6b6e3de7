//! The primitives in the leaves of a hierarchy, and the intersection of rays with a leaf, shared by all
//! traversals.

use crate::bvh::{Bvh, Child, Trees, WIDE, WideNode, slots};
use crate::coordinates::Coordinates;
use crate::geometry::Geometry;
use crate::kernel::ray_box::Padding;
use crate::kind::Kind;
use crate::kind::sphere::SphereLeaf;
use crate::kind::triangle::{Layout, MIN_LEAVES_PER_THREAD, TriangleLeaf, TriangleLeaves, intersect_one};
use crate::lane::Lane;
use crate::math::{Hit, Ray};
use crate::prepared::SingleRay;
use rayon::prelude::*;

/// The bounding volume hierarchy, and the primitives of its leaves in the form that tests read.
pub struct Hierarchy {
    /// The trees.
    pub bvh: Bvh,
    /// The padding of box tests.
    pub padding: Padding,
    /// The place of the primitives' coordinates in the world.
    pub(super) coordinates: Coordinates,
    triangles: TriangleLeaves,
    spheres: Vec<SphereLeaf>,
}

impl Hierarchy {
    /// Builds the hierarchy. Only the scalar traversal reads the binary tree of [`Trees::WideAndBinary`].
    pub fn new(geometry: &Geometry, trees: Trees) -> Self {
        Self::in_layout(geometry, trees, None)
    }

    /// Builds the hierarchy with a given layout of triangle leaves; `None` chooses by their size.
    pub fn in_layout(geometry: &Geometry, trees: Trees, layout: Option<Layout>) -> Self {
        let (bvh, padding) = rayon::join(|| Bvh::new(geometry, trees), || geometry.padding());
        let leaves = |kind: Kind| bvh.leaves[kind as usize].as_slice();
        let spheres = leaves(Kind::Sphere).par_iter().with_min_len(MIN_LEAVES_PER_THREAD);
        let triangles = (geometry.counts().first(Kind::Triangle), geometry.triangles.as_slice());
        let node_bytes = size_of_val(bvh.wide.as_slice());
        Self {
            triangles: TriangleLeaves::new(triangles, leaves(Kind::Triangle), node_bytes, layout),
            spheres: spheres.map(|leaf| SphereLeaf::new(&geometry.spheres, leaf)).collect(),
            coordinates: geometry.coordinates,
            padding,
            bvh,
        }
    }

    /// Returns the size of nodes and leaves in bytes.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + self.triangles.bytes() + size_of_val(self.spheres.as_slice())
    }

    /// Returns the number of primitives of a leaf.
    pub fn filled(&self, leaf: Child) -> usize {
        self.bvh.leaf(leaf).primitives().len()
    }

    /// Tests one ray against all primitives of a leaf at once.
    #[inline(always)]
    pub fn intersect_leaf(&self, leaf: Child, ray: &SingleRay, hit: &mut Hit<f32>) {
        match leaf.kind() {
            Kind::Sphere => self.spheres[leaf.index()].intersect(&ray.ray, hit),
            Kind::Triangle => self.with_triangles(leaf.index(), |leaf| {
                leaf.accept(leaf.candidates(ray.woop.stored()), &ray.woop, &ray.box_ray, hit);
            }),
        }
    }

    /// Tests one ray against the primitives of a leaf, one after the other: for the scalar baseline.
    #[inline(always)]
    pub fn intersect_leaf_one_by_one(&self, leaf: Child, ray: &SingleRay, hit: &mut Hit<f32>) {
        match leaf.kind() {
            Kind::Sphere => {
                self.spheres[leaf.index()].intersect_packet(&ray.ray, hit);
            }
            Kind::Triangle => {
                for (lane, &primitive) in self.bvh.leaf(leaf).primitives().iter().enumerate() {
                    let corners = self.triangles.corners(leaf.index(), lane);
                    intersect_one(corners, primitive, &ray.woop, &ray.box_ray, hit);
                }
            }
        }
    }

    /// Calls `visit` with a leaf of triangles.
    #[inline(always)]
    pub fn with_triangles<R>(&self, leaf: usize, visit: impl FnOnce(&TriangleLeaf) -> R) -> R {
        self.triangles.with(leaf, visit)
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
            leaves[slot] = self.triangles.expanded(node.children()[slot].index(), room);
        }
        leaves
    }

    /// Fetches the cache lines of a node or of a leaf of triangles ahead of its visit. Leaves of spheres are
    /// few, and not fetched.
    #[inline(always)]
    pub fn prefetch(&self, child: Child) {
        if !child.is_leaf() {
            return self.bvh.wide[child.index()].prefetch();
        }
        match child.kind() {
            Kind::Sphere => {}
            Kind::Triangle => self.triangles.prefetch(child.index()),
        }
    }

    /// Improves the hits of a packet with the spheres of a leaf, one after the other. Returns whether any hit
    /// was nearer.
    #[inline(never)]
    pub fn intersect_spheres_packet<L: Lane>(&self, leaf: usize, ray: &Ray<L>, hit: &mut Hit<L>) -> bool {
        self.spheres[leaf].intersect_packet(ray, hit)
    }

    /// Improves the hit of one ray with the spheres of a leaf.
    pub fn intersect_spheres(&self, leaf: usize, ray: &Ray<f32>, hit: &mut Hit<f32>) {
        self.spheres[leaf].intersect(ray, hit);
    }
}
