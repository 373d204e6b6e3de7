//! Materials, textures and vertex colours of glTF models.

use super::{Loaded, append, floats, material, model, pictured, push, put_colours, read_with, square};
use glam::{DVec3, Vec2, Vec3, vec2, vec3};
use octray::scene::{
    Attenuation, Filter, Material, MaterialExtras, MaterialKind, Scene, Texels, Wrap, convert_model,
};
use serde_json::{Value, json};

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
    assert_eq!((rich.color, rich.emission), (vec3(0.1, 0.2, 0.3), vec3(4.0, 2.0, 0.0)));
    assert_eq!(rich.kind, MaterialKind::MetalRough { roughness: 0.5, metallic: 0.25, ior: 1.8 });
    // A pane tints light once, a volume where light enters and leaves.
    let (pane, volume) = (MaterialKind::ThinGlass { ior: 1.33 }, MaterialKind::Glass { ior: 1.33 });
    for (thickness, kind, red) in [(0.0, pane, 0.25), (0.1, volume, 0.5)] {
        let (glass, scene) = material(|json| {
            json["pbrMetallicRoughness"] =
                json!({ "baseColorFactor": [0.25, 1, 1, 1], "metallicFactor": 0, "roughnessFactor": 0 });
            json["extensions"] = json!({
                "KHR_materials_transmission": { "transmissionFactor": 1 }, "KHR_materials_ior": { "ior": 1.33 },
                "KHR_materials_volume": { "thicknessFactor": thickness }
            });
        });
        assert_eq!((glass.kind, glass.color), (kind, vec3(red, 1.0, 1.0)), "{thickness:?}");
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    }
    let (unlit, _) = material(|json| {
        json["pbrMetallicRoughness"] = json!({ "baseColorFactor": [0.1, 0.2, 0.3, 1] });
        json["extensions"] = json!({ "KHR_materials_unlit": {} });
    });
    assert_eq!((unlit.kind, unlit.emission), (MaterialKind::Emitter, vec3(0.1, 0.2, 0.3)));
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
    assert_eq!(scene.uvs[1][2], vec2(0.5, 0.75));
    assert_eq!(scene.uvs[0], [[0.5, -3.25], [2.5, -3.25], [2.5, 0.75]].map(Vec2::from));
    assert_eq!(scaled.emission_map, None);
    let warning = &scene.warnings[0];
    assert!(warning.contains("materials[1].emissiveTexture") && warning.contains("coordinates"), "{warning}");
}

