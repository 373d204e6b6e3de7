//! glTF models: what is read, what is left out and said so, and what is refused.

use glam::{DVec3, Vec2, Vec3};
use octray::measure::stability::Rng;
use octray::scene::{Filter, Material, MaterialKind, Scene, Texels, convert_model, load};
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

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

struct Loaded {
    scene: Scene,
    folder: TempDir,
    path: PathBuf,
}

fn read_with(json: &Value, binary: &[u8]) -> Result<Loaded, String> {
    let folder = TempDir::new().unwrap();
    let path = folder.path().join("m.glb");
    fs::write(&path, glb(json, binary)).unwrap();
    let scene = load(path.to_str().unwrap()).map_err(|error| error.to_string())?;
    Ok(Loaded { scene, folder, path })
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

#[test]
fn a_placed_mesh_has_the_vertices_normals_and_coordinates_of_its_nodes() {
    let scene = read(&model(|json| {
        json["scenes"][0]["nodes"] = json!([1]);
        json["nodes"] = json!([
            { "mesh": 0, "translation": [1, 0, 0], "scale": [2, 1, 1] },
            { "children": [0], "rotation": [0, 0, 3, 3], "translation": [0, 0, 5] }
        ]);
    }));
    let near = |a: Vec3, b: [f32; 3]| assert!(a.abs_diff_eq(b.into(), 1e-6), "{a} {b:?}");
    let [first, second] = [0, 1].map(|triangle: usize| scene.triangles[triangle].vertices);
    near(first[0], [0.0, 1.0, 5.0]);
    near(first[1], [0.0, 3.0, 5.0]);
    near(first[2], [-1.0, 3.0, 5.0]);
    assert_eq!((first[0], first[2]), (second[0], second[1]));
    assert!(scene.normals.is_empty() && scene.uvs.is_empty(), "flat, and without textures");
}

#[test]
fn mirrored_nodes_keep_their_front() {
    for (scale, front) in [([1, 1, 1], 1.0), ([-1, 1, 1], 1.0), ([-1, -1, 1], 1.0), ([1, 1, -1], -1.0)] {
        let scene = read(&model(|json| json["nodes"][0]["scale"] = json!(scale)));
        for triangle in &scene.triangles {
            let [a, b, c] = triangle.vertices;
            assert_eq!((b - a).cross(c - a).normalize().z, front, "{scale:?}");
        }
    }
}

#[test]
fn strips_fans_and_missing_indices_make_the_triangles_of_the_standard() {
    let of = |mode: u32, indices: bool| {
        let scene = read(&model(|json| {
            let primitive = &mut json["meshes"][0]["primitives"][0];
            primitive["mode"] = json!(mode);
            if !indices {
                primitive.as_object_mut().unwrap().remove("indices");
            }
        }));
        let corner = |v: Vec3| {
            [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)].iter().position(|&(x, y)| (x, y) == (v.x, v.y))
        };
        let numbers = |triangle: &octray::scene::Triangle| triangle.vertices.map(|v| corner(v).unwrap());
        scene.triangles.iter().map(numbers).collect::<Vec<_>>()
    };
    assert_eq!(of(4, true), [[0, 1, 2], [0, 2, 3]]);
    assert_eq!(of(4, false), [[0, 1, 2]]);
    assert_eq!(of(5, false), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(of(6, false), [[0, 1, 2], [0, 2, 3]]);
    // 0 1 2 0 2 3, without the one that has no area.
    assert_eq!(of(5, true), [[0, 1, 2], [2, 1, 0], [2, 0, 3]]);
}

#[test]
fn numbers_may_be_quantised_and_sparse() {
    let json = model(|json| {
        // Bytes of 127 are 1 if normalised.
        json["accessors"][0] = json!({
            "bufferView": 2, "componentType": 5120, "count": 4, "type": "VEC3", "normalized": true,
            "sparse": {
                "count": 1,
                "indices": { "bufferView": 3, "componentType": 5123 },
                "values": { "bufferView": 3, "byteOffset": 2 }
            }
        });
        let views = json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": 136, "byteLength": 16, "byteStride": 4 }));
        views.push(json!({ "buffer": 0, "byteOffset": 152, "byteLength": 6 }));
        json["buffers"][0]["byteLength"] = json!(158);
    });
    let mut binary = square();
    binary.extend([0, 0, 0, 99, 127, 0, 0, 99, 127, 127, 0, 99, 0, 127, 0, 99]);
    binary.extend([2, 0, 127, 127, (-127_i8) as u8, 0]);
    let scene = read_with(&json, &binary).unwrap().scene;
    assert_eq!(scene.triangles[0].vertices, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, -1.0)]);
    assert_eq!(scene.triangles[1].vertices[2], Vec3::Y);
}

