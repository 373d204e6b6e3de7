//! Maps raster space to primary rays.

mod tile;

pub use crate::math::ViewFrustum;
pub use tile::{BLOCK, MAX_PIXELS, Tile};

use crate::lane::Lane;
use crate::math::{Ray, Vec3, portable};
use crate::scene;

/// A pinhole camera, prepared for packets. Raster space is in pixels from the upper left corner of the image;
/// the direction through its point (x, y) is `corner + x · right + y · down`, normalised.
#[derive(Clone, Copy, Debug)]
pub struct Pinhole {
    position: glam::Vec3,
    corner: glam::Vec3,
    right: glam::Vec3,
    down: glam::Vec3,
    /// The unit vector along the line of sight.
    forward: glam::Vec3,
}

impl Pinhole {
    /// Prepares a camera for a picture of this width and height.
    pub fn new(camera: &scene::Camera, [width, height]: [u32; 2]) -> Self {
        // In f64, because it is computed once per image.
        let forward = (camera.look_at.as_dvec3() - camera.position.as_dvec3()).normalize();
        let right = forward.cross(camera.up.as_dvec3()).normalize();
        let up = right.cross(forward);
        let half_height = portable::tan(f64::from(camera.vertical_fov).to_radians() / 2.0);
        let half_width = half_height * f64::from(width) / f64::from(height);
        let corner = forward - right * half_width + up * half_height;
        let right = right * (2.0 * half_width / f64::from(width));
        let down = up * (-2.0 * half_height / f64::from(height));
        Self {
            position: camera.position,
            corner: corner.as_vec3(),
            right: right.as_vec3(),
            down: down.as_vec3(),
            forward: forward.as_vec3(),
        }
    }

    /// Returns the frustum of all primary rays through the rectangle of pixels whose first is `x`, `y`.
    pub fn view_frustum(&self, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> ViewFrustum {
        // In pixels. A ray may pass the edge of a pixel exactly, and both additions in `rays` round by 2⁻²⁴
        // of the length of `corner` in each component: in the largest images, of 16,384² pixels, 2 √3 · 2⁻²⁴
        // · 11,585 = 2.4e-3 of a pixel (the size of a pixel cancels). The distance of the image plane adds to
        // the length of `corner`, too; if it is the larger part, the field of view is narrow and the
        // frustum's own margin is wider.
        let margin = 4e-3;
        let direction =
            |x: f64, y: f64| self.corner.as_dvec3() + self.right.as_dvec3() * x + self.down.as_dvec3() * y;
        let (left, top) = (f64::from(x) - margin, f64::from(y) - margin);
        let (right, bottom) = (f64::from(x + width) + margin, f64::from(y + height) + margin);
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        ViewFrustum::new(
            self.position.as_dvec3(),
            corners.map(|(x, y)| direction(x, y)),
            self.forward.as_dvec3(),
        )
    }

    /// Returns the origin of all primary rays.
    pub fn position(&self) -> glam::Vec3 {
        self.position
    }
    /// Returns the origin of all primary rays in each lane.
    #[inline(always)]
    pub fn origin<L: Lane>(&self) -> Vec3<L> {
        Vec3::splat(self.position)
    }

    /// Returns primary rays through points in raster space. Directions have unit length within 2 ε.
    #[inline(always)]
    pub fn rays<L: Lane>(&self, x: L, y: L) -> Ray<L> {
        let corner = Vec3::splat(self.corner);
        let through = Vec3::splat(self.right).mul_add(x, Vec3::splat(self.down).mul_add(y, corner));
        Ray { origin: self.origin(), direction: through.normalize() }
    }

    /// Projects directions from the camera to raster space: the inverse of [`Pinhole::rays`]. The mask holds
    /// the lanes whose direction points in front of the camera; in the others the point is unspecified.
    ///
    /// Domain: directions of any length.
    /// Error: 1e-3 of a pixel in images of up to 4,096 pixels a side (measured, `tests/pictures/history.rs`).
    #[inline(always)]
    pub fn project<L: Lane>(&self, direction: Vec3<L>) -> (L, L, L::Mask) {
        // `right` and `down` are perpendicular to the line of sight; `corner` has a component of 1 along it.
        let depth = direction.dot(Vec3::splat(self.forward));
        let on_plane = direction * (L::one() / depth) - Vec3::splat(self.corner);
        let along = |side: glam::Vec3| on_plane.dot(Vec3::splat(side / side.length_squared()));
        (along(self.right), along(self.down), L::zero().lt(depth))
    }

    /// Returns the width of a pixel at distance 1, in scene units.
    pub fn pixel_size(&self) -> f32 {
        self.right.length()
    }
}
