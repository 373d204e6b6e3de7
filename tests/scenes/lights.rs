//! Lights of files: native ones, those of glTF models, their units, and the cameras that come along.

use crate::folder::{Folder, gltf_triangle};
use glam::{Vec3, vec3};
use octray::scene::{LightShape, LightUnits, Scene, Sky, convert_model, load};
use std::f64::consts::PI;

const SPHERE: &str = r#""spheres": [ { "center": [0, 0, 0], "radius": 1 } ]"#;

/// A model with a spot of 10 W, a sun of 3 W/m² and a camera, in the units of Blender's exporter.
fn model(generator: &str) -> String {
    let candela = 683.0 * 10.0 / (4.0 * PI);
    let lights = format!(
        r#"[ {{ "type": "spot", "color": [1, 0.5, 0], "intensity": {candela}, "range": 8,
                "spot": {{ "innerConeAngle": 0.25, "outerConeAngle": 0.5 }} }},
             {{ "type": "directional", "intensity": {} }}, {{ "type": "area" }} ]"#,
        683 * 3
    );
    let more = format!(
        r#""materials": [{{}}], "extensions": {{ "KHR_lights_punctual": {{ "lights": {lights} }} }},
           "extensionsRequired": ["KHR_lights_punctual"],
           "cameras": [{{ "type": "perspective", "perspective": {{ "yfov": 0.5, "znear": 1, "aspectRatio": 2 }} }}]"#
    );
    // Turned by 90° about x, so that the light shines along y.
    let node = |light: u32| {
        format!(
            r#"{{ "translation": [1, 2, 3], "scale": [5, 5, 5], "rotation": [0.7071067811865476, 0, 0, 0.7071067811865476],
                 "extensions": {{ "KHR_lights_punctual": {{ "light": {light} }} }} }}"#
        )
    };
    let nodes =
        format!(r#"{{ "mesh": 0 }}, {}, {}, {{ "camera": 0, "translation": [0, 0, 7] }}"#, node(0), node(1));
    gltf_triangle("m.bin", &more)
        .replace(r#""version": "2.0""#, &format!(r#""version": "2.0", "generator": "{generator}""#))
        .replace(r#"[{ "mesh": 0 }]"#, &format!("[{nodes}]"))
        .replace(r#"[{ "nodes": [0] }]"#, r#"[{ "nodes": [0, 1, 2, 3] }]"#)
}

const BLENDER: &str = "Khronos glTF Blender I/O v4.2.70";

fn folder(generator: &str) -> Folder {
    let folder = Folder::new();
    let corners = [[0.0_f32; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    let bytes: Vec<u8> = corners.as_flattened().iter().flat_map(|x| x.to_le_bytes()).collect();
    folder.write("m.bin", bytes);
    folder.write("m.gltf", model(generator));
    folder
}

/// The model as a scene, and as a mesh of one with these keys.
fn named(folder: &Folder, keys: &str) -> Scene {
    folder.load_keys(&format!(r#""meshes": [ {{ "model": "m.gltf"{keys} }} ]"#)).unwrap()
}

/// The spot's intensity in red and the sun's irradiance.
fn brightness(scene: &Scene) -> [f32; 2] {
    [0, 1].map(|at| scene.lights[at].shape.brightness().x)
}

#[test]
fn lights_of_a_model_stand_where_their_nodes_do() {
    let folder = folder(BLENDER);
    let scene = load(&folder.name("m.gltf")).unwrap();
    let unit = scene.coordinates.unit as f32;
    assert_eq!((scene.lights.len(), unit), (2, 1.0));
    let LightShape::Spot { position, direction, range, inner_degrees, outer_degrees, .. } =
        scene.lights[0].shape
    else {
        panic!("{:?}", scene.lights)
    };
    assert_eq!(scene.coordinates.to_file(position.into()).as_vec3(), vec3(1.0, 2.0, 3.0));
    assert!(direction.distance(Vec3::Y) < 1e-6 && range == 8.0, "{direction} {range}");
    assert_eq!([inner_degrees, outer_degrees], [0.25, 0.5].map(|x: f64| x.to_degrees() as f32));
    assert!(scene.lights.iter().all(|light| light.units == LightUnits::Blender));
}

#[test]
fn candela_and_lux_are_radiometric_but_for_blender() {
    let near = |found: [f32; 2], expected: [f64; 2]| {
        let close = |(found, expected): (f32, f64)| (f64::from(found) / expected - 1.0).abs() < 1e-6;
        assert!(found.into_iter().zip(expected).all(close), "{found:?}, {expected:?}");
    };
    // What Cycles gives a lamp of 10 W, and its sun.
    let watts = [10.0 / (4.0 * PI), 3.0];
    let blender = folder(BLENDER);
    near(brightness(&load(&blender.name("m.gltf")).unwrap()), watts);
    near(brightness(&named(&blender, "")), watts);
    near(brightness(&named(&blender, r#", "light_units": "radiometric""#)), watts.map(|x| 683.0 * x));
    let other = folder("COLLADA2GLTF");
    near(brightness(&load(&other.name("m.gltf")).unwrap()), watts.map(|x| 683.0 * x));
    near(brightness(&named(&other, r#", "light_units": "blender""#)), watts);
    // The picture of a larger model is the same.
    let large = named(&blender, r#", "scale": 4"#);
    let per_unit = large.coordinates.unit.powi(2);
    near(brightness(&large), [watts[0] * 16.0 / per_unit, watts[1]]);
}

#[test]
fn lights_and_camera_come_along_unless_the_scene_says_otherwise() {
    let folder = folder(BLENDER);
    let scene = named(&folder, r#", "translate": [0, 0, 1], "rotate_degrees": [0, 90, 0]"#);
    let at = scene.coordinates.to_file(scene.camera.position.into());
    assert!(at.distance(glam::dvec3(7.0, 0.0, 1.0)) < 1e-6, "{at}");
    let forward = (scene.camera.look_at - scene.camera.position).normalize();
    assert!(forward.distance(Vec3::NEG_X) < 1e-6, "{forward}");
    assert_eq!((scene.lights.len(), scene.resolution), (2, [255, 127]));
    let LightShape::Spot { direction, .. } = scene.lights[0].shape else { panic!() };
    assert!(direction.distance(Vec3::Y) < 1e-6);
    // Lights emit: the sky is black.
    assert_eq!(scene.sky, Sky::Color(Vec3::ZERO));
    let without = named(&folder, r#", "lights": false, "camera": false"#);
    assert!(without.lights.is_empty() && without.sky == Sky::Color(Vec3::ONE));
    assert_ne!(without.camera.vertical_fov, scene.camera.vertical_fov);
    let keys = r#""meshes": [ { "model": "m.gltf", "lights": false, "light_units": "blender" } ]"#;
    let error = folder.load_keys(keys).unwrap_err().to_string();
    assert!(error.contains("meshes[0].light_units") && error.contains("remove `lights`"), "{error}");
    let own = r#""camera": { "vertical_fov": 33 }, "meshes": [ { "model": "m.gltf" } ]"#;
    assert_eq!(folder.load_keys(own).unwrap().camera.vertical_fov, 33.0);
}

#[test]
fn converted_lights_keep_their_bits() {
    let folder = folder(BLENDER);
    let scene = folder.path("scene.json");
    let converted = convert_model(&folder.path("m.gltf"), &scene).unwrap();
    let again = folder.load("scene.json", &converted.text).unwrap();
    let shapes = |scene: &Scene| scene.lights.iter().map(|light| light.shape).collect::<Vec<_>>();
    assert_eq!(shapes(&again), shapes(&load(&folder.name("m.gltf")).unwrap()));
    // A light of no known type is left out.
    folder.write("m.gltf", model(BLENDER).replace(r#"{ "light": 1 }"#, r#"{ "light": 2 }"#));
    let scene = load(&folder.name("m.gltf")).unwrap();
    let warned = scene
        .warnings
        .iter()
        .any(|warning| warning.contains("nodes[2]: a light is left out: the type `area`"));
    assert!(scene.lights.len() == 1 && warned, "{:?}", scene.warnings);
    for (known, faulty, words) in [
        (r#""range": 8"#, r#""range": -8"#, "nodes[1]: a light is left out: its `range` -8 is not above 0"),
        (r#""color": [1, "#, r#""color": [-1, "#, "its `color` [-1.0, 0.5, 0.0] times its `intensity` 543"),
        (r#"Angle": 0.25"#, r#"Angle": 0.75"#, "`innerConeAngle` (42.97"),
    ] {
        folder.write("m.gltf", model(BLENDER).replace(known, faulty));
        let warnings = load(&folder.name("m.gltf")).unwrap().warnings.concat();
        assert!(warnings.contains(words), "{warnings}");
    }
}

#[test]
fn faulty_lights_are_refused_with_their_place() {
    let folder = Folder::new();
    let point = r#""type": "point", "position": [0, 1, 0]"#;
    let spot = r#""type": "spot", "position": [0, 1, 0], "intensity": [1, 1, 1]"#;
    let sun = r#""type": "directional", "irradiance": [1, 1, 1]"#;
    for (keys, at, words) in [
        (r#""type": "area""#.to_string(), ".type", "the types are point, spot, directional"),
        (r#""position": [0, 1, 0]"#.to_string(), "", "\"type\": \"point\""),
        (point.to_string(), "", "`intensity`"),
        (format!(r#"{point}, "intensity": [1, -1, 1]"#), ".intensity[1]", "negative"),
        (format!(r#"{point}, "intensity": [1, 1, 1], "range": 0"#), ".range", "above 0"),
        (format!(r#"{point}, "irradiance": [1, 1, 1]"#), ".irradiance", "does not belong to a point light"),
        (spot.to_string(), "", "`direction`"),
        (format!(r#"{spot}, "direction": [0, 0, 0]"#), ".direction", "length zero"),
        (format!(r#"{spot}, "look_at": [0, 1, 0]"#), ".look_at", "length zero"),
        (format!(r#"{spot}, "look_at": [0, 0, 0], "direction": [0, 0, 1]"#), ".look_at", "remove"),
        (format!(r#"{spot}, "direction": [0, 0, 1], "outer_degrees": 91"#), ".outer_degrees", "to 90"),
        (format!(r#"{spot}, "direction": [0, 0, 1], "inner_degrees": 46"#), ".inner_degrees", "outer"),
        (sun.to_string(), "", "`direction`"),
        (format!(r#"{sun}, "direction": [0, -1, 0], "angular_diameter_degrees": 181"#), ".angular", "180"),
        (format!(r#"{sun}, "direction": [0, -1, 0], "angular_diameter_degrees": 1e-5"#), ".angular", "180"),
        (format!(r#"{sun}, "direction": [0, -1, 0], "power": 4"#), "", "unknown key `power`"),
    ] {
        let text = format!(r#"{{ "format": "octray-1", "lights": [ {{ {keys} }} ], {SPHERE} }}"#);
        folder.assert_refused("scene.json", text, &format!("lights[0]{at}"), words);
    }
}