#[test]
fn vertex_colours_multiply_and_survive_conversion() {
    // Of an unlit material they multiply what it emits.
    let unlit = json!({ "KHR_materials_unlit": {} });
    for (extensions, kind) in [(json!({}), "metal-rough"), (unlit, "emitter")] {
        let mut binary = square();
        let json = model(|json| {
            let bytes = [255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 255, 255, 255, 255];
            let accessor = json!({ "componentType": 5121, "normalized": true, "type": "VEC4" });
            json["materials"][0]["extensions"] = extensions;
            put_colours(json, &mut binary, &bytes, accessor);
        });
        let Loaded { scene, folder, path } = read_with(&json, &binary).unwrap();
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        let shown = |scene: &Scene| {
            let material = scene.triangles[0].material;
            let material = Material { name: String::new(), ..scene.materials[material as usize].clone() };
            (scene.textures.clone(), scene.uvs.clone(), material)
        };
        let converted = convert_model(&path, &folder.path("s.json")).unwrap();
        assert!(converted.pictures.is_empty());
        let text = converted.text;
        assert!(text.contains(r#""colors": [[1, 0, 0], [0, 1, 0], [0, 0, 1]]"#), "{text}");
        assert!(text.contains(&format!(r#""type":"{kind}""#)), "{text}");
        assert_eq!(shown(&scene), shown(&folder.load("s.json", text).unwrap()));
    }
}

#[test]
fn texture_coordinates_turn_counter_clockwise_and_stay_at_their_vertices() {
    let (json, binary) = pictured(|json| {
        let turned = json!({ "KHR_texture_transform": { "rotation": std::f64::consts::FRAC_PI_2 } });
        json["materials"][0]["pbrMetallicRoughness"] =
            json!({ "baseColorTexture": { "index": 0, "extensions": turned } });
    });
    let scene = read_with(&json, &binary).unwrap().scene;
    // (u, v) becomes (v, -u), v downwards.
    for (found, wanted) in scene.uvs[0].iter().zip([[1.0, 1.0], [1.0, 2.0], [0.0, 2.0]]) {
        assert!(found.abs_diff_eq(wanted.into(), 1e-6), "{found}, not {wanted:?}");
    }
    let (json, binary) = pictured(|json| {
        json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 0 } });
        json["nodes"][0]["scale"] = json!([-1, 1, 1]);
    });
    let scene = read_with(&json, &binary).unwrap().scene;
    for (triangle, uvs) in scene.triangles.iter().zip(&scene.uvs) {
        assert_eq!(*uvs, triangle.vertices.map(|v| vec2(-v.x, v.y)));
    }
}

#[test]
fn textures_use_the_set_of_coordinates_of_the_first_of_them() {
    let second = |texture: Value| {
        let (json, binary) = pictured(|json| {
            json["materials"][0] = texture;
            json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] = json!(4);
            // The last two numbers of the normals: (0, 1).
            let accessor = json!({ "bufferView": 0, "byteOffset": 16, "componentType": 5126, "count": 4, "type": "VEC2" });
            push(json, "accessors", accessor);
        });
        let scene = read_with(&json, &binary).unwrap().scene;
        assert_eq!(scene.uvs[0], [Vec2::ZERO; 3], "{json}");
        scene
    };
    let own = json!({ "index": 0, "texCoord": 1 });
    let other = json!({ "index": 0, "extensions": { "KHR_texture_transform": { "texCoord": 1 } } });
    let of = |texture: &Value| json!({ "pbrMetallicRoughness": { "baseColorTexture": texture } });
    assert_eq!(second(of(&own)).warnings.len(), 0);
    second(of(&other));
    let first = |texture: Value| second(texture).materials[0].clone();
    let rough = json!({ "pbrMetallicRoughness": { "metallicRoughnessTexture": own } });
    assert!(first(rough).roughness_map.is_some());
    assert!(first(json!({ "normalTexture": own })).normal_map.is_some());
    let glow = json!({ "emissiveTexture": own, "emissiveFactor": [1, 1, 1] });
    assert!(first(glow).emission_map.is_some());
    let mut both = of(&own);
    both["normalTexture"] = json!({ "index": 0 });
    let scene = second(both);
    assert_eq!(scene.materials[0].normal_map, None);
    assert!(scene.warnings[0].contains("materials[0].normalTexture"), "{:?}", scene.warnings);
}

#[test]
fn vertex_colours_may_be_three_floats_and_end_at_one() {
    let coloured = |mut json: Value, mut binary: Vec<u8>, last: f32| {
        let colours = [[2.0, 0.5, 0.0], [2.0, 0.5, 0.0], [2.0, 0.5, 0.0], [2.0, 0.5, last]].concat();
        put_colours(
            &mut json,
            &mut binary,
            &floats(&colours),
            json!({ "componentType": 5126, "type": "VEC3" }),
        );
        read_with(&json, &binary).unwrap()
    };
    let Loaded { folder, path, .. } = coloured(model(|_| {}), square(), 0.25);
    let text = convert_model(&path, &folder.path("s.json")).unwrap().text;
    assert!(text.contains(r#""colors": [[1, 0.5, 0], [1, 0.5, 0], [1, 0.5, 0.25]]"#), "{text}");
    // One colour is the material's, beside its textures.
    let (json, binary) = pictured(|json| {
        json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 0 } });
    });
    for (last, color, warnings) in [(0.0, vec3(1.0, 0.5, 0.0), 0), (0.25, Vec3::ONE, 1)] {
        let scene = coloured(json.clone(), binary.clone(), last).scene;
        let material = &scene.materials[scene.triangles[0].material as usize];
        assert_eq!((material.color, scene.warnings.len()), (color, warnings), "{:?}", scene.warnings);
        assert!(material.texture.is_some());
    }
}

/// A black picture.
const BLACK: &str = "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAQAAAAECAIAAAAmkwkpAAAADElEQVR4nGNgIB0AAAA0AAF2Xq7DAAAA\
                     AElFTkSuQmCC";

