//! Places a model: scales, rotates and translates it.

use glam::{DMat3, DVec3};
use octray_engine::math::portable;

/// A model's placement: scaled, then rotated, then translated.
pub struct Placement {
    pub rotation: DMat3,
    pub scale: f64,
    pub translate: DVec3,
}

impl Placement {
    /// The placement of a model in its own coordinates.
    pub const IDENTITY: Self = Self { rotation: DMat3::IDENTITY, scale: 1.0, translate: DVec3::ZERO };

    /// Makes a placement that rotates about the x, then the y, then the z axis, in degrees, counterclockwise
    /// as seen from the tip of the axis.
    pub fn new(scale: f64, [x, y, z]: [f64; 3], translate: DVec3) -> Self {
        let sin_cos = |degrees: f64| {
            // Right angles are exact, so that a mesh rotated by 90° keeps its flat faces flat.
            match degrees.rem_euclid(360.0) {
                0.0 => (0.0, 1.0),
                90.0 => (1.0, 0.0),
                180.0 => (0.0, -1.0),
                270.0 => (-1.0, 0.0),
                _ => portable::sin_cos(degrees.to_radians()),
            }
        };
        let ((sx, cx), (sy, cy), (sz, cz)) = (sin_cos(x), sin_cos(y), sin_cos(z));
        let about_x = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx]);
        let about_y = DMat3::from_cols_array(&[cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy]);
        let about_z = DMat3::from_cols_array(&[cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0]);
        Self { rotation: about_z * about_y * about_x, scale, translate }
    }

    pub fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * (p * self.scale) + self.translate
    }
}
