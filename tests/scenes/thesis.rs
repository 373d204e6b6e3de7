//! The thesis's own scene format: its values in our axes and our units.

use crate::folder::Folder;
use glam::{Vec3, vec2, vec3};
use octray::scene::{Filter, MaterialKind, Scene, Side, Sky};

fn load_text(text: &str) -> Scene {
    Folder::new().load("s.json", text).unwrap_or_else(|error| panic!("{error}"))
}

/// The file of the format's description, as it stands.
const EXAMPLE: &str = r#"{
  "res": [240, 135],
  "sky": [0.2, 0.3, 0.4],
  "sphere":   [ { "center": [0,5,0], "radius": 8, "color": [255,0,0], "emission": 1, "roughness": 5000, "texture": "./bin/texture/wall.jpg" } ],
  "triangle": [ { "center": [-20,20,-20], "s0": [0,0,40], "s1": [0,-40,20], "color": [255,255,255],
                  "emission": 0, "roughness": 0, "normal": [0,0,1], "texture": "" } ]
}"#;

/// The inverse of the display curve, IEC 61966-2-1.
fn linear(x: f64) -> f32 {
    (if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }) as f32
}

#[test]
fn example_of_the_description_loads_with_one_warning() {
    let scene = load_text(EXAMPLE);
    assert_eq!((scene.resolution, scene.max_bounces), ([240, 135], 4));
    assert_eq!(scene.sky, Sky::Color(vec3(linear(0.2), linear(0.3), linear(0.4))));
    assert_eq!(scene.spheres[0].center, vec3(0.0, -5.0, 0.0));
    assert_eq!((scene.spheres[0].radius, scene.spheres[0].texture_turn), (8.0, 0.5));
    assert_eq!(scene.spheres[0].texture_side, Side::Inside);
    let of = |number: u32| &scene.materials[number as usize];
    let lamp = of(scene.spheres[0].material);
    assert_eq!((lamp.kind, lamp.emission, lamp.texture), (MaterialKind::Emitter, Vec3::X, None));
    // Corners center, center + s0, center + s1, inverted through the origin.
    let corners = [[20., -20., 20.], [20., -20., -20.], [20., 20., 0.]].map(Vec3::from_array);
    assert_eq!(scene.triangles[0].vertices, corners);
    let mirror = of(scene.triangles[0].material);
    assert_eq!((mirror.kind, mirror.color), (MaterialKind::Metal { roughness: 0.0 }, Vec3::ONE));
    assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
    assert!(scene.warnings[0].contains("./bin/texture/wall.jpg"));
}

