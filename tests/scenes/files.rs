//! The native scene format: what its keys mean and what stands in for those left out.

use super::coordinates::in_file;
use crate::folder::Folder;
use glam::{Vec2, Vec3, vec2, vec3};
use octray::scene::{Filter, MaterialExtras, MaterialKind, Scene, Side, Sky, Texels};
use octray::scene::{builtin_names, load, load_with_view};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Loads a scene of these keys as a file, with whatever else stands in `folder`.
fn load_in(folder: &Folder, keys: &str) -> Scene {
    folder.load_keys(keys).unwrap_or_else(|error| panic!("{error}"))
}

fn load_keys(keys: &str) -> Scene {
    load_in(&Folder::new(), keys)
}

const BALL: &str = r#""spheres": [{ "center": [0,0,0], "radius": 1 }]"#;

/// A folder with a picture two pixels wide and one high: red, then half grey.
fn folder_with(picture: &str) -> Folder {
    let folder = Folder::new();
    let pixels =
        [1.0, 0.0, 0.0].into_iter().chain([if picture.ends_with("hdr") { 0.25 } else { 128.0 / 255.0 }; 3]);
    let colors = image::Rgb32FImage::from_raw(2, 1, pixels.collect()).unwrap();
    let path = folder.path(picture);
    match picture.ends_with("hdr") {
        true => colors.save(path).unwrap(),
        false => image::DynamicImage::from(colors).to_rgb8().save(path).unwrap(),
    }
    folder
}

/// Directly inside another ball of glass, an `ior` of 1 or of that one is a mistake; others may be meant.
#[test]
fn glass_in_glass_that_is_surely_a_mistake_is_a_warning() {
    let warnings = |outer: f64, inner: f64, color: f64, around: &str| {
        let text = format!(
            r#""materials": {{ "a": {{ "type": "glass", "ior": {outer} }}, "c": {{ "type": "glass", "ior": 0.667 }}, "d": {{ "type": "diffuse" }},
                "b": {{ "type": "glass", "ior": {inner}, "color": [{color}, 1, 1] }} }},
            "spheres": [ {{ "center": [0,0,0], "radius": 0.5, "material": "b" }}{around},
                {{ "center": [0.25,0,0], "radius": 1, "material": "a" }} ]"#
        );
        load_in(&Folder::new(), &text).warnings
    };
    for inner in [1.0, 1.25] {
        let [told] = &warnings(1.25, inner, 1.0, "")[..] else { panic!("one warning of {inner}") };
        let place = format!("spheres[0]: glass of `ior` {inner} inside glass of 1.25 ");
        assert!(told.contains(&place) && told.contains("write `ior` 0.800 (1 / 1.25)"), "{told}");
    }
    let hollow = r#", { "center": [0,0,0], "radius": 0.7, "material": "c" }"#;
    let opaque = r#", { "center": [0,0,0], "radius": 0.7, "material": "d" }"#;
    for (outer, inner, color, around) in [
        (1.5, 0.667, 1.0, ""),
        (1.5, 1.0, 0.5, ""),
        (1.5, 1.33, 1.0, ""),
        (0.8, 1.0, 1.0, ""),
        (1.5, 1.5, 1.0, hollow),
        // Within a ball that is not seen through.
        (1.5, 1.5, 1.0, opaque),
    ] {
        let told = warnings(outer, inner, color, around);
        assert!(told.is_empty(), "{outer}, {inner}: {told:?}");
    }
}