#[test]
fn glass_is_what_transmits_and_is_no_metal() {
    let of = |pbr: Value, transmission: &Value, ior: f64| {
        let (json, binary) = pictured(|json| {
            json["materials"][0]["pbrMetallicRoughness"] = pbr;
            json["materials"][0]["extensions"] = json!({
                "KHR_materials_transmission": transmission, "KHR_materials_ior": { "ior": ior },
                "KHR_materials_volume": { "thicknessFactor": 1, "thicknessTexture": { "index": 2 } }
            });
            let black = push(json, "images", json!({ "uri": BLACK }));
            push(json, "textures", json!({ "source": black }));
        });
        let scene = read_with(&json, &binary).unwrap().scene;
        (scene.materials[0].clone(), scene.warnings)
    };
    let plain = |metallic: f64| json!({ "metallicFactor": metallic, "roughnessFactor": 0, "baseColorTexture": { "index": 0 } });
    // The picture has no blue, so no metal, green in one half, and red in the other.
    let textured =
        |roughness: f64| json!({ "roughnessFactor": roughness, "metallicRoughnessTexture": { "index": 0 } });
    let rough = json!({ "metallicFactor": 0, "roughnessFactor": 0.5 });
    let varied = |factor: f64| json!({ "transmissionFactor": factor, "transmissionTexture": { "index": 1 } });
    let clear = |factor: f64| json!({ "transmissionFactor": factor });
    let [thin, rough_pane] = [
        MaterialKind::ThinGlass { ior: 1.5 },
        MaterialKind::RoughGlass { roughness: 0.5, ior: 1.5, thin: true },
    ];
    let metal_rough = |roughness, metallic| MaterialKind::MetalRough { roughness, metallic, ior: 1.5 };
    for (pbr, transmission, kind, share, warnings) in [
        (plain(0.0), clear(1.0), thin, 0.0, 0),
        (plain(0.0), clear(0.25), metal_rough(0.0, 0.0), 0.25, 0),
        (plain(0.25), clear(1.0), metal_rough(0.0, 0.25), 1.0, 0),
        (plain(1.0), clear(1.0), metal_rough(0.0, 1.0), 0.0, 0),
        (rough, clear(1.0), rough_pane, 0.0, 0),
        (textured(0.0), clear(1.0), thin, 0.0, 0),
        (textured(1.0), clear(1.0), metal_rough(1.0, 1.0), 1.0, 0),
        (textured(0.0), varied(1.0), metal_rough(0.0, 1.0), 0.5, 1),
    ] {
        let (material, found) = of(pbr, &transmission, 1.5);
        assert_eq!((material.kind, material.extras.transmission), (kind, share), "{transmission}");
        assert_eq!(material.extras.thin, share > 0.0);
        assert_eq!(found.len(), warnings, "{found:?}");
    }
}

