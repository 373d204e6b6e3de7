//! Triangles and cameras of glTF models: nodes, accessors, modes.

use super::super::coordinates::in_file;
use super::{Loaded, append, floats, model, placed, read, read_with, refused, square};
use glam::{Vec3, vec3};
use octray::scene::{Projection, load};
use serde_json::json;

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
    let mut binary = square();
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
        let bytes = [0, 0, 0, 99, 127, 0, 0, 99, 127, 127, 0, 99, 0, 127, 0, 99];
        append(json, &mut binary, &bytes, json!({ "byteStride": 4 }));
        append(json, &mut binary, &[2, 0, 127, 127, (-127_i8) as u8, 0], json!({}));
    });
    let scene = read_with(&json, &binary).unwrap().scene;
    assert_eq!(scene.triangles[0].vertices, [Vec3::ZERO, Vec3::X, vec3(1.0, 1.0, -1.0)]);
    assert_eq!(scene.triangles[1].vertices[2], Vec3::Y);
}

#[test]
fn node_chains_in_coordinates_of_a_map_keep_every_digit() {
    let (x, z) = (447_321.6, -5_411_873.7);
    let json = model(|json| {
        let matrix = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, x + 0.25, 0.0, z, 1.0];
        json["nodes"] = json!([
            { "mesh": 0, "translation": [x, 0, z] }, { "mesh": 0, "matrix": matrix },
            { "children": [3], "translation": [-x, 1e-3, z] }, { "mesh": 0, "translation": [2.0 * x + 0.5, 0, 0] }
        ]);
        json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    });
    let Loaded { path, folder: _folder, .. } = read_with(&json, &square()).unwrap();
    let scene = load(path.to_str().unwrap()).unwrap();
    let [first, second, third] = [0, 2, 4].map(|triangle: usize| scene.triangles[triangle].vertices[0]);
    assert!((second - first).abs_diff_eq(vec3(0.25, 0.0, 0.0), 1e-9), "{}", second - first);
    assert!((third - first).abs_diff_eq(vec3(0.5, 1e-3, 0.0), 1e-8), "{}", third - first);
}

#[test]
fn cameras_look_along_minus_z_of_their_node_and_have_its_aspect_ratio() {
    for (aspect, resolution, warnings) in
        [(16.0 / 9.0, [240, 135], 0), (0.5, [127, 255], 0), (1e9, [240, 135], 1)]
    {
        let scene = read(&model(|json| {
            let perspective = json!({ "yfov": 0.5, "aspectRatio": aspect });
            json["cameras"] = json!([{ "type": "perspective", "perspective": perspective }]);
            json["nodes"] =
                json!([{ "mesh": 0 }, { "camera": 0, "translation": [0, 0, 7], "rotation": [0, 0, 1, 0] }]);
            json["scenes"][0]["nodes"] = json!([0, 1]);
        }));
        let camera = scene.camera;
        assert_eq!((camera.position, camera.up), (vec3(0.0, 0.0, 7.0), Vec3::NEG_Y));
        assert_eq!((camera.look_at - camera.position).normalize(), Vec3::NEG_Z);
        assert!((camera.vertical_fov - 28.65).abs() < 0.01);
        assert_eq!((scene.resolution, scene.warnings.len()), (resolution, warnings), "{:?}", scene.warnings);
    }
}

