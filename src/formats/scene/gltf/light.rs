//! Adds the lights of a glTF file: KHR_lights_punctual.

use super::super::builder::SceneBuilder;
use super::super::check::{is_near, is_within_bounds};
use super::super::error::SceneError;
use super::super::placement::Placement;
use super::Gltf;
use super::schema::{Lenient, Light};
use glam::{DMat4, DVec3, DVec4};
use octray_engine::scene::{LightShape, LightUnits, PunctualLight};
use std::path::Path;

/// The part of `asset.generator` by which Blender's exporter is known.
const BLENDER: &str = "Khronos glTF Blender I/O";
/// The lumens per watt of Blender's exporter. With its usual units it writes a point or spot of P watts as
/// 683 P / 4π candela, and a sun of E W/m² as 683 E lux (glTF-Blender-IO, `PBR_WATTS_TO_LUMENS`). Cycles
/// gives a point the radiance P / 4π²r² on a ball of the radius r (`invarea` / 4π), and so π r² times that,
/// P / 4π, as intensity; a spot's cone only masks it, and a sun's strength is the irradiance. Over 683, the
/// file's numbers are these, in the units of emissive surfaces and the sky.
const LUMENS_PER_WATT: f64 = 683.0;

impl Gltf {
    /// Adds the lights of all nodes to the builder of a scene that has the model's triangles; those that
    /// cannot be used are left out with a note. Without `units`, the program that wrote the file decides.
    ///
    /// Intensities grow by the square of the placement's scale, so that a scaled model has the same picture.
    pub fn add_lights(
        &self,
        path: &Path,
        builder: &mut SceneBuilder,
        placement: &Placement,
        units: Option<LightUnits>,
    ) -> Result<(), SceneError> {
        let (document, place) = (self.document(path), "nodes");
        let generator = self.root.asset.generator.0.as_deref().unwrap_or_default();
        let by_generator =
            if generator.contains(BLENDER) { LightUnits::Blender } else { LightUnits::Radiometric };
        let units = units.unwrap_or(by_generator);
        let placement = builder.within_scene(placement, std::iter::empty());
        let Lenient(lights) = &self.root.extensions.lights;
        for &(node, index, ref transform) in &self.nodes.lights {
            let file = lights.as_ref().and_then(|lights| lights.lights.get(index));
            let shape = match file {
                Some(light) => shape(light, transform, &placement, units),
                None => Err(format!("there is no valid light {index} in `extensions.KHR_lights_punctual`")),
            };
            match shape {
                Ok(shape) => builder.scene.lights.push(PunctualLight { shape, units }),
                Err(why) => {
                    let root = document.source.root();
                    let what = format!("a light is left out: {why}");
                    builder.notes.add(&root.key(place).item(node), what);
                }
            }
        }
        builder.warn_of_notes(path, ": ");
        Ok(())
    }
}

/// Converts a light, which shines along −z of its node. Scales of nodes do not change it. `placement` leads
/// to the coordinates of the scene.
fn shape(
    file: &Light,
    transform: &DMat4,
    placement: &Placement,
    units: LightUnits,
) -> Result<LightShape, String> {
    let factor = match units {
        LightUnits::Radiometric => 1.0,
        LightUnits::Blender => 1.0 / LUMENS_PER_WATT,
    };
    let place = placement.point(transform.w_axis.truncate());
    let direction =
        (placement.rotation * (transform * DVec4::NEG_Z).truncate()).normalize_or_zero().as_vec3();
    let (color, power) = (file.color.unwrap_or([1.0; 3]), file.intensity.unwrap_or(1.0));
    let brightness = DVec3::from(color) * (power * factor);
    let intensity = brightness * (placement.scale * placement.scale);
    let numbers = brightness.to_array().into_iter().chain(intensity.to_array());
    if !numbers.into_iter().all(|number| number >= 0.0 && is_within_bounds(number)) {
        return Err(format!("its `color` {color:?} times its `intensity` {power} is negative or too large"));
    }
    let is_directional = file.kind == "directional";
    if file.kind != "point" && direction == glam::Vec3::ZERO {
        return Err("its node has no direction".into());
    }
    if !is_directional && !is_near(place) {
        return Err("it is too far away".into());
    }
    // A directional light has no range.
    if let Some(range) = file.range.filter(|&range| range <= 0.0 && !is_directional) {
        return Err(format!("its `range` {range} is not above 0"));
    }
    let range = file.range.unwrap_or(f64::INFINITY) * placement.scale;
    let (position, intensity, range) = (place.as_vec3(), intensity.as_vec3(), range as f32);
    match file.kind.as_str() {
        "point" => Ok(LightShape::Point { position, intensity, range }),
        "directional" => {
            let irradiance = brightness.as_vec3();
            Ok(LightShape::Directional { direction, irradiance, angular_diameter_degrees: 0.0 })
        }
        "spot" => {
            let outer = file.spot.outer_cone_angle.unwrap_or(std::f64::consts::FRAC_PI_4).to_degrees();
            let inner = file.spot.inner_cone_angle.unwrap_or(0.0).to_degrees();
            // Radians are rounded.
            let (outer, inner) = (outer.min(if outer < 90.001 { 90.0 } else { outer }), inner);
            if !(0.01..=90.0).contains(&outer) || !(0.0..=outer * 1.000_001).contains(&inner) {
                let what = "is not from 0 up to `outerConeAngle`";
                let most = "at least 0.01° and at most π/2 (90°)";
                return Err(format!("`innerConeAngle` ({inner}°) {what} ({outer}°), or this is not {most}"));
            }
            let [outer_degrees, inner_degrees] = [outer, inner.min(outer)].map(|degrees| degrees as f32);
            Ok(LightShape::Spot { position, direction, intensity, range, inner_degrees, outer_degrees })
        }
        other => Err(format!("the type `{other}` is unknown")),
    }
}
