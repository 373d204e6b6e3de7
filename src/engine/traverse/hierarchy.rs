//! The primitives in the leaves of a hierarchy, and the intersection of rays with a leaf, shared by all
//! traversals.

use super::compact::{Layout, TriangleLeaves};
use super::leaf::{TriangleLeaf, inclusive, intersect_one, keep_if_nearer};
use super::precalculated::SingleRay;
use crate::bvh::{Bounds, Bvh, Child, LEAF, Leaf, Trees, WIDE, WideNode, slots};
use crate::kernel::ray_box::Padding;
use crate::kernel::ray_sphere::{Robust, SphereMethod};
use crate::lane::{Lane, Mask, Native};
use crate::math::{Hit, Ray, Vec3};
use crate::scene::Scene;
use rayon::prelude::*;

/// The bounding volume hierarchy, and the primitives of its leaves as intersection reads them.
pub struct Hierarchy {
    /// The trees.
    pub bvh: Bvh,
    /// What box tests are padded by.
    pub padding: Padding,
    triangles: TriangleLeaves,
    spheres: Vec<SphereLeaf>,
}

/// Up to [`LEAF`] spheres as a structure of arrays.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct SphereLeaf {
    center: [[f32; LEAF]; 3],
    /// Squared; negative where there is no sphere, so that no ray hits it.
    radius2: [f32; LEAF],
    primitives: Leaf,
}

/// Fewest leaves for another thread to fill.
const MIN_LEAVES_PER_THREAD: usize = 256;

/// The [`Padding`] of a scene's boxes, from the extent of all its primitives.
pub fn padding_of(scene: &Scene) -> Padding {
    let reach = |number| {
        let Bounds { lo, hi } = Bounds::of_primitive(scene.primitive(number));
        lo.abs().max(hi.abs()).max_element()
    };
    let padding = Padding::new((0..scene.primitives()).map(reach).fold(0.0, f32::max));
    if scene.spheres.is_empty() { padding } else { padding.with_spheres() }
}

impl Hierarchy {
    /// [`Trees::WideAndBinary`] for the scalar traversal, which alone reads the binary tree.
    pub fn new(scene: &Scene, trees: Trees) -> Self {
        Self::in_layout(scene, trees, None)
    }

    /// The same with the leaves of triangles in a given layout; `None` chooses by their size.
    pub fn in_layout(scene: &Scene, trees: Trees, layout: Option<Layout>) -> Self {
        let (bvh, padding) = rayon::join(|| Bvh::new(scene, trees), || padding_of(scene));
        let spheres = bvh.sphere_leaves.par_iter().with_min_len(MIN_LEAVES_PER_THREAD);
        Self {
            triangles: TriangleLeaves::new(scene, &bvh, layout),
            spheres: spheres.map(|leaf| SphereLeaf::new(scene, leaf)).collect(),
            padding,
            bvh,
        }
    }

    /// Bytes of nodes and leaves.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + self.triangles.bytes() + size_of_val(self.spheres.as_slice())
    }

    /// Number of primitives of a leaf.
    pub fn filled(&self, leaf: Child) -> usize {
        self.bvh.leaf(leaf).primitives().len()
    }

    /// One ray against all primitives of a leaf at once.
    #[inline(always)]
    pub fn intersect_leaf(&self, leaf: Child, ray: &SingleRay, hit: &mut Hit<f32>) {
        if leaf.is_spheres() {
            self.intersect_spheres(leaf.index(), &ray.ray, hit);
        } else {
            self.with_triangles(leaf.index(), |leaf| {
                leaf.accept(leaf.candidates(ray.woop.stored()), &ray.woop, &ray.box_ray, hit);
            });
        }
    }

    /// One ray against the spheres of a leaf at once.
    #[inline(never)]
    pub fn intersect_spheres(&self, leaf: usize, ray: &Ray<f32>, hit: &mut Hit<f32>) {
        self.spheres[leaf].intersect(ray, hit);
    }

    /// One ray against the primitives of a leaf, one after the other: for the scalar baseline.
    #[inline(always)]
    pub fn intersect_leaf_one_by_one(&self, leaf: Child, ray: &SingleRay, hit: &mut Hit<f32>) {
        if leaf.is_spheres() {
            let leaf = &self.spheres[leaf.index()];
            for (lane, &primitive) in leaf.primitives.primitives().iter().enumerate() {
                let (center, radius2) = leaf.sphere::<f32>(lane);
                let (mask, t) = Robust::test::<f32>(&ray.ray, center, radius2, inclusive(hit.t));
                keep_if_nearer(mask, primitive, [t, 0.0, 0.0], hit);
            }
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

    /// Fetches the cache lines of a node or of a leaf of triangles ahead of its visit. Leaves of spheres are
    /// few, and not fetched.
    #[inline(always)]
    pub fn prefetch(&self, child: Child) {
        if !child.is_leaf() {
            self.bvh.wide[child.index()].prefetch();
        } else if !child.is_spheres() {
            self.triangles.prefetch(child.index());
        }
    }

    /// A packet against the spheres of a leaf, one after the other.
    #[inline(never)]
    pub fn intersect_spheres_packet<L: Lane>(&self, leaf: usize, ray: &Ray<L>, hit: &mut Hit<L>) -> bool {
        let mut closer = false;
        let leaf = &self.spheres[leaf];
        let precalculated = Robust::precalculate(ray);
        for (lane, &primitive) in leaf.primitives.primitives().iter().enumerate() {
            let (center, radius2) = leaf.sphere::<L>(lane);
            let infinite = L::splat(f32::INFINITY);
            let (mask, t) = Robust::test::<L>(&precalculated, center, radius2, infinite);
            closer |= keep_if_nearer(mask, primitive, [t, L::zero(), L::zero()], hit);
        }
        closer
    }
}

impl SphereLeaf {
    fn new(scene: &Scene, leaf: &Leaf) -> Self {
        let mut stored = Self { center: [[0.0; LEAF]; 3], radius2: [-1.0; LEAF], primitives: *leaf };
        for (lane, &primitive) in leaf.primitives().iter().enumerate() {
            let crate::scene::Sphere { center, radius, .. } = scene.spheres[primitive as usize];
            (0..3).for_each(|axis| stored.center[axis][lane] = center[axis]);
            stored.radius2[lane] = radius * radius;
        }
        stored
    }

    /// Centre and squared radius of one sphere in all lanes.
    #[inline(always)]
    fn sphere<L: Lane>(&self, lane: usize) -> (Vec3<L>, L) {
        let [x, y, z] = &self.center;
        (Vec3::new(L::splat(x[lane]), L::splat(y[lane]), L::splat(z[lane])), L::splat(self.radius2[lane]))
    }

    /// One ray against the spheres, one a lane.
    #[inline(always)]
    fn intersect(&self, ray: &Ray<f32>, hit: &mut Hit<f32>) {
        let ray = Ray {
            origin: ray.origin.each_ref().broadcast(),
            direction: ray.direction.each_ref().broadcast(),
        };
        let [x, y, z] = &self.center;
        let center = Vec3::new(Native::load(x), Native::load(y), Native::load(z));
        let radius2 = Native::load(&self.radius2);
        let limit = Native::splat(inclusive(hit.t));
        let (mask, t) = Robust::test(&Robust::precalculate(&ray), center, radius2, limit);
        for lane in mask.lanes() {
            keep_if_nearer(true, self.primitives.primitives[lane], [t.get(lane), 0.0, 0.0], hit);
        }
    }
}
