//! Brings the numbers of a material into the ranges of the standard, and notes those that were outside.

use super::super::json::JsonPath;
use super::super::notes::Notes;
use super::schema::Material;
use std::slice::from_mut;

/// The range of shares.
const FRACTION: [f64; 2] = [0.0, 1.0];
/// The range of numbers that the standard does not limit, up to the largest brightness that is shown.
const POSITIVE: [f64; 2] = [0.0, 1e9];
/// The values of `alphaMode`.
const MODES: [&str; 3] = ["OPAQUE", "MASK", "BLEND"];

/// Returns the material with the nearest allowed number in place of each that is outside its range.
pub fn within_ranges(file: &Material, place: &JsonPath, notes: &mut Notes) -> Material {
    let mut file = file.clone();
    if let Some(mode) = file.alpha_mode.as_ref().filter(|mode| !MODES.contains(&mode.as_str())) {
        let what = format!("`{mode:.40}` is none of {}: the material is opaque", MODES.join(", "));
        notes.add(&place.key("alphaMode"), what);
    }
    let (pbr, extensions) = (&mut file.pbr_metallic_roughness, &mut file.extensions);
    let distance = &mut extensions.volume.attenuation_distance;
    if let Some(distance) = distance.take_if(|distance| *distance <= 0.0) {
        let place = format!("{place}.extensions.KHR_materials_volume.attenuationDistance");
        notes.add(&place, format!("{distance} is not above 0: the volume absorbs no light"));
    }
    // An `ior` of 0 stands for a dielectric that reflects everything.
    extensions.ior.ior.iter_mut().filter(|ior| **ior == 0.0).for_each(|ior| *ior = 1e6);
    let mut hold = |key: &str, numbers: &mut [f64], [least, most]: [f64; 2]| {
        for number in numbers.iter_mut().filter(|number| !(least..=most).contains(*number)) {
            let held = number.clamp(least, most);
            let what = format!("{number} is outside {least} to {most}: {held} is used");
            notes.add(&format!("{place}.{key}"), what);
            *number = held;
        }
    };
    hold("alphaCutoff", file.alpha_cutoff.as_mut_slice(), POSITIVE);
    hold("emissiveFactor", file.emissive_factor.as_mut_slice().as_flattened_mut(), POSITIVE);
    let color = pbr.base_color_factor.as_mut_slice().as_flattened_mut();
    hold("pbrMetallicRoughness.baseColorFactor", color, FRACTION);
    hold("pbrMetallicRoughness.metallicFactor", pbr.metallic_factor.as_mut_slice(), FRACTION);
    hold("pbrMetallicRoughness.roughnessFactor", pbr.roughness_factor.as_mut_slice(), FRACTION);
    let mut hold = |name: &str, key: &str, numbers: &mut [f64], range| {
        hold(&format!("extensions.KHR_materials_{name}.{key}"), numbers, range);
    };
    let (specular, coat) = (&mut extensions.specular, &mut extensions.clearcoat);
    let (transmission, volume) = (&mut extensions.transmission, &mut extensions.volume);
    hold("ior", "ior", extensions.ior.ior.as_mut_slice(), [1.0, 1e6]);
    let strength = &mut extensions.emissive_strength.emissive_strength;
    hold("emissive_strength", "emissiveStrength", strength.as_mut_slice(), POSITIVE);
    hold("specular", "specularFactor", specular.specular_factor.as_mut_slice(), FRACTION);
    let color = specular.specular_color_factor.as_mut_slice().as_flattened_mut();
    hold("specular", "specularColorFactor", color, POSITIVE);
    hold("clearcoat", "clearcoatFactor", from_mut(&mut coat.clearcoat_factor), FRACTION);
    hold("clearcoat", "clearcoatRoughnessFactor", from_mut(&mut coat.clearcoat_roughness_factor), FRACTION);
    hold("transmission", "transmissionFactor", from_mut(&mut transmission.transmission_factor), FRACTION);
    hold("volume", "thicknessFactor", from_mut(&mut volume.thickness_factor), [0.0, 1e18]);
    hold("volume", "attenuationColor", volume.attenuation_color.as_mut_slice().as_flattened_mut(), FRACTION);
    file
}
