//! Rays against triangles. Both sides of a triangle can be hit.
//!
//! Woop's watertight test: the vertices are transformed into a space where the ray is the z axis, and three
//! edge functions are compared with zero, edges included.
//!
//! The test is watertight because (1) a vertex is transformed to the same 2D point in every triangle that
//! shares it, and (2) an edge function is the difference of two rounded products, so that both triangles of
//! an edge compute exactly opposite numbers. For (2) the edge functions must not be contracted to FMA; the
//! shear may. An edge function that is exactly zero counts as inside, so both triangles may report the hit,
//! and none is lost.
//!
//! Departures from the paper: axes are not swapped to keep the winding (both sides count), there is no
//! fallback to double precision, and a packet orders the components of a vertex with one register permutation
//! each.
//!
//! Domain: lengths from 1e-12 to 1e12, because three of them are multiplied: triangles of 1e-15 are sometimes
//! missed or have a wrong t, and those of 1e15 are always missed.
//! Error: 0 leaks on edges and vertices (360,000 aimed rays each, `mesh-edges` and `mesh-vertices` of `octray
//! stability`); p99 relative error of t 8e-5 on slivers of aspect 10⁴ (`triangles-slivers`). Confirmed by
//! `tests/pictures/stability.rs`.
//! Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.

use crate::kernel::surface::triangle_bounds;
use crate::lane::{Bits, Lane, Mask, NATIVE_WIDTH, Native, NativeMask};
use crate::math::{Ray, Vec3};

/// The result of a triangle test: the lanes that hit, t, and the barycentrics of the second and third vertex.
/// The numbers are unspecified outside of `mask`.
#[derive(Clone, Copy, Debug)]
pub struct TriangleHit<L: Lane> {
    /// The lanes that hit.
    pub mask: L::Mask,
    /// The distance in multiples of the direction's length.
    pub t: L,
    /// The barycentric weight of the second vertex.
    pub u: L,
    /// The barycentric weight of the third vertex.
    pub v: L,
}

impl<L: Lane> TriangleHit<L> {
    /// Returns a miss in every lane.
    #[inline(always)]
    pub fn none(limit: L) -> Self {
        Self { mask: L::Mask::splat(false), t: limit, u: L::zero(), v: L::zero() }
    }
}

/// The result of testing a pair of triangles; each ray hits at most one of the two.
#[derive(Clone, Copy, Debug)]
pub struct PairHit<L: Lane> {
    /// The hits of either triangle.
    pub hit: TriangleHit<L>,
    /// The lanes that hit the second triangle.
    pub is_second: L::Mask,
}

/// A triangle as three rows of eight: each vertex as x y z x y, so that the components from any axis on are
/// in cyclic order and fit one register. The last three numbers of the first and second row are the corners
/// of the triangle's box; the sixth of the third row is 1 if the successor continues the triangle, else 0.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub struct WoopTriangle {
    rows: [[f32; 8]; 3],
}

/// The index in the third row of the flag that the successor continues the triangle.
const LINKED: usize = 5;

/// The space in which the ray is the z axis: an order of axes and a shear.
#[derive(Clone, Copy)]
pub struct WoopRay<L: Lane> {
    /// The axis, 0 to 2, along which the direction is longest, which becomes z. The next two, cyclically,
    /// become x and y.
    z_axis: L::Bits,
    /// The origin in that order of axes.
    origin: Vec3<L>,
    /// The shear of x and y per z, and −1 per z: the sheared vector is the origin relative to a vertex.
    shear: Vec3<L>,
}

impl<L: Lane> WoopRay<L> {
    /// Returns the axis that becomes z, the origin in the ray's order of axes, and the shear, to be stored.
    #[inline(always)]
    pub fn into_parts(self) -> (L::Bits, Vec3<L>, Vec3<L>) {
        (self.z_axis, self.origin, self.shear)
    }
    /// Restores a prepared ray from its stored parts.
    #[inline(always)]
    pub fn from_parts(z_axis: L::Bits, origin: Vec3<L>, shear: Vec3<L>) -> Self {
        Self { z_axis, origin, shear }
    }
    /// Prepares a ray for all triangles.
    ///
    /// Domain: direction lengths between 1e-15 and 1e15. A zero or NaN direction misses.
    #[inline(always)]
    pub fn new(ray: &Ray<L>) -> Self {
        let d = ray.direction;
        let (ax, ay, az) = (d.x.abs(), d.y.abs(), d.z.abs());
        let x_is_not = ax.lt(ay.max(az));
        let y_is_not = ay.lt(az);
        let order = |v: Vec3<L>| {
            let pick = |x: L, y: L, z: L| L::select(x_is_not, L::select(y_is_not, z, y), x);
            Vec3::new(pick(v.y, v.z, v.x), pick(v.z, v.x, v.y), pick(v.x, v.y, v.z))
        };
        let axis = |axis: u32| L::Bits::splat(axis);
        let z_axis = L::Bits::select(x_is_not, L::Bits::select(y_is_not, axis(2), axis(1)), axis(0));
        let direction = order(d);
        let inverse_z = L::one() / direction.z;
        let shear = Vec3::new(direction.x * inverse_z, direction.y * inverse_z, -inverse_z);
        Self { z_axis, origin: order(ray.origin), shear }
    }