#[test]
fn materials_are_those_of_the_standard() {
    let (plain, _) = material(|_| {});
    assert_eq!((plain.name.as_str(), plain.color, plain.emission), ("plain", Vec3::ONE, Vec3::ZERO));
    assert_eq!(plain.kind, MaterialKind::MetalRough { roughness: 1.0, metallic: 1.0, ior: 1.5 });
    let (rich, _) = material(|json| {
        json["pbrMetallicRoughness"] = json!({ "baseColorFactor": [0.1, 0.2, 0.3, 0.4], "metallicFactor": 0.25, "roughnessFactor": 0.5 });
        json["emissiveFactor"] = json!([1, 0.5, 0]);
        json["extensions"] = json!({
            "KHR_materials_ior": { "ior": 1.8 }, "KHR_materials_emissive_strength": { "emissiveStrength": 4 }
        });
    });
    assert_eq!((rich.color, rich.emission), (Vec3::new(0.1, 0.2, 0.3), Vec3::new(4.0, 2.0, 0.0)));
    assert_eq!(rich.kind, MaterialKind::MetalRough { roughness: 0.5, metallic: 0.25, ior: 1.8 });
    let (glass, _) = material(|json| {
        json["pbrMetallicRoughness"] =
            json!({ "baseColorFactor": [0.25, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 0 });
        json["extensions"] = json!({
            "KHR_materials_transmission": { "transmissionFactor": 1 }, "KHR_materials_ior": { "ior": 1.33 }
        });
    });
    assert_eq!((glass.kind, glass.color), (MaterialKind::Glass { ior: 1.33 }, Vec3::new(0.5, 1.0, 1.0)));
    let (unlit, _) = material(|json| {
        json["pbrMetallicRoughness"] = json!({ "baseColorFactor": [0.1, 0.2, 0.3, 1] });
        json["extensions"] = json!({ "KHR_materials_unlit": {} });
    });
    assert_eq!((unlit.kind, unlit.emission), (MaterialKind::Emitter, Vec3::new(0.1, 0.2, 0.3)));
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
    let (mut binary, picture) = (square(), png());
    binary.extend(&picture);
    let json = model(|json| {
        let view = json!({ "buffer": 0, "byteOffset": 136, "byteLength": picture.len() });
        json["bufferViews"].as_array_mut().unwrap().push(view);
        json["buffers"][0]["byteLength"] = json!(binary.len());
        json["images"] = json!([{ "bufferView": 2, "mimeType": "image/png" }]);
        json["samplers"] = json!([{ "magFilter": 9728 }]);
        json["textures"] = json!([{ "source": 0 }, { "source": 0, "sampler": 0 }]);
        change(json);
    });
    (json, binary)
}

#[test]
fn textures_have_their_places_and_coordinates() {
    let transform = json!({ "KHR_texture_transform": { "scale": [2, 4], "offset": [0.5, 0.25] } });
    let (json, binary) = pictured(|json| {
        let texture = |index: usize| json!({ "index": index, "extensions": transform });
        json["materials"][0] = json!({
            "pbrMetallicRoughness": { "baseColorTexture": texture(0), "metallicRoughnessTexture": texture(1) },
            "normalTexture": texture(0), "emissiveTexture": texture(1), "emissiveFactor": [1, 1, 1]
        });
        json["materials"].as_array_mut().unwrap().push(json!({
            "pbrMetallicRoughness": { "baseColorTexture": texture(0) },
            "normalTexture": { "index": 0, "scale": 0.5, "extensions": transform },
            "emissiveTexture": { "index": 0 }, "emissiveFactor": [1, 1, 1]
        }));
        let mut other = json["meshes"][0]["primitives"][0].clone();
        other["material"] = json!(1);
        json["meshes"][0]["primitives"].as_array_mut().unwrap().push(other);
        json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0 }]);
        json["scenes"][0]["nodes"] = json!([0, 1]);
    });
    let scene = read_with(&json, &binary).unwrap().scene;
    let [all, scaled] = [0, 1].map(|index: usize| &scene.materials[index]);
    let texture = |index: Option<u32>| &scene.textures[index.unwrap() as usize];
    assert_eq!(texture(all.texture).filter, Filter::Bilinear);
    assert!(matches!(&texture(all.texture).texels, Texels::Srgb8(texels) if texels[0] == [255, 0, 0, 0]));
    assert_eq!(texture(all.roughness_map).filter, Filter::Nearest);
    assert!(matches!(texture(all.roughness_map).texels, Texels::Unorm8(_)));
    assert!(matches!(texture(all.normal_map).texels, Texels::Unorm8(_)));
    assert!(matches!(texture(all.emission_map).texels, Texels::Srgb8(_)));
    // Shared by both materials and both nodes.
    assert_eq!((scene.materials.len(), scene.textures.len(), scene.triangles.len()), (2, 5, 8));
    assert_eq!(all.texture, scaled.texture);
    // (1, -1, -1) of half the slope.
    let Texels::Float32(texels) = &texture(scaled.normal_map).texels else { panic!("scaled") };
    let wanted = 0.5 * DVec3::new(0.5, -0.5, -1.0).normalize() + 0.5;
    assert!(Vec3::from_slice(&texels[0]).abs_diff_eq(wanted.as_vec3(), 1e-6), "{texels:?}");
    // The upper left corner of the picture is (0, 0) in the file: (0.5, 0.25) after the transform.
    assert_eq!(scene.uvs[1][2], Vec2::new(0.5, 0.75));
    assert_eq!(scene.uvs[0], [[0.5, -3.25], [2.5, -3.25], [2.5, 0.75]].map(Vec2::from));
    assert_eq!(scaled.emission_map, None);
    let warning = &scene.warnings[0];
    assert!(warning.contains("materials[1].emissiveTexture") && warning.contains("coordinates"), "{warning}");
}

