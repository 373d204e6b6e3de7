//! Converts materials and skies of the native format: checks their keys, and fills in defaults.

use super::builder::SceneBuilder;
use super::error::SceneError;
use super::json::JsonPath;
use super::material_extras;
use super::native::{MaterialFile, SkyFile, WrapsFile};
use super::spelling::did_you_mean;
use super::texture::Lookup;
use glam::Vec3;
use octray_engine::scene::{MIN_LENGTH, Material, MaterialKind, Sky, TexelKind, Wrap};

/// Least texture size. With a smaller one, texture coordinates could be infinite in single precision.
const MIN_TEXTURE_SIZE: f64 = MIN_LENGTH;

const TYPES: [&str; 7] = ["diffuse", "metal", "plastic", "metal-rough", "glass", "scatter", "emitter"];
/// The types that have a roughness.
const ROUGH: &[&str] = &["metal", "plastic", "metal-rough", "glass", "scatter"];
/// All types but `emitter`.
const SCATTERING: &[&str] = &["diffuse", "metal", "plastic", "metal-rough", "glass", "scatter"];

/// Adds one material to the builder and returns its index.
pub fn material(
    builder: &mut SceneBuilder,
    (name, file): &(String, MaterialFile),
    place: &JsonPath,
) -> Result<u32, SceneError> {
    check_keys(file, place)?;
    // A map without `roughness` multiplies 1, and so is the roughness itself.
    let unstated = if file.roughness_map.is_some() || file.r#type == "metal-rough" { 1.0 } else { 0.0 };
    let stated_roughness = file.roughness.unwrap_or(unstated);
    let roughness = || place.key("roughness").fraction(stated_roughness);
    let ior = || ior(&place.key("ior"), &file.r#type, file.ior.unwrap_or(1.5));
    let kind = match file.r#type.as_str() {
        "diffuse" => MaterialKind::Diffuse,
        "metal" => MaterialKind::Metal { roughness: roughness()? },
        "plastic" => MaterialKind::Plastic { roughness: roughness()?, ior: ior()? },
        "metal-rough" => MaterialKind::MetalRough {
            roughness: roughness()?,
            metallic: place.key("metallic").fraction(file.metallic.unwrap_or(1.0))?,
            ior: ior()?,
        },
        "glass" => match (roughness()?, file.thin == Some(true)) {
            (0.0, false) => MaterialKind::Glass { ior: ior()? },
            (0.0, true) => MaterialKind::ThinGlass { ior: ior()? },
            (roughness, thin) => MaterialKind::RoughGlass { roughness, ior: ior()?, thin },
        },
        "scatter" => {
            MaterialKind::FuzzyMirror { roughness: place.key("roughness").not_negative(stated_roughness)? }
        }
        _ => MaterialKind::Emitter,
    };
    let color = match file.color {
        Some(color) => place.key("color").reflectance(color)?,
        None if matches!(kind, MaterialKind::Diffuse | MaterialKind::Plastic { .. }) => Vec3::splat(0.8),
        None => Vec3::ONE,
    };
    let emission = match file.emission {
        Some(emission) => place.key("emission").radiance(emission)?,
        None if kind == MaterialKind::Emitter || file.emission_map.is_some() => Vec3::ONE,
        None => Vec3::ZERO,
    };
    let cutoff = |cutoff| place.key("alpha_cutoff").fraction(cutoff);
    let alpha_cutoff = file.alpha_cutoff.map(cutoff).transpose()?;
    let wrap = match file.wrap {
        Some(WrapsFile::Each(each)) => each,
        Some(WrapsFile::Both(both)) => [both; 2],
        None => [Wrap::Repeat; 2],
    };
    let mut load = |key: &'static str, path: &Option<String>, texel_kind| {
        let lookup = Lookup { filter: file.filter.unwrap_or_default(), wrap, kind: texel_kind };
        let load = |path| texture(builder, &place.key(key), path, lookup);
        path.as_deref().map(load).transpose()
    };
    let material = Material {
        texture: load("texture", &file.texture, TexelKind::Color)?,
        roughness_map: load("roughness_map", &file.roughness_map, TexelKind::Data)?,
        normal_map: load("normal_map", &file.normal_map, TexelKind::Data)?,
        emission,
        emission_map: load("emission_map", &file.emission_map, TexelKind::Color)?,
        extras: material_extras::read(file, emission, place)?,
        opacity: place.key("opacity").fraction(file.opacity.unwrap_or(1.0))?,
        opacity_map: load("opacity_map", &file.opacity_map, TexelKind::AlphaOrGrey)?,
        alpha_cutoff,
        ..Material::new(name, kind, color)
    };
    let is_metal = matches!(kind, MaterialKind::MetalRough { metallic: 1.0, .. });
    if is_metal && material.roughness_map.is_none() && material.extras.transmission > 0.0 {
        let what = "metal lets no light through: write a `metallic` below 1, such as 0, or remove this";
        builder.notes.add(&place.key("transmission"), what);
    }
    let texture_size = match file.texture_size {
        Some(size) if size < MIN_TEXTURE_SIZE => {
            let mend = "write how many scene units one repeat of the texture covers, above 0";
            return Err(place.key("texture_size").error(format!("a texture of size {size}"), mend));
        }
        Some(size) => f64::from(place.key("texture_size").number(size)?),
        None => 1.0,
    };
    Ok(builder.add_material(material, texture_size))
}

