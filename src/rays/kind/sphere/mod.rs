//! Spheres.

mod leaf;
mod list;

pub use leaf::SphereLeaf;
pub use list::List;

use crate::kernel::ray_box::sphere_bounds;
use crate::kernel::surface::{sphere_offset, sphere_surface};
use crate::math::Vec3;

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: glam::Vec3,
    /// The radius, above 0.
    pub radius: f32,
}

impl Sphere {
    /// Returns [`sphere_bounds`].
    pub fn bounds(self) -> [glam::Vec3; 2] {
        sphere_bounds(self.center, self.radius)
    }
    /// Returns [`sphere_offset`].
    pub fn offset(self) -> f32 {
        sphere_offset(self.center, self.radius)
    }
    /// Returns the point of the surface next to `near`, and the unit normal there.
    pub fn surface(self, near: Vec3<f32>) -> (Vec3<f32>, Vec3<f32>) {
        sphere_surface::<f32>(near, Vec3::splat(self.center), 1.0 / self.radius, true)
    }
    /// Returns the distance of a point from the surface.
    pub fn distance(self, point: glam::DVec3) -> f64 {
        (point.distance(self.center.into()) - f64::from(self.radius)).abs()
    }
}
