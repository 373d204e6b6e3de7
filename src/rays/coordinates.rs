//! The transform between world coordinates, in double precision, and a structure's, in single precision.

use glam::DVec3;

/// The largest absolute value of a coordinate in a scene: ray–triangle tests multiply three lengths, and the
/// products stay below f32's maximum, 3.4e38.
pub const MAX_COORDINATE: f64 = (1_u64 << 40) as f64;
/// Scenes whose size is between the inverse of this number and this number keep the file's unit.
const USUAL: f64 = (1_u64 << 16) as f64;

/// The place of a scene's coordinates in its file. The file's coordinates are read in double precision and
/// rounded to single precision relative to an origin, so a scene may have any position and size. Exact
/// translations and scaling by powers of two change no bit of its film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinates {
    /// The point of the file that is (0, 0, 0) in the scene.
    pub origin: DVec3,
    /// The length 1 of the scene in the file's units. It is a power of two: dividing by it rounds nothing.
    pub unit: f64,
}

impl Default for Coordinates {
    /// Returns the coordinates of the file itself.
    fn default() -> Self {
        Self { origin: DVec3::ZERO, unit: 1.0 }
    }
}

impl Coordinates {
    /// Returns the coordinates of a scene of about this size around this point.
    pub fn around(origin: DVec3, size: f64) -> Self {
        let is_usual = !size.is_normal() || (1.0 / USUAL..=USUAL).contains(&size);
        let without_fraction = f64::from_bits(size.to_bits() & !((1 << (f64::MANTISSA_DIGITS - 1)) - 1));
        Self { origin, unit: if is_usual { 1.0 } else { without_fraction } }
    }
    /// Converts a point of the file to the scene.
    pub fn to_scene(&self, point: DVec3) -> DVec3 {
        (point - self.origin) / self.unit
    }
    /// Converts a point of the scene to the file.
    pub fn to_file(&self, point: DVec3) -> DVec3 {
        self.origin + point * self.unit
    }
}