#[test]
fn layers_and_absorption_are_read_and_survive_conversion() {
    let json = model(|json| {
        let material = &mut json["materials"][0];
        material["pbrMetallicRoughness"] = json!({ "metallicFactor": 0.1, "roughnessFactor": 0.3 });
        material["extensions"] = json!({
            "KHR_materials_specular": { "specularFactor": 0.3, "specularColorFactor": [0.1, 2, 1] },
            "KHR_materials_clearcoat": { "clearcoatFactor": 0.7, "clearcoatRoughnessFactor": 0.2 },
            "KHR_materials_transmission": { "transmissionFactor": 0.4 },
            "KHR_materials_volume": { "thicknessFactor": 1, "attenuationDistance": 0.3, "attenuationColor": [1, 0.2, 0.7] }
        });
    });
    let Loaded { scene, folder, path } = read_with(&json, &square()).unwrap();
    let extras = &scene.materials[0].extras;
    let expected = MaterialExtras {
        transmission: 0.4,
        thin: false,
        attenuation: Some(Attenuation { color: vec3(1.0, 0.2, 0.7), distance: 0.3 }),
        specular: 0.3,
        specular_color: vec3(0.1, 2.0, 1.0),
        clearcoat: 0.7,
        clearcoat_roughness: 0.2,
    };
    assert_eq!(*extras, expected);
    let text = convert_model(&path, &folder.path("s.json")).unwrap().text;
    assert_eq!(folder.load("s.json", text).unwrap().materials, scene.materials);
    // Distances are scaled with the model, and those of a huge scene are in its units.
    for scale in [2.0, 1e9] {
        let bytes =
            format!(r#"{{ "format": "octray-1", "meshes": [{{ "model": "m.glb", "scale": {scale} }}] }}"#);
        let scene = folder.load("scaled.json", bytes).unwrap();
        let distance = f64::from(scene.materials[0].extras.attenuation.unwrap().distance);
        let wanted = f64::from(0.3_f32) * scale;
        assert!((distance * scene.coordinates.unit / wanted - 1.0).abs() < 1e-6, "{distance}");
    }
    // Blender writes these numbers always.
    let (plain, scene) = material(|json| {
        json["extensions"] =
            json!({ "KHR_materials_specular": { "specularFactor": 1, "specularColorFactor": [1, 1, 1] } });
    });
    assert_eq!((plain.extras, scene.warnings.len()), (MaterialExtras::default(), 0));
}

#[test]
fn what_of_textures_is_left_out_is_said_with_its_place() {
    let warned = |change: &dyn Fn(&mut Value), place: &str, what: &str| {
        let (json, binary) = pictured(|json| {
            json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 1 } });
            change(json);
        });
        let warnings = read_with(&json, &binary).unwrap().scene.warnings;
        let found = warnings
            .iter()
            .any(|warning| warning.contains(&format!("m.glb: {place}: ")) && warning.contains(what));
        assert!(found, "{place}, {what}: {warnings:#?}");
    };
    warned(&|json| json["samplers"][0]["wrapT"] = json!(5), "samplers[0]", "there is no wrap 5");
    warned(&|json| json["samplers"][0]["magFilter"] = json!(5), "samplers[0]", "there is no `magFilter` 5");
    let unmapped = |json: &mut Value| {
        json["meshes"][0]["primitives"][0]["attributes"].as_object_mut().unwrap().remove("TEXCOORD_0");
    };
    warned(&unmapped, "meshes[0].primitives[0]", "without its texture coordinates");
    let (json, binary) = pictured(|json| json["materials"][0]["emissiveTexture"] = json!({ "index": 0 }));
    let scene = read_with(&json, &binary).unwrap().scene;
    assert!(scene.textures.is_empty() && scene.materials[0].emission_map.is_none(), "its factor is 0");
}

#[test]
fn samplers_clamp_and_mirror_and_webp_images_come_first() {
    let webp = |json: &mut Value| {
        json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorTexture": { "index": 1 } });
        json["samplers"][0]["wrapS"] = json!(33071);
        json["samplers"][0]["wrapT"] = json!(33648);
        json["extensionsRequired"] = json!(["EXT_texture_webp"]);
        json["images"].as_array_mut().unwrap().insert(0, json!({ "uri": "gone.png" }));
        json["textures"][1] =
            json!({ "source": 0, "sampler": 0, "extensions": { "EXT_texture_webp": { "source": 1 } } });
    };
    let (json, binary) = pictured(webp);
    let Loaded { scene, folder, path } = read_with(&json, &binary).unwrap();
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
    assert_eq!(scene.textures[0].wrap, [Wrap::Clamp, Wrap::Mirror]);
    assert_eq!(scene.textures[0].texels.len(), 2);
    let converted = convert_model(&path, &folder.path("s.json")).unwrap();
    for (name, bytes) in converted.pictures {
        folder.write(name.to_str().unwrap(), bytes);
    }
    let again = folder.load("s.json", converted.text).unwrap();
    assert_eq!((again.textures[0].wrap, again.uvs), (scene.textures[0].wrap, scene.uvs));
}

