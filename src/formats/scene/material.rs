//! Materials and skies of the native format: which keys belong together, and the defaults of missing ones.
//!
//! For: [`material`], [`sky`].

use super::builder::SceneBuilder;
use super::check::{fraction, not_negative, number, radiance, reflectance, turns};
use super::error::SceneError;
use super::files::Files;
use super::json::{JsonPath, Source};
use super::native::{FilterFile, MaterialFile, SkyFile};
use super::spelling::nearest;
use glam::Vec3;
use octray_engine::scene::{Filter, MIN_LENGTH, Material, MaterialKind, Sky, TexelKind};

/// Texture sizes below this are refused: a single-precision texture coordinate could not be finite
/// everywhere.
const MIN_TEXTURE_SIZE: f64 = MIN_LENGTH;

const TYPES: [&str; 7] = ["diffuse", "metal", "plastic", "metal-rough", "glass", "scatter", "emitter"];
/// Types that have a roughness.
const ROUGH: [&str; 4] = ["metal", "plastic", "metal-rough", "scatter"];

/// Adds one material to the builder and returns its index.
pub fn material(
    source: &Source,
    files: &Files,
    builder: &mut SceneBuilder,
    (name, file): &(String, MaterialFile),
    place: &JsonPath,
) -> Result<u32, SceneError> {
    check_keys(source, file, place)?;
    let roughness = place.key("roughness");
    // A map without `roughness` is the roughness itself: it multiplies 1.
    let unstated = if file.roughness_map.is_some() || file.r#type == "metal-rough" { 1.0 } else { 0.0 };
    let stated_roughness = file.roughness.unwrap_or(unstated);
    let kind = match file.r#type.as_str() {
        "diffuse" => MaterialKind::Diffuse,
        "metal" => MaterialKind::Metal { roughness: fraction(source, &roughness, stated_roughness)? },
        "plastic" => MaterialKind::Plastic {
            roughness: fraction(source, &roughness, stated_roughness)?,
            ior: coat_ior(source, &place.key("ior"), file.ior.unwrap_or(1.5))?,
        },
        "metal-rough" => MaterialKind::MetalRough {
            roughness: fraction(source, &roughness, stated_roughness)?,
            metallic: fraction(source, &place.key("metallic"), file.metallic.unwrap_or(1.0))?,
            ior: dielectric_ior(source, &place.key("ior"), file.ior.unwrap_or(1.5))?,
        },
        "glass" => MaterialKind::Glass { ior: ior(source, &place.key("ior"), file.ior.unwrap_or(1.5))? },
        "scatter" => {
            let roughness = not_negative(source, &roughness, stated_roughness)?;
            MaterialKind::Scatter { roughness }
        }
        _ => MaterialKind::Emitter,
    };
    let emitter = kind == MaterialKind::Emitter;
    let color = match file.color {
        Some(color) => reflectance(source, &place.key("color"), color)?,
        None if matches!(kind, MaterialKind::Diffuse | MaterialKind::Plastic { .. }) => Vec3::splat(0.8),
        None => Vec3::ONE,
    };
    let emission = match file.emission {
        Some(emission) => radiance(source, &place.key("emission"), emission)?,
        None if emitter || file.emission_map.is_some() => Vec3::ONE,
        None => Vec3::ZERO,
    };
    let mut load = |key: &'static str, path: &Option<String>, texel_kind| {
        let load = |path| texture(source, files, builder, &place.key(key), path, (file.filter, texel_kind));
        path.as_deref().map(load).transpose()
    };
    let texture = load("texture", &file.texture, TexelKind::Color)?;
    let roughness_map = load("roughness_map", &file.roughness_map, TexelKind::Data)?;
    let normal_map = load("normal_map", &file.normal_map, TexelKind::Data)?;
    let emission_map = load("emission_map", &file.emission_map, TexelKind::Color)?;
    let texture_size = match file.texture_size {
        Some(size) if size < MIN_TEXTURE_SIZE => {
            let mend = "write how many scene units one repeat of the texture covers, above 0";
            return Err(source.error(&place.key("texture_size"), format!("a texture of size {size}"), mend));
        }
        Some(size) => f64::from(number(source, &place.key("texture_size"), size)?),
        None => 1.0,
    };
    let name = name.clone();
    let material = Material { name, kind, color, texture, roughness_map, normal_map, emission, emission_map };
    Ok(builder.add_material(material, texture_size))
}

