//! A model as a scene file of the native format that stands alone: triangles written out, materials beside them.
//!
//! For: [`native_from_obj`]. May import: scene's own files. Must never know: how a scene file is read.
//!
//! Every number is written so that reading it gives the same bits. Textures stay files, named as the model's materials
//! name them.

use super::file::FORMAT;
use super::files::read_named;
use super::{Filter, Material, MaterialKind, Scene, SceneError, Sky, obj};
use glam::{Vec2, Vec3};
use serde_json::{Map, Value, json};
use std::collections::HashMap;
use std::fmt::Write;
use std::path::Path;

/// The text of a scene file that shows the model as [`load`](super::load) would. Texture paths are relative to the
/// model's folder, so that the file works there.
pub fn native_from_obj(model: &Path) -> Result<String, SceneError> {
    Ok(native_from_obj_in(model, model.parent().unwrap_or(Path::new("")))?.0)
}

/// The same for a scene file in another folder, and what is odd about the model, a sentence each.
pub fn native_from_obj_in(model: &Path, folder: &Path) -> Result<(String, Vec<String>), SceneError> {
    let scene = obj::scene(&read_named(model)?, model, String::new())?;
    Ok((text(&scene, &|texture| relative(model, folder, texture)), scene.warnings))
}

/// The path from `folder` to a texture that the model names relative to its own folder.
fn relative(model: &Path, folder: &Path, texture: &str) -> String {
    // Joined with a dot, an empty path is the folder we are in.
    let folders = [model.parent().unwrap_or(Path::new("")), folder].map(|folder| folder.join("."));
    // Only real paths can be compared: `a/../b` is `b`, unless `a` is a link. What does not exist yet has none.
    let real = folders.each_ref().map(|folder| folder.canonicalize());
    let [model_folder, folder] = match real {
        [Ok(model_folder), Ok(folder)] => [model_folder, folder],
        _ => folders.map(|folder| std::path::absolute(&folder).unwrap_or(folder)),
    };
    let target = model_folder.join(texture);
    let shared = target.components().zip(folder.components()).take_while(|(a, b)| a == b).count();
    if shared == 0 {
        return target.to_string_lossy().into_owned();
    }
    let up = folder.components().skip(shared).map(|_| "..".to_string());
    let down = target.components().skip(shared).map(|part| part.as_os_str().to_string_lossy().into_owned());
    up.chain(down).collect::<Vec<_>>().join("/")
}

fn text(scene: &Scene, texture_path: &dyn Fn(&str) -> String) -> String {
    let names = unique_names(&scene.materials);
    let mut text = String::from("{\n");
    let mut entry =
        |key: &str, value: String| writeln!(text, "  {}: {value},", json!(key)).expect("text grows");
    entry("format", json!(FORMAT).to_string());
    let camera = scene.camera;
    entry(
        "camera",
        format!(
            "{{ \"position\": {}, \"look_at\": {}, \"up\": {}, \"vertical_fov\": {} }}",
            vec3(camera.position),
            vec3(camera.look_at),
            vec3(camera.up),
            number(camera.vertical_fov)
        ),
    );
    entry("resolution", json!(scene.resolution).to_string());
    entry("max_bounces", json!(scene.max_bounces).to_string());
    match scene.sky {
        Sky::Color(color) => entry("sky", format!("{{ \"color\": {} }}", vec3(color))),
        Sky::Gradient { bottom, top } => {
            let (bottom, top) = (vec3(bottom), vec3(top));
            entry("sky", format!("{{ \"gradient\": {{ \"bottom\": {bottom}, \"top\": {top} }} }}"));
        }
        // No model brings a picture of the sky.
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
        if scene.materials[triangle.material as usize].pictures().next().is_some() {
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

/// The materials' names, numbered where a name stands twice: the format has each only once.
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
    let pictures = [
        ("texture", material.texture),
        ("roughness_map", material.roughness_map),
        ("normal_map", material.normal_map),
    ];
    for (key, picture) in pictures {
        if let Some(texture) = picture.map(|index| &scene.textures[index as usize]) {
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

fn vec3(v: Vec3) -> String {
    format!("[{}, {}, {}]", number(v.x), number(v.y), number(v.z))
}

fn vec2(v: Vec2) -> String {
    format!("[{}, {}]", number(v.x), number(v.y))
}

/// The shortest decimal that reads back as the same bits. Reading goes through f64, so what is shortest for f32 could in
/// principle round twice; then f64's digits serve.
fn number(x: f32) -> String {
    let short = json_digits(f64::from(x).abs() >= 1e16, &x);
    let read_back = short.parse::<f64>().map(|read| read as f32);
    if read_back.is_ok_and(|read| read.to_bits() == x.to_bits()) {
        short
    } else {
        json_digits(false, &f64::from(x))
    }
}

/// `{:e}` keeps huge numbers short; JSON reads both forms.
fn json_digits<T: std::fmt::Display + std::fmt::LowerExp>(huge: bool, x: &T) -> String {
    if huge { format!("{x:e}") } else { format!("{x}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn number_reads_back_as_the_same_bits_at_any_magnitude() {
        // Every bit pattern at a stride that is a large prime: all exponents, many fractions.
        for bits in (0..u32::MAX).step_by(104_729) {
            let x = f32::from_bits(bits);
            if x.is_finite() {
                let read: f64 = serde_json::from_str(&number(x)).unwrap();
                assert_eq!((read as f32).to_bits(), bits, "{x:e} written as {}", number(x));
            }
        }
    }

    #[test]
    fn unique_names_numbers_what_stands_twice() {
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
