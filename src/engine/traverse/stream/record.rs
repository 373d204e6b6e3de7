//! The prepared rays of a stream, and their octants.

use crate::kernel::ray_box::{Padding, Slabs};
use crate::kernel::ray_triangle::{TriangleMethod, Woop, WoopRay};
use crate::lane::{Bits, F32x8, Lane, Mask, Mask8, U32x8};
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
    /// Prepares eight rays: their records, and the axes of their triangle tests. Adds them to `octant`.
    #[inline(always)]
    pub fn of_packet(
        ray: &Ray<F32x8>,
        padding: Padding,
        t: F32x8,
        octant: &mut Octant,
    ) -> ([Self; 8], U32x8) {
        let slabs = Slabs::new(ray, padding);
        octant.add(slabs.inverse);
        let (axis, origin, shear) = Woop::prepare(ray).into_parts();
        let columns = [slabs.inverse, slabs.near, slabs.far, origin, shear].map(|v| [v.x, v.y, v.z]);
        let [[a, b, c], [d, e, f], [g, h, i], [j, k, l], [m, n, o]] = columns;
        let lanes = U32x8::from_fn(|lane| lane as u32);
        let transposed = |columns: [F32x8; 8]| F32x8::gather_rows::<8>(bytemuck::cast_slice(&columns), lanes);
        let (low, high) = (transposed([a, b, c, d, e, f, g, h]), transposed([i, t, j, k, l, m, n, o]));
        (std::array::from_fn(|lane| bytemuck::cast([low[lane], high[lane]])), axis)
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

pub const OCTANTS: usize = 8;
/// In the place of an octant: rays of more than one.
pub const MIXED: usize = OCTANTS;

/// The octant that all rays run into, if it is one.
pub struct Octant {
    /// For each axis, the lanes in which all rays added so far run backwards along it.
    all: [Mask8; 3],
    /// The lanes in which any ray does.
    any: [Mask8; 3],
}

impl Default for Octant {
    fn default() -> Self {
        Self { all: [Mask8::splat(true); 3], any: [Mask8::splat(false); 3] }
    }
}

impl Octant {
    /// Adds eight rays, given by [`Slabs::inverse`].
    #[inline(always)]
    fn add(&mut self, inverse: Vec3<F32x8>) {
        for (axis, inverse) in [inverse.x, inverse.y, inverse.z].into_iter().enumerate() {
            let backwards = inverse.is_sign_negative();
            self.all[axis] = self.all[axis] & backwards;
            self.any[axis] = self.any[axis] | backwards;
        }
    }

    /// One bit for each axis along which all rays run backwards; [`MIXED`] where they run into several
    /// octants.
    pub fn index(&self) -> usize {
        let (all, any) = (self.all.map(Mask::all), self.any.map(Mask::any));
        if all == any { (0..3).map(|axis| usize::from(all[axis]) << axis).sum() } else { MIXED }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The octant of eight rays and then eight more, where those of the second packet differ in one lane.
    fn octant(first: [f32; 3], odd: [f32; 3]) -> usize {
        let mut octant = Octant::default();
        let packet = |lane: [f32; 3]| {
            let [x, y, z] = std::array::from_fn(|axis| {
                F32x8::from_fn(|at| if at == 5 { lane[axis] } else { first[axis] })
            });
            Vec3::new(x, y, z)
        };
        octant.add(packet(first));
        octant.add(packet(odd));
        octant.index()
    }

    #[test]
    fn rays_agree_on_an_octant_or_are_mixed() {
        for index in 0..OCTANTS {
            let ray = [0, 1, 2].map(|axis| if index >> axis & 1 == 1 { -2.0 } else { 3.0 });
            assert_eq!(octant(ray, ray), index);
            for axis in 0..3 {
                let mut odd = ray;
                odd[axis] = -odd[axis];
                assert_eq!(octant(ray, odd), MIXED, "{ray:?} and {odd:?}");
            }
        }
    }
}
