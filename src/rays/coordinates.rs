//! The coordinates of the world, in double precision, and those of a structure, in single precision.

use glam::DVec3;

/// Largest absolute value of a coordinate in a scene: cubes of lengths, as in ray–triangle tests, stay below
/// f32's maximum, 3.4e38.
pub const MAX_COORDINATE: f64 = (1_u64 << 40) as f64;
/// Sizes from 1 over this to this need no other unit.
const USUAL: f64 = (1_u64 << 16) as f64;

/// Where the coordinates of a scene stand in its file. A file's are read in double precision and rounded to
/// single precision relative to an origin: so a scene may stand anywhere, and have any size. Translations
/// that double precision holds, and scaling by powers of two, change no bit of its film.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coordinates {
    /// The file's point that is (0, 0, 0) in the scene.
    pub origin: DVec3,
    /// A length of 1 in the scene, in the file's units. A power of two: dividing by it rounds nothing.
    pub unit: f64,
}

impl Default for Coordinates {
    /// The file's own.
    fn default() -> Self {
        Self { origin: DVec3::ZERO, unit: 1.0 }
    }
}

impl Coordinates {
    /// Those of a scene of about this size around this point.
    pub fn around(origin: DVec3, size: f64) -> Self {
        let is_usual = !size.is_normal() || (1.0 / USUAL..=USUAL).contains(&size);
        let without_fraction = f64::from_bits(size.to_bits() & !((1 << (f64::MANTISSA_DIGITS - 1)) - 1));
        Self { origin, unit: if is_usual { 1.0 } else { without_fraction } }
    }
    /// A point of the file in the scene.
    pub fn to_scene(&self, point: DVec3) -> DVec3 {
        (point - self.origin) / self.unit
    }
    /// A point of the scene in the file.
    pub fn to_file(&self, point: DVec3) -> DVec3 {
        self.origin + point * self.unit
    }
}