#[test]
fn vertex_colours_multiply_and_survive_conversion() {
    let json = model(|json| {
        json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = json!(4);
        let accessor =
            json!({ "bufferView": 2, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4" });
        json["accessors"].as_array_mut().unwrap().push(accessor);
        json["bufferViews"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "buffer": 0, "byteOffset": 136, "byteLength": 16 }));
        json["buffers"][0]["byteLength"] = json!(152);
    });
    let mut binary = square();
    binary.extend([255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255]);
    let Loaded { scene, folder, path } = read_with(&json, &binary).unwrap();
    let shown = |scene: &Scene| {
        let material = scene.triangles[0].material;
        let material = Material { name: String::new(), ..scene.materials[material as usize].clone() };
        (scene.textures.clone(), scene.uvs.clone(), material)
    };
    let target = folder.path().join("s.json");
    let converted = convert_model(&path, &target).unwrap();
    assert!(
        converted.pictures.is_empty()
            && converted.text.contains("\"colors\": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]")
    );
    fs::write(&target, converted.text).unwrap();
    let again = load(target.to_str().unwrap()).unwrap();
    assert_eq!(shown(&scene), shown(&again));
}

#[test]
fn conversion_writes_pictures_that_are_inside_the_model() {
    let (json, binary) = pictured(|json| {
        json["materials"][0] = json!({
            "pbrMetallicRoughness": { "baseColorTexture": { "index": 1 }, "metallicFactor": 0.5 },
            "normalTexture": { "index": 0, "scale": 0.5 }
        });
    });
    let Loaded { scene, folder, path } = read_with(&json, &binary).unwrap();
    let target = folder.path().join("deep/s.json");
    let converted = convert_model(&path, &target).unwrap();
    fs::create_dir(folder.path().join("deep")).unwrap();
    let names: Vec<_> = converted.pictures.iter().map(|(name, _)| name.to_str().unwrap()).collect();
    assert_eq!(names, ["s-1.png", "s-2.exr"]);
    for (name, content) in &converted.pictures {
        fs::write(folder.path().join("deep").join(name), content).unwrap();
    }
    fs::write(&target, converted.text).unwrap();
    let again = load(target.to_str().unwrap()).unwrap();
    assert_eq!((&scene.triangles, &scene.uvs, scene.camera), (&again.triangles, &again.uvs, again.camera));
    for (before, after) in scene.textures.iter().zip(&again.textures) {
        assert_eq!((&before.texels, Filter::Nearest), (&after.texels, after.filter), "one filter for all");
    }
    assert_eq!(scene.materials[0], again.materials[0]);
}

#[test]
fn cameras_look_along_minus_z_of_their_node() {
    let scene = read(&model(|json| {
        json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } }]);
        json["nodes"] =
            json!([{ "mesh": 0 }, { "camera": 0, "translation": [0, 0, 7], "rotation": [0, 0, 1, 0] }]);
        json["scenes"][0]["nodes"] = json!([0, 1]);
    }));
    let camera = scene.camera;
    assert_eq!((camera.position, camera.up), (Vec3::new(0.0, 0.0, 7.0), Vec3::NEG_Y));
    assert_eq!((camera.look_at - camera.position).normalize(), Vec3::NEG_Z);
    assert!((camera.vertical_fov - 28.65).abs() < 0.01);
}

