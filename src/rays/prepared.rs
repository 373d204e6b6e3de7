//! Rays ready for boxes and triangles: what is computed once a ray or packet.

use crate::kernel::ray_box::{BoxRay, Padding};
use crate::kernel::ray_triangle::WoopRay;
use crate::lane::{Lane, Native};
use crate::math::{Ray, Vec3};

/// One ray, ready for boxes and triangles.
#[derive(Clone, Copy)]
pub struct SingleRay {
    /// The ray itself.
    pub ray: Ray<f32>,
    /// What box tests need of it.
    pub box_ray: BoxRay<f32>,
    /// What triangle tests need of it.
    pub woop: WoopRay<f32>,
}

impl SingleRay {
    /// Prepares a ray.
    #[inline(always)]
    pub fn new(ray: Ray<f32>, padding: Padding) -> Self {
        Self { ray, box_ray: BoxRay::new(&ray, padding), woop: WoopRay::new(&ray) }
    }
}

/// A packet of rays, ready for triangles.
pub struct Packet<L: Lane> {
    /// The rays themselves.
    pub ray: Ray<L>,
    pub(crate) woop: WoopRay<L>,
    /// See [`WoopRay::common_axis`].
    pub(crate) axis: Option<u32>,
    /// Computed for the first hit: many packets hit nothing.
    pub(crate) box_ray: Option<BoxRay<L>>,
}

impl<L: Lane> Packet<L> {
    /// Prepares a packet.
    #[inline(always)]
    pub fn new(ray: Ray<L>) -> Self {
        let woop = WoopRay::new(&ray);
        Self { ray, axis: woop.common_axis(), woop, box_ray: None }
    }
}

/// A ray broadcast to all lanes.
#[inline(always)]
pub(crate) fn splat_box_ray(box_ray: &BoxRay<f32>) -> BoxRay<Native> {
    let all = |v: &Vec3<f32>| v.each_ref().broadcast();
    BoxRay { inverse: all(&box_ray.inverse), near: all(&box_ray.near), far: all(&box_ray.far) }
}
