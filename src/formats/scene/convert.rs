//! Converts a model to a native scene file with its triangles and materials.
//!
//! Every number reads back as the same bits. Textures stay files, named as in the model's materials. Textures
//! inside the model become files.

use super::error::SceneError;
use super::files::Files;
use super::material_extras;
use super::native::FORMAT;
use super::write::{camera, number, placed, relative, vector};
use super::{model, vertex_colors};
use crate::openexr;
use glam::Vec3;
use image::codecs::png::PngEncoder;
use image::{ExtendedColorType, ImageEncoder};
use octray_engine::film::Picture;
use octray_engine::scene::{
    Filter, LightShape, Material, MaterialKind, Portal, Scene, Sky, Texels, Texture, Wrap,
};
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// A scene file, and the pictures beside it.
pub struct Converted {
    /// The text of the scene file.
    pub text: String,
    /// The names beside the scene file, and the content, of textures inside the model, as in a .glb file.
    pub pictures: Vec<(PathBuf, Vec<u8>)>,
    /// The files that were read, and names that were tried.
    pub files: Vec<PathBuf>,
    /// Warnings about everything that was left out, with its place.
    pub warnings: Vec<String>,
}

/// Converts a model to a scene file at `scene` that loads as the same scene as the model. Texture paths in it
/// are relative to its folder.
pub fn convert_model(model: &Path, scene: &Path) -> Result<Converted, SceneError> {
    let files = Files::beside(model);
    let content = files.read_named(model)?;
    let shown = model::scene(&content, model, &files, String::new())?;
    let [models, folder] = [model, scene].map(|path| path.parent().unwrap_or(Path::new("")));
    let mut pictures = Vec::new();
    let mut paths = Vec::new();
    for texture in &shown.textures {
        if texture.name == vertex_colors::NAME {
            paths.push(String::new());
        } else if models.join(&texture.name).is_file() {
            paths.push(relative(models, &texture.name, folder));
        } else {
            let (extension, bytes) = encoded(texture).map_err(|reason| {
                let what = format!("cannot write the texture `{}`: {reason}", texture.name);
                SceneError::new(what).in_file(model)
            })?;
            let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
            let name = PathBuf::from(format!("{stem}-{}.{extension}", pictures.len() + 1));
            paths.push(name.to_string_lossy().into_owned());
            pictures.push((name, bytes));
        }
    }
    let text = text(&shown, &paths);
    Ok(Converted { text, pictures, files: files.into_requested(), warnings: shown.warnings })
}

/// Returns the extension and the content of an image file that reads back as the same texels.
fn encoded(texture: &Texture) -> Result<(&'static str, Vec<u8>), String> {
    let (width, height) = (texture.width, texture.height);
    let mut bytes = Vec::new();
    match &texture.texels {
        Texels::Srgb8(texels) | Texels::Unorm8(texels) => {
            let raw: Vec<u8> = texels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
            PngEncoder::new(&mut bytes)
                .write_image(&raw, width, height, ExtendedColorType::Rgb8)
                .map_err(|error| error.to_string())?;
            Ok(("png", bytes))
        }
        Texels::Float32(texels) => {
            let pixels = texels.iter().map(|&[r, g, b, _]| [r, g, b]).collect();
            openexr::write(std::io::Cursor::new(&mut bytes), &Picture { width, height, pixels }, "")
                .map_err(|error| error.to_string())?;
            Ok(("exr", bytes))
        }
    }
}

