//! Rays prepared for box and triangle tests: the values that are computed once per ray or packet.

use crate::kernel::ray_box::{BoxRay, Padding};
use crate::kernel::ray_triangle::WoopRay;
use crate::lane::{Lane, Native};
use crate::math::{Ray, Vec3};

/// One ray, prepared for boxes and triangles.
#[derive(Clone, Copy)]
pub struct SingleRay {
    /// The ray itself.
    pub ray: Ray<f32>,
    /// The ray in the form that box tests read.
    pub box_ray: BoxRay<f32>,
    /// The ray in the form that triangle tests read.
    pub woop: WoopRay<f32>,
}

impl SingleRay {
    /// Prepares a ray.
    #[inline(always)]
    pub fn new(ray: Ray<f32>, padding: Padding) -> Self {
        Self { ray, box_ray: BoxRay::new(&ray, padding), woop: WoopRay::new(&ray) }
    }
}

/// A packet of rays, prepared for triangles.
pub struct Packet<L: Lane> {
    /// The rays themselves.
    pub ray: Ray<L>,
    pub(crate) woop: WoopRay<L>,
    /// See [`WoopRay::common_axis`].
    pub(crate) axis: Option<u32>,
    /// The ray for box tests, computed for the first hit: many packets hit nothing.
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

/// Returns a ray broadcast to all lanes.
#[inline(always)]
pub(crate) fn splat_box_ray(box_ray: &BoxRay<f32>) -> BoxRay<Native> {
    let all = |v: &Vec3<f32>| v.each_ref().broadcast();
    BoxRay { inverse: all(&box_ray.inverse), near: all(&box_ray.near), far: all(&box_ray.far) }
}
