//! Intersects rays with the triangles of a leaf.

use crate::kernel::ray_box::{BoxRay, Padding, own_box};
use crate::kernel::ray_triangle::{StoredWoopRay, TriangleBlock, TriangleHit, WoopRay};
use crate::kind::{LEAF, Leaf, inclusive, keep_if_nearer};
use crate::lane::{Lane, Mask, Native, set_bits};
use crate::math::{Hit, Vec3};
use crate::prepared::Packet;

/// Up to [`LEAF`] triangles, 40 bytes each.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
pub struct TriangleLeaf {
    pub(crate) vertices: TriangleBlock,
    pub(crate) primitives: Leaf,
}

/// Returns the exact lower and upper corner of a triangle's box: [`crate::kernel::surface::triangle_bounds`]
/// over lanes.
#[inline(always)]
pub fn box_of<L: Lane>([a, b, c]: [Vec3<L>; 3]) -> (Vec3<L>, Vec3<L>) {
    let x = extent_along([a.x, b.x, c.x]);
    let y = extent_along([a.y, b.y, c.y]);
    let z = extent_along([a.z, b.z, c.z]);
    (Vec3::new(x[0], y[0], z[0]), Vec3::new(x[1], y[1], z[1]))
}

/// Returns the least and the greatest coordinate of a triangle along one axis.
#[inline(always)]
fn extent_along<L: Lane>([a, b, c]: [L; 3]) -> [L; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

impl TriangleLeaf {
    /// A leaf without triangles.
    pub(crate) const EMPTY: Self =
        Self { vertices: [[[f32::NAN; LEAF]; 3]; 3], primitives: Leaf { primitives: [Leaf::NONE; LEAF] } };

    /// Returns the lower and upper planes of the triangles' boxes along an axis; NaN in unused lanes.
    #[inline(always)]
    pub fn planes(&self, axis: usize) -> [Native; 2] {
        let [a, b, c] = &self.vertices;
        extent_along([Native::load(&a[axis]), Native::load(&b[axis]), Native::load(&c[axis])])
    }

    /// Returns the triangles, one bit each, that a ray's line passes, not behind its origin. They include all
    /// that the ray hits, and few others.
    #[inline(always)]
    pub fn candidates(&self, woop: StoredWoopRay) -> u32 {
        woop.candidates(&self.vertices).bitmask()
    }

    /// Keeps a ray's nearest hit with the triangles whose bits are set: none or one triangle, seldom two.
    #[inline(always)]
    pub fn accept(&self, candidates: u32, woop: &WoopRay<f32>, box_ray: &BoxRay<f32>, hit: &mut Hit<f32>) {
        for lane in set_bits(candidates) {
            let primitive = self.primitives.primitives[lane & (LEAF - 1)];
            intersect_one(self.corners(lane), primitive, woop, box_ray, hit);
        }
    }

    /// Calls `visit` with the hits of a ray with the triangles whose bits are set.
    #[inline(always)]
    pub fn visit(
        &self,
        candidates: u32,
        (woop, box_ray): (&WoopRay<f32>, &BoxRay<f32>),
        visit: &mut impl FnMut(Hit<f32>),
    ) {
        for lane in set_bits(candidates) {
            let corners = self.corners(lane).map(|[x, y, z]| Vec3::new(x, y, z));
            if let Some(found) = woop.test_one(corners) {
                let primitive = self.primitives.primitives[lane & (LEAF - 1)];
                visit_found(&found, box_of(corners), primitive, box_ray, visit);
            }
        }
    }

    #[inline(always)]
    pub(crate) fn corners(&self, lane: usize) -> [[f32; 3]; 3] {
        self.vertices.each_ref().map(|vertex| vertex.each_ref().map(|row| row[lane & (LEAF - 1)]))
    }

    /// Returns the triangles of `lanes`, one bit each, that the line of any of a packet's rays passes, not
    /// behind its origin; returns `lanes` if the rays have different z axes.
    #[inline(always)]
    pub fn candidates_of_packet<L: Lane>(&self, lanes: u32, packet: &Packet<L>) -> u32 {
        let Some(axis) = packet.axis else { return lanes };
        set_bits(lanes).fold(0, |candidates, lane| {
            candidates | u32::from(packet.woop.is_lane_candidate(axis, &self.vertices, lane)) << lane
        })
    }

    /// Keeps the nearest hits of a packet's rays with one of the triangles. Returns whether any hit was
    /// nearer. Out of line, so that the calling loop stays in registers.
    #[inline(never)]
    pub fn accept_packet<L: Lane>(
        &self,
        lane: usize,
        padding: Padding,
        packet: &mut Packet<L>,
        hit: &mut Hit<L>,
    ) -> bool {
        let Some(axis) = packet.axis else { return self.accept_packet_of_axes(lane, padding, packet, hit) };
        let found = packet.woop.test_lane_along(axis, &self.vertices, lane);
        found.is_some_and(|found| self.keep(lane, &found, padding, packet, hit))
    }

    /// Runs [`TriangleLeaf::accept_packet`] on different z axes. Few packets have them, and this test
    /// would take registers from the other.
    #[cold]
    #[inline(never)]
    fn accept_packet_of_axes<L: Lane>(
        &self,
        lane: usize,
        padding: Padding,
        packet: &mut Packet<L>,
        hit: &mut Hit<L>,
    ) -> bool {
        let found = packet.woop.test_each(self.corners_in_all_lanes(lane));
        found.is_some_and(|found| self.keep(lane, &found, padding, packet, hit))
    }

    #[inline(always)]
    fn corners_in_all_lanes<L: Lane>(&self, lane: usize) -> [Vec3<L>; 3] {
        // Not array::map: for vectors of sixteen it would be a call.
        let splat = |[x, y, z]: [f32; 3]| Vec3::new(L::splat(x), L::splat(y), L::splat(z));
        let [a, b, c] = self.corners(lane);
        [splat(a), splat(b), splat(c)]
    }

    /// Keeps a packet's hits with one of the triangles where they are nearer. Returns whether any was.
    #[inline(always)]
    fn keep<L: Lane>(
        &self,
        lane: usize,
        found: &TriangleHit<L>,
        padding: Padding,
        packet: &mut Packet<L>,
        hit: &mut Hit<L>,
    ) -> bool {
        let box_ray = packet.box_ray.get_or_insert_with(|| BoxRay::new(&packet.ray, padding));
        let (bounds, infinite) = (box_of(self.corners_in_all_lanes(lane)), L::splat(f32::INFINITY));
        let (mask, t) = own_box(box_ray, bounds, found.mask, found.t, infinite);
        keep_if_nearer(mask, self.primitives.primitives[lane & (LEAF - 1)], [t, found.u, found.v], hit)
    }
}

/// Calls `visit` with a hit that obeys the rule of the own box.
pub(super) fn visit_found(
    found: &TriangleHit<f32>,
    bounds: (Vec3<f32>, Vec3<f32>),
    primitive: u32,
    box_ray: &BoxRay<f32>,
    visit: &mut impl FnMut(Hit<f32>),
) {
    let (is_hit, t) = own_box(box_ray, bounds, found.mask, found.t, f32::INFINITY);
    if is_hit {
        visit(Hit { t, primitive, u: found.u, v: found.v });
    }
}

/// Tests one ray against one triangle given by its corners, with the rule of the own box.
#[inline(always)]
pub fn intersect_one(
    corners: [[f32; 3]; 3],
    primitive: u32,
    woop: &WoopRay<f32>,
    box_ray: &BoxRay<f32>,
    hit: &mut Hit<f32>,
) {
    let corners = corners.map(|[x, y, z]| Vec3::new(x, y, z));
    if let Some(found) = woop.test_one(corners) {
        let (mask, t) = own_box(box_ray, box_of(corners), found.mask, found.t, inclusive(hit.t));
        keep_if_nearer(mask, primitive, [t, found.u, found.v], hit);
    }
}