#[test]
fn what_is_left_out_is_said_with_its_place() {
    let warned = |change: &dyn Fn(&mut Value), place: &str, what: &str| {
        let warnings = read(&model(|json| change(json))).warnings;
        let found = warnings
            .iter()
            .any(|warning| warning.contains(&format!("m.glb: {place}: ")) && warning.contains(what));
        assert!(found, "{place}, {what}: {warnings:#?}");
    };
    warned(
        &|json| json["animations"] = json!([{ "channels": [], "samplers": [] }]),
        "animations[0]",
        "not played",
    );
    warned(
        &|json| {
            json["skins"] = json!([{ "joints": [0] }]);
            json["nodes"][0]["skin"] = json!(0);
        },
        "nodes[0].skin",
        "without bones",
    );
    let light = json!({ "KHR_lights_punctual": { "light": 0 } });
    warned(
        &|json| json["nodes"][0]["extensions"] = light.clone(),
        "nodes[0].extensions",
        "KHR_lights_punctual",
    );
    let draco = json!({ "KHR_draco_mesh_compression": { "bufferView": 0, "attributes": {} } });
    let primitive = "meshes[0].primitives[0]";
    warned(&|json| json["meshes"][0]["primitives"][0]["extensions"] = draco.clone(), primitive, "draco");
    warned(&|json| json["meshes"][0]["primitives"][0]["targets"] = json!([{}]), primitive, "morph");
    let lines = |json: &mut Value| {
        let mut lines = json["meshes"][0]["primitives"][0].clone();
        lines["mode"] = json!(1);
        json["meshes"][0]["primitives"].as_array_mut().unwrap().push(lines);
    };
    warned(&lines, "meshes[0].primitives[1]", "points and lines");
    let set =
        |key: &'static str, value: Value| move |json: &mut Value| json["materials"][0][key] = value.clone();
    warned(&set("alphaMode", json!("BLEND")), "materials[0].alphaMode", "opaque");
    warned(
        &set("extensions", json!({ "KHR_materials_sheen": {} })),
        "materials[0].extensions",
        "KHR_materials_sheen",
    );
    let gone = json!({ "baseColorTexture": { "index": 3 } });
    warned(&set("pbrMetallicRoughness", gone), "materials[0].pbrMetallicRoughness", "no texture 3");
}

