//! Lights without a surface: points, spots and distant lights.

use glam::Vec3;
use serde::Deserialize;

/// A light of a scene that is no primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PunctualLight {
    /// The place, the directions and the brightness.
    pub shape: LightShape,
    /// The meaning of the brightness in the light's file; the shape's is radiometric already.
    pub units: LightUnits,
}

/// The way in which a [`PunctualLight`] emits.
///
/// Intensities are radiant intensities over the square of the scene's unit of length, in every channel: a
/// point at the distance d receives `intensity` / d². Directions have any length but 0.
#[derive(Clone, Copy, Debug, PartialEq)]
#[allow(missing_docs)] // The variants' text explains their fields.
pub enum LightShape {
    /// A point that emits in all directions. Beyond `range` it lights nothing; infinite without a limit.
    Point { position: Vec3, intensity: Vec3, range: f32 },
    /// A point that emits around a direction: all of its intensity up to the angle `inner_degrees` from it,
    /// and none from `outer_degrees` on, which is at least as large and at most 90.
    Spot {
        position: Vec3,
        direction: Vec3,
        intensity: Vec3,
        range: f32,
        inner_degrees: f32,
        outer_degrees: f32,
    },
    /// A light at infinity that shines along a direction, and gives surfaces across it this irradiance. With
    /// an angular diameter above 0, and at most 180, it is a disc that rays can see.
    Directional { direction: Vec3, irradiance: Vec3, angular_diameter_degrees: f32 },
}

/// The meaning of candela and lux in the file of a light. Scene files have these names in lower case.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LightUnits {
    /// They are watts per steradian and per square metre.
    Radiometric,
    /// They are 683 times these numbers.
    Blender,
}

impl From<LightShape> for PunctualLight {
    /// Makes a light whose brightness is radiometric.
    fn from(shape: LightShape) -> Self {
        Self { shape, units: LightUnits::Radiometric }
    }
}

impl LightShape {
    /// Returns the radiant intensity or the irradiance.
    pub fn brightness(&self) -> Vec3 {
        match *self {
            Self::Point { intensity, .. } | Self::Spot { intensity, .. } => intensity,
            Self::Directional { irradiance, .. } => irradiance,
        }
    }
}
