//! Rays ready for boxes and triangles: what is computed once a ray or packet.

use crate::kernel::ray_box::{Padding, Slabs};
use crate::kernel::ray_triangle::{TriangleMethod, Woop, WoopRay};
use crate::lane::{Lane, Native};
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

/// A packet of rays, ready for triangles.
pub struct Packet<L: Lane> {
    /// The rays themselves.
    pub ray: Ray<L>,
    pub(super) woop: WoopRay<L>,
    /// See [`WoopRay::common_axis`].
    pub(super) axis: Option<u32>,
    /// Computed for the first hit: many packets hit nothing.
    pub(super) slabs: Option<Slabs<L>>,
}

impl<L: Lane> Packet<L> {
    /// Prepares a packet.
    #[inline(always)]
    pub fn new(ray: Ray<L>) -> Self {
        let woop = Woop::prepare(&ray);
        Self { ray, axis: woop.common_axis(), woop, slabs: None }
    }
}

/// A ray's slabs broadcast to all lanes.
#[inline(always)]
pub(super) fn splat_slabs(slabs: &Slabs<f32>) -> Slabs<Native> {
    let all = |v: &Vec3<f32>| v.each_ref().broadcast();
    Slabs { inverse: all(&slabs.inverse), near: all(&slabs.near), far: all(&slabs.far) }
}