#[test]
fn native_example_of_the_design_keeps_every_value() {
    let scene = load_in(
        &folder_with("clay.png"),
        r#""camera": { "position": [0,1,5], "look_at": [0,1,0], "up": [0,1,0], "vertical_fov": 40 },
        "resolution": [320, 180],
        "max_bounces": 7,
        "sky": { "color": [0.5,0.7,1.0] },
        "materials": {
          "clay":   { "type": "diffuse", "color": [0.8,0.5,0.3], "texture": "clay.png", "filter": "nearest" },
          "chrome": { "type": "metal", "color": [0.9,0.9,0.9], "roughness": 0.1 },
          "pane":   { "type": "glass", "ior": 1.33, "thin": true },
          "old":    { "type": "scatter", "color": [1,1,1], "roughness": 2.5 },
          "lamp":   { "type": "diffuse", "color": [0,0,0], "emission": [15,14,13] }
        },
        "spheres":   [ { "center": [0,1,0], "radius": 2, "material": "old", "turn_degrees": 90 } ],
        "triangles": [ { "vertices": [[0,0,0],[1,0,0],[0,1,0]], "uvs": [[0,0],[1,0],[0,0.5]], "material": "clay" } ]"#,
    );
    let scene = in_file(scene);
    assert_eq!(scene.name, "scene.json");
    assert_eq!(scene.camera.position, vec3(0.0, 1.0, 5.0));
    assert_eq!(scene.camera.look_at, vec3(0.0, 1.0, 0.0));
    assert_eq!(scene.camera.vertical_fov, 40.0);
    assert_eq!((scene.resolution, scene.max_bounces), ([320, 180], 7));
    assert_eq!(scene.sky, Sky::Color(vec3(0.5, 0.7, 1.0)));
    let kinds: Vec<MaterialKind> = scene.materials.iter().map(|material| material.kind).collect();
    let [metal, glass] = [MaterialKind::Metal { roughness: 0.1 }, MaterialKind::ThinGlass { ior: 1.33 }];
    let fuzzy = MaterialKind::FuzzyMirror { roughness: 2.5 };
    assert_eq!(kinds, [MaterialKind::Diffuse, metal, glass, fuzzy, MaterialKind::Diffuse]);
    assert_eq!(scene.materials[2].color, Vec3::ONE);
    assert_eq!(scene.materials[4].emission, vec3(15.0, 14.0, 13.0));
    let ball = scene.spheres[0];
    assert_eq!((ball.radius, ball.material, ball.texture_turn), (2.0, 3, 0.25));
    assert_eq!(scene.triangles[0].vertices, [Vec3::ZERO, Vec3::X, Vec3::Y]);
    assert_eq!(scene.uvs, [[Vec2::ZERO, Vec2::X, vec2(0.0, 0.5)]]);
    let texture = &scene.textures[scene.materials[0].texture.unwrap() as usize];
    assert_eq!((texture.width, texture.height, texture.filter), (2, 1, Filter::Nearest));
    // IEC 61966-2-1: ((128/255 + 0.055) / 1.055)^2.4 = 0.2158605.
    assert_eq!(texture.texels.linear(0), [1.0, 0.0, 0.0]);
    assert!((texture.texels.linear(1)[0] - 0.215_860_5).abs() < 1e-7, "{:?}", texture.texels.linear(1));
    assert!(scene.warnings.is_empty() && scene.normals.is_empty());
}

#[test]
fn metal_rough_and_turned_skies_are_read() {
    let scene = load_in(
        &folder_with("p.png"),
        r#""spheres": [{ "center": [1,2,3], "radius": 2, "material": "m" }],
        "materials": { "m": { "type": "metal-rough", "emission_map": "p.png" },
                       "o": { "type": "emitter", "opacity": 0.25, "opacity_map": "p.png", "alpha_cutoff": 0.5 },
                       "n": { "type": "metal-rough", "metallic": 0.25, "roughness": 0, "roughness_map": "p.png", "ior": 9 } },
        "sky": { "texture": "p.png", "turn_degrees": -90 }"#,
    );
    let [m, o, n] = [0, 1, 2].map(|index: usize| &scene.materials[index]);
    assert_eq!((m.opacity, o.opacity, o.alpha_cutoff), (1.0, 0.25, Some(0.5)));
    // The luminance of red, as bytes without decoding.
    let grey = scene.textures[o.opacity_map.unwrap() as usize].texels.linear(0);
    assert!(grey.iter().all(|x| (x - 0.2126).abs() < 0.5 / 255.0), "{grey:?}");
    assert_eq!(m.kind, MaterialKind::MetalRough { roughness: 1.0, metallic: 1.0, ior: 1.5 });
    assert_eq!((m.emission, m.emission_map.is_some(), m.color), (Vec3::ONE, true, Vec3::ONE));
    assert_eq!(n.kind, MaterialKind::MetalRough { roughness: 0.0, metallic: 0.25, ior: 9.0 });
    assert!(matches!(scene.sky, Sky::Texture { turn: 0.75, .. }), "{:?}", scene.sky);
}

