//! The bounds of a scene, and a camera that frames them.

use super::camera::Camera;
use super::model::Scene;
use super::shapes::{Sphere, Triangle};
use glam::{DVec3, Vec3};

/// Degrees.
const VERTICAL_FOV: f32 = 40.0;
/// The camera stands in this direction from the centre of the bounds, this many of their diagonals away.
const VIEW_FROM: DVec3 = DVec3::new(1.0, 0.5, 1.5);
const VIEW_DIAGONALS: f64 = 1.2;

/// The lower and upper corner of the axis-aligned box around all primitives; `None` if there are none.
pub fn bounds(spheres: &[Sphere], triangles: &[Triangle]) -> Option<(DVec3, DVec3)> {
    let spheres = spheres.iter().flat_map(|sphere| {
        let (center, radius) = (sphere.center.as_dvec3(), f64::from(sphere.radius));
        [center - radius, center + radius]
    });
    let vertices = triangles.iter().flat_map(|triangle| triangle.vertices.map(Vec3::as_dvec3));
    spheres.chain(vertices).fold(None, |bounds, point| {
        let (lower, upper) = bounds.unwrap_or((point, point));
        Some((lower.min(point), upper.max(point)))
    })
}

/// A camera that sees all of a box, or as much of it as the given position and target allow.
pub fn framing((lower, upper): (DVec3, DVec3), position: Option<Vec3>, look_at: Option<Vec3>) -> Camera {
    let look_at = look_at.unwrap_or_else(|| ((lower + upper) / 2.0).as_vec3());
    let position = position.unwrap_or_else(|| {
        let distance = VIEW_DIAGONALS * (upper - lower).length();
        (look_at.as_dvec3() + VIEW_FROM.normalize() * distance).as_vec3()
    });
    Camera { position, look_at, up: Vec3::Y, vertical_fov: VERTICAL_FOV }
}

impl Scene {
    /// The lower and upper corner of the axis-aligned box around all primitives.
    pub fn bounds(&self) -> (DVec3, DVec3) {
        bounds(&self.spheres, &self.triangles).unwrap_or_default()
    }
    /// A camera that sees the whole scene, independent of the scene's own; `None` where f32 cannot separate
    /// its position from its target.
    pub fn overview(&self) -> Option<Camera> {
        let camera = framing(self.bounds(), None, None);
        camera.fault().is_none().then_some(camera)
    }
}