#[test]
fn orthographic_cameras_show_twice_their_magnification() {
    let scene = read(&model(|json| {
        json["cameras"] = json!([{ "type": "orthographic", "orthographic":
            { "xmag": 1.5, "ymag": 3, "znear": 0, "zfar": 9 } }]);
        json["nodes"] = json!([{ "mesh": 0 }, { "camera": 0, "translation": [0, 0, 7], "scale": [9, 9, 9] }]);
        json["scenes"][0]["nodes"] = json!([0, 1]);
    }));
    assert_eq!(scene.camera.projection, Projection::Orthographic { height: 6.0 });
    assert_eq!((scene.resolution, scene.camera.position), ([127, 255], vec3(0.0, 0.0, 7.0)));
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn impossible_numbers_of_cameras_and_rotations_are_named() {
    let orthographic = |x: f64, y: f64| json!({ "orthographic": { "xmag": x, "ymag": y } });
    for (camera, words) in [
        (
            json!({ "perspective": { "yfov": 0 } }),
            "cameras[0] has a `yfov` of 0, not above 0 and below π: the",
        ),
        (json!({ "perspective": { "yfov": 4 } }), "cameras[0] has a `yfov` of 4, not"),
        (json!({ "perspective": { "yfov": 1, "aspectRatio": 0 } }), "the aspect ratio 0 is not within 1/64"),
        (
            orthographic(0.0, 2.0),
            "cameras[0] has an `xmag` of 0 and a `ymag` of 2, not above 0: the model is",
        ),
        (orthographic(-1.0, 2.0), "cameras[0]: `xmag` -1 and `ymag` 2 are used without their signs."),
    ] {
        let scene = read(&model(|json| {
            json["cameras"] = json!([camera]);
            json["nodes"] = json!([{ "mesh": 0 }, { "camera": 0, "translation": [0, 0, 7] }]);
            json["scenes"][0]["nodes"] = json!([0, 1]);
        }));
        assert!(scene.warnings[0].contains(words), "{:?}", scene.warnings);
    }
    let scene = read(&model(|json| json["nodes"][0]["rotation"] = json!([0, 0, 0, 0])));
    assert!(scene.warnings[0].contains("nodes[0]: a rotation has length 0.000 and"), "{:?}", scene.warnings);
}

#[test]
fn normals_stay_upright_where_nodes_stretch() {
    let mut binary = square();
    let normals = [[0.6, 0.0, 0.8], [0.0, 0.6, 0.8], [0.0, -0.6, 0.8], [-0.6, 0.0, 0.8]];
    for (vertex, normal) in normals.iter().enumerate() {
        binary[32 * vertex + 12..][..12].copy_from_slice(&floats(normal));
    }
    let json =
        model(|json| json["nodes"][0] = json!({ "mesh": 0, "translation": [1, 0, 0], "scale": [2, 1, 1] }));
    let scene = placed(&json, &binary, json!({ "rotate_degrees": [0, 0, 90], "translate": [5, 0, 0] }));
    // Twice as long in x, then turned from x to y.
    let wanted = normals.map(|[x, y, z]: [f32; 3]| vec3(-y, x / 2.0, z).normalize());
    for (triangle, corners) in [[0, 1, 2], [0, 2, 3]].into_iter().enumerate() {
        for (found, corner) in scene.normals[triangle].iter().zip(corners) {
            assert!(found.abs_diff_eq(wanted[corner], 1e-6), "{corner}: {found}, not {}", wanted[corner]);
        }
    }
    assert_eq!(scene.triangles[0].vertices[..2], [vec3(5.0, 1.0, 0.0), vec3(5.0, 3.0, 0.0)]);
}

#[test]
fn numbers_of_every_type_are_normalised_by_their_largest() {
    let cases: [(u32, Vec<u8>, Vec<u8>, f32); 5] = [
        (5120, i8::MAX.to_le_bytes().to_vec(), i8::MIN.to_le_bytes().to_vec(), -1.0),
        (5121, vec![u8::MAX], vec![0], 0.0),
        (5122, i16::MAX.to_le_bytes().to_vec(), i16::MIN.to_le_bytes().to_vec(), -1.0),
        (5123, u16::MAX.to_le_bytes().to_vec(), vec![0; 2], 0.0),
        (5125, u32::MAX.to_le_bytes().to_vec(), vec![0; 4], 0.0),
    ];
    for (kind, most, least, lowest) in cases {
        let zero = vec![0; most.len()];
        let corners =
            [[&zero, &zero, &least], [&most, &zero, &zero], [&most, &most, &zero], [&zero, &most, &zero]];
        let bytes: Vec<u8> = corners.into_iter().flatten().flatten().copied().collect();
        let mut binary = square();
        let json = model(|json| {
            json["accessors"][0] = json!({
                "bufferView": 2, "componentType": kind, "count": 4, "type": "VEC3", "normalized": true
            });
            append(json, &mut binary, &bytes, json!({}));
        });
        let scene = read_with(&json, &binary).unwrap().scene;
        let wanted = [vec3(0.0, 0.0, lowest), Vec3::X, vec3(1.0, 1.0, 0.0)];
        assert_eq!(scene.triangles[0].vertices, wanted, "{kind}");
    }
}

#[test]
fn sparse_numbers_without_a_view_replace_zeros_from_their_offsets() {
    let mut binary = square();
    let json = model(|json| {
        json["accessors"][0] = json!({ "componentType": 5126, "count": 4, "type": "VEC3", "sparse": {
            "count": 3,
            "indices": { "bufferView": 2, "byteOffset": 3, "componentType": 5121 },
            "values": { "bufferView": 2, "byteOffset": 8 }
        } });
        let corners = floats(&[1.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 1.0, 0.0]);
        append(json, &mut binary, &[vec![0, 0, 0, 1, 2, 3, 0, 0], corners].concat(), json!({}));
    });
    let scene = read_with(&json, &binary).unwrap().scene;
    assert_eq!(scene.triangles[0].vertices, [Vec3::ZERO, Vec3::X, vec3(1.0, 1.0, 0.0)]);
    assert_eq!(scene.triangles[1].vertices[2], Vec3::Y);
}

#[test]
fn numbers_that_are_none_are_refused() {
    let mut binary = square();
    binary[32..36].copy_from_slice(&f32::NAN.to_le_bytes());
    let error = read_with(&model(|_| {}), &binary).err().unwrap();
    assert!(error.contains("the value of element 1 is not a number"), "{error}");
    let mut binary = square();
    binary[129] = 255;
    let json = model(|json| json["accessors"][3]["componentType"] = json!(5120));
    let error = read_with(&json, &binary).err().unwrap();
    assert!(error.contains("these are not indices of vertices"), "{error}");
    let error = refused(&model(|json| {
        json["buffers"].as_array_mut().unwrap().push(json!({ "byteLength": 4 }));
        json["bufferViews"][0]["buffer"] = json!(1);
    }));
    assert!(error.contains("buffers[1]") && error.contains("the file has no binary part"), "{error}");
}

#[test]
fn scenes_matrices_and_cameras_are_the_ones_that_are_named() {
    let scene = read(&model(|json| {
        json["nodes"][0]["matrix"] = json!([0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1]);
    }));
    assert_eq!(scene.triangles[0].vertices[..2], [vec3(5.0, 0.0, 0.0), vec3(5.0, 1.0, 0.0)]);
    let scene = read(&model(|json| {
        json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "translation": [0, 0, 3] }]);
        json["scenes"] = json!([{ "nodes": [0] }, { "nodes": [1] }]);
        json["scene"] = json!(1);
    }));
    assert_eq!(scene.triangles[0].vertices[0].z, 3.0);
    let scene = read(&model(|json| {
        json["nodes"] = json!([{ "mesh": 0 }, { "children": [0], "translation": [0, 0, 3] }]);
        let json = json.as_object_mut().unwrap();
        json.remove("scene");
        json.remove("scenes");
    }));
    assert_eq!((scene.triangles.len(), scene.triangles[0].vertices[0].z), (2, 3.0));
    let scene = read(&model(|json| {
        json["cameras"] = json!([{ "type": "perspective", "perspective": { "yfov": 0.5, "znear": 0.1 } }]);
        json["nodes"] = json!([
            { "mesh": 0 }, { "camera": 0, "translation": [0, 0, 7] }, { "camera": 0, "translation": [0, 0, 9] }
        ]);
        json["scenes"][0]["nodes"] = json!([0, 1, 2]);
    }));
    assert_eq!(scene.camera.position.z, 7.0);
}

