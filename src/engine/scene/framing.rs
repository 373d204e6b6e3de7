//! Computes the bounds of a scene, and a camera that frames them.

use super::camera::{Camera, VERTICAL_FOV};
use super::model::Scene;
use crate::math::portable;
use glam::{DVec3, Vec3};

/// The direction of the camera from the centre of the bounds, and its distance in diagonals of the bounds.
const VIEW_FROM: DVec3 = DVec3::new(1.0, 0.5, 1.5);
const VIEW_DIAGONALS: f64 = 1.2;
/// The width over height of the pictures into which tall models must fit, and the share of the distance added
/// for a margin around them.
const ASPECT: f64 = 16.0 / 9.0;
const MARGIN: f64 = 1.03;

impl Scene {
    /// Returns the corners of the axis-aligned box around all primitives; zeros if there are none.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        let boxes = self.all_primitives().map(|primitive| primitive.shape().extent());
        boxes.reduce(|[a, b], [c, d]| [a.min(c), b.max(d)]).unwrap_or_default().into()
    }

    /// Returns a camera that sees the whole scene, independent of the scene's own; `None` if f32 cannot
    /// separate its position from its target.
    pub fn overview(&self) -> Option<Camera> {
        let camera = self.framing(None, None);
        camera.fault().is_none().then_some(camera)
    }

    /// Returns a camera that sees all primitives, or as many as the given position and target allow.
    pub fn framing(&self, position: Option<Vec3>, look_at: Option<Vec3>) -> Camera {
        let (lower, upper) = self.bounds();
        let look_at = look_at.unwrap_or_else(|| ((lower + upper) / 2.0).as_vec3());
        let position = position.unwrap_or_else(|| {
            let target = look_at.as_dvec3();
            let mut distance = VIEW_DIAGONALS * (upper - lower).length();
            let fitting = self.fitting(target);
            if fitting > distance {
                distance = MARGIN * fitting;
            }
            (target + VIEW_FROM.normalize() * distance).as_vec3()
        });
        Camera::pinhole(position, look_at, Vec3::Y, VERTICAL_FOV)
    }

    /// Returns the least distance from the target, in the direction [`VIEW_FROM`], at which all primitives
    /// are in a picture of this [`ASPECT`]. The usual distance is enough for all but tall ones.
    fn fitting(&self, target: DVec3) -> f64 {
        let backward = VIEW_FROM.normalize();
        let right = DVec3::Y.cross(backward).normalize();
        let up = backward.cross(right);
        let (sin, cos) = portable::sin_cos(f64::from(VERTICAL_FOV).to_radians() / 2.0);
        let half_height = sin / cos;
        // A ball touches the planes of the frustum: r / sin of half the angle farther away than its centre.
        let needed = |center: DVec3, radius: f64| {
            let from = center - target;
            let along = |axis: DVec3, slope: f64| {
                (from.dot(axis).abs() + radius * (1.0 + slope * slope).sqrt()) / slope
            };
            from.dot(backward) + along(up, half_height).max(along(right, half_height * ASPECT))
        };
        let balls = self.all_primitives().flat_map(|primitive| primitive.shape().balls());
        balls.map(|(center, radius)| needed(center, radius)).fold(0.0, f64::max)
    }
}