/// Refuses unknown types and keys that do not belong to the type.
fn check_keys(source: &Source, file: &MaterialFile, place: &JsonPath) -> Result<(), SceneError> {
    let name = file.r#type.as_str();
    if !TYPES.contains(&name) {
        let guess = nearest(name, TYPES).map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
        let mend = format!("{guess}the types are {}", TYPES.join(", "));
        return Err(source.error(&place.key("type"), format!("unknown material type `{name}`"), mend));
    }
    let refuse = |key: &str, mend: &str| {
        Err(source.error(&place.key(key), format!("`{key}` does not belong to a {name} material"), mend))
    };
    if file.roughness.is_some() && !ROUGH.contains(&name) {
        return refuse(
            "roughness",
            "remove it, or make the type `metal`, `plastic`, `metal-rough` or `scatter`",
        );
    }
    if file.roughness_map.is_some() && !ROUGH.contains(&name) {
        let mend = "remove it, or make the type `metal`, `plastic`, `metal-rough` or `scatter`";
        return refuse("roughness_map", mend);
    }
    if file.metallic.is_some() && name != "metal-rough" {
        return refuse("metallic", "remove it, or make the type `metal-rough`");
    }
    if file.roughness_map.is_some() && file.roughness == Some(0.0) && name != "metal-rough" {
        let mend = "remove it, or give `roughness` a number above 0, which it multiplies";
        let what = "a `roughness_map` multiplies `roughness` and cannot change a `roughness` of 0";
        return Err(source.error(&place.key("roughness_map"), what, mend));
    }
    if file.normal_map.is_some() && name == "emitter" {
        return refuse("normal_map", "remove it: an emitter scatters nothing");
    }
    if file.emission_map.is_some() && name == "emitter" {
        return refuse("emission_map", "make it the `texture`, which multiplies the emission of an emitter");
    }
    if file.ior.is_some() && !["glass", "plastic", "metal-rough"].contains(&name) {
        return refuse("ior", "remove it, or make the type `glass`, `plastic` or `metal-rough`");
    }
    if file.color.is_some() && name == "emitter" {
        return refuse("color", "remove it: an emitter scatters nothing; its light is `emission`");
    }
    let pictures = [&file.texture, &file.roughness_map, &file.normal_map, &file.emission_map];
    if pictures.iter().all(|path| path.is_none()) {
        let present = [("filter", file.filter.is_some()), ("texture_size", file.texture_size.is_some())];
        if let Some((key, _)) = present.iter().find(|(_, present)| *present) {
            let what = format!("`{key}` without a `texture`");
            return Err(source.error(&place.key(key), what, "remove it, or add a `texture`"));
        }
    }
    Ok(())
}

fn ior(source: &Source, place: &JsonPath, x: f64) -> Result<f32, SceneError> {
    // Its reciprocal must be finite too.
    if x < MIN_LENGTH {
        let mend = "write a number above 0: water is 1.33, glass 1.5, diamond 2.4";
        return Err(source.error(place, format!("an index of refraction of {x} is impossible"), mend));
    }
    number(source, place, x)
}

/// The index of refraction of metal-rough.
fn dielectric_ior(source: &Source, place: &JsonPath, x: f64) -> Result<f32, SceneError> {
    if x < 1.0 {
        let mend = "write a number of 1 or more: most dielectrics are about 1.5";
        return Err(source.error(
            place,
            format!("a surface cannot have an index of refraction of {x}"),
            mend,
        ));
    }
    number(source, place, x)
}

/// A coat's index of refraction. No coat has one above 3, where the model would gain energy
/// (`kernel::bsdf::plastic`).
fn coat_ior(source: &Source, place: &JsonPath, x: f64) -> Result<f32, SceneError> {
    if !(1.0..=3.0).contains(&x) {
        let what = format!("a coat cannot have an index of refraction of {x}");
        let mend = "write a number from 1 to 3: varnish and most plastics are about 1.5";
        return Err(source.error(place, what, mend));
    }
    Ok(x as f32)
}

fn texture(
    source: &Source,
    files: &Files,
    builder: &mut SceneBuilder,
    place: &JsonPath,
    path: &str,
    (filter, texel_kind): (Option<FilterFile>, TexelKind),
) -> Result<u32, SceneError> {
    let filter = match filter {
        Some(FilterFile::Nearest) => Filter::Nearest,
        Some(FilterFile::Bilinear) | None => Filter::Bilinear,
        Some(FilterFile::Trilinear) => Filter::Trilinear,
    };
    let full = files.resolve(path);
    builder.textures.load(files, &full, path, filter, texel_kind).map_err(|reason| {
        let mend = format!(
            "the file searched for is {}: give the path of an image (png, jpg, bmp, tga, hdr, exr) relative to the scene \
             file",
            full.display()
        );
        source.error(place, format!("cannot use the texture `{path}`: {reason}"), mend)
    })
}

/// The sky that a file describes.
pub fn sky(
    source: &Source,
    files: &Files,
    builder: &mut SceneBuilder,
    file: &SkyFile,
    place: &JsonPath,
) -> Result<Sky, SceneError> {
    if file.filter.is_some() && file.texture.is_none() {
        let mend = "remove it, or add a `texture`";
        return Err(source.error(&place.key("filter"), "`filter` without a `texture`", mend));
    }
    if file.turn_degrees.is_some() && file.texture.is_none() {
        let mend = "remove it, or add a `texture`: a sky without one is the same from all sides";
        return Err(source.error(&place.key("turn_degrees"), "`turn_degrees` without a `texture`", mend));
    }
    match file {
        SkyFile { gradient: Some(gradient), color: None, texture: None, .. } => {
            let place = place.key("gradient");
            Ok(Sky::Gradient {
                bottom: radiance(source, &place.key("bottom"), gradient.bottom)?,
                top: radiance(source, &place.key("top"), gradient.top)?,
            })
        }
        SkyFile { gradient: Some(_), .. } => {
            let mend = "keep `gradient` alone, or remove it and keep `color` and `texture`";
            Err(source.error(place, "a sky cannot have a `gradient` and a `color` or `texture`", mend))
        }
        SkyFile { color, texture: Some(path), filter, turn_degrees, .. } => Ok(Sky::Texture {
            turn: turns(source, &place.key("turn_degrees"), *turn_degrees)?,
            color: radiance(source, &place.key("color"), color.unwrap_or([1.0; 3]))?,
            texture: texture(
                source,
                files,
                builder,
                &place.key("texture"),
                path,
                (*filter, TexelKind::Color),
            )?,
        }),
        SkyFile { color: Some(color), .. } => Ok(Sky::Color(radiance(source, &place.key("color"), *color)?)),
        _ => {
            let mend = "give it a `color`, a `gradient` or a `texture`, or remove `sky`";
            Err(source.error(place, "the sky is empty", mend))
        }
    }
}