const NOT_ROUGH: &str = "remove it, or make the type `metal`, `plastic`, `glass`, `metal-rough` or `scatter`";
const NOT_EMISSION: &str = "make it the `texture`, which multiplies the emission of an emitter";
const NOT_COLOR: &str = "remove it: an emitter scatters nothing; its light is `emission`";
/// The types that may let light through, and those with layers.
const TRANSMITTING: &[&str] = &["glass", "metal-rough"];
const LAYERED: &[&str] = &["metal-rough"];
const NOT_CLEAR: &str = "remove it, or make the type `glass`";
const NOT_LAYERED: &str = "remove it, or make the type `metal-rough`";
const NO_INDEX: &str = "remove it, or make the type `glass`, `plastic` or `metal-rough`";

/// A key that some types lack, the types that have it, the remedy for the others, and whether it is there.
type Rule = (&'static str, &'static [&'static str], &'static str, fn(&MaterialFile) -> bool);

const RULES: [Rule; 15] = [
    ("roughness", ROUGH, NOT_ROUGH, |file| file.roughness.is_some()),
    ("roughness_map", ROUGH, NOT_ROUGH, |file| file.roughness_map.is_some()),
    ("metallic", &["metal-rough"], "remove it, or make the type `metal-rough`", |file| {
        file.metallic.is_some()
    }),
    ("normal_map", SCATTERING, "remove it: an emitter scatters nothing", |file| file.normal_map.is_some()),
    ("emission_map", SCATTERING, NOT_EMISSION, |file| file.emission_map.is_some()),
    ("ior", &["glass", "plastic", "metal-rough"], NO_INDEX, |file| file.ior.is_some()),
    ("thin", TRANSMITTING, NOT_CLEAR, |file| file.thin.is_some()),
    ("attenuation_color", TRANSMITTING, NOT_CLEAR, |file| file.attenuation_color.is_some()),
    ("attenuation_distance", TRANSMITTING, NOT_CLEAR, |file| file.attenuation_distance.is_some()),
    ("transmission", LAYERED, NOT_LAYERED, |file| file.transmission.is_some()),
    ("specular", LAYERED, NOT_LAYERED, |file| file.specular.is_some()),
    ("specular_color", LAYERED, NOT_LAYERED, |file| file.specular_color.is_some()),
    ("clearcoat", LAYERED, NOT_LAYERED, |file| file.clearcoat.is_some()),
    ("clearcoat_roughness", LAYERED, NOT_LAYERED, |file| file.clearcoat_roughness.is_some()),
    ("color", SCATTERING, NOT_COLOR, |file| file.color.is_some()),
];

/// Tests whether materials of this type have a key of materials. A type that does not exist has all.
pub fn has_key(material_type: &str, key: &str) -> bool {
    !TYPES.contains(&material_type)
        || RULES.iter().all(|(known, types, ..)| *known != key || types.contains(&material_type))
}

/// Tests whether this is a key of materials, by any of its names.
pub fn is_key(word: &str) -> bool {
    let keys =
        ["color", "emission", "roughness", "metallic", "ior", "thin", "texture", "normal_map", "opacity"];
    RULES.iter().any(|(key, ..)| *key == word)
        || keys.contains(&word)
        || !did_you_mean(word, &keys).is_empty()
}

/// Refuses unknown types and keys that do not belong to the type.
fn check_keys(file: &MaterialFile, place: &JsonPath) -> Result<(), SceneError> {
    let name = file.r#type.as_str();
    if !TYPES.contains(&name) {
        let mend = format!("{}the types are {}", did_you_mean(name, &TYPES), TYPES.join(", "));
        return Err(place.key("type").error(format!("unknown material type `{name}`"), mend));
    }
    let misplaced = RULES.iter().filter(|(_, types, _, is_there)| is_there(file) && !types.contains(&name));
    let faults = misplaced.map(|(key, _, mend, _)| {
        place.key(key).error(format!("`{key}` does not belong to a material of type `{name}`"), *mend)
    });
    if let Some(error) = SceneError::join(faults.collect()) {
        return Err(error);
    }
    if file.roughness_map.is_some() && file.roughness == Some(0.0) && name != "metal-rough" {
        let mend = "remove it, or give `roughness` a number above 0, which it multiplies";
        let what = "a `roughness_map` multiplies `roughness` and cannot change a `roughness` of 0";
        return Err(place.key("roughness_map").error(what, mend));
    }
    if file.alpha_cutoff.is_some() && file.opacity_map.is_none() {
        let mend = "remove it, or add an `opacity_map`: the `texture` again, if its alpha cuts parts out";
        return Err(place.key("alpha_cutoff").error("`alpha_cutoff` without an `opacity_map`", mend));
    }
    let MaterialFile { texture, roughness_map, normal_map, emission_map, opacity_map, .. } = file;
    let pictures = [texture, roughness_map, normal_map, emission_map, opacity_map];
    if pictures.iter().all(|path| path.is_none()) {
        needs_texture("filter", file.filter.is_some(), place, "")?;
        needs_texture("wrap", file.wrap.is_some(), place, "")?;
        needs_texture("texture_size", file.texture_size.is_some(), place, "")?;
    }
    Ok(())
}

/// Refuses a key of a texture if there is no texture.
fn needs_texture(key: &str, is_there: bool, place: &JsonPath, why: &str) -> Result<(), SceneError> {
    if is_there {
        let mend = format!("remove it, or add a `texture`{why}");
        return Err(place.key(key).error(format!("`{key}` without a `texture`"), mend));
    }
    Ok(())
}

/// Checks the index of refraction of a material of this type. Above 3, a coat would gain energy in the model
/// (`kernel::bsdf::plastic`). The reciprocal of glass's must be finite.
fn ior(place: &JsonPath, material_type: &str, x: f64) -> Result<f32, SceneError> {
    let (range, what, mend) = match material_type {
        "glass" => (
            MIN_LENGTH..=f64::INFINITY,
            format!("an index of refraction of {x} is impossible"),
            "write a number above 0: water is 1.33, glass 1.5, diamond 2.4",
        ),
        "plastic" => (
            1.0..=3.0,
            format!("a coat cannot have an index of refraction of {x}"),
            "write a number from 1 to 3: varnish and most plastics are about 1.5",
        ),
        _ => (
            1.0..=f64::INFINITY,
            format!("a surface cannot have an index of refraction of {x}"),
            "write a number of 1 or more: most dielectrics are about 1.5",
        ),
    };
    if range.contains(&x) { place.number(x) } else { Err(place.error(what, mend)) }
}

fn texture(
    builder: &mut SceneBuilder,
    place: &JsonPath,
    path: &str,
    lookup: Lookup,
) -> Result<u32, SceneError> {
    let full = builder.files().resolve(path);
    builder.textures.load(&full, path, lookup).map_err(|reason| {
        let mend = format!(
            "the file searched for is {}: give the path of an image (png, jpg, webp, bmp, tga, hdr, exr) relative to the scene \
             file",
            full.display()
        );
        place.error(format!("cannot use the texture `{path}`: {reason}"), mend)
    })
}

/// Converts the sky of a file.
pub fn sky(builder: &mut SceneBuilder, file: &SkyFile, place: &JsonPath) -> Result<Sky, SceneError> {
    if file.texture.is_none() {
        needs_texture("filter", file.filter.is_some(), place, "")?;
        let why = ": a sky without one is the same from all sides";
        needs_texture("turn_degrees", file.turn_degrees.is_some(), place, why)?;
    }
    match file {
        SkyFile { gradient: Some(gradient), color: None, texture: None, .. } => {
            let place = place.key("gradient");
            Ok(Sky::Gradient {
                bottom: place.key("bottom").radiance(gradient.bottom)?,
                top: place.key("top").radiance(gradient.top)?,
            })
        }
        SkyFile { gradient: Some(_), .. } => {
            let mend = "keep `gradient` alone, or remove it and keep `color` and `texture`";
            Err(place.error("a sky cannot have a `gradient` and a `color` or `texture`", mend))
        }
        SkyFile { color, texture: Some(path), turn_degrees, .. } => Ok(Sky::Texture {
            turn: place.key("turn_degrees").turns(*turn_degrees)?,
            color: place.key("color").radiance(color.unwrap_or([1.0; 3]))?,
            texture: {
                let lookup = Lookup::repeating(file.filter.unwrap_or_default(), TexelKind::Color);
                texture(builder, &place.key("texture"), path, lookup)?
            },
        }),
        SkyFile { color: Some(color), .. } => Ok(Sky::Color(place.key("color").radiance(*color)?)),
        _ => {
            let mend = "give it a `color`, a `gradient` or a `texture`, or remove `sky`";
            Err(place.error("the sky is empty", mend))
        }
    }
}