fn text(scene: &Scene, paths: &[String]) -> String {
    let names = unique_names(&scene.materials);
    let mut lines = Vec::new();
    let mut entry = |key: &str, value: String| lines.push(format!("  {}: {value}", json!(key)));
    entry("format", json!(FORMAT).to_string());
    entry("origin", json!(scene.coordinates.origin.to_array()).to_string());
    entry("camera", camera(&scene.camera, &scene.coordinates));
    entry("resolution", json!(scene.resolution).to_string());
    entry("max_bounces", json!(scene.max_bounces).to_string());
    match scene.sky {
        Sky::Color(color) => entry("sky", format!("{{ \"color\": {} }}", vector(color))),
        Sky::Gradient { bottom, top } => {
            let (bottom, top) = (vector(bottom), vector(top));
            entry("sky", format!("{{ \"gradient\": {{ \"bottom\": {bottom}, \"top\": {top} }} }}"));
        }
        // A model has no sky texture.
        Sky::Texture { .. } => {}
    }
    let materials =
        scene.materials.iter().zip(&names).map(|(material, name)| {
            format!("    {}: {}", json!(name), material_text(scene, material, paths))
        });
    entry("materials", format!("{{\n{}\n  }}", materials.collect::<Vec<_>>().join(",\n")));
    if !scene.portals.is_empty() {
        let points =
            |portal: &Portal| portal.vertices.map(|vertex| placed(vertex, &scene.coordinates)).join(", ");
        let portals =
            scene.portals.iter().map(|portal| format!("    {{ \"vertices\": [{}] }}", points(portal)));
        lines.push(format!("  \"portals\": [\n{}\n  ]", portals.collect::<Vec<_>>().join(",\n")));
    }
    let mut text = format!("{{\n{},\n  \"triangles\": [", lines.join(",\n"));
    for number in 0..scene.triangles.len() {
        text += if number == 0 { "\n" } else { ",\n" };
        text += &triangle_text(scene, number, &names);
    }
    text + "\n  ]" + &lights_text(scene) + "\n}\n"
}

/// Returns the entry of the lights; nothing without lights.
fn lights_text(scene: &Scene) -> String {
    if scene.lights.is_empty() {
        return String::new();
    }
    let lines = scene.lights.iter().map(|light| format!("    {}", light_text(&light.shape, scene)));
    format!(",\n  \"lights\": [\n{}\n  ]", lines.collect::<Vec<_>>().join(",\n"))
}

fn light_text(shape: &LightShape, scene: &Scene) -> String {
    let coordinates = &scene.coordinates;
    let at = |position: Vec3, intensity: Vec3, range: f32| {
        // The unit is a power of two: no digit changes.
        let unit = coordinates.unit as f32;
        let range = match range.is_finite() {
            true => format!(", \"range\": {}", number(range * unit)),
            false => String::new(),
        };
        let intensity = vector(intensity * unit * unit);
        format!("\"position\": {}, \"intensity\": {intensity}{range}", placed(position, coordinates))
    };
    match *shape {
        LightShape::Point { position, intensity, range } => {
            format!("{{ \"type\": \"point\", {} }}", at(position, intensity, range))
        }
        LightShape::Spot { position, direction, intensity, range, inner_degrees, outer_degrees } => format!(
            "{{ \"type\": \"spot\", {}, \"direction\": {}, \"inner_degrees\": {}, \"outer_degrees\": {} }}",
            at(position, intensity, range),
            vector(direction),
            number(inner_degrees),
            number(outer_degrees)
        ),
        LightShape::Directional { direction, irradiance, angular_diameter_degrees } => format!(
            "{{ \"type\": \"directional\", \"direction\": {}, \"irradiance\": {}, \
             \"angular_diameter_degrees\": {} }}",
            vector(direction),
            vector(irradiance),
            number(angular_diameter_degrees)
        ),
    }
}

fn triangle_text(scene: &Scene, number: usize, names: &[String]) -> String {
    let triangle = &scene.triangles[number];
    let material = &scene.materials[triangle.material as usize];
    let three = |key: &str, [a, b, c]: [String; 3]| format!("\"{key}\": [{a}, {b}, {c}], ");
    let mut text = three("vertices", triangle.vertices.map(|vertex| placed(vertex, &scene.coordinates)));
    if let Some(texture) = vertex_colors_of(scene, material) {
        let colors = vertex_colors::read_back(texture, scene.uvs[number]);
        text += &three("colors", colors.map(vector));
    } else if material.textures().next().is_some() {
        text += &three("uvs", scene.uvs[number].map(vector));
    }
    if let Some(normals) = scene.normals.get(number).filter(|normals| normals[0] != Vec3::ZERO) {
        text += &three("normals", normals.map(vector));
    }
    format!("    {{ {text}\"material\": {} }}", json!(names[triangle.material as usize]))
}

