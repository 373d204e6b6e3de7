//! Converts the parameters that few materials have, from the native format and back.

use super::error::SceneError;
use super::json::JsonPath;
use super::native::MaterialFile;
use glam::Vec3;
use octray_engine::scene::{Attenuation, MIN_LENGTH, MaterialExtras};
use serde_json::{Value, json};

/// Reads the parameters of a material that emits `emission`. Distances are in units of the file.
pub fn read(file: &MaterialFile, emission: Vec3, place: &JsonPath) -> Result<MaterialExtras, SceneError> {
    let plain = MaterialExtras::default();
    let fraction = |key: &'static str, value: Option<f64>, unstated: f32| {
        value.map_or(Ok(unstated), |value| place.key(key).fraction(value))
    };
    let is_thin = file.thin == Some(true);
    let transmission = fraction("transmission", file.transmission, plain.transmission)?;
    let is_metal_rough = file.r#type == "metal-rough";
    let attenuation = attenuation(file, place)?;
    if is_metal_rough && transmission == 0.0 && (is_thin || attenuation.is_some()) {
        let key = if is_thin { "thin" } else { "attenuation_color" };
        let mend = "remove it, or give `transmission` a number above 0";
        return Err(place.key(key).error(format!("`{key}` on a surface that lets no light through"), mend));
    }
    if attenuation.is_some() && (is_thin || emission != Vec3::ZERO) {
        let (what, other) = match is_thin {
            true => ("a pane without thickness absorbs nothing", "thin"),
            false => ("glass that emits light cannot absorb it", "emission"),
        };
        let mend = format!("remove it and `attenuation_distance`, or remove `{other}`");
        return Err(place.key("attenuation_color").error(what, mend));
    }
    if file.clearcoat_roughness.is_some() && file.clearcoat.is_none() {
        let mend = "remove it, or add `clearcoat`: the share of the surface that is coated";
        let what = "`clearcoat_roughness` without a `clearcoat`";
        return Err(place.key("clearcoat_roughness").error(what, mend));
    }
    Ok(MaterialExtras {
        transmission,
        thin: is_metal_rough && is_thin,
        attenuation,
        specular: fraction("specular", file.specular, plain.specular)?,
        specular_color: match file.specular_color {
            Some(color) => place.key("specular_color").radiance(color)?,
            None => plain.specular_color,
        },
        clearcoat: fraction("clearcoat", file.clearcoat, plain.clearcoat)?,
        clearcoat_roughness: fraction(
            "clearcoat_roughness",
            file.clearcoat_roughness,
            plain.clearcoat_roughness,
        )?,
    })
}

fn attenuation(file: &MaterialFile, place: &JsonPath) -> Result<Option<Attenuation>, SceneError> {
    let (color, distance) = match (file.attenuation_color, file.attenuation_distance) {
        (None, None) => return Ok(None),
        (Some(color), Some(distance)) => (color, distance),
        (Some(_), None) => {
            let mend = "add `attenuation_distance`: the length after which white light has this colour";
            return Err(place.key("attenuation_color").error("a colour without its distance", mend));
        }
        (None, Some(_)) => {
            let mend = "add `attenuation_color`: the colour of white light after this length";
            return Err(place.key("attenuation_distance").error("a distance without its colour", mend));
        }
    };
    let at_distance = place.key("attenuation_distance");
    if distance < MIN_LENGTH {
        let mend = "write a length above 0, in scene units";
        return Err(at_distance.error(format!("light cannot be absorbed over a length of {distance}"), mend));
    }
    let color = place.key("attenuation_color").reflectance(color)?;
    Ok(Some(Attenuation { color, distance: at_distance.number(distance)? }))
}

/// Returns the keys and values of the parameters that differ from the default; `unit` is the length of a
/// scene unit in the file.
pub fn keys(extras: &MaterialExtras, unit: f64) -> Vec<(&'static str, Value)> {
    let plain = MaterialExtras::default();
    let number = |x: f32| json!(f64::from(x));
    let channels = |color: Vec3| json!(color.to_array().map(f64::from));
    let mut keys = Vec::new();
    let MaterialExtras {
        transmission,
        thin,
        attenuation,
        specular,
        specular_color,
        clearcoat,
        clearcoat_roughness,
    } = *extras;
    for (key, value, unstated) in [
        ("transmission", transmission, plain.transmission),
        ("specular", specular, plain.specular),
        ("clearcoat", clearcoat, plain.clearcoat),
    ] {
        if value != unstated {
            keys.push((key, number(value)));
        }
    }
    if thin {
        keys.push(("thin", json!(true)));
    }
    if let Some(Attenuation { color, distance }) = attenuation {
        keys.push(("attenuation_color", channels(color)));
        keys.push(("attenuation_distance", json!(f64::from(distance) * unit)));
    }
    if specular_color != plain.specular_color {
        keys.push(("specular_color", channels(specular_color)));
    }
    if clearcoat > 0.0 && clearcoat_roughness != plain.clearcoat_roughness {
        keys.push(("clearcoat_roughness", number(clearcoat_roughness)));
    }
    keys
}
