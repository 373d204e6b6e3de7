//! Rays ready for boxes and triangles: what is computed once a ray or packet.

use crate::kernel::ray_box::{Padding, Slabs};
use crate::kernel::ray_triangle::{TriangleMethod, Woop, WoopRay};
use crate::lane::{F32x8, Lane};
use crate::math::{Ray, Vec3};

/// One ray, ready for boxes and triangles.
#[derive(Clone, Copy)]
pub struct SingleRay {
    /// The ray itself.
    pub ray: Ray<f32>,
    /// What box tests need of it.
    pub slabs: Slabs<f32>,
    /// What triangle tests need of it.
    pub woop: WoopRay<f32>,
}

impl SingleRay {
    /// Prepares a ray.
    #[inline(always)]
    pub fn new(ray: Ray<f32>, padding: Padding) -> Self {
        Self { ray, slabs: Slabs::new(&ray, padding), woop: Woop::prepare(&ray) }
    }
}

/// Eight rays, ready for triangles.
pub struct Packet {
    /// The rays themselves.
    pub ray: Ray<F32x8>,
    pub(super) woop: WoopRay<F32x8>,
    /// See [`WoopRay::common_axis`].
    pub(super) axis: Option<u32>,
    /// Computed for the first hit: many packets hit nothing.
    pub(super) slabs: Option<Slabs<F32x8>>,
}

impl Packet {
    /// Prepares eight rays.
    #[inline(always)]
    pub fn new(ray: Ray<F32x8>) -> Self {
        let woop = Woop::prepare(&ray);
        Self { ray, axis: woop.common_axis(), woop, slabs: None }
    }
}

/// A vector broadcast to all lanes.
#[inline(always)]
pub(super) fn splat_vector(v: Vec3<f32>) -> Vec3<F32x8> {
    Vec3::new(F32x8::splat(v.x), F32x8::splat(v.y), F32x8::splat(v.z))
}

/// A ray's slabs broadcast to all lanes.
#[inline(always)]
pub(super) fn splat_slabs(slabs: &Slabs<f32>) -> Slabs<F32x8> {
    let Slabs { inverse, near, far } = *slabs;
    let [inverse, near, far] = [inverse, near, far].map(splat_vector);
    Slabs { inverse, near, far }
}
