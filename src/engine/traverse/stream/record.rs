//! The prepared rays of a stream, and their octants.

use crate::kernel::ray_box::{Padding, Slabs};
use crate::kernel::ray_triangle::{TriangleMethod, Woop, WoopRay};
use crate::lane::{Bits, F32x8, Lane, U32x8};
use crate::math::{Hit, MISS, Ray, Vec3};
use crate::traverse::rays::Hits;
use bytemuck::{Pod, Zeroable};

/// A ray ready for boxes and triangles: one cache line.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct Record {
    /// The columns of [`Slabs`].
    pub inverse: [f32; 3],
    pub near: [f32; 3],
    pub far: [f32; 3],
    /// The distance of the nearest hit so far, at first the ray's t_max; −∞ once the ray is done.
    pub t: f32,
    /// The vectors of [`WoopRay`].
    origin: [f32; 3],
    shear: [f32; 3],
}

impl Record {
    /// Prepares eight rays: their records, the axes of their triangle tests, and their octants, one bit for
    /// each axis along which a ray runs backwards.
    #[inline(always)]
    pub fn of_packet(ray: &Ray<F32x8>, padding: Padding, t: F32x8) -> ([Self; 8], U32x8, U32x8) {
        let slabs = Slabs::new(ray, padding);
        // Differs from `< 0` only for −0, the inverse of an infinite direction: its product with any plane is
        // 0.
        let backwards = |inverse: F32x8, axis: u32| inverse.to_bits().shr(31).shl(axis);
        let Vec3 { x, y, z } = slabs.inverse;
        let octants = backwards(x, 0) | backwards(y, 1) | backwards(z, 2);
        let (axis, origin, shear) = Woop::prepare(ray).into_parts();
        let columns = [slabs.inverse, slabs.near, slabs.far, origin, shear].map(|v| [v.x, v.y, v.z]);
        let [[a, b, c], [d, e, f], [g, h, i], [j, k, l], [m, n, o]] = columns;
        let lanes = U32x8::from_fn(|lane| lane as u32);
        let transposed = |columns: [F32x8; 8]| F32x8::gather_rows::<8>(bytemuck::cast_slice(&columns), lanes);
        let (low, high) = (transposed([a, b, c, d, e, f, g, h]), transposed([i, t, j, k, l, m, n, o]));
        (std::array::from_fn(|lane| bytemuck::cast([low[lane], high[lane]])), axis, octants)
    }

    pub fn slabs(&self) -> Slabs<f32> {
        Slabs { inverse: vector(self.inverse), near: vector(self.near), far: vector(self.far) }
    }

    /// Stores the hit of the ray with this index in its batch.
    #[inline(always)]
    pub fn store_hit<const ANY: bool>(&mut self, ray: usize, hit: &Hit<f32>, hits: &mut Hits) {
        self.t = if ANY && hit.primitive != MISS { f32::NEG_INFINITY } else { hit.t };
        hits.set(ray, hit);
    }

    pub fn woop(&self, axis: u32) -> WoopRay<f32> {
        WoopRay::from_parts(axis, vector(self.origin), vector(self.shear))
    }
}

fn vector([x, y, z]: [f32; 3]) -> Vec3<f32> {
    Vec3::new(x, y, z)
}
