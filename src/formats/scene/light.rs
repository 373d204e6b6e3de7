//! Converts the lights of a native file.

use super::error::SceneError;
use super::json::JsonPath;
use super::native::{LightFile, example};
use super::spelling::did_you_mean;
use glam::{DVec3, Vec3};
use octray_engine::scene::{Coordinates, LightShape, PunctualLight};

/// The types of lights.
const TYPES: [&str; 3] = ["point", "spot", "directional"];
/// The least angle of a spot, and the least angular diameter of a disc, in degrees: single precision rounds
/// directions by 10⁻⁵ of them at most.
const LEAST_DEGREES: [f64; 2] = [0.01, 1e-4];

/// Converts a light of a file.
pub fn light(
    file: &LightFile,
    place: &JsonPath,
    coordinates: &Coordinates,
) -> Result<PunctualLight, SceneError> {
    let Some(kind) = TYPES.iter().position(|known| *known == file.r#type) else {
        let known = format!("{}the types are {}", did_you_mean(&file.r#type, &TYPES), TYPES.join(", "));
        return Err(place.key("type").error(format!("the light type `{}` is unknown", file.r#type), known));
    };
    check_keys(file, kind, place)?;
    let vector = |key: &'static str, v: Option<[f64; 3]>| {
        let example = example(key).unwrap_or_default();
        let mend = || format!("add `{key}` to this object, such as \"{key}\": {example}");
        v.ok_or_else(|| place.error(format!("the key `{key}` is missing"), mend()))
    };
    if kind == 2 {
        let along = vector("direction", file.direction)?;
        let irradiance = vector("irradiance", file.irradiance)?;
        return Ok(PunctualLight::from(LightShape::Directional {
            direction: direction(&place.key("direction"), along.into())?,
            irradiance: place.key("irradiance").radiance(irradiance)?,
            angular_diameter_degrees: diameter(&place.key("angular_diameter_degrees"), file)?,
        }));
    }
    let in_file = vector("position", file.position)?;
    let position = place.key("position").point(in_file, coordinates)?.as_vec3();
    let at_intensity = place.key("intensity");
    let intensity = vector("intensity", file.intensity)?;
    let per_square = coordinates.unit * coordinates.unit;
    let intensity = at_intensity.radiance(intensity.map(|channel| channel / per_square))?;
    let range = match file.range {
        Some(range) if range > 0.0 => place.key("range").number(range / coordinates.unit)?,
        Some(range) => {
            let mend = "write a length above 0, or remove `range` for a light without a limit";
            return Err(place.key("range").error(format!("a light cannot have the range {range}"), mend));
        }
        None => f32::INFINITY,
    };
    if kind == 0 {
        return Ok(PunctualLight::from(LightShape::Point { position, intensity, range }));
    }
    let (key, along) = match (file.direction, file.look_at) {
        (along, None) => ("direction", vector("direction", along)?.into()),
        (None, Some(target)) => ("look_at", DVec3::from(target) - DVec3::from(in_file)),
        (Some(_), Some(_)) => {
            let mend = "remove `look_at`: both say where the spot shines";
            return Err(place.key("look_at").error("a spot with `direction` and `look_at`", mend));
        }
    };
    let [inner, outer] = cones(file, place)?;
    Ok(PunctualLight::from(LightShape::Spot {
        position,
        direction: direction(&place.key(key), along)?,
        intensity,
        range,
        inner_degrees: inner as f32,
        outer_degrees: outer as f32,
    }))
}

/// Refuses the keys that do not belong to a type, given by its index in [`TYPES`].
fn check_keys(file: &LightFile, kind: usize, place: &JsonPath) -> Result<(), SceneError> {
    let keys: [(&str, bool, &[usize]); 9] = [
        ("position", file.position.is_some(), &[0, 1]),
        ("direction", file.direction.is_some(), &[1, 2]),
        ("look_at", file.look_at.is_some(), &[1]),
        ("intensity", file.intensity.is_some(), &[0, 1]),
        ("irradiance", file.irradiance.is_some(), &[2]),
        ("range", file.range.is_some(), &[0, 1]),
        ("inner_degrees", file.inner_degrees.is_some(), &[1]),
        ("outer_degrees", file.outer_degrees.is_some(), &[1]),
        ("angular_diameter_degrees", file.angular_diameter_degrees.is_some(), &[2]),
    ];
    let own = |key: &&(&str, bool, &[usize])| key.2.contains(&kind);
    let known: Vec<&str> = keys.iter().filter(own).map(|key| key.0).collect();
    let Some((key, ..)) = keys.iter().find(|key| key.1 && !own(key)) else { return Ok(()) };
    let mend = format!("remove it; the keys of this type are {}", known.join(", "));
    Err(place.key(key).error(format!("`{key}` does not belong to a {} light", TYPES[kind]), mend))
}

/// Returns a direction of any length but 0 as a unit vector, except for rounding; a vector that is one
/// already keeps its bits.
fn direction(place: &JsonPath, along: DVec3) -> Result<Vec3, SceneError> {
    place.vec3(along.into())?;
    let unit = along.normalize_or_zero().as_vec3();
    let is_unit = (along.length() - 1.0).abs() < 1e-6;
    if unit == Vec3::ZERO {
        return Err(place.error("a direction of length zero", "write where the light shines, as [0, -1, 0]"));
    }
    Ok(if is_unit { along.as_vec3() } else { unit })
}

/// Returns the angles of a spot's cones in degrees.
fn cones(file: &LightFile, place: &JsonPath) -> Result<[f64; 2], SceneError> {
    let outer = file.outer_degrees.unwrap_or(45.0);
    let inner = file.inner_degrees.unwrap_or(0.0);
    let [least, _] = LEAST_DEGREES;
    if !(least..=90.0).contains(&outer) {
        let what = format!("a spot cannot reach {outer}° from its direction");
        return Err(place.key("outer_degrees").error(what, format!("write degrees from {least} to 90")));
    }
    if !(0.0..=outer).contains(&inner) {
        let what = format!("the inner cone of {inner}° is not within the outer one of {outer}°");
        return Err(place.key("inner_degrees").error(what, "write degrees from 0 to `outer_degrees`"));
    }
    Ok([inner, outer])
}

fn diameter(place: &JsonPath, file: &LightFile) -> Result<f32, SceneError> {
    let degrees = file.angular_diameter_degrees.unwrap_or(0.0);
    let [_, least] = LEAST_DEGREES;
    if degrees != 0.0 && !(least..=180.0).contains(&degrees) {
        let mend =
            format!("write 0 for a light without a disc, or degrees from {least} to 180; the sun has 0.53");
        return Err(place.error(format!("a disc of {degrees}° is impossible"), mend));
    }
    Ok(degrees as f32)
}
