//! The primitives in the leaves of a hierarchy, and the intersection of rays with a leaf, shared by all
//! traversals.

use super::prepared::{Packet, SingleRay, splat_slabs, splat_vector};
use crate::buffers::SphereBlock;
use crate::bvh::{Bounds, Bvh, Child, LEAF, Leaf, Trees};
use crate::kernel::ray_box::{Padding, Slabs, own_box};
use crate::kernel::ray_sphere::{Robust, SphereMethod};
use crate::kernel::ray_triangle::{EightTriangles, TriangleHit, WoopRay};
use crate::lane::{Bits, F32x8, Lane, Mask, Mask8, U32x8};
use crate::math::{Hit, Ray, Vec3};
use crate::scene::Scene;
use rayon::prelude::*;

/// The bounding volume hierarchy, and the primitives of its leaves as intersection reads them.
pub struct Hierarchy {
    pub bvh: Bvh,
    pub padding: Padding,
    triangles: Vec<TriangleLeaf>,
    spheres: Vec<SphereLeaf>,
}

/// Up to eight triangles: 320 bytes.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct TriangleLeaf {
    vertices: EightTriangles,
    primitives: Leaf,
}

/// Up to eight spheres.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct SphereLeaf {
    spheres: SphereBlock,
    primitives: Leaf,
}

/// Fewest leaves for another thread to fill.
const MIN_LEAVES_PER_THREAD: usize = 256;

/// The [`Padding`] of a scene's boxes, from the extent of all its primitives.
pub fn padding_of(scene: &Scene) -> Padding {
    let vertices = scene.triangles.iter().flat_map(|triangle| triangle.vertices);
    let of_triangles = vertices.map(|vertex| vertex.abs().max_element()).fold(0.0, f32::max);
    let corner = |sphere: &crate::scene::Sphere| {
        let Bounds { lo, hi } = Bounds::of_sphere(sphere.center, sphere.radius);
        lo.abs().max(hi.abs()).max_element()
    };
    let padding = Padding::new(scene.spheres.iter().map(corner).fold(of_triangles, f32::max));
    if scene.spheres.is_empty() { padding } else { padding.with_spheres() }
}

impl Hierarchy {
    /// [`Trees::WideAndBinary`] for the scalar traversal, which alone reads the binary tree.
    pub fn new(scene: &Scene, trees: Trees) -> Self {
        let (bvh, padding) = rayon::join(|| Bvh::new(scene, trees), || padding_of(scene));
        let first_triangle = scene.spheres.len();
        let triangle_leaf = |leaf: &Leaf| {
            let mut vertices = [[[f32::NAN; LEAF]; 3]; 3];
            for (lane, &primitive) in leaf.primitives().iter().enumerate() {
                let corners = scene.triangles[primitive as usize - first_triangle].vertices;
                let components = corners.iter().flat_map(|corner| corner.to_array());
                vertices
                    .iter_mut()
                    .flatten()
                    .zip(components)
                    .for_each(|(row, component)| row[lane] = component);
            }
            TriangleLeaf { vertices, primitives: *leaf }
        };
        let sphere_leaf = |leaf: &Leaf| {
            let spheres = leaf.primitives().iter().map(|&primitive| &scene.spheres[primitive as usize]);
            SphereLeaf { spheres: SphereBlock::new(spheres), primitives: *leaf }
        };
        let (triangles, spheres) = (bvh.triangle_leaves.par_iter(), bvh.sphere_leaves.par_iter());
        Self {
            triangles: triangles.with_min_len(MIN_LEAVES_PER_THREAD).map(triangle_leaf).collect(),
            spheres: spheres.with_min_len(MIN_LEAVES_PER_THREAD).map(sphere_leaf).collect(),
            padding,
            bvh,
        }
    }