    /// Returns a point in the ray's order of axes.
    #[inline(always)]
    pub fn in_order(&self, point: Vec3<L>) -> Vec3<L> {
        let is = |axis: u32| self.z_axis.equals(L::Bits::splat(axis));
        let (x, y) = (is(0), is(1));
        let pick = |of_x: L, of_y: L, of_z: L| L::select(x, of_x, L::select(y, of_y, of_z));
        let Vec3 { x, y, z } = point;
        Vec3::new(pick(y, z, x), pick(z, x, y), pick(x, y, z))
    }

    /// Returns a vertex in the ray's order of axes.
    #[inline(always)]
    fn vertex(&self, row: &[f32; 8]) -> Vec3<L> {
        let pick = |steps: u32| L::pick(row, self.z_axis.wrapping_add(L::Bits::splat(steps)));
        Vec3::new(pick(1), pick(2), pick(0))
    }

    #[inline(always)]
    fn vertices(&self, triangle: &WoopTriangle) -> [Vec3<L>; 3] {
        [self.vertex(&triangle.rows[0]), self.vertex(&triangle.rows[1]), self.vertex(&triangle.rows[2])]
    }

    /// Tests a triangle; returns `None` if no ray hits it. The caller compares the t of hits after clamping
    /// it to [`WoopTriangle::own_box`].
    #[inline(always)]
    pub fn test(&self, triangle: &WoopTriangle) -> Option<TriangleHit<L>> {
        crossing((self.origin, self.shear), self.vertices(triangle)).hit(self.shear)
    }

    /// Tests a linked triangle and its successor. Returns `None` if some ray may hit both, because it passes
    /// their common edge or they are degenerate: the caller then tests one after the other.
    ///
    /// The vertices that a, b, c and a, c, d share are transformed once. Each lane continues with the
    /// triangle that its line passes.
    #[inline(always)]
    pub fn test_pair(&self, [first, second]: [&WoopTriangle; 2]) -> Option<PairHit<L>> {
        let ([a, b, c], d) = (self.vertices(first), self.vertex(&second.rows[2]));
        let (a, b, c, d) = (self.origin - a, self.origin - b, self.origin - c, self.origin - d);
        let shear = |v| sheared(self.shear, v);
        let (pa, pb, pc, pd) = (shear(a), shear(b), shear(c), shear(d));
        let first = [edge_function(pc, pb), edge_function(pa, pc), edge_function(pb, pa)];
        // The last one is that of the first triangle with opposite sign, except for the sign of zeros.
        let second = [edge_function(pd, pc), edge_function(pa, pd), edge_function(pc, pa)];
        let (in_first, in_second) = (inside(first), inside(second));
        if (in_first & in_second).any() {
            return None;
        }
        let of = |first: L, second: L| L::select(in_second, second, first);
        let edges = [of(first[0], second[0]), of(first[1], second[1]), of(first[2], second[2])];
        let z = [a.z, of(b.z, c.z), of(c.z, d.z)];
        let found = Crossing::new(self.shear, in_first | in_second, z, edges).hit(self.shear);
        let hit = found.unwrap_or_else(|| TriangleHit::none(L::splat(f32::INFINITY)));
        Some(PairHit { hit, is_second: in_second })
    }
}

impl WoopTriangle {
    /// Stores a triangle, linked to no other.
    pub fn new(vertices: [glam::Vec3; 3]) -> Self {
        let ([a, b, c], [lo, hi]) = (vertices, triangle_bounds(vertices));
        let row = |v: glam::Vec3, rest: glam::Vec3| [v.x, v.y, v.z, v.x, v.y, rest.x, rest.y, rest.z];
        Self { rows: [row(a, lo), row(b, hi), row(c, glam::Vec3::ZERO)] }
    }

    /// Returns the lower and upper corner of the triangle's own box, to which hits are restricted
    /// ([`crate::kernel::ray_box::own_box`]). The order of tests therefore does not change the closest hit.
    #[inline(always)]
    pub fn own_box(&self) -> [glam::Vec3; 2] {
        let corner = |row: usize| {
            let [.., x, y, z] = self.rows[row];
            glam::Vec3::new(x, y, z)
        };
        [corner(0), corner(1)]
    }

