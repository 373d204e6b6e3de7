//! Maps raster space to primary rays.

mod tile;

pub use crate::math::ViewFrustum;
pub use tile::{BLOCK, MAX_PIXELS, Tile};

use crate::buffers::Features;
use crate::kernel::ray_cone::Cone;
use crate::lane::Lane;
use crate::math::{Ray, Vec3, portable};
use crate::sampling::warp::{sample_concentric_disc, sample_polygon};
use crate::scene::{self, Lens, Projection};

/// A camera, prepared for packets. Raster space is in pixels from the upper left corner of the image. With
/// p = `corner + x · right + y · down`, rays through its point (x, y) start
///
/// - for a pinhole, at `position`, with the direction p, normalised;
/// - for a thin lens, at a point o of the aperture beside `position`, with the direction p − o / f,
///   normalised, where f is the distance of the focal plane: they meet at f · p. Source: Potmesil,
///   Chakravarty, "A lens and aperture camera model for synthetic image generation", SIGGRAPH 1981;
/// - for an orthographic camera, at `position + p`, with the direction `forward`.
#[derive(Clone, Copy, Debug)]
pub struct PreparedCamera {
    position: glam::Vec3,
    corner: glam::Vec3,
    right: glam::Vec3,
    down: glam::Vec3,
    /// The unit vector along the line of sight.
    forward: glam::Vec3,
    origins: Origins,
}

/// The points from which rays start.
#[derive(Clone, Copy, Debug)]
enum Origins {
    Pinhole,
    Aperture(Aperture),
    Plane,
}

/// The aperture of a thin lens.
#[derive(Clone, Copy, Debug)]
struct Aperture {
    /// From the position to the aperture's right edge.
    right: glam::Vec3,
    /// From the position to the aperture's upper edge.
    up: glam::Vec3,
    /// One over the distance of the focal plane.
    inv_focus: f32,
    /// The number of blades and the corner beside the top, as [`sample_polygon`] needs them; `None` for a
    /// round aperture.
    blades: Option<(u32, [f32; 2])>,
}

impl Aperture {
    fn new(Lens { radius, blades, .. }: Lens, focus: f64, [right, up]: [glam::DVec3; 2]) -> Self {
        let (sin, cos) = portable::sin_cos(std::f64::consts::TAU / f64::from(blades.max(1)));
        Self {
            right: (right * f64::from(radius)).as_vec3(),
            up: (up * f64::from(radius)).as_vec3(),
            inv_focus: (1.0 / focus) as f32,
            blades: (blades > 0).then_some((blades, [sin as f32, cos as f32])),
        }
    }
}

impl PreparedCamera {
    /// Prepares a camera for a picture of this width and height.
    pub fn new(camera: &scene::Camera, [width, height]: [u32; 2]) -> Self {
        // In f64, because it is computed once per image.
        let forward = (camera.look_at.as_dvec3() - camera.position.as_dvec3()).normalize();
        let right = forward.cross(camera.up.as_dvec3()).normalize();
        let up = right.cross(forward);
        let half_height = camera.half_height();
        let half_width = half_height * f64::from(width) / f64::from(height);
        let (plane, origins) = match camera.projection {
            Projection::Perspective(lens) if lens.radius > 0.0 => {
                (forward, Origins::Aperture(Aperture::new(lens, camera.focus(), [right, up])))
            }
            Projection::Perspective(_) => (forward, Origins::Pinhole),
            Projection::Orthographic { .. } => (glam::DVec3::ZERO, Origins::Plane),
        };
        let corner = plane - right * half_width + up * half_height;
        let right = right * (2.0 * half_width / f64::from(width));
        let down = up * (-2.0 * half_height / f64::from(height));
        Self {
            position: camera.position,
            corner: corner.as_vec3(),
            right: right.as_vec3(),
            down: down.as_vec3(),
            forward: forward.as_vec3(),
            origins,
        }
    }

    /// Returns the frustum of all primary rays of a pinhole through the rectangle of pixels whose first is
    /// `x`, `y`.
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

    /// Returns the camera's position: that of a pinhole, the middle of a lens, or that of the picture.
    pub fn position(&self) -> glam::Vec3 {
        self.position
    }
    /// Returns the origin of all primary rays, if they have one: only those of a pinhole do.
    #[inline(always)]
    pub fn common_origin(&self) -> Option<glam::Vec3> {
        matches!(self.origins, Origins::Pinhole).then_some(self.position)
    }
    /// Returns the features that its rays need.
    pub fn needs(&self) -> Features {
        match self.origins {
            Origins::Pinhole => Features::NONE,
            Origins::Aperture(_) | Origins::Plane => Features::RAY_ORIGINS,
        }
    }
    /// Tests whether the camera has a lens, so that only the focal plane is sharp.
    pub fn has_lens(&self) -> bool {
        matches!(self.origins, Origins::Aperture(_))
    }

