//! Rays made of points in single and double precision.
//!
//! For: [`ray`], [`towards`], [`packet`]. May import: `lane`, `math`. Must never know: what the rays are aimed at.

use crate::lane::Lane;
use crate::math::{Ray, Vec3};
use glam::DVec3;

/// A ray of width one.
pub fn ray(origin: glam::Vec3, direction: glam::Vec3) -> Ray<f32> {
    Ray { origin: Vec3::splat(origin), direction: Vec3::splat(direction) }
}

/// The ray of unit direction from a point of single precision through one of double precision, which it misses by the rounding of its
/// direction alone.
pub fn towards(origin: glam::Vec3, target: DVec3) -> Ray<f32> {
    ray(origin, (target - origin.as_dvec3()).normalize().as_vec3())
}

/// Origin and direction without rounding, as judges take them.
pub fn exactly(ray: &Ray<f32>) -> (DVec3, DVec3) {
    (ray.origin.get(0).as_dvec3(), ray.direction.get(0).as_dvec3())
}

/// A packet from rays, one a lane.
pub fn packet<L: Lane>(rays: &[Ray<f32>]) -> Ray<L> {
    let lanes = |of: fn(&Ray<f32>) -> Vec3<f32>| {
        Vec3::new(
            L::from_fn(|i| of(&rays[i]).x),
            L::from_fn(|i| of(&rays[i]).y),
            L::from_fn(|i| of(&rays[i]).z),
        )
    };
    Ray { origin: lanes(|ray| ray.origin), direction: lanes(|ray| ray.direction) }
}
