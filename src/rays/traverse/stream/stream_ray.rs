//! The stored form of a stream's rays, and their octants.

use crate::columns::Hits;
use crate::kernel::ray_box::{BoxRay, Padding};
use crate::kernel::ray_triangle::{StoredWoopRay, WoopRay};
use crate::lane::{Bits, F32x8, Lane, Mask, Native, NativeBits, U32x8};
use crate::math::{Hit, MISS, Ray, Vec3};
use bytemuck::{Pod, Zeroable};

/// Whether box tests order the two planes of an axis by their t, or by the ray's octant. AMD's processors,
/// which alone have SSE4a, order by t in few cycles, as integers, and load fewer vectors a cycle: the planes
/// stay in registers for all rays of a list. On other processors, the planes that the ray meets first and
/// second are loaded.
pub const ORDERS_BY_T: bool = cfg!(target_feature = "sse4a");

/// A ray prepared for boxes and triangles: one cache line.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct StreamRay {
    /// See [`BoxRay`].
    pub inverse: [f32; 3],
    /// [`BoxRay::near`] and [`BoxRay::far`]. With [`ORDERS_BY_T`] they are exchanged along axes on which the
    /// ray runs backwards, so that they belong to the lower and the upper planes of boxes.
    rest: [f32; 6],
    /// The distance of the nearest hit so far, initially the ray's t_max; −∞ once the ray is done.
    pub t: f32,
    /// The vectors of [`WoopRay`].
    origin: [f32; 3],
    shear: [f32; 3],
}

impl StreamRay {
    /// Prepares eight rays. Returns them, the axes of their triangle tests, and their octants, one bit for
    /// each axis along which a ray runs backwards.
    #[inline(always)]
    pub fn of_packet(ray: &Ray<F32x8>, padding: Padding, t: F32x8) -> ([Self; 8], U32x8, U32x8) {
        let BoxRay { inverse, near, far } = BoxRay::new(ray, padding);
        // It differs from a test for a negative direction only for −0, whose inverse has the sign too.
        let octants = [inverse.x, inverse.y, inverse.z].map(|inverse| inverse.to_bits().shr(31));
        let octants = octants[0] | octants[1].shl(1) | octants[2].shl(2);
        let (d, g) = in_other_order(inverse.x, near.x, far.x);
        let (e, h) = in_other_order(inverse.y, near.y, far.y);
        let (f, i) = in_other_order(inverse.z, near.z, far.z);
        let Vec3 { x: a, y: b, z: c } = inverse;
        let (axis, origin, shear) = WoopRay::new(ray).into_parts();
        let (Vec3 { x: j, y: k, z: l }, Vec3 { x: m, y: n, z: o }) = (origin, shear);
        let lanes = U32x8::from_fn(|lane| lane as u32);
        let transposed = |columns: [F32x8; 8]| F32x8::gather_rows::<8>(bytemuck::cast_slice(&columns), lanes);
        let (low, high) = (transposed([a, b, c, d, e, f, g, h]), transposed([i, t, j, k, l, m, n, o]));
        (std::array::from_fn(|lane| bytemuck::cast([low[lane], high[lane]])), axis, octants)
    }

    /// Returns the number at an index of `rest`, 0 to 5.
    #[inline(always)]
    pub fn rest(&self, place: usize) -> &f32 {
        // `rest` follows the three numbers of `inverse`; `& 15` drops the bounds check.
        let numbers: &[f32; 16] = bytemuck::cast_ref(self);
        &numbers[(3 + place) & 15]
    }

    #[inline(always)]
    pub fn box_ray(&self) -> BoxRay<f32> {
        let rest = |axis: usize| in_other_order(self.inverse[axis], self.rest[axis], self.rest[3 + axis]);
        let (x, y, z) = (rest(0), rest(1), rest(2));
        let (near, far) = (Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1));
        BoxRay { inverse: vector(self.inverse), near, far }
    }

    /// Returns rays, one per lane, in the forms of box and triangle tests, and the t of their hits so far.
    #[inline(always)]
    pub fn columns(
        stream_rays: &[Self],
        rays: NativeBits,
        axes: NativeBits,
    ) -> (BoxRay<Native>, WoopRay<Native>, Native) {
        // A stream ray is two rows.
        let rows: &[[f32; 8]] = bytemuck::cast_slice(stream_rays);
        let row = rays.shl(1);
        let [a, b, c, d, e, f, g, h] = Native::gather_rows::<8>(rows, row);
        let [i, t, j, k, l, m, n, o] = Native::gather_rows::<8>(rows, row | NativeBits::splat(1));
        let (x, y, z) = (in_other_order(a, d, g), in_other_order(b, e, h), in_other_order(c, f, i));
        let (near, far) = (Vec3::new(x.0, y.0, z.0), Vec3::new(x.1, y.1, z.1));
        let woop = WoopRay::from_parts(axes, Vec3::new(j, k, l), Vec3::new(m, n, o));
        (BoxRay { inverse: Vec3::new(a, b, c), near, far }, woop, t)
    }

    /// Stores the hit of the ray with this index in its batch.
    #[inline(always)]
    pub fn store_hit<const ANY: bool>(&mut self, ray: usize, hit: &Hit<f32>, hits: &mut Hits) {
        self.t = if ANY && hit.primitive != MISS { f32::NEG_INFINITY } else { hit.t };
        hits.set(ray, hit);
    }

    #[inline(always)]
    pub fn woop(&self, axis: u32) -> WoopRay<f32> {
        WoopRay::from_parts(axis, vector(self.origin), vector(self.shear))
    }
    /// Returns a reference to the ray in the form of triangle tests.
    #[inline(always)]
    pub fn stored_woop(&self, axis: u32) -> StoredWoopRay<'_> {
        let ([a, b, c], [x, y, z]) = (&self.origin, &self.shear);
        StoredWoopRay { z_axis: axis, origin: Vec3 { x: a, y: b, z: c }, shear: Vec3 { x, y, z } }
    }
}

/// Returns the numbers of an axis in the order of [`BoxRay`], near and far, from their order in `rest`; or
/// the other way round.
#[inline(always)]
fn in_other_order<L: Lane>(inverse: L, first: L, second: L) -> (L, L) {
    let exchanged = inverse.is_sign_negative() & Mask::splat(ORDERS_BY_T);
    (L::select(exchanged, second, first), L::select(exchanged, first, second))
}

fn vector([x, y, z]: [f32; 3]) -> Vec3<f32> {
    Vec3::new(x, y, z)
}
