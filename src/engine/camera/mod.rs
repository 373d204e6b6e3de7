//! Pixels to primary rays.
//!
//! For: [`Pinhole`], [`Pyramid`], the space it sees, and [`Tile`], a rectangle of pixels. May import: `lane`, `math`, `scene`. Must never know: buffers, film.

mod pyramid;
mod tile;

pub use pyramid::Pyramid;
pub use tile::{MAX_PIXELS, Tile};

use crate::lane::Lane;
use crate::math::{Ray, Vec3};
use crate::scene;

/// A pinhole camera ready for packets: the ray through the point (x, y) of the picture, in pixels from its upper left corner, is
/// `corner + x · right + y · down`, normalised.
#[derive(Clone, Copy, Debug)]
pub struct Pinhole {
    position: glam::Vec3,
    corner: glam::Vec3,
    right: glam::Vec3,
    down: glam::Vec3,
    /// The line of sight, of unit length.
    forward: glam::Vec3,
}

impl Pinhole {
    pub fn new(camera: &scene::Camera, [width, height]: [u32; 2]) -> Self {
        // In f64: this happens once a picture.
        let forward = (camera.look_at.as_dvec3() - camera.position.as_dvec3()).normalize();
        let right = forward.cross(camera.up.as_dvec3()).normalize();
        let up = right.cross(forward);
        let half_height = (f64::from(camera.vertical_fov).to_radians() / 2.0).tan();
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

    /// The pyramid that holds all primary rays through the pixels from `x`, `y` on, `width` and `height` of them.
    pub fn pyramid(&self, [x, y]: [u32; 2], [width, height]: [u32; 2]) -> Pyramid {
        // In pixels. A pixel's edge may be hit exactly, and both additions in `rays` round by 2⁻²⁴ of the corner's length in each
        // component. At the largest pictures that is 2 √3 · 2⁻²⁴ · 11,585 = 2.4e-3 of a pixel (16,384² of them; the pixel's size
        // cancels). The camera's distance from the picture adds to the corner's length, too: where that is the larger part, the field
        // of view is narrow and the pyramid's own margin is wider.
        let more = 4e-3;
        let direction =
            |x: f64, y: f64| self.corner.as_dvec3() + self.right.as_dvec3() * x + self.down.as_dvec3() * y;
        let (left, top) = (f64::from(x) - more, f64::from(y) - more);
        let (right, bottom) = (f64::from(x + width) + more, f64::from(y + height) + more);
        let corners = [(left, top), (right, top), (right, bottom), (left, bottom)];
        Pyramid::new(self.position.as_dvec3(), corners.map(|(x, y)| direction(x, y)), self.forward.as_dvec3())
    }

    /// Where all primary rays start.
    #[inline(always)]
    pub fn origin<L: Lane>(&self) -> Vec3<L> {
        Vec3::splat(self.position)
    }

    /// Primary rays through points of the picture, in pixels. Directions have unit length within 2 ε.
    #[inline(always)]
    pub fn rays<L: Lane>(&self, x: L, y: L) -> Ray<L> {
        let corner = Vec3::splat(self.corner);
        let through = Vec3::splat(self.right).mul_add(x, Vec3::splat(self.down).mul_add(y, corner));
        Ray { origin: self.origin(), direction: through.normalize() }
    }

    /// Where in the picture a direction from the camera points, in pixels from its upper left corner, and whether that is in front of the
    /// camera: the inverse of [`Pinhole::rays`]. Of what is behind, the numbers mean nothing.
    ///
    /// Units: a direction of any length. Error: 1e-3 of a pixel in pictures of up to 4,096 pixels a side (measured, `tests/history.rs`).
    #[inline(always)]
    pub fn project<L: Lane>(&self, direction: Vec3<L>) -> (L, L, L::Mask) {
        // Corner, right and down are at right angles to the line of sight but for the corner's part along it, which is 1.
        let depth = direction.dot(Vec3::splat(self.forward));
        let on_plane = direction * (L::one() / depth) - Vec3::splat(self.corner);
        let along = |side: glam::Vec3| on_plane.dot(Vec3::splat(side / side.length_squared()));
        (along(self.right), along(self.down), L::zero().lt(depth))
    }

    /// The width of a pixel at the distance 1, in scene units.
    pub fn pixel_size(&self) -> f32 {
        self.right.length()
    }
}
