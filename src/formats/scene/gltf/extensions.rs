//! Names the extensions that are read, and notes all others.

use super::super::json::{JsonPath, Source};
use super::super::notes::Notes;
use serde_json::Value;

/// Extensions that are read.
pub const READ: [&str; 11] = [
    "EXT_texture_webp",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_ior",
    "KHR_materials_emissive_strength",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_materials_volume",
    "KHR_mesh_quantization",
    "KHR_texture_transform",
];

/// Extensions without which a file's geometry cannot be read.
pub const COMPRESSIONS: [&str; 3] =
    ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"];

/// Notes the extensions that are not read; those of materials and images only if the model has its `own`
/// materials.
pub fn note_ignored(source: &Source, own: bool, notes: &mut Notes) {
    let Ok(mut root) = serde_json::from_str::<Value>(source.text) else { return };
    let material_keys = ["materials", "textures", "images", "samplers"];
    if let Some(root) = root.as_object_mut() {
        // Animations are left out as a whole.
        root.retain(|key, _| key != "animations" && (own || !material_keys.contains(&key.as_str())));
    }
    visit(&source.root(), &root, notes);
}

/// Visits the extensions of a value's parts, whose places are more precise, and then those of the value.
fn visit(place: &JsonPath, value: &Value, notes: &mut Notes) {
    let is_other = |(key, _): &(&String, &Value)| *key != "extensions" && *key != "extras";
    match value {
        Value::Array(items) => (0..items.len()).for_each(|at| visit(&place.item(at), &items[at], notes)),
        Value::Object(keys) => {
            keys.iter().filter(is_other).for_each(|(key, value)| visit(&place.key(key), value, notes));
            let Some(Value::Object(extensions)) = keys.get("extensions") else { return };
            for (name, content) in extensions {
                let place = place.key("extensions");
                let place = place.key(name);
                if READ.contains(&name.as_str()) {
                    visit(&place, content, notes);
                } else {
                    notes.add(&place, text(name));
                }
            }
        }
        _ => {}
    }
}

fn text(name: &str) -> String {
    let more = match name {
        name if COMPRESSIONS.contains(&name) => ": the uncompressed copy is shown, if there is one",
        _ => "",
    };
    format!("`{name}` is left out{more}")
}
