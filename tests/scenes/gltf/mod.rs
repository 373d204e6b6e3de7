//! glTF models: what is read, what is left out and said so, and what is refused. Here: a model to change.

mod files;
mod geometry;
mod materials;

use super::coordinates::in_file;
use crate::folder::Folder;
use octray::scene::{Material, Scene};
use serde_json::{Value, json};
use std::path::PathBuf;

/// A binary file of a JSON text and a binary part.
fn glb(json: &Value, binary: &[u8]) -> Vec<u8> {
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let chunk = |kind: &[u8; 4], data: &[u8]| [&(data.len() as u32).to_le_bytes(), &kind[..], data].concat();
    let chunks = [chunk(b"JSON", &text), chunk(b"BIN\0", binary)].concat();
    let header = [&b"glTF"[..], &2_u32.to_le_bytes(), &(12 + chunks.len() as u32).to_le_bytes()].concat();
    [header, chunks].concat()
}

fn floats(numbers: &[f32]) -> Vec<u8> {
    numbers.iter().flat_map(|number| number.to_le_bytes()).collect()
}

/// A square of four vertices, 12 + 12 + 8 bytes each, and the indices of two triangles.
fn square() -> Vec<u8> {
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];
    let vertex = |[x, y]: [f32; 2]| floats(&[x, y, 0.0, 0.0, 0.0, 1.0, x, 1.0 - y]);
    let mut bytes: Vec<u8> = corners.into_iter().flat_map(vertex).collect();
    bytes.extend([0_u8, 1, 2, 0, 2, 3]);
    bytes.extend([0, 0]);
    bytes
}

/// A file with the square on one node, changed by `change`.
fn model(change: impl FnOnce(&mut Value)) -> Value {
    let mut json = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{
            "attributes": { "POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2 }, "indices": 3, "material": 0
        }] }],
        "materials": [{ "name": "plain" }],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0] },
            { "bufferView": 0, "byteOffset": 12, "componentType": 5126, "count": 4, "type": "VEC3" },
            { "bufferView": 0, "byteOffset": 24, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "bufferView": 1, "componentType": 5121, "count": 6, "type": "SCALAR" }
        ],
        "bufferViews": [
            { "buffer": 0, "byteLength": 128, "byteStride": 32 }, { "buffer": 0, "byteOffset": 128, "byteLength": 6 }
        ],
        "buffers": [{ "byteLength": 136 }]
    });
    change(&mut json);
    json
}

/// Puts a value where a path of keys and numbers leads.
fn put(json: &mut Value, path: &str, value: Value) {
    fn step<'a>(at: &'a mut Value, key: &str) -> &'a mut Value {
        match key.parse::<usize>() {
            Ok(number) => &mut at[number],
            Err(_) => &mut at[key],
        }
    }
    *path.split('/').fold(json, step) = value;
}

fn push(json: &mut Value, path: &str, value: Value) -> usize {
    let list = json[path].as_array_mut().unwrap();
    list.push(value);
    list.len() - 1
}

/// The square and more bytes: with a view of these that has more keys, whose number comes first.
fn append(json: &mut Value, binary: &mut Vec<u8>, bytes: &[u8], keys: Value) -> usize {
    let mut view = json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len() });
    view.as_object_mut().unwrap().extend(keys.as_object().unwrap().clone());
    binary.extend(bytes);
    json["buffers"][0]["byteLength"] = json!(binary.len());
    push(json, "bufferViews", view)
}

/// Gives the square's vertices colours.
fn put_colours(json: &mut Value, binary: &mut Vec<u8>, bytes: &[u8], mut accessor: Value) {
    accessor["bufferView"] = json!(append(json, binary, bytes, json!({})));
    accessor["count"] = json!(4);
    let number = push(json, "accessors", accessor);
    put(json, "meshes/0/primitives/0/attributes/COLOR_0", json!(number));
}

struct Loaded {
    scene: Scene,
    folder: Folder,
    path: PathBuf,
}

fn read_with(json: &Value, binary: &[u8]) -> Result<Loaded, String> {
    let folder = Folder::new();
    let scene = in_file(folder.load("m.glb", glb(json, binary)).map_err(|error| error.to_string())?);
    Ok(Loaded { scene, path: folder.path("m.glb"), folder })
}

fn read(json: &Value) -> Scene {
    read_with(json, &square()).unwrap().scene
}

fn refused(json: &Value) -> String {
    read_with(json, &square()).err().unwrap()
}

fn material(change: impl FnOnce(&mut Value)) -> (Material, Scene) {
    let scene = read(&model(|json| change(&mut json["materials"][0])));
    (scene.materials[0].clone(), scene)
}

/// A picture of one row: red, green.
fn png() -> Vec<u8> {
    let picture = image::RgbImage::from_raw(2, 1, vec![255, 0, 0, 0, 255, 0]).unwrap();
    let mut bytes = std::io::Cursor::new(Vec::new());
    picture.write_to(&mut bytes, image::ImageFormat::Png).unwrap();
    bytes.into_inner()
}

/// The square, with the picture in the file.
fn pictured(change: impl FnOnce(&mut Value)) -> (Value, Vec<u8>) {
    let mut binary = square();
    let json = model(|json| {
        append(json, &mut binary, &png(), json!({}));
        json["images"] = json!([{ "bufferView": 2, "mimeType": "image/png" }]);
        json["samplers"] = json!([{ "magFilter": 9728 }]);
        json["textures"] = json!([{ "source": 0 }, { "source": 0, "sampler": 0 }]);
        change(json);
    });
    (json, binary)
}

/// The square's mesh on a node, in a scene that places the model.
fn placed(json: &Value, binary: &[u8], placement: Value) -> Scene {
    let Loaded { folder, .. } = read_with(json, binary).unwrap();
    let mut mesh = json!({ "model": "m.glb" });
    mesh.as_object_mut().unwrap().extend(placement.as_object().unwrap().clone());
    in_file(folder.load_keys(&format!(r#""meshes": [{mesh}]"#)).unwrap())
}