#[test]
fn a_node_with_the_extra_portal_is_one_and_is_not_shown() {
    let placed = |scale: [i32; 3], extras: serde_json::Value| {
        let json = model(|json| {
            json["nodes"] = json!([{ "mesh": 0 }, { "mesh": 0, "scale": scale, "translation": [0, 0, -2], "extras": extras }]);
            json["scenes"][0]["nodes"] = json!([0, 1]);
        });
        read_with(&json, &square()).unwrap()
    };
    let normal = |[a, b, c, d]: [Vec3; 4]| {
        assert!((a + c).abs_diff_eq(b + d, 1e-6));
        (b - a).cross(d - a)
    };
    for (scale, front) in [([1, 1, 1], 1.0), ([-2, 1, 1], 2.0), ([1, 1, -1], -1.0)] {
        let Loaded { scene, folder, path } = placed(scale, json!({ "portal": true }));
        assert_eq!((scene.triangles.len(), scene.portals.len()), (2, 1), "{scale:?}");
        let vertices = scene.portals[0].vertices;
        assert!(normal(vertices).abs_diff_eq(front * Vec3::Z, 1e-5), "{scale:?}: {vertices:?}");
        let converted = octray::scene::convert_model(&path, &folder.path("s.json")).unwrap();
        assert_eq!(in_file(folder.load("s.json", converted.text).unwrap()).portals, scene.portals);
    }
    for (value, count) in [(json!(1), 1), (json!(1.0), 1), (json!(0), 0), (json!(false), 0), (json!(null), 0)]
    {
        let scene = placed([1, 1, 1], json!({ "portal": value })).scene;
        assert_eq!((scene.portals.len(), scene.triangles.len()), (count, 4 - 2 * count), "{value}");
    }
    let bare = read(&model(|json| {
        json["nodes"] = json!([{ "mesh": 0 }, { "extras": { "portal": true } }]);
        json["scenes"][0]["nodes"] = json!([0, 1]);
    }));
    assert!(bare.warnings[0].contains("nodes[1]"), "{:?}", bare.warnings);
    let strip = model(|json| {
        json["meshes"][0]["primitives"].as_array_mut().unwrap().clear();
        json["meshes"]
            .as_array_mut()
            .unwrap()
            .push(json!({ "primitives": model(|_| ())["meshes"][0]["primitives"] }));
        json["nodes"] = json!([{ "mesh": 1 }, { "mesh": 0, "extras": { "portal": true } }]);
        json["scenes"][0]["nodes"] = json!([0, 1]);
    });
    let scene = read(&strip);
    assert!(scene.portals.is_empty() && scene.warnings[0].contains("nodes[1]"), "{:?}", scene.warnings);
}
