//! Spheres.

mod leaf;
mod list;

pub use leaf::SphereLeaf;
pub use list::List;

use crate::kernel::ray_box::sphere_bounds;
use crate::kernel::ray_sphere::QuadraticEquation;
use crate::kernel::surface::{sphere_offset, sphere_surface};
use crate::math::{Hit, Ray, Vec3};

/// A sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Its centre.
    pub center: glam::Vec3,
    /// The radius, above 0.
    pub radius: f32,
}

/// Calls `visit` with each hit of a ray with a sphere: none, one or two.
pub(super) fn visit(
    ray: &Ray<f32>,
    number: u32,
    (center, radius2): (Vec3<f32>, f32),
    visit: &mut impl FnMut(Hit<f32>),
) {
    let (may_hit, equation) = QuadraticEquation::new(ray, center, radius2);
    let roots = equation.roots().into_iter().filter(|&t| may_hit && t > 0.0);
    roots.for_each(|t| visit(Hit { t, primitive: number, u: 0.0, v: 0.0 }));
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