#[test]
fn alpha_modes_are_opacities_that_convert_keeps() {
    let of = |keys: Value, factor: f64, alphas: Option<[u8; 2]>| {
        let mut binary = square();
        let json = model(|json| {
            let pixels = alphas.unwrap_or_default().map(|alpha| [200, 100, 50, alpha]).concat();
            let mut png = std::io::Cursor::new(Vec::new());
            let picture = image::RgbaImage::from_raw(2, 1, pixels).unwrap();
            picture.write_to(&mut png, image::ImageFormat::Png).unwrap();
            append(json, &mut binary, &png.into_inner(), json!({}));
            json["images"] = json!([{ "bufferView": 2, "mimeType": "image/png" }]);
            json["textures"] = json!([{ "source": 0 }]);
            json["materials"][0] = keys;
            json["materials"][0]["pbrMetallicRoughness"] = json!({ "baseColorFactor": [1, 1, 1, factor] });
            if alphas.is_some() {
                json["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"] = json!({ "index": 0 });
            }
        });
        let Loaded { scene, folder, path } = read_with(&json, &binary).unwrap();
        assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
        let shown = |scene: &Scene| {
            let Material { opacity, opacity_map, alpha_cutoff, .. } = scene.materials[0];
            let texels = opacity_map.map(|map| scene.textures[map as usize].texels.clone());
            (opacity, texels, alpha_cutoff)
        };
        let converted = convert_model(&path, &folder.path("s.json")).unwrap();
        converted.pictures.iter().for_each(|(name, bytes)| drop(folder.write(name.to_str().unwrap(), bytes)));
        assert_eq!(shown(&scene), shown(&folder.load("s.json", converted.text).unwrap()));
        shown(&scene)
    };
    let (blend, mask) =
        (json!({ "alphaMode": "BLEND" }), json!({ "alphaMode": "MASK", "alphaCutoff": 0.25 }));
    let halves = Some([255, 51]);
    let texels = || Some(Texels::Unorm8(vec![[255, 255, 255, 0], [51, 51, 51, 0]]));
    let cases = [
        (json!({}), 0.5, halves, (1.0, None, None)),
        (json!({ "alphaMode": "OPAQUE" }), 0.5, None, (1.0, None, None)),
        (blend.clone(), 0.5, None, (0.5, None, None)),
        (blend.clone(), 0.5, halves, (0.5, texels(), None)),
        // A picture without transparency needs no map.
        (blend, 0.75, Some([255; 2]), (0.75, None, None)),
        (mask.clone(), 0.5, halves, (0.5, texels(), Some(0.25))),
        (mask.clone(), 0.25, None, (1.0, None, None)),
        (mask.clone(), 0.125, halves, (0.0, None, None)),
        (mask, 0.25, Some([255; 2]), (1.0, None, None)),
        (json!({ "alphaMode": "MASK" }), 1.0, halves, (1.0, texels(), Some(0.5))),
        (json!({ "alphaMode": "MASK", "alphaCutoff": 1.5 }), 1.0, halves, (0.0, None, None)),
    ];
    for (number, (keys, factor, alphas, wanted)) in cases.into_iter().enumerate() {
        assert_eq!(of(keys, factor, alphas), wanted, "case {number}");
    }
}

#[test]
fn numbers_outside_their_ranges_are_said_with_what_is_used_instead() {
    let extension = |name: &str, key: &str| format!("extensions.KHR_materials_{name}.{key}");
    for (path, value, words) in [
        (extension("ior", "ior"), json!(0.5), "0.5 is outside 1 to 1000000: 1 is used"),
        (
            extension("emissive_strength", "emissiveStrength"),
            json!(-1),
            "-1 is outside 0 to 1000000000: 0 is",
        ),
        (extension("transmission", "transmissionFactor"), json!(2), "2 is outside 0 to 1: 1 is used"),
        (
            extension("volume", "attenuationDistance"),
            json!(0),
            "0 is not above 0: the volume absorbs no light",
        ),
        (extension("specular", "specularColorFactor"), json!([1, -2, 1]), "-2 is outside"),
        (extension("clearcoat", "clearcoatFactor"), json!(1.5), "1.5 is outside 0 to 1: 1 is used"),
        ("pbrMetallicRoughness.roughnessFactor".into(), json!(3), "3 is outside 0 to 1: 1 is used"),
        ("alphaCutoff".into(), json!(-1), "-1 is outside"),
        (
            "alphaMode".into(),
            json!("blend"),
            "`blend` is none of OPAQUE, MASK, BLEND: the material is opaque",
        ),
    ] {
        let (_, scene) = material(|json| {
            let place = path.split('.').fold(json, |at, key| &mut at[key]);
            *place = value;
        });
        let warning = scene.warnings.concat();
        assert!(warning.contains(&format!("materials[0].{path}: {words}")), "{path}: {warning}");
        assert_eq!(scene.warnings.len(), 1, "{warning}");
    }
    let (mirror, scene) = material(|json| json["extensions"]["KHR_materials_ior"] = json!({ "ior": 0 }));
    assert!(matches!(mirror.kind, MaterialKind::MetalRough { ior: 1e6, .. }) && scene.warnings.is_empty());
}