#[test]
fn broken_files_are_refused_with_place_and_remedy() {
    let refuse = |change: &dyn Fn(&mut Value), what: &str| {
        let error = refused(&model(|json| change(json)));
        assert!(error.contains(what) && error.contains("m.glb"), "{what}: {error}");
    };
    let accessor = |index: usize, key: &'static str, value: Value| {
        move |json: &mut Value| json["accessors"][index][key] = value.clone()
    };
    refuse(&accessor(0, "count", json!(5)), "accessors[0], line 1, column");
    refuse(&accessor(0, "count", json!(u64::MAX)), "more elements than the file has bytes for");
    refuse(&accessor(0, "byteOffset", json!(u64::MAX)), "reaches beyond its buffer");
    refuse(&accessor(0, "bufferView", json!(9)), "reaches beyond its buffer");
    refuse(&accessor(0, "componentType", json!(1)), "unknown type");
    refuse(&accessor(0, "type", json!("VEC2")), "2 components, not 3");
    refuse(&accessor(1, "count", json!(2)), "2 values for 4 vertices");
    refuse(&accessor(3, "byteOffset", json!(1)), "reaches beyond its buffer");
    refuse(&|json| json["accessors"][0]["count"] = json!(2), "uses vertex 2 of 2");
    let huge = json!({ "componentType": 5126, "count": 1_u64 << 40, "type": "VEC3", "sparse": {
        "count": 0, "indices": { "bufferView": 0, "componentType": 5125 }, "values": { "bufferView": 0 } } });
    refuse(&|json| json["accessors"][0] = huge.clone(), "more elements than");
    refuse(&|json| json["bufferViews"][0]["byteLength"] = json!(1_u64 << 60), "reaches beyond its buffer");
    refuse(&|json| json["bufferViews"][0]["byteStride"] = json!(1), "reaches beyond its buffer");
    refuse(&|json| json["buffers"][0]["byteLength"] = json!(1_u64 << 60), "the buffer has 136 bytes");
    refuse(
        &|json| json["nodes"][0]["children"] = json!([0]),
        "node 0 is the child of two nodes, or of itself",
    );
    refuse(&|json| json["nodes"][0]["mesh"] = json!(7), "no mesh 7");
    refuse(&|json| json["scenes"][0]["nodes"] = json!([4]), "no node 4");
    refuse(&|json| json["nodes"][0]["camera"] = json!(0), "no camera 0");
    refuse(&|json| json["meshes"][0]["primitives"][0]["material"] = json!(6), "no material 6");
    refuse(&|json| json["meshes"][0]["primitives"][0]["indices"] = json!(60), "no accessor 60");
    refuse(&|json| json["asset"]["version"] = json!("1.0"), "glTF 1.0 is not read");
    refuse(&|json| json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]), "compressed");
    refuse(&|json| json["nodes"][0]["scale"] = json!([0, 0, 0]), "nothing to see");
    refuse(&|json| json["nodes"][0]["translation"] = json!([1e30, 0, 0]), "too far");
    refuse(
        &|json| json["meshes"] = json!([{ "primitives": [{ "attributes": {}, "mode": 4.5 }] }]),
        "line 1, column",
    );
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
    let folder = TempDir::new().unwrap();
    let json = model(|json| {
        json["buffers"][0]["uri"] = json!("a%20b.bin");
        json["images"] = json!([{ "uri": "p.png" }, { "uri": "gone.png" }]);
        json["textures"] = json!([{ "source": 0 }, { "source": 1 }]);
        json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 0 } });
        json["materials"][0]["normalTexture"] = json!({ "index": 1 });
    });
    let path = folder.path().join("m.gltf");
    fs::write(&path, json.to_string()).unwrap();
    let error = load(path.to_str().unwrap()).unwrap_err();
    assert!(error.to_string().contains("buffers[0].uri") && error.to_string().contains("a b.bin"), "{error}");
    fs::write(folder.path().join("a b.bin"), square()).unwrap();
    fs::write(folder.path().join("p.png"), png()).unwrap();
    let scene = load(path.to_str().unwrap()).unwrap();
    assert_eq!(scene.textures[0].name, "p.png");
    assert!(
        scene.warnings[0].contains("images[1]: the image is left out: no such file"),
        "{:?}",
        scene.warnings
    );
    let names: Vec<_> = scene.files.iter().map(|file| file.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["m.gltf", "a b.bin", "p.png", "gone.png"], "the viewer watches them");
    // In a scene, placed, with its own or another material.
    let of = |mesh: Value| {
        let text =
            json!({ "format": "octray-1", "materials": { "red": { "type": "diffuse" } }, "meshes": [mesh] });
        let path = folder.path().join("s.json");
        fs::write(&path, text.to_string()).unwrap();
        load(path.to_str().unwrap())
    };
    let placed = of(json!({ "model": "m.gltf", "scale": 2, "translate": [0, 0, 1] })).unwrap();
    assert_eq!(placed.triangles[0].vertices[2], Vec3::new(2.0, 2.0, 1.0));
    assert!(matches!(placed.materials[1].kind, MaterialKind::MetalRough { .. }));
    let red = of(json!({ "obj": "m.gltf", "material": "red" })).unwrap();
    assert_eq!((red.triangles[0].material, red.materials.len()), (0, 1));
    let error = of(json!({ "obj": "m.gltf", "model": "m.gltf" })).unwrap_err().to_string();
    assert!(error.contains("`model` and `obj`") && error.contains("meshes[0].obj, line 1"), "{error}");
    let error = of(json!({ "modl": "m.gltf" })).unwrap_err().to_string();
    assert!(error.contains("did you mean `model`?"), "{error}");
}

#[test]
fn changed_bytes_never_cause_a_panic() {
    let (json, binary) = pictured(|json| {
        json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 1 } });
    });
    let content = glb(&json, &binary);
    let folder = TempDir::new().unwrap();
    let mut rng = Rng(11);
    for (round, extension) in (0..1200).zip(["glb", "glb", "glb", "gltf"].iter().cycle()) {
        let path = folder.path().join(format!("m.{extension}"));
        let mut changed = if *extension == "glb" { content.clone() } else { json.to_string().into_bytes() };
        for _ in 0..1 + round % 3 {
            let at = rng.bits() as usize % changed.len();
            // Digits become digits, so that numbers change and the JSON stays whole.
            changed[at] = match changed[at] {
                b'0'..=b'9' => b'0' + (rng.bits() % 10) as u8,
                _ if round % 2 == 0 => continue,
                _ => rng.bits() as u8,
            };
        }
        if round % 7 == 0 {
            changed.truncate(rng.bits() as usize % changed.len());
        }
        fs::write(&path, changed).unwrap();
        let _ = load(path.to_str().unwrap());
    }
    assert!(load(Path::new("m.glb").to_str().unwrap()).is_err());
}
