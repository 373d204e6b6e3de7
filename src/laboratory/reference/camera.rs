//! Camera rays, with the points of a lens, and their ray cones.

use super::geometry::Reference;
use crate::scene::{Lens, Projection};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

impl Reference {
    /// Origin and unit direction of the ray through the point (x, y) of the picture, in pixels from its upper
    /// left corner, and the point of the lens that two numbers in [0, 1) choose.
    pub fn camera_ray(&self, resolution: [u32; 2], [x, y]: [f64; 2], on_lens: [f64; 2]) -> (DVec3, DVec3) {
        let [width, height] = resolution.map(f64::from);
        let position = self.camera.position.as_dvec3();
        let forward = (self.camera.look_at.as_dvec3() - position).normalize();
        let right = forward.cross(self.camera.up.as_dvec3()).normalize();
        let up = right.cross(forward);
        let half_height = self.half_height();
        let half_width = half_height * width / height;
        let across = (2.0 * x / width - 1.0) * half_width;
        let upwards = (1.0 - 2.0 * y / height) * half_height;
        let on_picture = right * across + up * upwards;
        match self.camera.projection {
            Projection::Orthographic { .. } => (position + on_picture, forward),
            Projection::Perspective(lens) => {
                // The rays through all points of the lens meet on the focal plane.
                let focus = lens.focus.map_or(self.camera.look_at.as_dvec3().distance(position), f64::from);
                let [a, b] = point_of_lens(&lens, on_lens).map(|x| x * f64::from(lens.radius));
                let beside = right * a + up * b;
                (position + beside, ((forward + on_picture) * focus - beside).normalize())
            }
        }
    }

    /// Returns the ray cone at the camera: its width, in scene units, and what it grows by in a unit of
    /// distance. It is half a pixel wide.
    pub(super) fn camera_cone(&self, height: u32) -> (f64, f64) {
        let half_pixel = self.half_height() / f64::from(height);
        match self.camera.projection {
            Projection::Perspective(_) => (0.0, half_pixel),
            Projection::Orthographic { .. } => (half_pixel, 0.0),
        }
    }

    /// Half the picture's height: in scene units for an orthographic camera, else at distance 1.
    fn half_height(&self) -> f64 {
        match self.camera.projection {
            Projection::Perspective(_) => (f64::from(self.camera.vertical_fov).to_radians() / 2.0).tan(),
            Projection::Orthographic { height } => 0.5 * f64::from(height),
        }
    }
}

/// The point of a lens of radius 1 that two numbers choose.
fn point_of_lens(lens: &Lens, [u, v]: [f64; 2]) -> [f64; 2] {
    let at = |radius: f64, angle: f64| [radius * angle.cos(), radius * angle.sin()];
    let corners = f64::from(lens.blades);
    if lens.blades > 0 {
        // Uniform in the triangle of two corners and the middle; the first corner is the top.
        let (side, near) = ((u * corners).floor(), (u * corners).fract().sqrt());
        let corner = |number: f64| at(near, PI / 2.0 - TAU * number / corners);
        let ([ax, ay], [bx, by]) = (corner(side), corner(side + 1.0));
        return [ax + (bx - ax) * v, ay + (by - ay) * v];
    }
    // Squares around the middle become circles (Shirley, Chiu, Journal of Graphics Tools 2(3), 1997).
    let [a, b] = [2.0 * u - 1.0, 2.0 * v - 1.0];
    match (a.abs() > b.abs(), b == 0.0) {
        (true, _) => at(a, PI / 4.0 * b / a),
        (false, true) => [0.0; 2],
        (false, false) => at(b, PI / 2.0 - PI / 4.0 * a / b),
    }
}