    /// Bytes of nodes and leaves.
    pub fn bytes(&self) -> usize {
        self.bvh.bytes() + size_of_val(self.triangles.as_slice()) + size_of_val(self.spheres.as_slice())
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
            let leaf = &self.triangles[leaf.index()];
            if let Some(found) = leaf.test(&ray.woop) {
                leaf.accept(&ray.slabs, &found, hit);
            }
        }
    }

    /// One ray against up to eight spheres.
    #[inline(never)]
    pub fn intersect_spheres(&self, leaf: usize, ray: &Ray<f32>, hit: &mut Hit<f32>) {
        let leaf = &self.spheres[leaf];
        let ray = Ray { origin: splat_vector(ray.origin), direction: splat_vector(ray.direction) };
        for (center, radius2) in leaf.spheres.lanes::<F32x8>() {
            let limit = F32x8::splat(inclusive(hit.t));
            let (mask, t) = Robust::test::<F32x8>(&Robust::prepare(&ray), center, radius2, limit);
            let none = F32x8::zero();
            keep_nearest(mask, &leaf.primitives.primitives, [t, none, none], hit);
        }
    }

    /// One ray against the primitives of a leaf, one after the other: for the scalar baseline.
    #[inline(always)]
    pub fn intersect_leaf_one_by_one(&self, leaf: Child, ray: &SingleRay, hit: &mut Hit<f32>) {
        if leaf.is_spheres() {
            let leaf = &self.spheres[leaf.index()];
            for (lane, &primitive) in leaf.primitives.primitives().iter().enumerate() {
                let (center, radius2) = leaf.spheres.splat::<f32>(lane);
                let (mask, t) = Robust::test::<f32>(&ray.ray, center, radius2, inclusive(hit.t));
                keep_if_nearer(mask, primitive, [t, 0.0, 0.0], hit);
            }
        } else {
            let leaf = &self.triangles[leaf.index()];
            for (lane, &primitive) in leaf.primitives.primitives().iter().enumerate() {
                let corners = leaf.corners(lane).map(|[x, y, z]| Vec3::new(x, y, z));
                if let Some(found) = ray.woop.test_one(corners) {
                    let (mask, t) =
                        own_box(&ray.slabs, box_of(corners), found.mask, found.t, inclusive(hit.t));
                    keep_if_nearer(mask, primitive, [t, found.u, found.v], hit);
                }
            }
        }
    }

    #[inline(always)]
    pub fn triangle_leaf(&self, leaf: usize) -> &TriangleLeaf {
        &self.triangles[leaf]
    }

    /// A packet against up to eight spheres, one after the other.
    #[inline(never)]
    pub fn intersect_spheres_packet(&self, leaf: usize, ray: &Ray<F32x8>, hit: &mut Hit<F32x8>) -> bool {
        let mut closer = false;
        let leaf = &self.spheres[leaf];
        let prepared = Robust::prepare(ray);
        for (lane, &primitive) in leaf.primitives.primitives().iter().enumerate() {
            let (center, radius2) = leaf.spheres.splat::<F32x8>(lane);
            let infinite = F32x8::splat(f32::INFINITY);
            let (mask, t) = Robust::test::<F32x8>(&prepared, center, radius2, infinite);
            closer |= keep_lanes_if_nearer(mask, primitive, [t, F32x8::zero(), F32x8::zero()], hit);
        }
        closer
    }
}

/// The limit that lets hits at `t` itself pass: among equal distances the lowest number wins, in any order of
/// tests.
#[inline(always)]
fn inclusive(t: f32) -> f32 {
    // Not next_up: its special cases would cost branches. t is positive, or −∞ for rays that are done.
    if (0.0..f32::INFINITY).contains(&t) { f32::from_bits(t.to_bits() + 1) } else { t }
}

/// Lower and upper corner of the box of a triangle: exact. [`Bounds::of_triangle`] over lanes.
#[inline(always)]
fn box_of<L: Lane>([a, b, c]: [Vec3<L>; 3]) -> (Vec3<L>, Vec3<L>) {
    let [x, y, z] = [[a.x, b.x, c.x], [a.y, b.y, c.y], [a.z, b.z, c.z]].map(extent_along);
    (Vec3::new(x[0], y[0], z[0]), Vec3::new(x[1], y[1], z[1]))
}