#[test]
fn rough_glass_and_extras_are_read_and_refused() {
    let with = |material: &str| {
        let text = format!(
            r#"{{ "format": "octray-1", "materials": {{ "m": {{ {material} }} }},
            "spheres": [{{ "center": [0,0,0], "radius": 1, "material": "m" }}] }}"#
        );
        Folder::new().load("scene.json", text)
    };
    let read = |text: &str| in_file(with(text).unwrap()).materials.remove(0);
    let absorbing = r#""attenuation_color": [1, 0.5, 0], "attenuation_distance": 0.25"#;
    let rough = read(&format!(r#""type": "glass", "roughness": 0.5, {absorbing}"#));
    assert_eq!(rough.kind, MaterialKind::RoughGlass { roughness: 0.5, ior: 1.5, thin: false });
    let attenuation = rough.extras.attenuation.unwrap();
    assert_eq!((attenuation.color, attenuation.distance), (vec3(1.0, 0.5, 0.0), 0.25));
    let metal = r#""type": "metal-rough""#;
    let coated =
        read(&format!(r#"{metal}, "clearcoat": 0.5, "specular": 0, "transmission": 1, "thin": true"#));
    let (extras, plain) = (coated.extras, MaterialExtras::default());
    assert_eq!(
        extras,
        MaterialExtras { clearcoat: 0.5, specular: 0.0, transmission: 1.0, thin: true, ..plain }
    );
    let warnings = |keys: &str| with(&format!(r#"{metal}, "transmission": 1{keys}"#)).unwrap().warnings;
    assert!(warnings("")[0].contains("materials.m.transmission: metal lets no light through"));
    assert!(warnings(r#", "metallic": 0.9"#).is_empty());
    for (text, key, what) in [
        (r#""type": "diffuse", "clearcoat": 1"#.to_string(), "clearcoat", "make the type `metal-rough`"),
        (format!(r#"{metal}, "thin": true"#), "thin", "lets no light through"),
        (format!(r#"{metal}, {absorbing}"#), "attenuation_color", "lets no light through"),
        (format!(r#"{metal}, "clearcoat_roughness": 1"#), "clearcoat_roughness", "add `clearcoat`"),
        (format!(r#"{metal}, "specular": 2"#), "specular", "from 0 to 1"),
        (format!(r#""type": "glass", "thin": true, {absorbing}"#), "attenuation_color", "absorbs nothing"),
        (format!(r#""type": "glass", "emission": [1,1,1], {absorbing}"#), "attenuation_color", "emits light"),
        (
            r#""type": "glass", "attenuation_distance": 1"#.into(),
            "attenuation_distance",
            "add `attenuation_color`",
        ),
    ] {
        let error = with(&text).unwrap_err().to_string();
        assert!(error.contains(&format!("materials.m.{key}")) && error.contains(what), "{text}: {error}");
    }
}

#[test]
fn native_defaults_fill_a_scene_of_one_sphere() {
    // A byte order mark is skipped.
    let text = "\u{feff}{ \"format\": \"octray-1\", \"spheres\": [{ \"center\": [1,2,3], \"radius\": 2 }] }";
    let scene = in_file(Folder::new().load("scene.json", text).unwrap());
    assert_eq!((scene.resolution, scene.max_bounces), ([240, 135], 4));
    assert_eq!(scene.sky, Sky::Color(Vec3::ONE));
    let material = &scene.materials[scene.spheres[0].material as usize];
    assert_eq!((material.kind, material.color), (MaterialKind::Diffuse, Vec3::splat(0.8)));
    // Bounds 4 wide each way: diagonal 4 sqrt 3; the camera stands 1.2 of it away along (1, 0.5, 1.5) / sqrt
    // 3.5.
    let step = 1.2 * 4.0 * 3.0_f32.sqrt() / 3.5_f32.sqrt();
    let expected = vec3(1.0, 2.0, 3.0) + step * vec3(1.0, 0.5, 1.5);
    assert_eq!(scene.camera.look_at, vec3(1.0, 2.0, 3.0));
    assert!(scene.camera.position.distance(expected) < 1e-5, "{}", scene.camera.position);
    assert_eq!((scene.camera.up, scene.camera.vertical_fov), (Vec3::Y, 40.0));
}

#[test]
fn native_defaults_of_materials_follow_their_type() {
    let materials = r#""a": { "type": "diffuse" }, "b": { "type": "metal" }, "c": { "type": "glass" },
        "d": { "type": "scatter" }, "e": { "type": "emitter" }"#;
    let scene = load_keys(&format!(r#"{BALL}, "materials": {{ {materials} }}"#));
    let of = |name: &str| scene.materials.iter().find(|material| material.name == name).unwrap();
    assert_eq!((of("a").kind, of("a").color), (MaterialKind::Diffuse, Vec3::splat(0.8)));
    assert_eq!((of("b").kind, of("b").color), (MaterialKind::Metal { roughness: 0.0 }, Vec3::ONE));
    assert_eq!((of("c").kind, of("c").color), (MaterialKind::Glass { ior: 1.5 }, Vec3::ONE));
    assert_eq!((of("d").kind, of("d").color), (MaterialKind::FuzzyMirror { roughness: 0.0 }, Vec3::ONE));
    assert_eq!((of("e").kind, of("e").emission), (MaterialKind::Emitter, Vec3::ONE));
}

#[test]
fn a_missing_sky_is_black_where_something_emits_and_a_black_one_over_nothing_that_does_is_a_warning() {
    let with = |material: &str| {
        load_keys(&format!(
            r#""materials": {{ "m": {material}, "unused": {{ "type": "emitter" }} }},
                "spheres": [{{ "center": [0,0,0], "radius": 1, "material": "m" }}]"#
        ))
    };
    assert_eq!(with(r#"{ "type": "diffuse", "emission": [0, 0, 1] }"#).sky, Sky::Color(Vec3::ZERO));
    assert_eq!(with(r#"{ "type": "diffuse" }"#).sky, Sky::Color(Vec3::ONE));
    let warnings = load_keys(&format!(r#""sky": {{ "color": [0,0,0] }}, {BALL}"#)).warnings;
    assert!(warnings.len() == 1 && warnings[0].contains("black"), "{warnings:?}");
}

#[test]
fn sky_reads_gradient_and_texture() {
    let folder = Folder::new();
    crate::openexr::write(&folder.path("sky.exr"), 1, &[[2.0, 0.5, 0.25]]);
    let with = |sky: &str| load_in(&folder, &format!(r#""sky": {sky}, {BALL}"#));
    let gradient = with(r#"{ "gradient": { "bottom": [1,1,1], "top": [0.5,0.7,1] } }"#);
    assert_eq!(gradient.sky, Sky::Gradient { bottom: Vec3::ONE, top: vec3(0.5, 0.7, 1.0) });
    let textured = with(r#"{ "texture": "sky.exr", "color": [3,3,3] }"#);
    assert_eq!(textured.sky, Sky::Texture { texture: 0, color: Vec3::splat(3.0), turn: 0.0 });
    // An EXR holds linear light: the numbers pass as they are.
    assert_eq!(textured.textures[0].texels, Texels::Float32(vec![[2.0, 0.5, 0.25, 0.0]]));
    assert_eq!(textured.textures[0].filter, Filter::Bilinear);
}

#[test]
fn texture_used_twice_is_loaded_once_for_each_filter() {
    let keys = r#""materials": {
        "a": { "type": "diffuse", "texture": "p.png" }, "b": { "type": "metal", "texture": "p.png" },
        "c": { "type": "metal", "texture": "p.png", "filter": "nearest" },
        "d": { "type": "metal", "texture": "p.png", "filter": "trilinear" } },
        "sky": { "texture": "p.png", "filter": "trilinear" }"#;
    let scene = load_in(&folder_with("p.png"), &format!("{BALL}, {keys}"));
    let numbers: Vec<_> = scene.materials.iter().take(4).map(|material| material.texture.unwrap()).collect();
    assert_eq!(numbers, [0, 0, 1, 2]);
    let filters: Vec<_> = scene.textures.iter().map(|texture| texture.filter).collect();
    assert_eq!(filters, [Filter::Bilinear, Filter::Nearest, Filter::Trilinear]);
    assert!(matches!(scene.sky, Sky::Texture { texture: 2, .. }));
}

#[test]
fn textures_of_every_format_hold_the_same_picture() {
    for name in ["p.png", "p.bmp", "p.tga", "p.hdr"] {
        let material = format!(r#""m": {{ "type": "diffuse", "texture": "{name}" }}"#);
        let scene = load_in(&folder_with(name), &format!(r#"{BALL}, "materials": {{ {material} }}"#));
        let second = if name == "p.hdr" { 0.25 } else { 0.215_860_5 };
        let texels = &scene.textures[0].texels;
        assert_eq!(texels.linear(0), [1.0, 0.0, 0.0], "{name}");
        assert!((texels.linear(1)[1] - second).abs() < 1e-7, "{name}: {texels:?}");
    }
}

#[test]
fn planar_mapping_lies_in_the_plane_with_its_upper_edge_up() {
    let scene = load_in(
        &folder_with("p.png"),
        r#""materials": {
          "m": { "type": "diffuse", "texture": "p.png", "texture_size": 2 }, "plain": { "type": "diffuse" } },
        "triangles": [
          { "vertices": [[0,0,0],[1,0,0],[0,1,0]], "material": "plain" },
          { "vertices": [[1,5,1],[1,5,5],[7,5,1]], "material": "m" },
          { "vertices": [[0,0,0],[0,4,0],[0,0,6]], "material": "m" } ]"#,
    );
    // The first textured one lies flat: u = x/2, v = -z/2, less whole repeats so that the least is in [0, 1).
    assert_eq!(scene.uvs[1], [vec2(0.5, 2.5), vec2(0.5, 0.5), vec2(3.5, 2.5)]);
    // The second stands and is seen from +x: u = -z/2, v = y/2.
    assert_eq!(scene.uvs[2], [vec2(3.0, 0.0), vec2(3.0, 2.0), vec2(0.0, 0.0)]);
    assert_eq!(scene.uvs[0], [Vec2::ZERO; 3]);
}

/// Each point of a plane shows the same of the picture, whichever triangle it belongs to and however that
/// lists its vertices.
#[test]
fn planar_mapping_is_the_planes_and_not_the_triangles() {
    // A parallelogram on a slope, far enough out to have whole repeats to leave away.
    let [a, b, c, d] = [[10.0, 3.0, -7.0], [12.0, 4.5, -7.5], [11.5, 6.0, -9.0], [9.5, 4.5, -8.5]];
    let orders = [[a, b, c], [c, a, b], [a, c, b], [b, a, c], [a, c, d], [d, c, a]];
    let triangles = orders.map(|vertices| format!(r#"{{ "vertices": {vertices:?}, "material": "m" }}"#));
    let (material, triangles) = (r#""m": { "type": "diffuse", "texture": "p.png" }"#, triangles.join(", "));
    let keys = format!(r#""materials": {{ {material} }}, "triangles": [ {triangles} ]"#);
    let scene = load_in(&folder_with("p.png"), &keys);
    let mut seen: Vec<([f64; 3], Vec2)> = Vec::new();
    for (vertices, uvs) in orders.iter().zip(&scene.uvs) {
        for (&vertex, &uv) in vertices.iter().zip(uvs) {
            match seen.iter().find(|(known, _)| *known == vertex) {
                Some(&(_, known)) => {
                    let apart = uv - known - (uv - known).round();
                    assert!(apart.abs().max_element() < 1e-5, "{vertex:?}: {uv} and {known}");
                }
                None => seen.push((vertex, uv)),
            }
        }
    }
    assert_eq!(seen.len(), 4);
}

#[test]
fn texture_coordinates_are_absent_where_no_triangle_is_textured() {
    let triangle = r#"{ "vertices": [[0,0,0],[1,0,0],[0,1,0]], "uvs": [[0,0],[1,0],[0,1]] }"#;
    assert!(load_keys(&format!(r#""triangles": [ {triangle} ]"#)).uvs.is_empty());
}

#[test]
fn numbers_up_to_the_bound_are_accepted() {
    let scene = load_keys(
        r#""spheres": [{ "center": [1e12, -99999999999, 1e-40], "radius": 1e-18 },
        { "center": [0,0,0], "radius": 1e12 }], "origin": [0,0,0], "camera": { "position": [0,0,1], "look_at": [0,0,0] }"#,
    );
    assert_eq!(scene.spheres[0].center, vec3(1e12, -99_999_999_999.0, 1e-40));
    assert_eq!(scene.spheres[0].radius, 1e-18);
}

#[test]
fn turn_degrees_wraps_to_less_than_a_turn_and_pictures_are_seen_from_outside_unless_said() {
    let ball =
        |keys: &str| load_keys(&BALL.replace(r#""radius": 1"#, &format!(r#""radius": 1{keys}"#))).spheres[0];
    let turn = |degrees: &str| ball(&format!(r#", "turn_degrees": {degrees}"#)).texture_turn;
    assert_eq!(["0", "360", "-90", "450", "-1e-12"].map(turn), [0.0, 0.0, 0.75, 0.25, 0.0]);
    let sides = ["", r#", "picture_from": "outside""#, r#", "picture_from": "inside""#];
    assert_eq!(sides.map(|keys| ball(keys).texture_side), [Side::Outside, Side::Outside, Side::Inside]);
}

#[test]
fn builtin_scenes_load_with_what_their_names_promise() {
    let names: Vec<&str> = builtin_names().collect();
    let expected =
        ["thesis", "three", "spheres", "cornell", "cornell-spheres", "balls", "materials", "chess", "far"];
    assert_eq!(names, expected);
    let counts: Vec<(usize, usize)> = names
        .iter()
        .map(|name| {
            let scene = load(&format!("builtin:{name}")).unwrap_or_else(|error| panic!("{error}"));
            assert_eq!(scene.name, format!("builtin:{name}"));
            assert_eq!(scene.resolution, [240, 135]);
            assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
            (scene.spheres.len(), scene.triangles.len())
        })
        .collect();
    assert_eq!(counts, [(3, 2), (3, 0), (50, 0), (0, 32), (2, 12), (10, 2), (13, 0), (4, 2), (1, 72)]);
}

#[test]
fn builtin_scenes_equal_their_files_in_the_project() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    for name in builtin_names() {
        let inside = load(&format!("builtin:{name}")).unwrap();
        let path = folder.join(format!("{name}.json"));
        let outside = load(path.to_str().unwrap()).unwrap_or_else(|error| panic!("{error}"));
        let rest = |scene: &Scene| (scene.camera, scene.resolution, scene.max_bounces, scene.sky);
        assert_eq!(rest(&inside), rest(&outside), "{name}");
        assert_eq!((inside.spheres, inside.triangles), (outside.spheres, outside.triangles), "{name}");
        assert_eq!((inside.uvs, inside.normals), (outside.uvs, outside.normals), "{name}");
        assert_eq!((inside.textures, inside.materials), (outside.textures, outside.materials), "{name}");
        assert_eq!(inside.warnings, outside.warnings, "{name}");
    }
    let files = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let scenes = files.filter(|path| path.extension().is_some_and(|end| end == "json"));
    let is_inside = |path: &PathBuf| builtin_names().any(|name| path.file_stem().unwrap() == name);
    for path in scenes.filter(|path| !is_inside(path)) {
        let scene = load(path.to_str().unwrap()).unwrap_or_else(|error| panic!("{error}"));
        assert!(scene.warnings.is_empty(), "{}: {:?}", path.display(), scene.warnings);
    }
}

#[test]
fn scenes_of_the_book_load_without_a_warning() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes/book");
    for (file, spheres) in [("final.json", 485), ("defocus.json", 485), ("materials.json", 12)] {
        let scene = load_with_view(folder.join(file).to_str().unwrap()).unwrap();
        assert_eq!((scene.spheres.len(), &scene.warnings[..]), (spheres, &[][..]), "{file}");
    }
}

/// A change while a scene is read must be newer than this time.
#[test]
fn time_of_reading_is_that_before_the_first_file_is_read() {
    let folder = Folder::new();
    let faces = "f 1 2 3\n".repeat(50_000);
    let model = folder.write("model.obj", format!("v 0 0 0\nv 1 0 0\nv 0 1 0\n{faces}"));
    let begin = SystemTime::now();
    let read = load_with_view(&model).unwrap().read.unwrap();
    let half = begin.elapsed().unwrap() / 2;
    assert!((begin..begin + half).contains(&read), "{read:?} of {begin:?} and {half:?} more");
    assert_eq!(load_with_view("builtin:three").unwrap().read, None);
}