    /// Links triangles to successors that continue them: a, b, c before a, c, d, as polygons are cut. No
    /// triangle belongs to two pairs.
    pub fn link_pairs(triangles: &mut [Self]) {
        let vertex = |triangle: &Self, row: usize| <[f32; 3]>::try_from(&triangle.rows[row][..3]).ok();
        let mut index = 1;
        while index < triangles.len() {
            let [first, second] = [&triangles[index - 1], &triangles[index]];
            let continues = vertex(first, 0) == vertex(second, 0) && vertex(first, 2) == vertex(second, 1);
            if continues {
                triangles[index - 1].rows[2][LINKED] = 1.0;
            }
            index += 1 + usize::from(continues);
        }
    }

    /// Tests whether the successor continues this triangle: then [`WoopRay::test_pair`] tests both.
    #[inline(always)]
    pub fn is_linked(&self) -> bool {
        self.rows[2][LINKED] != 0.0
    }
}

/// Applies Woop's test, up to the division, to rays given by origin and shear, and to triangles, all in the
/// rays' order of axes.
#[inline(always)]
fn crossing<L: Lane>((origin, shear): (Vec3<L>, Vec3<L>), [a, b, c]: [Vec3<L>; 3]) -> Crossing<L> {
    // Not the vertices relative to the origin: only the subtrahend can be read from memory by the subtraction
    // itself. The edge functions are the same.
    let (a, b, c) = (origin - a, origin - b, origin - c);
    let (pa, pb, pc) = (sheared(shear, a), sheared(shear, b), sheared(shear, c));
    let edges = [edge_function(pc, pb), edge_function(pa, pc), edge_function(pb, pa)];
    Crossing::new(shear, inside(edges), [a.z, b.z, c.z], edges)
}

/// Returns x and y of a vertex in the space of the ray. The vertex is subtracted and not the product: a
/// negated shear would be broadcast to the lanes once more.
#[inline(always)]
fn sheared<L: Lane>(shear: Vec3<L>, v: Vec3<L>) -> (L, L) {
    (shear.x.mul_add(v.z, -v.x), shear.y.mul_add(v.z, -v.y))
}

/// Returns the lanes whose edge functions have the same sign, zero included: their lines pass the triangle.
#[inline(always)]
fn inside<L: Lane>([u, v, w]: [L; 3]) -> L::Mask {
    let (least, most) = (u.min(v).min(w), u.max(v).max(w));
    L::zero().le(least) | most.le(L::zero())
}

/// The crossings of lines and triangles, before the division.
struct Crossing<L: Lane> {
    /// The lanes whose lines pass their triangle, not behind the origin. A few of them miss: their t is zero,
    /// infinite or NaN.
    ahead: L::Mask,
    /// The distance along z, times the determinant.
    z: L,
    /// The sum of the edge functions.
    determinant: L,
    /// The edge functions opposite to the second and the third vertex.
    v: L,
    w: L,
}

impl<L: Lane> Crossing<L> {
    /// Returns the crossings of the lanes that are `inside` their triangles. The arguments are the z of the
    /// origin relative to the vertices and the edge functions of the opposite edges.
    #[inline(always)]
    fn new(shear: Vec3<L>, inside: L::Mask, [az, bz, cz]: [L; 3], [u, v, w]: [L; 3]) -> Self {
        let determinant = u + v + w;
        let z = u.mul_add(az, v.mul_add(bz, w * cz));
        // A ray that leaves a surface has t < 0 with it. The sign of t needs no division: it is the sign of
        // the product, and comes from combining the sign bits.
        let sign = L::from_bits(z.to_bits() ^ determinant.to_bits() ^ shear.z.to_bits());
        Self { ahead: inside & !sign.is_sign_negative(), z, determinant, v, w }
    }

    /// Returns the hits, or `None` if no line passes its triangle ahead.
    #[inline(always)]
    fn hit(&self, shear: Vec3<L>) -> Option<TriangleHit<L>> {
        if !self.ahead.any() {
            return None;
        }
        // A zero determinant gives an infinite or NaN t, which the mask rejects.
        let inverse = L::one() / self.determinant;
        let t = self.z * shear.z * inverse;
        let mask = self.ahead & L::zero().lt(t) & t.lt(L::splat(f32::INFINITY));
        Some(TriangleHit { mask, t, u: self.v * inverse, v: self.w * inverse })
    }
}

/// Returns p.x q.y − p.y q.x as two rounded products: with mul_add, edges would leak.
#[inline(always)]
fn edge_function<L: Lane>(p: (L, L), q: (L, L)) -> L {
    p.0 * q.1 - p.1 * q.0
}

