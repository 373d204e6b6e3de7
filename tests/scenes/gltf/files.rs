//! glTF files: binary and text, buffers and pictures beside them, damage, conversion.

use super::super::coordinates::in_file;
use super::{Loaded, glb, model, pictured, png, put, read, read_with, refused, square};
use crate::folder::{Folder, gltf_triangle};
use glam::{Vec3, vec3};
use octray::scene::{Filter, MaterialKind, convert_model};
use serde_json::{Value, json};
use std::collections::BTreeMap;

#[test]
fn conversion_writes_pictures_that_are_inside_the_model() {
    let (json, binary) = pictured(|json| {
        json["materials"][0] = json!({
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 1 }, "metallicFactor": 0.5 },
            "normalTexture": { "index": 0, "scale": 0.5 }
        });
    });
    let Loaded { scene, folder, path } = read_with(&json, &binary).unwrap();
    let converted = convert_model(&path, &folder.path("deep/s.json")).unwrap();
    let names: Vec<_> = converted.pictures.iter().map(|(name, _)| name.to_str().unwrap()).collect();
    assert_eq!(names, ["s-1.png", "s-2.exr"]);
    for (name, content) in &converted.pictures {
        folder.write(&format!("deep/{}", name.display()), content);
    }
    let again = folder.load("deep/s.json", converted.text).unwrap();
    assert_eq!((&scene.triangles, &scene.uvs, scene.camera), (&again.triangles, &again.uvs, again.camera));
    for (before, after) in scene.textures.iter().zip(&again.textures) {
        assert_eq!((&before.texels, Filter::Nearest), (&after.texels, after.filter), "one filter for all");
    }
    assert_eq!(scene.materials[0], again.materials[0]);
}

