//! Lights that are no primitives, for `octray inspect`: kind, place, brightness and units as text.

use super::camera::vector;
use crate::scene::{Coordinates, LightShape, LightUnits, PunctualLight, point_in_file};
use glam::Vec3;

/// Describes a light of a scene with these coordinates, in those of the file.
pub fn text(light: &PunctualLight, coordinates: &Coordinates) -> String {
    let unit = coordinates.unit as f32;
    let color = |color: Vec3| vector(color.to_array());
    let place = |position: Vec3| vector(point_in_file(position, coordinates).to_array());
    let brightness = |intensity: Vec3, range: f32| {
        let limit = if range.is_finite() { format!(", up to {} away", range * unit) } else { String::new() };
        format!("{} W/sr{limit}", color(intensity * unit * unit))
    };
    let text = match light.shape {
        LightShape::Point { position, intensity, range } => {
            format!("point at {}, {}", place(position), brightness(intensity, range))
        }
        LightShape::Spot { position, direction, intensity, range, inner_degrees, outer_degrees } => format!(
            "spot at {} along {}, {}, cones of {inner_degrees}° and {outer_degrees}°",
            place(position),
            color(direction),
            brightness(intensity, range)
        ),
        LightShape::Directional { direction, irradiance, angular_diameter_degrees } => format!(
            "directional along {}, {} W/m², a disc of {angular_diameter_degrees}°",
            color(direction),
            color(irradiance)
        ),
    };
    match light.units {
        LightUnits::Radiometric => text,
        LightUnits::Blender => text + "; its file says 683 times as much, as Blender's exporter does",
    }
}
