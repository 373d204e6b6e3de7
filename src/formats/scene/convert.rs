//! Converts a model to a native scene file with its triangles and materials written out.
//!
//! For: [`native_from_obj`], [`native_from_obj_in`]. May import: `obj`, `files`, `write`, `native` (the
//! format's name). Must not know: how a scene file is read.
//!
//! Every number reads back as the same bits. Textures stay files, named as in the model's materials.

use super::error::SceneError;
use super::files::Files;
use super::native::FORMAT;
use super::obj;
use super::write::{camera, number, relative, vec2, vec3};
use glam::Vec3;
use octray_engine::scene::{Filter, Material, MaterialKind, Scene, Sky};
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

/// The text of a scene file that shows the model as [`load`](super::load) would. Texture paths are relative
/// to the model's folder, so that the file works there.
pub fn native_from_obj(model: &Path) -> Result<String, SceneError> {
    Ok(native_from_obj_in(model, model.parent().unwrap_or(Path::new("")))?.0)
}

/// The same for a scene file in another folder, with the model's warnings.
pub fn native_from_obj_in(model: &Path, folder: &Path) -> Result<(String, Vec<String>), SceneError> {
    let files = Files::beside(model);
    let scene = obj::scene(&files.read_named(model)?, model, &files, String::new())?;
    let models = model.parent().unwrap_or(Path::new(""));
    Ok((text(&scene, &|texture| relative(models, texture, folder)), scene.warnings))
}

fn text(scene: &Scene, texture_path: &dyn Fn(&str) -> String) -> String {
    let names = unique_names(&scene.materials);
    let mut text = String::from("{\n");
    let mut entry =
        |key: &str, value: String| writeln!(text, "  {}: {value},", json!(key)).expect("text grows");
    entry("format", json!(FORMAT).to_string());
    entry("camera", camera(&scene.camera));
    entry("resolution", json!(scene.resolution).to_string());
    entry("max_bounces", json!(scene.max_bounces).to_string());
    match scene.sky {
        Sky::Color(color) => entry("sky", format!("{{ \"color\": {} }}", vec3(color))),
        Sky::Gradient { bottom, top } => {
            let (bottom, top) = (vec3(bottom), vec3(top));
            entry("sky", format!("{{ \"gradient\": {{ \"bottom\": {bottom}, \"top\": {top} }} }}"));
        }
        // A model has no sky texture.
        Sky::Texture { .. } => {}
    }
    let materials = scene.materials.iter().zip(&names).map(|(material, name)| {
        format!("    {}: {}", json!(name), material_text(scene, material, texture_path))
    });
    entry("materials", format!("{{\n{}\n  }}", materials.collect::<Vec<_>>().join(",\n")));
    text.push_str("  \"triangles\": [\n");
    for (i, triangle) in scene.triangles.iter().enumerate() {
        let [a, b, c] = triangle.vertices.map(vec3);
        write!(text, "    {{ \"vertices\": [{a}, {b}, {c}]").expect("text grows");
        if scene.materials[triangle.material as usize].textures().next().is_some() {
            let [a, b, c] = scene.uvs[i].map(vec2);
            write!(text, ", \"uvs\": [{a}, {b}, {c}]").expect("text grows");
        }
        if let Some(normals) = scene.normals.get(i).filter(|normals| normals[0] != Vec3::ZERO) {
            let [a, b, c] = normals.map(vec3);
            write!(text, ", \"normals\": [{a}, {b}, {c}]").expect("text grows");
        }
        let comma = if i + 1 < scene.triangles.len() { "," } else { "" };
        let material = json!(names[triangle.material as usize]);
        writeln!(text, ", \"material\": {material} }}{comma}").expect("text grows");
    }
    text.push_str("  ]\n}\n");
    text
}

/// The materials' names, duplicates numbered: the format refuses a name that occurs twice.
fn unique_names(materials: &[Material]) -> Vec<String> {
    let mut seen: HashMap<String, usize> = HashMap::new();
    materials
        .iter()
        .map(|material| {
            let mut name = material.name.clone();
            while seen.contains_key(&name) {
                let count = seen.get_mut(&material.name).map_or(2, |count| {
                    *count += 1;
                    *count
                });
                name = format!("{} {count}", material.name);
            }
            seen.insert(name.clone(), 1);
            name
        })
        .collect()
}

fn material_text(scene: &Scene, material: &Material, texture_path: &dyn Fn(&str) -> String) -> String {
    let mut keys = Map::new();
    let mut set = |key: &str, value: Value| keys.insert(key.to_string(), value);
    let (kind, key) = match material.kind {
        MaterialKind::Diffuse => ("diffuse", None),
        MaterialKind::Metal { roughness } => ("metal", Some(("roughness", roughness))),
        MaterialKind::Scatter { roughness } => ("scatter", Some(("roughness", roughness))),
        MaterialKind::Glass { ior } => ("glass", Some(("ior", ior))),
        MaterialKind::Plastic { roughness, .. } => ("plastic", Some(("roughness", roughness))),
        MaterialKind::Emitter => ("emitter", None),
    };
    set("type", json!(kind));
    if let Some((key, value)) = key {
        set(key, json!(f64::from(value)));
    }
    if let MaterialKind::Plastic { ior, .. } = material.kind {
        set("ior", json!(f64::from(ior)));
    }
    if material.kind != MaterialKind::Emitter {
        set("color", channels(material.color));
    }
    if material.emission != Vec3::ZERO {
        set("emission", channels(material.emission));
    }
    let textures = [
        ("texture", material.texture),
        ("roughness_map", material.roughness_map),
        ("normal_map", material.normal_map),
    ];
    for (key, texture) in textures {
        if let Some(texture) = texture.map(|index| &scene.textures[index as usize]) {
            set(key, json!(texture_path(&texture.name)));
            if texture.filter == Filter::Nearest {
                set("filter", json!("nearest"));
            }
        }
    }
    Value::Object(keys).to_string()
}

fn channels(color: Vec3) -> Value {
    Value::Array(color.to_array().iter().map(|&x| number(x).parse().expect("a JSON number")).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unique_names_numbers_duplicates() {
        let material = |name: &str| Material {
            name: name.to_string(),
            kind: MaterialKind::Diffuse,
            color: Vec3::ONE,
            texture: None,
            roughness_map: None,
            normal_map: None,
            emission: Vec3::ZERO,
        };
        assert_eq!(
            unique_names(&["a", "a", "b", "a 2", "a"].map(material)),
            ["a", "a 2", "b", "a 2 2", "a 3"]
        );
    }
}