/// A block of as many triangles as one vector has lanes, in structure-of-arrays form: three vertices of three
/// components, NaN in unused lanes.
pub type TriangleBlock = [[[f32; NATIVE_WIDTH]; 3]; 3];

/// A reference to one stored [`WoopRay`], whose numbers a test reads straight into all lanes.
#[derive(Clone, Copy)]
pub struct StoredWoopRay<'a> {
    /// See [`WoopRay`].
    pub z_axis: u32,
    /// See [`WoopRay`].
    pub origin: Vec3<&'a f32>,
    /// See [`WoopRay`].
    pub shear: Vec3<&'a f32>,
}

impl StoredWoopRay<'_> {
    /// Returns the triangles of a block, one per lane, that the ray's line passes, not behind its origin.
    /// They include all that [`WoopRay::test_one`] hits, and few others.
    #[inline(always)]
    pub fn candidates(&self, triangles: &TriangleBlock) -> NativeMask {
        let [x, y, z] = ORDERS[(self.z_axis & 3) as usize];
        let row = |vertex: usize, axis: usize| Native::load(&triangles[vertex][axis]);
        let vertex = |vertex: usize| Vec3::new(row(vertex, x), row(vertex, y), row(vertex, z));
        let vertices = [vertex(0), vertex(1), vertex(2)];
        crossing((self.origin.broadcast(), self.shear.broadcast()), vertices).ahead
    }
}

impl WoopRay<f32> {
    /// Returns a reference to the stored ray.
    #[inline(always)]
    pub fn stored(&self) -> StoredWoopRay<'_> {
        StoredWoopRay { z_axis: self.z_axis, origin: self.origin.each_ref(), shear: self.shear.each_ref() }
    }

    /// Tests one ray against one triangle given by its vertices.
    #[inline(always)]
    pub fn test_one(&self, vertices: [Vec3<f32>; 3]) -> Option<TriangleHit<f32>> {
        let order = ORDERS[(self.z_axis & 3) as usize];
        let vertex = |v: Vec3<f32>| {
            let v = [v.x, v.y, v.z];
            Vec3::new(v[order[0]], v[order[1]], v[order[2]])
        };
        crossing((self.origin, self.shear), vertices.map(vertex)).hit(self.shear)
    }
}

impl<L: Lane> WoopRay<L> {
    /// Returns the axis that becomes z, if it is the same in all lanes.
    #[inline(always)]
    pub fn common_axis(&self) -> Option<u32> {
        let first = self.z_axis.get(0);
        self.z_axis.equals(L::Bits::splat(first)).all().then_some(first)
    }

    /// Tests each ray against the triangle of its lane, given by its vertices.
    #[inline(always)]
    pub fn test_each(&self, [a, b, c]: [Vec3<L>; 3]) -> Option<TriangleHit<L>> {
        let vertices = [self.in_order(a), self.in_order(b), self.in_order(c)];
        crossing((self.origin, self.shear), vertices).hit(self.shear)
    }

    /// Tests a packet whose rays all have the z axis `axis` against one triangle of a block.
    #[inline(always)]
    pub fn test_lane_along(
        &self,
        axis: u32,
        triangles: &TriangleBlock,
        lane: usize,
    ) -> Option<TriangleHit<L>> {
        self.crossing_along(axis, triangles, lane).hit(self.shear)
    }

    /// Tests whether the line of any of these rays passes the triangle, not behind the origin. The result is
    /// true wherever [`WoopRay::test_lane_along`] finds a hit, and seldom elsewhere.
    #[inline(always)]
    pub fn is_lane_candidate(&self, axis: u32, triangles: &TriangleBlock, lane: usize) -> bool {
        self.crossing_along(axis, triangles, lane).ahead.any()
    }

    #[inline(always)]
    fn crossing_along(&self, axis: u32, triangles: &TriangleBlock, lane: usize) -> Crossing<L> {
        let [x, y, z] = ORDERS[(axis & 3) as usize];
        let lane = lane & (NATIVE_WIDTH - 1);
        let vertex = |rows: &[[f32; NATIVE_WIDTH]; 3]| {
            Vec3::new(L::splat(rows[x][lane]), L::splat(rows[y][lane]), L::splat(rows[z][lane]))
        };
        let [a, b, c] = triangles;
        crossing((self.origin, self.shear), [vertex(a), vertex(b), vertex(c)])
    }
}

/// The axes that become x, y and z, indexed by the axis that becomes z. It has four entries, so that `& 3`
/// removes the bounds check.
pub(crate) const ORDERS: [[usize; 3]; 4] = [[1, 2, 0], [2, 0, 1], [0, 1, 2], [0, 1, 2]];
