//! Scenes that are refused: each message names the place of the fault and what to write instead.

use crate::folder::Folder;
use octray::scene::{SceneError, load};
use std::fs;
use std::path::Path;

/// A scene of one sphere with this line added as its line 3.
fn with(line: &str) -> String {
    let spheres = r#""spheres": [ { "center": [0,0,0], "radius": 1 } ]"#;
    format!("{{\n  \"format\": \"octray-1\",\n  {line},\n  {spheres}\n}}")
}

/// A scene with this one sphere, which starts in column 16 of line 1.
fn sphere(sphere: &str) -> String {
    format!(r#"{{ "spheres": [ {sphere} ], "format": "octray-1" }}"#)
}

/// A scene whose line 3 has the material `m` with these keys.
fn material(keys: &str) -> String {
    with(&format!(r#""materials": {{ "m": {{ {keys} }} }}"#))
}

/// A scene of one triangle with these keys, which starts in line 2.
fn triangle(keys: &str) -> String {
    format!("{{ \"format\": \"octray-1\",\n \"triangles\": [ {{ {keys} }} ] }}")
}

/// A scene whose line 3 has a camera with these keys.
fn camera(keys: &str) -> String {
    with(&format!(r#""camera": {{ {keys} }}"#))
}

/// Asserts that each text, as a part of a scene beside a picture, is refused with these words. Places are
/// relative to `part`.
#[track_caller]
fn assert_refused(scene: impl Fn(&str) -> String, part: &str, cases: &[(&str, &str, &str)]) {
    let folder = Folder::new();
    folder.save_picture("p.png");
    for (text, at, words) in cases {
        folder.assert_refused("scene.json", scene(text), &format!("{part}{at}"), words);
    }
}

fn refuse(text: impl AsRef<[u8]>) -> SceneError {
    Folder::new().load("scene.json", text).expect_err("the scene must be refused")
}

#[test]
fn broken_json_names_line_and_column() {
    let cases = [
        ("", "line 1, column 1", "write a JSON object"),
        ("{\n  \"max_bounces\": 3\n\n", "line 2, column 19", "close the brackets"),
        ("{ \"format\": \"octray-1\",\n \"spheres\": [", "spheres", "close the brackets"),
        (r#"{ "format": "octray-1", }"#, "line 1, column 25", "remove the comma"),
        ("{ \"format\"\n \"octray-1\" }", "line 2, column 2", "mend the JSON"),
        ("{} {}", "line 1, column 4", "remove what follows"),
        ("[1, 2]", "", "octray-1"),
        (r#""scene""#, "line 1", "write an object"),
        (
            r#"{ "format": "octray-2", "spheres": [] }"#,
            "format, line 1, column 13",
            r#""format": "octray-1""#,
        ),
        (r#"{ "sky": [1, 1, 1], "name": "x" }"#, "", "octray-1"),
        (r#"{ "sky": [1, 1, 1], "name": "x" }"#, "", "`sphere`, `triangle` or `res`"),
        (r#"{ "format": "octray-1", "spheres": [] }"#, "", "`spheres`"),
    ];
    assert_refused(str::to_string, "", &cases);
    assert_refused(with, "", &[(r#""max_bounces": 3 // few"#, "line 3", "comma")]);
    Folder::new().assert_refused("scene.json", b"{\n \"format\": \"octray-1\xff\" }", "line 2", "UTF-8");
}

#[test]
fn unknown_missing_and_doubled_keys_are_named_with_the_nearest_known_ones() {
    let twice = r#""materials": { "a": { "type": "metal" }, "a": { "type": "metal" } }"#;
    let cases = [
        (r#""skye": {}"#, "skye, line 3, column 11", "did you mean `sky`?"),
        (r#""camera": { "fov": 40 }"#, "camera", "vertical_fov"),
        (r#""format2": 1, "sky": 3"#, "format2", "the keys known here"),
        (r#""sky": null, "sky": null"#, "", "remove or rename"),
        (twice, "materials", "the name `a` occurs twice"),
    ];
    assert_refused(with, "", &cases);
    let known = "center, radius, material, turn_degrees, picture_from";
    let cases = [
        (r#"{ "center": [0,0,0], "radius": 1, "colour": 3 }"#, "", known),
        (r#"{ "center": [0,0,0], "radius": 1, "picture_from": "within" }"#, "", "one of outside, inside"),
        (r#"{ "center": [0,0,0] }"#, ", line 1", "add `radius`"),
    ];
    assert_refused(sphere, "spheres[0]", &cases);
    let cases =
        [(r#""type": "diffuse", "colour": 1"#, "", "`color`"), (r#""color": [1,1,1]"#, "", "add `type`")];
    assert_refused(material, "materials.m", &cases);
}

#[test]
fn wrong_types_are_named_with_an_example() {
    let point = r#""center": [0, 1, 5]"#;
    let long = format!(r#"{{ "center": "{}", "radius": 1 }}"#, "x".repeat(999));
    let cases = [
        (r#"{ "center": [0,"0",0], "radius": 1 }"#, ".center[1], line 1, column 31", point),
        (r#"{ "center": [0,0], "radius": 1 }"#, ".center", point),
        (&long, ".center", "xxxxxxx…"),
    ];
    assert_refused(sphere, "spheres[0]", &cases);
    let cases = [
        (r#""resolution": [240.5, 135]"#, "resolution[0], line 3", "[240, 135]"),
        (r#""max_bounces": -1"#, "max_bounces, line 3", r#""max_bounces": 16"#),
        (r#""sky": [0.7,0.8,1.0]"#, "sky[0], line 3", r#""sky": { "color": [0.7, 0.8, 1] }"#),
        (r#""materials": [1]"#, "materials", r#"{ "red": { "type": "diffuse""#),
        (r#""materials": { "m": "red" }"#, "materials.m", r#""m": { "type": "diffuse""#),
    ];
    assert_refused(with, "", &cases);
}

/// A scene with this key in one of its parts, or a material of this type.
fn with_word(part: &str, word: &str) -> String {
    match part {
        "scene" => with(&format!(r#""{word}": 1"#)),
        "camera" => camera(&format!(r#""{word}": 1"#)),
        "mesh" => with(&format!(r#""meshes": [ {{ "{word}": 1, "model": "x.obj" }} ]"#)),
        "sphere" => sphere(&format!(r#"{{ "{word}": 1, "center": [0,0,0], "radius": 1 }}"#)),
        "type" => material(&format!(r#""type": "{word}""#)),
        kind => material(&format!(r#""type": "{kind}", "{word}": 1"#)),
    }
}

/// Words of *Ray Tracing in One Weekend*, Mitsuba, pbrt and Blender, and what is meant by them.
#[test]
fn words_of_other_programs_are_understood() {
    for (part, word, words) in [
        ("camera", "lookfrom", "did you mean `position`?"),
        ("mesh", "rotation", "did you mean `rotate_degrees`?"),
        ("diffuse", "baseColor", "did you mean `color`?"),
        ("type", "lambertian", "did you mean `diffuse`?"),
        ("camera", "image_width", "did you mean `resolution` of the scene?"),
        ("camera", "defocus_angle", "did you mean `aperture_radius`?"),
        ("scene", "samplesPerPixel", "octray render --samples N"),
        ("glass", "transparency", "did you mean `opacity`?"),
        ("sphere", "albedo", "an entry of `materials`"),
    ] {
        assert_refused(|word| with_word(part, word), "", &[(word, "", words)]);
    }
    // Only keys that the type has are offered.
    let mend = refuse(with_word("diffuse", "fuzz")).mend.unwrap();
    assert!(!mend.contains("roughness") && mend.contains("color, emission, texture"), "{mend}");
}

/// The place and the first line of each message of an error.
fn messages(error: &SceneError) -> Vec<(&str, &str)> {
    let all = std::iter::once(error).chain(&error.others);
    all.map(|one| (one.at.as_ref().unwrap().split(',').next().unwrap(), &one.what[..])).collect()
}

#[test]
fn all_faults_of_a_scene_are_reported_at_once_in_its_order() {
    let text = r#"{ "format": "octray-1",
        "camera": { "lookfrom": [0,1,5], "look_at": [0,1,0], "vfov": 40 },
        "sky": [0.7, 0.8, 1],
        "materials": { "a": { "type": "lambertian", "albedo": [1,1,1] }, "b": { "type": "metal", "fuzz": 0 },
                       "c": { "type": "emitter", "color": [1,1,1], "ior": 2 } },
        "spheres": [ { "center": [0,0,0], "radius": -1, "material": "a" }, { "center": [0,0] },
                     { "center": [0,0,0], "radius": 1, "material": "x" } ] }"#;
    let error = refuse(text);
    let places: Vec<_> = messages(&error).into_iter().map(|(place, _)| place).collect();
    assert_eq!(places.len(), 10, "at most ten: {error}");
    assert_eq!(places[..4], ["camera.lookfrom", "camera.vfov", "sky[0]", "materials.a.type"], "{error}");
    assert_eq!(places[4..6], ["materials.a.albedo", "materials.b.fuzz"], "{error}");
    assert_eq!(error.to_string().matches("\nalso: ").count(), 9, "{error}");
    // A name that is left out, or a material with a fault, is no fault of what uses it.
    let text = r#"{ "format": "octray-1", "materials": 3,
        "spheres": [ { "center": [0,0,0], "radius": 1, "material": "a" }, { "radius": 1 }, { "center": 1 } ] }"#;
    let error = refuse(text);
    let faults: Vec<_> = messages(&error).into_iter().map(|(_, what)| what).collect();
    assert_eq!(faults[..2], ["`materials` cannot be 3", "the key `center` is missing"], "{error}");
    assert_eq!(faults[2..], ["the key `radius` is missing", "`center` cannot be 1"], "{error}");
    let error = refuse(with(r#""meshes": [ { "file": "x.obj" } ]"#));
    assert!(error.others.is_empty() && error.what.contains("`file`"), "{error}");
    // Both faults of a key that is there twice and wrong elsewhere are reported.
    let error = refuse(with(r#""sky": null, "sky": null, "world": 1"#));
    assert_eq!(error.others.len(), 1, "{error}");
}

#[test]
fn numbers_out_of_range_are_refused_with_their_range() {
    for bad in ["NaN", "1e400", "-1e400", "Infinity", "-Infinity"] {
        let text = format!(r#"{{ "center": [0,{bad},0], "radius": 1 }}"#);
        assert_refused(sphere, "spheres[0]", &[(&text, ".center[1], line 1", "JSON has no NaN")]);
    }
    let cases = [
        (r#"{ "center": [0,0,1e39], "radius": 1 }"#, ".center[2], line 1, column 33", "-1e18 to 1e18"),
        (r#"{ "center": [0,0,-1.1e18], "radius": 1 }"#, ".center[2]", "-1e18 to 1e18"),
    ];
    assert_refused(sphere, "spheres[0]", &cases);
    // A sphere beside another, so that the scene has a size.
    let one_of_two = |radius: &str| {
        sphere(&format!(
            r#"{{ "center": [0,0,0], "radius": {radius} }}, {{ "center": [9,0,0], "radius": 1 }}"#
        ))
    };
    let at = "spheres[0].radius, line 1, column 47";
    let cases = ["0", "-1", "1e-50"].map(|radius| (radius, at, "at least 1e-18"));
    assert_refused(one_of_two, "", &cases);
    let cases = [
        (r#""resolution": [0, 135]"#, "resolution[0], line 3", "1 to 16384"),
        (r#""resolution": [240, 16385]"#, "resolution[1]", "1 to 16384"),
        (r#""max_bounces": 1025"#, "max_bounces, line 3, column 18", "0 to 1024"),
        (r#""sky": { "color": [0, -1, 0] }"#, "sky.color[1]", "0 or more"),
        (
            r#""sky": { "gradient": { "bottom": [0,0,0], "top": [0,0,1e300] } }"#,
            "sky.gradient.top[2]",
            "1e18",
        ),
    ];
    assert_refused(with, "", &cases);
    let cases = [
        (r#""vertical_fov": 0"#, ".vertical_fov, line 3, column 31", "below 180"),
        (r#""vertical_fov": 180"#, ".vertical_fov, line 3, column 31", "below 180"),
        (r#""position": [1,2,3], "look_at": [1,2,3]"#, ".look_at, line 3", "so that the two differ"),
        (r#""position": [1,2,3], "look_at": [1,2,3.0000000000000001]"#, ".look_at", "single precision"),
        (r#""position": [0,5,0], "look_at": [0,0,0]"#, ".up", "give an `up`"),
        (r#""aperture_radius": -1"#, ".aperture_radius, line 3, column 34", "0 is a pinhole"),
        (r#""f_number": 0"#, ".f_number, line 3", "above 0, such as 2.8"),
        (r#""f_number": 2, "aperture_radius": 1"#, ".f_number", "leave out one of them"),
        (r#""focus_distance": 2"#, ".focus_distance", "add `aperture_radius`"),
        (r#""f_number": 2, "focus_distance": 0"#, ".focus_distance", "a length above 0"),
        (r#""f_number": 2, "focus_distance": 1, "focus_on": [0,0,0]"#, ".focus_on", "leave out one of them"),
        (r#""f_number": 2, "position": [0,0,5], "focus_on": [0,0,6]"#, ".focus_on", "that the camera sees"),
        (r#""f_number": 2, "blades": 2"#, ".blades", "3 to 16"),
        (r#""orthographic_height": 0"#, ".orthographic_height", "above 0"),
        (r#""orthographic_height": 2, "vertical_fov": 40"#, ".vertical_fov", "or `orthographic_height`"),
        (r#""orthographic_height": 2, "f_number": 2"#, ".f_number", "or `orthographic_height`"),
    ];
    assert_refused(camera, "camera", &cases);
}

#[test]
fn triangles_without_area_or_with_impossible_attributes_are_refused() {
    let at = ".vertices, line 2, column 31";
    let cases = [
        (r#""vertices": [[0,0,0],[1,0,0],[1,0,0]]"#, at, "move its vertices apart"),
        // Different in double precision, the same in single.
        (r#""vertices": [[0,0,0],[1,0,0],[1.000000001,0,0]]"#, at, "the same in single"),
        (r#""vertices": [[0,0,0],[1,1,1],[2,2,2]]"#, at, "on one line"),
        (r#""vertices": [[0,0,0],[1e-39,0,0],[0,1,0]]"#, at, "zero area"),
        (r#""vertices": [[0,0,0],[1,0,0],[0,1e30,0]]"#, ".vertices[2][1]", "1e18"),
    ];
    assert_refused(triangle, "triangles[0]", &cases);
    let cases = [
        (r#""normals": [[0,0,1],[0,0,0],[0,0,1]]"#, ".normals[1]", "away from the surface"),
        (r#""material": "x""#, ".material", "no `materials`"),
    ];
    let whole = |keys: &str| format!(r#""vertices": [[0,0,0],[1,0,0],[0,1,0]], {keys}"#);
    assert_refused(|keys| triangle(&whole(keys)), "triangles[0]", &cases);
    let textured = r#""m": { "type": "diffuse", "texture": "p.png" }"#;
    let colors = r#""material": "m", "colors": [[1,0,0],[0,1,0],[0,0,1]]"#;
    let scene = triangle(&whole(colors)).replacen('{', &format!(r#"{{ "materials": {{ {textured} }},"#), 1);
    assert_refused(str::to_string, "", &[(&scene, "triangles[0].colors", "without textures")]);
}

#[test]
fn unknown_materials_suggest_the_nearest() {
    let text = |materials: &str| {
        let ball = r#"{ "center": [0,0,0], "radius": 1, "material": "crome" }"#;
        format!("{{ \"format\": \"octray-1\", \"materials\": {{ {materials} }},\n\"spheres\": [ {ball} ] }}")
    };
    let at = "spheres[0].material, line 2, column 60";
    let cases = [
        (r#""chrome": { "type": "metal" }"#, at, "did you mean `chrome`?"),
        ("", at, "the scene has no `materials`"),
    ];
    assert_refused(text, "", &cases);
}

#[test]
fn materials_out_of_range_or_with_keys_of_another_type_are_refused() {
    let cases = [
        (r#""type": "metl""#, ".type", "did you mean `metal`?"),
        (r#""type": "diffuse", "color": [1, 1.5, 0]"#, ".color[1], line 3", "use `emission`"),
        (r#""type": "metal", "color": [-0.1, 0, 0]"#, ".color[0]", "from 0 to 1"),
        (r#""type": "diffuse", "emission": [1, 1, -2]"#, ".emission[2]", "0 or more"),
        (r#""type": "plastic", "ior": 0.9"#, ".ior, line 3", "from 1 to 3"),
        (r#""type": "plastic", "ior": 3.5"#, ".ior, line 3", "from 1 to 3"),
        (r#""type": "metal", "roughness": 1.1"#, ".roughness", "from 0 to 1"),
        (r#""type": "scatter", "roughness": -1"#, ".roughness", "0 or more"),
        (r#""type": "glass", "ior": 0"#, ".ior", "glass 1.5"),
        (r#""type": "metal-rough", "ior": 0.9"#, ".ior", "1 or more"),
        (r#""type": "diffuse", "texture": "p.png", "texture_size": 0"#, ".texture_size", "above 0"),
        (r#""type": "metal", "roughness": 0, "roughness_map": "p.png""#, ".roughness_map", "above 0"),
        (r#""type": "diffuse", "ior": 1.5"#, ".ior, line 3", "glass"),
        (r#""type": "diffuse", "roughness": 0.5"#, ".roughness", "`metal-rough` or `scatter`"),
        (r#""type": "emitter", "normal_map": "p.png""#, ".normal_map", "scatters nothing"),
        (r#""type": "metal", "metallic": 0.5"#, ".metallic", "make the type `metal-rough`"),
        (r#""type": "metal", "thin": true"#, ".thin", "make the type `glass`"),
        (r#""type": "emitter", "emission_map": "p.png""#, ".emission_map", "`texture`"),
        (r#""type": "emitter", "color": [1,1,1]"#, ".color", "`emission`"),
        (r#""type": "glass", "opacity": 1.5"#, ".opacity", "from 0 to 1"),
        (r#""type": "diffuse", "alpha_cutoff": 0.5"#, ".alpha_cutoff", "add an `opacity_map`"),
        (r#""type": "diffuse", "opacity_map": "p.png", "alpha_cutoff": -1"#, ".alpha_cutoff", "from 0 to 1"),
        (r#""type": "diffuse", "filter": "nearest""#, ".filter", "add a `texture`"),
    ];
    assert_refused(material, "materials.m", &cases);
}

#[test]
fn skies_with_conflicting_keys_are_refused() {
    let both = r#""gradient": { "bottom": [0,0,0], "top": [1,1,1] }, "texture": "x.hdr""#;
    let cases = [
        (both, ", line 3, column 10", "keep `gradient` alone"),
        ("", ", line 3", "remove `sky`"),
        (r#""color": [1,1,1], "filter": "nearest""#, ".filter", "texture"),
        (r#""color": [1,1,1], "turn_degrees": 5"#, ".turn_degrees", "the same from all sides"),
        (r#""filter": "cubic""#, ".filter", "one of nearest, bilinear, trilinear"),
    ];
    assert_refused(|keys| with(&format!(r#""sky": {{ {keys} }}"#)), "sky", &cases);
}

#[test]
fn images_that_cannot_be_read_are_refused_with_the_path_that_was_tried() {
    let folder = Folder::new();
    folder.save_picture("cut.png");
    folder.write("text.png", "not a picture");
    folder.write("cut.png", &folder.bytes("cut.png")[..40]);
    fs::create_dir(folder.path("folder.png")).unwrap();
    for (name, what) in [
        ("missing.png", "no such file"),
        ("text.png", "broken"),
        ("cut.png", "broken"),
        ("folder.png", "folder"),
    ] {
        let keys = ["texture", "roughness_map", "normal_map"].map(|key| {
            (
                format!("materials.m.{key}, line 3"),
                material(&format!(r#""type": "metal", "roughness": 1, "{key}": "{name}""#)),
            )
        });
        let sky = ("sky.texture".to_string(), with(&format!(r#""sky": {{ "texture": "{name}" }}"#)));
        for (at, text) in keys.into_iter().chain([sky]) {
            folder.assert_refused("scene.json", &text, &at, what);
            folder.assert_refused("scene.json", &text, &at, &folder.name(name));
        }
    }
}

#[test]
fn meshes_that_cannot_be_used_are_refused() {
    let folder = Folder::new();
    folder.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    for (keys, at, words) in [
        (r#""obj": "missing.obj""#, "meshes[0].obj, line 3", "relative to the scene file"),
        (r#""obj": "one.obj", "scale": 0"#, "meshes[0].scale", "above 0"),
        (r#""obj": "one.obj", "scale": -1"#, "meshes[0].scale", "cannot be mirrored"),
        (r#""obj": "one.obj", "material": "x""#, "meshes[0].material", "no `materials`"),
        (r#""obj": "one.obj", "translate": [0,0,1e30]"#, "meshes[0].translate[2]", "1e18"),
        (r#""obj": "one.obj", "translate": [1e13,0,0]"#, "meshes[0], line 3", "too far"),
        // Rounding makes their triangles flat.
        (r#""obj": "one.obj", "scale": 1e-30"#, "meshes[0], line 3", "larger `scale`"),
        (r#""obj": "one.obj", "translate": [1e11,0,0]"#, "meshes[0]", "smaller `translate`"),
        (r#""obj": "flat.obj""#, "meshes[0]", "export the model again"),
    ] {
        let text = format!(r#""camera": {{ "look_at": [0,0,0] }}, "meshes": [ {{ {keys} }} ]"#);
        folder.assert_refused("scene.json", with(&text), at, words);
    }
}

#[test]
fn names_that_are_no_scenes_are_refused_with_what_may_be_meant() {
    let folder = Folder::new();
    folder.write("scene.txt", "{}");
    let kinds = "(.json), a model (.obj, .gltf, .glb, .ply)";
    let inside = |name: &str| folder.name(name);
    for (name, words) in [
        (inside("missing.json"), ["no such file", kinds]),
        (inside(""), ["this is a folder, not a scene", kinds]),
        (inside("scene.txt"), ["files of the kind `.txt` are not read", kinds]),
        (String::new(), ["not the name of a scene", kinds]),
        ("three".into(), ["not the name of a scene", "did you mean `builtin:three`?"]),
        ("terrian:100".into(), ["not the name of a scene", "did you mean `builtin:terrain:100`?"]),
        ("terrain".into(), ["not the name of a scene", "did you mean `builtin:terrain:N`?"]),
        ("builtin:cornel".into(), ["did you mean `builtin:cornell`?", "chess"]),
        ("builtin:knott:5".into(), ["did you mean `builtin:knot:5`?", "cornell"]),
    ] {
        let error = load(&name).unwrap_err();
        let told = error.to_string();
        assert!(words.iter().all(|words| told.contains(words)), "{name}: {told}");
        assert!(name.starts_with("builtin:") || error.file.as_deref() == Some(Path::new(&name)), "{told}");
    }
}

#[cfg(unix)]
#[test]
fn devices_and_pipes_are_refused_instead_of_read_forever() {
    let folder = Folder::new();
    std::os::unix::fs::symlink("/dev/zero", folder.path("zero.json")).unwrap();
    let error = load(&folder.name("zero.json")).unwrap_err();
    assert!(error.what.contains("not a regular file"), "{error}");
}

#[test]
fn a_message_has_three_lines_what_where_and_remedy() {
    let folder = Folder::new();
    let error = folder.load("scene.json", sphere(r#"{ "center": [0,0,0], "radius": 0 }"#)).unwrap_err();
    let place = format!("{}: spheres[0].radius, line 1, column 47", folder.name("scene.json"));
    let remedy = "in a scene of this size a radius is at least 1e-18";
    assert_eq!(error.to_string(), format!("the radius is 0\n  at {place}\n  {remedy}"));
}

#[test]
fn portals_are_parallelograms_and_few() {
    let portals = |corners: &str| with(&format!(r#""portals": [ {{ {corners} }} ]"#));
    let example = r#""vertices": [[0, 1, 0], [0, 1, -2], [0, 2, -2], [0, 2, 0]]"#;
    let around = r#"[[0, 1, 0], [0, 1, -2], [0, 2.5, -2], [0, 2.5, 0]]"#;
    let cases = [
        ("", "", example),
        (r#""vertices": [[0, 1, 0], [0, 1, -2], [0, 2, -2]]"#, ".vertices", example),
        (r#""vertices": [[0, 1, 0], [0, 1, -2], [0, 2, -2], [0, 2.5, 0]]"#, ".vertices", around),
        (r#""vertices": [[0, 1, 0], [0, 1, -2], [0, 2, 0], [0, 2, -2]]"#, ".vertices", "in their order"),
        (r#""vertices": [[0, 1, 0], [0, 1, 0], [0, 2, 0], [0, 2, 0]]"#, ".vertices", "span an area"),
        (r#""vertices": [[0, 1, 0], [0, 1, 1e30], [0, 2, 0], [0, 2, 0]]"#, ".vertices[1][2]", "1e18"),
    ];
    assert_refused(portals, "portals[0]", &cases);
    let many = format!(r#""portals": [ {} ]"#, vec![format!("{{ {example} }}"); 65].join(", "));
    assert_refused(with, "", &[(&many, "", "at most 64")]);
    // Rounded corners are taken, and completed.
    let rounded = r#""sky": { "color": [0, 0, 0] }, "portals": [ { "vertices": [[0, 1, 0], [0, 1, -2], [0, 2.001, -2], [0, 2, 0]] } ]"#;
    let scene = Folder::new().load("scene.json", with(rounded)).unwrap();
    let [a, b, c, d] = scene.portals[0].vertices;
    assert_eq!(c, b + d - a);
    assert!(
        scene.warnings.iter().any(|warning| warning.contains("no light comes through")),
        "{:?}",
        scene.warnings
    );
}