/// Returns the materials' names. Duplicates are numbered, because the format refuses them.
fn unique_names(materials: &[Material]) -> Vec<String> {
    let mut seen: HashMap<String, usize> = HashMap::new();
    materials
        .iter()
        .map(|material| {
            let mut name = material.name.clone();
            while seen.contains_key(&name) {
                let count = seen.entry(material.name.clone()).and_modify(|count| *count += 1).or_insert(2);
                name = format!("{} {count}", material.name);
            }
            seen.insert(name.clone(), 1);
            name
        })
        .collect()
}

/// Returns the texture of vertex colours, if the material has it.
fn vertex_colors_of<'a>(scene: &'a Scene, material: &Material) -> Option<&'a Texture> {
    let texture = &scene.textures[material.texture? as usize];
    (texture.name == vertex_colors::NAME).then_some(texture)
}

fn material_text(scene: &Scene, material: &Material, paths: &[String]) -> String {
    let (kind, numbers) = match material.kind {
        MaterialKind::Diffuse => ("diffuse", vec![]),
        MaterialKind::Metal { roughness } => ("metal", vec![("roughness", roughness)]),
        MaterialKind::FuzzyMirror { roughness } => ("scatter", vec![("roughness", roughness)]),
        MaterialKind::Glass { ior } | MaterialKind::ThinGlass { ior } => ("glass", vec![("ior", ior)]),
        MaterialKind::RoughGlass { roughness, ior, .. } => {
            ("glass", vec![("roughness", roughness), ("ior", ior)])
        }
        MaterialKind::Plastic { roughness, ior } => ("plastic", vec![("roughness", roughness), ("ior", ior)]),
        MaterialKind::MetalRough { roughness, metallic, ior } => {
            ("metal-rough", vec![("roughness", roughness), ("metallic", metallic), ("ior", ior)])
        }
        MaterialKind::Emitter => ("emitter", vec![]),
    };
    let numbers = numbers.into_iter().map(|(key, x)| (key.to_string(), json!(f64::from(x))));
    let mut keys: Map<String, Value> = numbers.collect();
    let mut set = |key: &str, value: Value| keys.insert(key.to_string(), value);
    set("type", json!(kind));
    if matches!(material.kind, MaterialKind::ThinGlass { .. } | MaterialKind::RoughGlass { thin: true, .. }) {
        set("thin", json!(true));
    }
    for (key, value) in material_extras::keys(&material.extras, scene.coordinates.unit) {
        set(key, value);
    }
    if material.kind != MaterialKind::Emitter {
        set("color", channels(material.color));
    }
    if material.emits() {
        set("emission", channels(material.emission));
    }
    if material.opacity < 1.0 {
        set("opacity", json!(f64::from(material.opacity)));
    }
    if let Some(cutoff) = material.alpha_cutoff {
        set("alpha_cutoff", json!(f64::from(cutoff)));
    }
    let textures = [
        ("texture", material.texture),
        ("roughness_map", material.roughness_map),
        ("normal_map", material.normal_map),
        ("emission_map", material.emission_map),
        ("opacity_map", material.opacity_map),
    ];
    let is_colored = vertex_colors_of(scene, material).is_some();
    for (key, index) in textures.into_iter().filter(|_| !is_colored) {
        let Some(index) = index.map(|index| index as usize) else { continue };
        set(key, json!(paths[index]));
        let Texture { filter, wrap, .. } = &scene.textures[index];
        if *filter == Filter::Nearest {
            set("filter", json!("nearest"));
        }
        if *wrap != [Wrap::Repeat; 2] {
            set("wrap", json!(wrap.map(Wrap::name)));
        }
    }
    Value::Object(keys).to_string()
}

fn channels(color: Vec3) -> Value {
    Value::Array(color.to_array().iter().map(|&x| number(x).parse().expect("a JSON number")).collect())
}