#[test]
fn camera_keeps_the_old_view() {
    let scene = load_text(r#"{ "res": [400, 100], "sphere": [ { "center": [0,0,0], "radius": 1 } ] }"#);
    let camera = scene.camera;
    assert_eq!(camera.position, vec3(-2.0, 2.5, 365.63));
    let forward = (camera.look_at - camera.position).normalize();
    let right = forward.cross(camera.up);
    // Theirs: yaw -4.7, nearly along +z; x grows to the left, y downwards. Inverted: nearly along -z, right
    // +x, up +y. Not -3π/2: the middle of the picture passes x = -2.53 at z = 0, and the origin, which would
    // lie 7.7 pixels right of the middle, lies 9.8 left of it.
    let (sin, cos) = (-4.7_f64).sin_cos();
    assert!((forward.as_dvec3() + glam::dvec3(cos, 0.0, sin)).length() < 1e-6, "{forward}");
    assert!((right.as_dvec3() - glam::dvec3(sin, 0.0, -cos)).length() < 1e-6, "{right}");
    assert_eq!(camera.up, Vec3::Y);
    // Focal length 200 w / 68: half the width over it is 34/200 at any width; the height follows the aspect,
    // 1/4.
    let half_height = (camera.vertical_fov.to_radians() / 2.0).tan();
    assert!((half_height - 34.0 / 200.0 / 4.0).abs() < 1e-7, "{half_height}");
}

/// The centre of this ball is in the upper left of their picture, and must be so in ours.
#[test]
fn ball_up_and_left_of_their_camera_stays_up_and_left() {
    let scene = load_text(r#"{ "sphere": [ { "center": [12, -12.5, 0], "radius": 1 } ] }"#);
    let toward = scene.spheres[0].center - scene.camera.position;
    assert_eq!(toward, vec3(-10.0, 10.0, -365.63));
}

#[test]
fn default_resolution_and_missing_keys_are_filled_in() {
    let scene = load_text(r#"{ "sphere": [ { "center": [1,2,3], "radius": 1 } ] }"#);
    assert_eq!((scene.resolution, scene.sky), ([240, 135], Sky::Color(Vec3::ZERO)));
    let material = &scene.materials[0];
    assert_eq!((material.kind, material.color), (MaterialKind::Metal { roughness: 0.0 }, Vec3::ONE));
}

#[test]
fn surfaces_follow_emission_then_roughness() {
    let scene = load_text(
        r#"{ "sphere": [
        { "center": [0,0,0], "radius": 1, "color": [128,255,0], "emission": 2.5, "roughness": 7 },
        { "center": [0,0,0], "radius": 1, "color": [128,255,0], "emission": 0, "roughness": 5000 },
        { "center": [0,0,0], "radius": 1, "color": [128,255,0], "emission": -1, "roughness": 0 },
        { "center": [9,0,0], "radius": 1, "color": [128,255,0], "emission": 0, "roughness": 5000 } ] }"#,
    );
    let of = |i: usize| &scene.materials[scene.spheres[i].material as usize];
    let color = vec3(linear(128.0 / 255.0), 1.0, 0.0);
    assert_eq!(of(0).kind, MaterialKind::Emitter);
    assert!((of(0).emission - 2.5 * color).length() < 1e-6, "{}", of(0).emission);
    assert_eq!((of(1).kind, of(1).color), (MaterialKind::FuzzyMirror { roughness: 2.5 }, color));
    assert_eq!((of(1).emission, of(2).kind), (Vec3::ZERO, MaterialKind::Metal { roughness: 0.0 }));
    // Equal surfaces share one material.
    assert_eq!((scene.spheres[3].material, scene.materials.len()), (scene.spheres[1].material, 3));
}

#[test]
fn textures_are_found_beside_the_scene_and_above_it_with_either_slash() {
    let folder = Folder::new();
    folder.save_picture("project/bin/texture/wall.png");
    folder.save_picture("project/scenes/deep/near.png");
    let texture = |path: &str| {
        let text = format!(
            r#"{{ "sky": [1,1,1], "sphere": [ {{ "center": [0,0,0], "radius": 1, "texture": "{}" }} ] }}"#,
            path.replace('\\', "\\\\")
        );
        folder.load("project/scenes/deep/s.json", &text).unwrap()
    };
    for path in
        ["near.png", "./near.png", "./bin/texture/wall.png", "bin/texture/wall.png", "bin\\texture\\wall.png"]
    {
        let scene = texture(path);
        assert!(scene.warnings.is_empty(), "{path}: {:?}", scene.warnings);
        assert_eq!(scene.textures[0].filter, Filter::Nearest);
        assert_eq!(scene.materials[0].texture, Some(0));
    }
    let missing = texture("bin/texture/none.png");
    assert!(missing.warnings[0].contains("bin/texture/none.png") && missing.textures.is_empty());
}

#[test]
fn ball_textures_lie_as_in_their_program() {
    let scene = load_text(r#"{ "sphere": [ { "center": [0,0,0], "radius": 1 } ] }"#);
    for theirs in
        [[0.6, 0.64, 0.48], [-0.6, 0.0, 0.8], [0.0, -0.8, -0.6], [-0.36, 0.48, -0.8]].map(Vec3::from_array)
    {
        let ours = -theirs;
        let u =
            (ours.z.atan2(ours.x) / std::f32::consts::TAU + scene.spheres[0].texture_turn).rem_euclid(1.0);
        let row = ours.y.acos() / std::f32::consts::PI;
        // Their lookup, from the description: column and row (from the top), each in [0, 1).
        let their_u = (theirs.z.atan2(theirs.x) / std::f32::consts::TAU).rem_euclid(1.0);
        let their_row = 1.0 - theirs.y.acos() / std::f32::consts::PI;
        assert!((u - their_u).abs() < 1e-6 && (row - their_row).abs() < 1e-6, "{theirs}: {u} {row}");
    }
}

#[test]
fn triangle_textures_lie_as_in_their_program() {
    let folder = Folder::new();
    folder.save_picture("p.png");
    let text = r#"{ "triangle": [
        { "center": [7,8,9], "s0": [300,0,0], "s1": [0,0,200], "roughness": 1, "texture": "p.png" },
        { "center": [7,8,9], "s0": [0,50,0], "s1": [0,0,25], "roughness": 1, "texture": "p.png" } ] }"#;
    let scene = folder.load("s.json", text).unwrap();
    // First: n = x cross z = (0,-1,0); tangent (0, -n.z, n.y) = (0,0,-1); bitangent n x tangent = (1,0,0).
    // At s0: u 0, row 3. At s1: u -2, row 0. Stored: v = 1 - row.
    assert_eq!(scene.uvs[0], [vec2(0.0, 1.0), vec2(0.0, -2.0), vec2(-2.0, 1.0)]);
    // Second: n = y cross z = (1,0,0); tangent (n.z, 0, -n.x) = (0,0,-1); bitangent (0,1,0).
    assert_eq!(scene.uvs[1], [vec2(0.0, 1.0), vec2(0.0, 0.5), vec2(-0.25, 1.0)]);
}