    #[inline(always)]
    fn on_plane<L: Lane>(&self, x: L, y: L) -> Vec3<L> {
        let corner = Vec3::splat(self.corner);
        Vec3::splat(self.right).mul_add(x, Vec3::splat(self.down).mul_add(y, corner))
    }

    /// Returns rays from the camera's position through points in raster space: the primary rays of a pinhole.
    /// Directions have unit length within 2 ε.
    #[inline(always)]
    pub fn pinhole_rays<L: Lane>(&self, x: L, y: L) -> Ray<L> {
        Ray { origin: Vec3::splat(self.position), direction: self.on_plane(x, y).normalize() }
    }

    /// Returns the primary rays through points in raster space and the middle of the lens.
    #[inline(always)]
    pub fn rays<L: Lane>(&self, x: L, y: L) -> Ray<L> {
        match self.origins {
            Origins::Pinhole | Origins::Aperture(_) => self.pinhole_rays(x, y),
            Origins::Plane => {
                let origin = Vec3::splat(self.position) + self.on_plane(x, y);
                Ray { origin, direction: Vec3::splat(self.forward) }
            }
        }
    }

    /// Returns the primary rays through points in raster space and points of the lens that `u` and `v`
    /// choose uniformly; cameras without one ignore them.
    ///
    /// Domain: u, v in [0, 1).
    /// Error: the origin is rounded like every point; beside it, rays miss their common point of the focal
    /// plane by 4 ε of its distance.
    #[inline(always)]
    pub fn sample_rays<L: Lane>(&self, x: L, y: L, u: L, v: L) -> Ray<L> {
        let Origins::Aperture(Aperture { right, up, inv_focus, blades }) = self.origins else {
            return self.rays(x, y);
        };
        let (a, b) = match blades {
            Some((blades, corner)) => sample_polygon(blades, corner, u, v),
            None => sample_concentric_disc(u, v),
        };
        let beside = Vec3::splat(right).mul_add(a, Vec3::splat(up) * b);
        let direction = beside.mul_add(L::splat(-inv_focus), self.on_plane(x, y));
        Ray { origin: Vec3::splat(self.position) + beside, direction: direction.normalize() }
    }

    /// Projects vectors from the camera's position to raster space: the inverse of
    /// [`PreparedCamera::rays`]. The mask holds the lanes whose vector points in front of the camera; in the
    /// others the point is unspecified.
    ///
    /// Domain: vectors to points of rays; for a pinhole and a lens, of any length.
    /// Error: 1e-3 of a pixel in images of up to 4,096 pixels a side (measured, `tests/pictures/history.rs`).
    #[inline(always)]
    pub fn project<L: Lane>(&self, direction: Vec3<L>) -> (L, L, L::Mask) {
        // `right` and `down` are perpendicular to the line of sight; `corner` has a component of 1 along it,
        // or, for an orthographic camera, of 0.
        let depth = direction.dot(Vec3::splat(self.forward));
        let scale = if let Origins::Plane = self.origins { L::one() } else { L::one() / depth };
        let on_plane = direction * scale - Vec3::splat(self.corner);
        let along = |side: glam::Vec3| on_plane.dot(Vec3::splat(side / side.length_squared()));
        (along(self.right), along(self.down), L::zero().lt(depth))
    }

    /// Returns the width of a pixel at a distance, in scene units.
    pub fn pixel_size_at(&self, distance: f32) -> f32 {
        match self.origins {
            Origins::Pinhole | Origins::Aperture(_) => self.right.length() * distance,
            Origins::Plane => self.right.length(),
        }
    }
    /// Returns the cones of primary rays, half a pixel wide; those of a lens are a pinhole's.
    #[inline(always)]
    pub fn cone<L: Lane>(&self) -> Cone<L> {
        let half = L::splat(0.5 * self.right.length());
        match self.origins {
            Origins::Pinhole | Origins::Aperture(_) => Cone { width: L::zero(), angle: half },
            Origins::Plane => Cone { width: half, angle: L::zero() },
        }
    }
    /// Returns the diameter in pixels of the circle of confusion of a point at a distance; 0 without a lens.
    pub fn blur_at<L: Lane>(&self, distance: L) -> L {
        match self.origins {
            Origins::Aperture(Aperture { right, inv_focus, .. }) => {
                let diameter = L::splat(2.0 * right.length() / self.right.length());
                (L::one() / distance - L::splat(inv_focus)).abs() * diameter
            }
            Origins::Pinhole | Origins::Plane => L::zero(),
        }
    }
}
