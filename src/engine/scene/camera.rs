//! The camera of a scene, and its validation.

use glam::Vec3;

/// The smallest radius, and distance from camera to target: its square, 1e-36, is still a normal f32.
pub const MIN_LENGTH: f64 = 1e-18;
/// The sine of the smallest angle between the camera's line of sight and its `up`: well above f32 rounding
/// (6e-8).
const MIN_UP_SINE: f64 = 1e-5;

/// A pinhole camera.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Camera {
    /// The position of the eye.
    pub position: Vec3,
    /// The target, which differs from `position`.
    pub look_at: Vec3,
    /// The direction that points up in the image, not parallel to the line of sight.
    pub up: Vec3,
    /// The angle in degrees from the lower to the upper edge of the image; above 0 and below 180.
    pub vertical_fov: f32,
}

/// An error in a camera: its key in the scene file, the problem, and its remedy.
pub type CameraFault = (&'static str, String, &'static str);

impl Camera {
    /// Returns the first error, if any.
    pub fn fault(&self) -> Option<CameraFault> {
        let Self { position, look_at, up, vertical_fov } = *self;
        if !(vertical_fov > 0.0 && vertical_fov < 180.0) {
            let what = format!("a vertical field of view of {vertical_fov}° is impossible");
            return Some(("vertical_fov", what, "write degrees above 0 and below 180; 40 is a good start"));
        }
        let sight = look_at.as_dvec3() - position.as_dvec3();
        if sight.length() < MIN_LENGTH {
            let what = "the camera looks at its own position".to_string();
            return Some((
                "look_at",
                what,
                "move `look_at` (or `position`) so that the two differ in single precision",
            ));
        }
        let up = up.as_dvec3();
        if sight.normalize().cross(up.normalize_or_zero()).length() < MIN_UP_SINE {
            let what = "`up` is parallel to the line of sight (or zero)".to_string();
            return Some((
                "up",
                what,
                "give an `up` that points to the upper edge of the picture, such as [0, 0, -1]",
            ));
        }
        None
    }
}