/// The least and the greatest coordinate of a triangle along one axis.
#[inline(always)]
fn extent_along<L: Lane>([a, b, c]: [L; 3]) -> [L; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

/// [`keep_if_nearer`] in each lane; whether any lane kept it.
#[inline(always)]
fn keep_lanes_if_nearer(mask: Mask8, primitive: u32, [t, u, v]: [F32x8; 3], hit: &mut Hit<F32x8>) -> bool {
    let number = U32x8::splat(primitive);
    let one = U32x8::splat(1);
    let lower = number.wrapping_add(one).less(hit.primitive.wrapping_add(one));
    let nearer = mask & (t.lt(hit.t) | (t.eq(hit.t) & lower));
    hit.t = F32x8::select(nearer, t, hit.t);
    hit.primitive = U32x8::select(nearer, number, hit.primitive);
    hit.u = F32x8::select(nearer, u, hit.u);
    hit.v = F32x8::select(nearer, v, hit.v);
    nearer.any()
}

impl TriangleLeaf {
    /// The lower and the upper planes of the triangles' boxes along an axis; NaN where there is no triangle.
    #[inline(always)]
    pub fn planes(&self, axis: usize) -> [F32x8; 2] {
        extent_along(self.vertices.each_ref().map(|vertex| F32x8::load(&vertex[axis])))
    }

    /// One ray against all of them; [`TriangleLeaf::accept`] then applies the rule of the own box to what is
    /// found.
    #[inline(always)]
    pub fn test(&self, woop: &WoopRay<f32>) -> Option<TriangleHit<F32x8>> {
        woop.test_eight(&self.vertices)
    }

    #[inline(always)]
    fn corners(&self, lane: usize) -> [[f32; 3]; 3] {
        self.vertices.each_ref().map(|vertex| vertex.each_ref().map(|row| row[lane & 7]))
    }

    /// A packet against one of the triangles; whether any ray found a nearer hit.
    #[inline(always)]
    pub fn intersect_packet(
        &self,
        lane: usize,
        padding: Padding,
        packet: &mut Packet,
        hit: &mut Hit<F32x8>,
    ) -> bool {
        let found = match packet.axis {
            Some(axis) => packet.woop.test_lane_along(axis, &self.vertices, lane),
            None => packet.woop.test_corners(self.corners(lane)),
        };
        found.is_some_and(|found| self.accept_lanes(lane, padding, packet, &found, hit))
    }

    /// Applies the rule of the own box to a packet's hits and keeps those that are nearer. Out of line: the
    /// calling loop stays in registers.
    #[inline(never)]
    fn accept_lanes(
        &self,
        lane: usize,
        padding: Padding,
        packet: &mut Packet,
        found: &TriangleHit<F32x8>,
        hit: &mut Hit<F32x8>,
    ) -> bool {
        let infinite = F32x8::splat(f32::INFINITY);
        let splat = |[x, y, z]: [f32; 3]| Vec3::new(F32x8::splat(x), F32x8::splat(y), F32x8::splat(z));
        let slabs = packet.slabs.get_or_insert_with(|| Slabs::new(&packet.ray, padding));
        let (mask, t) = own_box(slabs, box_of(self.corners(lane).map(splat)), found.mask, found.t, infinite);
        keep_lanes_if_nearer(mask, self.primitives.primitives[lane & 7], [t, found.u, found.v], hit)
    }

    /// Applies the rule of the own box to a ray's hits and keeps the nearest. Rare and out of line: the
    /// calling loops stay in registers.
    #[cold]
    #[inline(never)]
    pub fn accept(&self, slabs: &Slabs<f32>, found: &TriangleHit<F32x8>, hit: &mut Hit<f32>) {
        let vertex = |[x, y, z]: &[[f32; LEAF]; 3]| Vec3::new(F32x8::load(x), F32x8::load(y), F32x8::load(z));
        let slabs = splat_slabs(slabs);
        let limit = F32x8::splat(inclusive(hit.t));
        let corners = box_of(self.vertices.each_ref().map(vertex));
        let (mask, t) = own_box(&slabs, corners, found.mask, found.t, limit);
        keep_nearest(mask, &self.primitives.primitives, [t, found.u, found.v], hit);
    }
}

/// Keeps a hit that is nearer, or as near and of a lower number.
#[inline(always)]
fn keep_if_nearer(mask: bool, primitive: u32, [t, u, v]: [f32; 3], hit: &mut Hit<f32>) {
    // MISS is the largest number: plus one it is 0, below every other, so that a hit at t_max itself is none.
    let lower = primitive.wrapping_add(1) < hit.primitive.wrapping_add(1);
    if mask && (t < hit.t || (t == hit.t && lower)) {
        *hit = Hit { t, primitive, u, v };
    }
}

/// Keeps the nearest hit of the lanes in `mask`.
#[inline(always)]
fn keep_nearest(mask: Mask8, primitives: &[u32; LEAF], [t, u, v]: [F32x8; 3], hit: &mut Hit<f32>) {
    for lane in mask.lanes() {
        keep_if_nearer(true, primitives[lane], [t, u, v].map(|column| column.get(lane)), hit);
    }
}
