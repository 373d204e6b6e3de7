//! Rays from points in single and double precision.

use crate::math::{Ray, Vec3};
use glam::DVec3;

/// Returns a ray of width one.
pub fn ray(origin: glam::Vec3, direction: glam::Vec3) -> Ray<f32> {
    Ray { origin: Vec3::splat(origin), direction: Vec3::splat(direction) }
}

/// Returns the ray of unit direction from a single-precision point through a double-precision one, which it
/// misses only by the rounding of its direction.
pub(crate) fn towards(origin: glam::Vec3, target: DVec3) -> Ray<f32> {
    ray(origin, (target - origin.as_dvec3()).normalize().as_vec3())
}

/// Returns origin and direction in f64, without rounding.
pub(crate) fn to_f64(ray: &Ray<f32>) -> (DVec3, DVec3) {
    (ray.origin.get(0).as_dvec3(), ray.direction.get(0).as_dvec3())
}