#[test]
fn huge_numbers_tabs_blank_lines_and_marks_load() {
    let scene = load_text(
        "\u{feff}{\n\t\"res\":\t[240.0, 135],\n\t\"sphere\": [\n\t\t{ \"center\": [0, 99999999999, 0], \"radius\": 99999999999,\t\
         \"color\": [1,2,3], \"emission\": 99999999999 }\n\t],\n\t\"triangle\": []\n}\n\n\n\t\n",
    );
    assert_eq!(scene.spheres[0].center.y, -1e11);
    assert_eq!(scene.spheres[0].radius, 1e11);
}

#[test]
fn what_is_left_out_or_brought_into_range_is_one_warning() {
    let ball = |keys: &str| format!(r#"{{ "center": [0,0,0], "radius": 1, {keys} }}"#);
    let (metallic, gone) = (ball(r#""metallic": 0.5"#), ball(r#""texture": "gone.png""#));
    let flat = r#"{ "center": [0,0,0], "s0": [1,0,0], "s1": [2,0,0] }"#;
    let whole = r#"{ "center": [0,0,0], "s0": [1,0,0], "s1": [0,1,0] }"#;
    for (keys, words) in [
        (
            format!(r#""triangle": [ {whole}, {flat}, {flat} ]"#),
            "triangle[1]: a triangle of zero area is left out (1 more like it)",
        ),
        (format!(r#""sphere": [ {metallic}, {metallic} ]"#), "(1 more like it)"),
        (
            format!(r#""sphere": [ {} ], "author": {{ "a": [1] }}"#, ball(r#""color": [255,255,255]"#)),
            "`author`",
        ),
        (format!(r#""sphere": [ {gone}, {gone}, {gone} ]"#), "gone.png"),
        (format!(r#""sphere": [ {} ]"#, ball(r#""color": [300,-5,255], "roughness": 9"#)), "sphere[0].color"),
    ] {
        let scene = load_text(&format!(r#"{{ "sky": [1,1,1], {keys} }}"#));
        assert_eq!(scene.warnings.len(), 1, "{:?}", scene.warnings);
        assert!(scene.warnings[0].contains(words), "{words}: {:?}", scene.warnings);
        let color = scene.materials[0].color;
        assert!(color == Vec3::ONE || color == vec3(1.0, 0.0, 1.0), "within 0 to 1: {color}");
        assert!(scene.triangles.len() <= 1);
    }
}

#[test]
fn faults_name_path_line_and_remedy() {
    let folder = Folder::new();
    for (part, keys, at, words) in [
        ("sphere", r#""center": [0,0,0], "radius": 0"#, "sphere[0].radius, line 1", "at least"),
        ("sphere", r#""center": [0,1e30,0], "radius": 1"#, "sphere[0].center[1]", "1e18"),
        ("sphere", r#""radius": 1"#, "sphere[0]", "add `center`"),
        ("sphere", r#""center": "x", "radius": 1"#, "sphere[0].center, line 1", "array"),
        ("sphere", r#""center": [0,0,0], "radius": 1, "roughness": -1"#, "sphere[0].roughness", "0 or more"),
        ("sphere", r#""center": [0,0,NaN], "radius": 1"#, "sphere[0].center[2]", "NaN"),
        ("triangle", r#""center": [0,0,0], "s0": [1,0,0]"#, "triangle[0]", "add `s1`"),
        ("triangle", r#""center": [1e18,0,0], "s0": [1e18,0,0], "s1": [0,1,0]"#, "triangle[0]", "too far"),
    ] {
        folder.assert_refused("s.json", format!(r#"{{ "{part}": [ {{ {keys} }} ] }}"#), at, words);
    }
    for (key, at, words) in [
        (r#""res": [0, 135]"#, "res[0], line 1", "1 to"),
        (r#""res": [2.5, 135]"#, "res[0], line 1, column 11", "whole number"),
        (r#""sky": [0,-1,0]"#, "sky[1]", "0 to 1"),
    ] {
        let text = format!(r#"{{ {key}, "sphere": [ {{ "center": [0,0,0], "radius": 1 }} ] }}"#);
        folder.assert_refused("s.json", text, at, words);
    }
    folder.assert_refused("s.json", r#"{ "res": [240, 135] }"#, "", "`sphere`");
}