#[test]
fn what_is_left_out_is_said_with_its_place() {
    let warned = |json: &Value, place: &str, what: &str| {
        let warnings = read(json).warnings;
        let place = format!("m.glb: {place}: ");
        let found = warnings.iter().any(|warning| warning.contains(&place) && warning.contains(what));
        assert!(found, "{place}, {what}: {warnings:#?}");
    };
    let light = json!({ "KHR_lights_punctual": { "light": 0 } });
    let draco = json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": {} } });
    let sheen = json!({ "KHR_materials_sheen": {} });
    let clear = json!({ "KHR_materials_transmission": { "transmissionFactor": 0.9 },
        "KHR_materials_specular": { "specularTexture": { "index": 0 } },
        "KHR_materials_clearcoat": { "clearcoatFactor": 1 },
        "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 2, "attenuationColor": [1, 0, 1] } });
    let variants = json!({ "KHR_materials_variants": { "variants": [] } });
    let cameras = json!([{ "type": "orthographic" }, { "type": "orthographic" }]);
    let dielectric = json!({ "metallicFactor": 0, "extensions": { "VENDOR_tint": {} } });
    let gone = json!({ "baseColorTexture": { "index": 3 } });
    let animation = json!([{ "channels": [], "samplers": [] }]);
    for (path, value, place, what) in [
        ("animations", animation, "animations[0]", "not played"),
        ("nodes/0/extensions", light, "nodes[0]", "there is no valid light 0"),
        ("extensions", variants, "extensions.KHR_materials_variants", "left out"),
        ("cameras", cameras, "cameras", "several cameras"),
        ("materials/0/occlusionTexture", json!({ "index": 0 }), "materials[0].occlusionTexture", "occlusion"),
        (
            "meshes/0/primitives/0/extensions",
            draco,
            "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression",
            "uncompressed copy",
        ),
        ("meshes/0/primitives/0/targets", json!([{}]), "meshes[0].primitives[0]", "morph"),
        ("materials/0/extensions", sheen, "materials[0].extensions.KHR_materials_sheen", "left out"),
        ("materials/0/pbrMetallicRoughness", gone, "materials[0].pbrMetallicRoughness", "no `textures[3]`"),
    ] {
        warned(&model(|json| put(json, path, value)), place, what);
    }
    let glass = model(|json| {
        put(json, "materials/0/extensions", clear);
        put(json, "materials/0/emissiveFactor", json!([1, 1, 1]));
        put(json, "materials/0/pbrMetallicRoughness", dielectric);
    });
    for what in ["textures of", "without its clear coat", "absorption"] {
        warned(&glass, "materials[0].extensions", what);
    }
    warned(&glass, "materials[0].pbrMetallicRoughness.extensions.VENDOR_tint", "left out");
    let skinned = model(|json| {
        put(json, "skins", json!([{ "joints": [0] }]));
        put(json, "nodes/0/skin", json!(0));
    });
    warned(&skinned, "nodes[0].skin", "without bones");
    let lines = model(|json| {
        let mut lines = json["meshes"][0]["primitives"][0].clone();
        lines["mode"] = json!(1);
        json["meshes"][0]["primitives"].as_array_mut().unwrap().push(lines);
    });
    warned(&lines, "meshes[0].primitives[1]", "points and lines");
}

#[test]
fn broken_files_are_refused_with_place_and_remedy() {
    let huge = json!({ "componentType": 5126, "count": 1_u64 << 40, "type": "VEC3", "sparse": {
        "count": 0, "indices": { "bufferView": 0, "componentType": 5125 }, "values": { "bufferView": 0 } } });
    let odd_mode = json!([{ "primitives": [{ "attributes": {}, "mode": 4.5 }] }]);
    for (path, value, what) in [
        ("accessors/0/count", json!(5), "accessors[0], line 1, column"),
        ("accessors/0/count", json!(u64::MAX), "more elements than the file has bytes for"),
        ("accessors/0/count", json!(2), "uses vertex 2 of 2"),
        ("accessors/0/byteOffset", json!(u64::MAX), "reaches beyond its buffer"),
        ("accessors/0/bufferView", json!(9), "`bufferViews[9]` is missing"),
        ("accessors/0/componentType", json!(1), "accessors[0].componentType, line 1"),
        ("accessors/0/type", json!("VEC2"), "2 components, not 3"),
        ("accessors/0", huge, "more elements than"),
        ("accessors/1/count", json!(2), "2 values for 4 vertices"),
        ("accessors/3/byteOffset", json!(1), "reaches beyond its buffer"),
        ("bufferViews/0/byteLength", json!(1_u64 << 60), "reaches beyond its buffer"),
        ("bufferViews/0/byteStride", json!(1), "overlap"),
        ("buffers/0/byteLength", json!(1_u64 << 60), "`buffers[0]` has 136 bytes"),
        ("nodes/0/children", json!([0]), "node 0 is the child of two nodes, or of itself"),
        ("nodes/0/mesh", json!(7), "no `meshes[7]`"),
        ("nodes/0/camera", json!(0), "no `cameras[0]`"),
        ("nodes/0/scale", json!([0, 0, 0]), "nothing to see"),
        ("scenes/0/nodes", json!([4]), "no `nodes[4]`"),
        ("meshes/0/primitives/0/material", json!(6), "no `materials[6]`"),
        ("meshes/0/primitives/0/indices", json!(60), "no `accessors[60]`"),
        ("meshes", odd_mode, "meshes[0].primitives[0].mode, line 1, column"),
        ("meshes", json!({}), "no `meshes[0]`"),
        ("nodes/0/translation", json!([1, "2", 3]), "nodes[0].translation[1], line 1, column"),
        ("nodes/0/scale", json!([1, 2]), "invalid length 2, expected an array of length 3"),
        ("nodes/0/mesh", json!(-1), "write a whole number of 0 or more here"),
        ("buffers/0/uri", json!("gone.bin"), "gone.bin: no such file"),
        ("buffers/0/uri", json!("data:,%00"), "`buffers[0]` has 1 bytes"),
        ("asset/version", json!("1.0"), "glTF 1.0 is not read"),
        ("asset/minVersion", json!("2.1"), "glTF 2.1 is not read"),
        ("extensionsRequired", json!(["KHR_draco_mesh_compression"]), "compressed"),
        ("extensionsRequired", json!(["KHR_texture_transform", "VENDOR_x"]), "extension `VENDOR_x`"),
        ("extensionsRequired", json!(["VENDOR_x"]), "extensionsRequired[0], line 1, column"),
    ] {
        let error = refused(&model(|json| put(json, path, value)));
        assert!(error.contains(what) && error.contains("m.glb"), "{path}, {what}: {error}");
        // The folder has a random name, which may hold such a word.
        let said: String = error.lines().filter_map(|line| line.rsplit("/m.glb").next()).collect();
        assert!(!["struct", "f64", "map,", "sequence"].iter().any(|word| said.contains(word)), "{error}");
    }
}

/// What is put into a model, each by itself: of optional objects, and of those that nobody uses.
const UNREAD: &str = r#"{
    "animations": [{ "channels": [{ "sampler": 0, "target": { "path": "pointer" } }], "samplers": "x" }],
    "scenes/1": { "name": "Scene.001" }, "nodes/1": { "mesh": "none", "matrix": [1] }, "skins": 4,
    "meshes/1": 5, "nodes/0/skin": "x", "meshes/0/primitives/0/attributes/_ID": "x", "accessors/4": {}, "accessors/0/max": 1,
    "accessors/1": { "componentType": 5126, "count": 4, "type": "VEC3" }, "accessors/2": {},
    "accessors/0/count": 4.0,
    "bufferViews/2": { "buffer": 7 }, "buffers/1": { "byteLength": 8, "uri": "gone.bin" },
    "cameras": [{ "perspective": 5 }], "images": [{ "uri": "gone.png" }, 3], "textures": [{}, 4],
    "samplers": "x", "materials/0/name": 12, "materials/1": [], "extras": 7.5, "asset/extras": [1, null],
    "scenes/0/extras": true, "nodes/0/extras": "x", "meshes/0/extras": false, "accessors/0/extras": [],
    "meshes/0/primitives/0/extras": "x", "buffers/0/extras": 1, "extensions/VENDOR_x": [{ "a": null }],
    "nodes/0/extensions/VENDOR_x": 5, "materials/0/extensions/VENDOR_x": "x"
}"#;

#[test]
fn what_nobody_reads_refuses_no_model() {
    let wanted = read(&model(|_| {})).triangles;
    for (path, value) in serde_json::from_str::<BTreeMap<String, Value>>(UNREAD).unwrap() {
        let json = model(|json| {
            let mut parts = path.split('/');
            if let (Some(list), Some(index)) = (json[parts.next().unwrap()].as_array_mut(), parts.next()) {
                list.resize(list.len().max(index.parse::<usize>().unwrap() + 1), Value::Null);
            }
            put(json, &path, value);
        });
        let loaded = read_with(&json, &square()).map(|loaded| loaded.scene.triangles);
        assert_eq!(loaded.as_ref(), Ok(&wanted), "{path}");
    }
}

#[test]
fn bytes_of_another_format_are_not_called_broken_json() {
    let folder = Folder::new();
    let error = |name: &str, content: &[u8]| folder.load(name, content).unwrap_err().to_string();
    let neither = "neither binary, which begins with `glTF`, nor";
    for name in ["m.glb", "M.GLB"] {
        assert!(error(name, b"o model\nv 0 0 0\n").contains(&format!("{neither} JSON")));
        assert!(error(name, b"\xff\xfe").contains(&format!("{neither} text in UTF-8")));
        assert!(error(name, b"glTF\x01\0\0\0").contains("not binary glTF of version 2"));
        // JSON, and text that should be, has its faults named by their place.
        assert!(error(name, b" {\n\"asset\" 1}").contains("line 2"));
    }
    assert!(error("m.gltf", b"o model\n").contains("line 1"));
}

#[test]
fn copies_of_a_mesh_are_counted_before_they_are_made() {
    // 2^16 nodes of 2^11 triangles: 2^27.
    let json = model(|json| {
        json["accessors"][3]["count"] = json!(3 << 11);
        json["bufferViews"][1] = json!({ "buffer": 0, "byteOffset": 136, "byteLength": 3 << 11 });
        json["buffers"][0]["byteLength"] = json!(136 + (3 << 11));
        json["nodes"] = (0..1 << 16).map(|_| json!({ "mesh": 0 })).collect();
        json["scenes"][0]["nodes"] = (0..1 << 16).collect();
    });
    let mut binary = square();
    binary.resize(136 + (3 << 11), 0);
    let error = read_with(&json, &binary).err().unwrap();
    assert!(error.contains("more than 67108864 triangles"), "{error}");
}

#[test]
fn a_text_file_names_buffers_and_pictures_beside_it() {
    let folder = Folder::new();
    let mut json = model(|json| {
        json["buffers"][0]["uri"] = json!("a%20b.bin");
        json["images"] = json!([{ "uri": "p.png" }, { "uri": "gone.png" }]);
        json["textures"] = json!([{ "source": 0 }, { "source": 1 }]);
        json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 0 } });
        json["materials"][0]["normalTexture"] = json!({ "index": 1 });
    });
    let error = folder.load("m.gltf", json.to_string()).unwrap_err();
    assert!(error.to_string().contains("buffers[0].uri") && error.to_string().contains("a b.bin"), "{error}");
    folder.write("a b.bin", square());
    folder.write("p.png", png());
    let scene = folder.load("m.gltf", json.to_string()).unwrap();
    assert_eq!(scene.textures[0].name, "p.png");
    let warning = &scene.warnings[0];
    assert!(warning.contains("images[1]: the image is left out: no such file"), "{warning}");
    let names: Vec<_> = scene.files.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["m.gltf", "a b.bin", "p.png", "gone.png"], "the viewer watches them");
    // As models from other machines name it.
    json["images"][0]["uri"] = json!("C:\\textures\\P.PNG");
    assert_eq!(folder.load("m.gltf", json.to_string()).unwrap().textures[0].name, "p.png");
    // In a scene, placed, with its own or another material.
    let of = |mesh: Value| {
        let red = r#""materials": { "red": { "type": "diffuse" } }"#;
        folder.load_keys(&format!(r#"{red}, "meshes": [{mesh}]"#)).map(in_file)
    };
    let placed = of(json!({ "model": "m.gltf", "scale": 2, "translate": [0, 0, 1] })).unwrap();
    assert_eq!(placed.triangles[0].vertices[2], vec3(2.0, 2.0, 1.0));
    assert!(matches!(placed.materials[1].kind, MaterialKind::MetalRough { .. }));
    let red = of(json!({ "obj": "m.gltf", "material": "red" })).unwrap();
    assert_eq!((red.triangles[0].material, red.materials.len()), (0, 1));
    let error = of(json!({ "obj": "m.gltf", "model": "m.gltf" })).unwrap_err().to_string();
    assert!(error.contains("`model` and `obj`") && error.contains("meshes[0].obj, line 1"), "{error}");
    let error = of(json!({ "modl": "m.gltf" })).unwrap_err().to_string();
    assert!(error.contains("did you mean `model`?"), "{error}");
}

#[test]
fn data_uris_byte_order_marks_and_unknown_chunks_are_read() {
    let folder = Folder::new();
    let base64 = "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA";
    let percent = format!("{}%80%3f{}%80%3F{}", "%00".repeat(14), "%00".repeat(14), "%00".repeat(4));
    for uri in [
        format!("data:application/octet-stream;base64,{base64}"),
        format!(r"data:;base64,{}\n{}", &base64[..9], &base64[9..]),
        format!("DATA:a/b;charset=x;BASE64,%41{}", &base64[1..]),
        format!("data:application/octet-stream,{percent}"),
        format!("data:,{percent}"),
    ] {
        let json = gltf_triangle(&uri, r#""materials": [{}]"#);
        let scene = folder.load("m.gltf", format!("\u{feff}{json}")).unwrap();
        assert_eq!(scene.triangles[0].vertices, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    }
    let mut bytes = glb(&model(|_| {}), &square());
    let error = folder.load("m.glb", &bytes[..bytes.len() - 144]).unwrap_err().to_string();
    assert!(error.contains("the file is cut off"), "{error}");
    let at = 20 + u32::from_le_bytes(bytes[12..16].try_into().unwrap()) as usize;
    bytes[..at].iter_mut().rev().take_while(|byte| **byte == b' ').for_each(|byte| *byte = 0);
    bytes.splice(at..at, *b"\x04\0\0\0XTRAabcd");
    bytes.extend(b"more than the header says");
    assert_eq!(folder.load("m.glb", bytes).unwrap().triangles.len(), 2);
}
