//! What a stream keeps of its rays.

use crate::kernel::ray_box::{Padding, Slabs};
use crate::kernel::ray_triangle::{TriangleMethod, Woop, WoopRay};
use crate::lane::{Bits, F32x8, Lane, Mask, Mask8, U32x8};
use crate::math::{Hit, MISS, Ray, Vec3};
use crate::traverse::rays::Hits;
use bytemuck::{Pod, Zeroable};

/// What boxes and triangles want of a ray: one cache line.
#[derive(Clone, Copy, Pod, Zeroable)]
#[repr(C, align(64))]
pub struct Record {
    /// As [`Slabs`] names them.
    pub inverse: [f32; 3],
    pub near: [f32; 3],
    pub far: [f32; 3],
    /// Found so far; how far the ray reaches, and −∞ where it wants nothing more.
    pub t: f32,
    /// As [`WoopRay`] keeps them.
    origin: [f32; 3],
    shear: [f32; 3],
}

impl Record {
    /// Eight rays made ready: their records, and the axes of their triangle tests. `octant` takes note of where they run.
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
        let turned = |columns: [F32x8; 8]| F32x8::gather_rows::<8>(bytemuck::cast_slice(&columns), lanes);
        let (low, high) = (turned([a, b, c, d, e, f, g, h]), turned([i, t, j, k, l, m, n, o]));
        (std::array::from_fn(|lane| bytemuck::cast([low[lane], high[lane]])), axis)
    }

    pub fn slabs(&self) -> Slabs<f32> {
        Slabs { inverse: vector(self.inverse), near: vector(self.near), far: vector(self.far) }
    }

    /// Notes what the ray, at this place of its batch, has found.
    #[inline(always)]
    pub fn keep<const ANY: bool>(&mut self, ray: usize, hit: &Hit<f32>, hits: &mut Hits) {
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
/// In the place of an octant: more than one.
pub const MIXED: usize = OCTANTS;

/// The octant that rays run into, as long as they agree.
pub struct Octant {
    /// For each axis, the lanes in which all rays so far run backwards along it.
    all: [Mask8; 3],
    /// And those in which any does.
    any: [Mask8; 3],
}

impl Default for Octant {
    fn default() -> Self {
        Self { all: [Mask8::splat(true); 3], any: [Mask8::splat(false); 3] }
    }
}

impl Octant {
    /// Eight more rays, by [`Slabs::inverse`].
    #[inline(always)]
    fn add(&mut self, inverse: Vec3<F32x8>) {
        for (axis, inverse) in [inverse.x, inverse.y, inverse.z].into_iter().enumerate() {
            let backwards = inverse.is_sign_negative();
            self.all[axis] = self.all[axis] & backwards;
            self.any[axis] = self.any[axis] | backwards;
        }
    }

    /// A bit for each axis along which all rays run backwards; [`MIXED`] where they do not agree.
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
