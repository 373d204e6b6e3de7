//! Every way to get a scene wrong is answered with what is wrong, where, and how to mend it.

use crate::folder::Folder;
use octray::scene::{SceneError, load};
use std::fs;
use std::path::Path;

fn error_of(folder: &Folder, text: impl AsRef<[u8]>) -> SceneError {
    let error = folder.load("scene.json", text).expect_err("the scene must be refused");
    assert_eq!(error.file, Some(folder.path("scene.json")), "{error}");
    error
}

/// Asserts that a scene text is refused with these words in what is wrong, where, and how to mend it.
#[track_caller]
fn refused(text: impl AsRef<[u8]>, what: &str, at: &str, mend: &str) {
    let folder = Folder::new();
    let error = error_of(&folder, text);
    assert!(error.what.contains(what), "what: {error}");
    assert!(error.at.clone().unwrap_or_default().starts_with(at), "at: {error}");
    assert!(error.mend.clone().unwrap_or_default().contains(mend), "mend: {error}");
}

/// A scene of one sphere with this line added as its line 3.
fn with(line: &str) -> String {
    format!(
        "{{\n  \"format\": \"octray-1\",\n  {line},\n  \"spheres\": [ {{ \"center\": [0,0,0], \"radius\": 1 }} ]\n}}"
    )
}

/// A scene with this one sphere, which starts in column 16 of line 1.
fn sphere(sphere: &str) -> String {
    format!(r#"{{ "spheres": [ {sphere} ], "format": "octray-1" }}"#)
}

fn material(keys: &str) -> String {
    with(&format!(r#""materials": {{ "m": {{ {keys} }} }}"#))
}

#[test]
fn texts_that_are_no_scene_are_refused_with_line_and_column() {
    refused("", "broken JSON", "line 1, column 1", "write a JSON object");
    refused("{\n  \"max_bounces\": 3\n\n", "broken JSON", "line 2, column 19", "close the brackets");
    refused("{ \"format\": \"octray-1\",\n \"spheres\": [", "broken JSON", "spheres", "close the brackets");
    refused(r#"{ "format": "octray-1", }"#, "trailing comma", "line 1, column 25", "remove the comma");
    refused("{ \"format\"\n \"octray-1\" }", "broken JSON", "line 2, column 2", "mend the JSON");
    refused(with(r#""max_bounces": 3 // few"#), "broken JSON", "line 3", "comma");
    refused("{} {}", "trailing characters", "line 1, column 4", "remove what follows");
    let four = r#"{"format": "octray-1", "camera": {"position": [0, 1, 5, 0]}}"#;
    refused(four, "too many entries in this list", "camera.position", "remove those from here on");
    refused("[1, 2]", "not a scene", "", "octray-1");
    refused(r#""scene""#, "string", "line 1", "write an object");
    refused(b"{\n \"format\": \"octray-1\xff\" }", "not UTF-8", "line 2", "UTF-8");
    let text = r#"{ "format": "octray-2", "spheres": [] }"#;
    refused(text, "`octray-2`", "format, line 1, column 13", r#""format": "octray-1""#);
    let neither = r#"{ "sky": [1, 1, 1], "name": "x" }"#;
    refused(neither, "", "", "octray-1");
    refused(neither, "", "", "`sphere`, `triangle` or `res`");
    refused(r#"{ "format": "octray-1", "spheres": [] }"#, "nothing to see", "", "`spheres`");
}

#[test]
fn keys_that_are_unknown_missing_doubled_or_of_another_type_are_named() {
    refused(with(r#""skye": {}"#), "unknown key `skye`", "skye, line 3, column 8", "did you mean `sky`?");
    let text = sphere(r#"{ "center": [0,0,0], "radius": 1, "colour": 3 }"#);
    refused(
        text,
        "unknown key `colour`",
        "spheres[0]",
        "center, radius, material, turn_degrees, picture_from",
    );
    refused(material(r#""type": "diffuse", "colour": 1"#), "`colour`", "materials.m", "`color`");
    refused(with(r#""camera": { "fov": 40 }"#), "`fov`", "camera", "vertical_fov");
    refused(sphere(r#"{ "center": [0,0,0] }"#), "`radius` is missing", "spheres[0], line 1", "add `radius`");
    refused(material(r#""color": [1,1,1]"#), "`type` is missing", "materials.m", "add `type`");
    refused(with(r#""sky": null, "sky": null"#), "a second `sky`", "", "remove or rename");
    let twice = with(r#""materials": { "a": { "type": "metal" }, "a": { "type": "metal" } }"#);
    refused(twice, "the name `a` occurs twice", "materials", "rename");
    let text = sphere(r#"{ "center": [0,"0",0], "radius": 1 }"#);
    refused(text, r#"string "0""#, "spheres[0].center[1], line 1, column 33", "write a number");
    refused(sphere(r#"{ "center": [0,0], "radius": 1 }"#), "length 2", "spheres[0].center", "length 3");
    refused(with(r#""resolution": [240.5, 135]"#), "240.5", "resolution[0], line 3", "whole number");
    refused(with(r#""max_bounces": -1"#), "-1", "max_bounces, line 3", "whole number");
    refused(with(r#""sky": 3"#), "integer `3`", "sky, line 3", "write an object with `color`");
    refused(with(r#""format2": 1, "sky": 3"#), "unknown key", "format2", "the keys known here");
}

#[test]
fn numbers_radii_triangles_and_normals_that_cannot_be_are_refused() {
    for bad in ["NaN", "1e400", "-1e400", "Infinity", "-Infinity"] {
        let text = sphere(&format!(r#"{{ "center": [0,{bad},0], "radius": 1 }}"#));
        refused(text, "finite number", "spheres[0].center[1], line 1", "JSON has no NaN");
    }
    for bad in ["1e39", "-1.1e18"] {
        let text = sphere(&format!(r#"{{ "center": [0,0,{bad}], "radius": 1 }}"#));
        refused(text, "too large", "spheres[0].center[2], line 1, column 33", "-1e18 to 1e18");
    }
    for (bad, what) in [("0", "the radius is 0"), ("-1", "the radius is -1"), ("1e-50", "too small")] {
        let text = sphere(&format!(r#"{{ "center": [0,0,0], "radius": {bad} }}"#));
        refused(text, what, "spheres[0].radius, line 1, column 47", "at least 1e-18");
    }
    refused(sphere(r#"{ "center": [0,0,0], "radius": 1e19 }"#), "too large", "spheres[0].radius", "1e18");
    let triangle = |vertices: &str| {
        format!("{{ \"format\": \"octray-1\",\n \"triangles\": [ {{ \"vertices\": {vertices} }} ] }}")
    };
    let at = "triangles[0].vertices, line 2, column 31";
    refused(triangle("[[0,0,0],[1,0,0],[1,0,0]]"), "vertices are the same", at, "move its vertices apart");
    // Different in double precision, the same in single.
    refused(triangle("[[0,0,0],[1,0,0],[1.000000001,0,0]]"), "the same in single", at, "remove");
    refused(triangle("[[0,0,0],[1,1,1],[2,2,2]]"), "on one line", at, "remove the triangle");
    refused(triangle("[[0,0,0],[1e-20,0,0],[0,1e-20,0]]"), "zero area", at, "move");
    refused(triangle("[[0,0,0],[1,0,0],[0,1e30,0]]"), "too large", "triangles[0].vertices[2][1]", "1e18");
    let text = "{ \"format\": \"octray-1\", \"triangles\": [ { \"vertices\": [[0,0,0],[1,0,0],[0,1,0]], \
                \"normals\": [[0,0,1],[0,0,0],[0,0,1]] } ] }";
    refused(text, "length zero", "triangles[0].normals[1]", "away from the surface");
}

#[test]
fn materials_that_make_no_sense_are_refused() {
    let text = |materials: &str| {
        format!(
            "{{ \"format\": \"octray-1\", \"materials\": {{ {materials} }},\n\"spheres\": [ {{ \"center\": [0,0,0], \
             \"radius\": 1, \"material\": \"crome\" }} ] }}"
        )
    };
    let at = "spheres[0].material, line 2, column 60";
    refused(text(r#""chrome": { "type": "metal" }"#), "`crome`", at, "did you mean `chrome`?");
    refused(text(r#""velvet": { "type": "metal" }"#), "`crome`", at, "use one of velvet");
    refused(text(""), "`crome`", at, "the scene has no `materials`");
    let triangle = "{ \"format\": \"octray-1\", \"triangles\": [ { \"vertices\": [[0,0,0],[1,0,0],[0,1,0]], \
                    \"material\": \"x\" } ] }";
    refused(triangle, "`x`", "triangles[0].material", "no `materials`");
    let text = material(r#""type": "diffuse", "color": [1, 1.5, 0]"#);
    refused(text, "1.5 is outside 0 to 1", "materials.m.color[1], line 3", "use `emission`");
    let text = material(r#""type": "metal", "color": [-0.1, 0, 0]"#);
    refused(text, "-0.1", "materials.m.color[0]", "from 0 to 1");
    let text = material(r#""type": "diffuse", "emission": [1, 1, -2]"#);
    refused(text, "-2 is negative", "materials.m.emission[2]", "0 or more");
    refused(with(r#""sky": { "color": [0, -1, 0] }"#), "-1 is negative", "sky.color[1]", "0 or more");
    let text = with(r#""sky": { "gradient": { "bottom": [0,0,0], "top": [0,0,1e300] } }"#);
    refused(text, "too large", "sky.gradient.top[2]", "1e18");
    refused(material(r#""type": "metl""#), "`metl`", "materials.m.type", "did you mean `metal`?");
    refused(material(r#""type": "velvet""#), "`velvet`", "materials.m.type", "diffuse, metal, plastic");
    for ior in ["0.9", "3.5", "-1"] {
        let text = material(&format!(r#""type": "plastic", "ior": {ior}"#));
        refused(text, ior, "materials.m.ior, line 3", "from 1 to 3");
    }
    let text = material(r#""type": "plastic", "roughness": 1.5"#);
    refused(text, "1.5 is outside", "materials.m.roughness", "from 0 to 1");
    let text = material(r#""type": "metal", "roughness": 0, "roughness_map": "r.png""#);
    refused(text, "cannot change a `roughness` of 0", "materials.m.roughness_map", "above 0");
    for key in ["roughness_map", "normal_map"] {
        let text = material(&format!(r#""type": "metal", "{key}": "gone.png""#));
        refused(text, "gone.png", &format!("materials.m.{key}"), "relative to the scene file");
    }
    let cases = [
        (r#""type": "diffuse", "ior": 1.5"#, "ior", "glass"),
        (r#""type": "diffuse", "roughness": 0.5"#, "roughness", "`metal-rough` or `scatter`"),
        (r#""type": "diffuse", "roughness_map": "r.png""#, "roughness_map", "`metal-rough` or `scatter`"),
        (r#""type": "emitter", "normal_map": "n.png""#, "normal_map", "scatters nothing"),
        (r#""type": "metal", "metallic": 0.5"#, "metallic", "make the type `metal-rough`"),
        (r#""type": "emitter", "emission_map": "e.png""#, "emission_map", "`texture`"),
        (r#""type": "glass", "roughness": 0.5"#, "roughness", "`metal-rough` or `scatter`"),
        (r#""type": "emitter", "color": [1,1,1]"#, "color", "`emission`"),
        (r#""type": "diffuse", "filter": "nearest""#, "filter", "add a `texture`"),
        (r#""type": "diffuse", "texture_size": 2"#, "texture_size", "add a `texture`"),
    ];
    for (keys, key, mend) in cases {
        refused(material(keys), &format!("`{key}`"), &format!("materials.m.{key}, line 3"), mend);
    }
    let text = material(r#""type": "metal", "roughness": 1.1"#);
    refused(text, "1.1 is outside 0 to 1", "materials.m.roughness", "from 0 to 1");
    let text = material(r#""type": "scatter", "roughness": -1"#);
    refused(text, "-1 is negative", "materials.m.roughness", "0 or more");
    for bad in ["0", "-1.5"] {
        let text = material(&format!(r#""type": "glass", "ior": {bad}"#));
        refused(text, "index of refraction", "materials.m.ior", "glass 1.5");
    }
}

#[test]
fn textures_that_cannot_be_used_are_refused() {
    let folder = Folder::new();
    folder.write("text.png", "not a picture");
    fs::create_dir(folder.path("folder.png")).unwrap();
    let mut png = Vec::new();
    image::RgbImage::new(8, 8)
        .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
        .unwrap();
    folder.write("cut.png", &png[..png.len() / 2]);
    let mut dark = [[0.0; 3]; 4];
    dark[1][1] = -1.0;
    crate::openexr::write(&folder.path("negative.exr"), 2, &dark);
    dark[1][1] = f32::NAN;
    crate::openexr::write(&folder.path("nan.exr"), 2, &dark);
    let cases = [
        ("missing.png", "no such file"),
        ("text.png", "broken"),
        ("cut.png", "broken"),
        ("folder.png", "folder"),
        ("negative.exr", "column 1, row 0 holds -1"),
        ("nan.exr", "column 1, row 0 holds NaN"),
    ];
    for (name, what) in cases {
        let text = material(&format!(r#""type": "diffuse", "texture": "{name}""#));
        let error = error_of(&folder, text);
        assert!(error.what.contains(name) && error.what.contains(what), "{error}");
        assert!(error.at.as_ref().unwrap().starts_with("materials.m.texture, line 3"), "{error}");
        // The remedy says where the file was looked for.
        assert!(error.mend.as_ref().unwrap().contains(folder.path(name).to_str().unwrap()), "{error}");
        let error = error_of(&folder, with(&format!(r#""sky": {{ "texture": "{name}" }}"#)));
        assert!(error.what.contains(what), "{error}");
        assert!(error.at.as_ref().unwrap().starts_with("sky.texture"), "{error}");
    }
}

#[test]
fn skies_sizes_and_cameras_that_make_no_sense_are_refused() {
    let gradient = r#""gradient": { "bottom": [0,0,0], "top": [1,1,1] }"#;
    for other in [r#""color": [1,1,1]"#, r#""texture": "x.hdr""#] {
        let text = with(&format!(r#""sky": {{ {gradient}, {other} }}"#));
        refused(text, "`gradient`", "sky, line 3, column 10", "keep `gradient` alone");
    }
    refused(with(r#""sky": {}"#), "empty", "sky, line 3", "remove `sky`");
    refused(with(r#""sky": { "color": [1,1,1], "filter": "nearest" }"#), "`filter`", "sky.filter", "texture");
    refused(
        with(r#""sky": { "filter": "cubic" }"#),
        "`cubic`",
        "sky.filter",
        "one of nearest, bilinear, trilinear",
    );
    refused(with(r#""resolution": [0, 135]"#), "0 pixels wide", "resolution[0], line 3", "1 to 16384");
    refused(with(r#""resolution": [240, 16385]"#), "16385 pixels high", "resolution[1]", "1 to 16384");
    refused(with(r#""max_bounces": 1025"#), "1025", "max_bounces, line 3, column 18", "0 to 1024");
    let camera = |keys: &str| with(&format!(r#""camera": {{ {keys} }}"#));
    let text = camera(r#""position": [1,2,3], "look_at": [1,2,3]"#);
    refused(text, "its own position", "camera.look_at, line 3", "so that the two differ");
    // Different in double precision only.
    let text = camera(r#""position": [1,2,3], "look_at": [1,2,3.00000001]"#);
    refused(text, "its own position", "camera.look_at", "single precision");
    let text = camera(r#""position": [0,5,0], "look_at": [0,0,0]"#);
    refused(text, "parallel", "camera.up", "give an `up`");
    let text = camera(r#""position": [0,5,0], "look_at": [0,0,1], "up": [0,0,0]"#);
    refused(text, "zero", "camera.up, line 3", "give an `up`");
    for bad in ["0", "180", "-40"] {
        let text = camera(&format!(r#""vertical_fov": {bad}"#));
        refused(text, "field of view", "camera.vertical_fov, line 3, column 31", "below 180");
    }
}

#[test]
fn meshes_that_cannot_be_used_are_refused() {
    let folder = Folder::new();
    folder.write("one.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    fs::create_dir(folder.path("folder.obj")).unwrap();
    let mesh = |keys: &str| with(&format!(r#""meshes": [ {{ {keys} }} ]"#));
    let cases = [
        (r#""obj": "missing.obj""#, "no such file", "meshes[0].obj, line 3", "relative to the scene file"),
        (r#""obj": "folder.obj""#, "folder", "meshes[0].obj", "relative to the scene file"),
        (r#""obj": "one.obj", "scale": 0"#, "scaled by 0", "meshes[0].scale", "above 0"),
        (r#""obj": "one.obj", "scale": -1"#, "scaled by -1", "meshes[0].scale", "cannot be mirrored"),
        (r#""obj": "one.obj", "material": "x""#, "`x`", "meshes[0].material", "no `materials`"),
        (r#""obj": "one.obj", "translate": [0,0,1e30]"#, "too large", "meshes[0].translate[2]", "1e18"),
        (
            r#""obj": "one.obj", "translate": [1e18,0,0], "scale": 1e18"#,
            "too far",
            "meshes[0], line 3",
            "smaller",
        ),
    ];
    folder.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    let collapsed = [
        (r#""obj": "one.obj", "scale": 1e-30"#, "`one.obj`", "meshes[0], line 3", "larger `scale`"),
        (r#""obj": "one.obj", "translate": [1e17,0,0]"#, "zero area", "meshes[0]", "smaller `translate`"),
        (r#""obj": "flat.obj""#, "zero area", "meshes[0]", "export the model again"),
    ];
    for (keys, what, at, mend) in cases.into_iter().chain(collapsed) {
        let error = error_of(&folder, mesh(keys));
        assert!(error.what.contains(what), "{error}");
        assert!(error.at.as_ref().unwrap().starts_with(at), "{error}");
        assert!(error.mend.as_ref().unwrap().contains(mend), "{error}");
    }
}

#[test]
fn names_that_are_no_scenes_are_refused() {
    let folder = Folder::new();
    let path = |name: &str| folder.path(name).to_str().unwrap().to_string();
    fs::create_dir(folder.path("folder.json")).unwrap();
    folder.write("scene.txt", "{}");
    let cases = [
        (path("missing.json"), "no such file", "(.json), a model (.obj, .gltf, .glb, .ply)"),
        (path("missing.obj"), "no such file", "(.json), a model (.obj, .gltf, .glb, .ply)"),
        (path("folder.json"), "folder", "(.json), a model (.obj, .gltf, .glb, .ply)"),
        (path(""), "this is a folder, not a scene", "(.json), a model (.obj, .gltf, .glb, .ply)"),
        (
            path("scene.txt"),
            "files of the kind `.txt` are not read",
            "(.json), a model (.obj, .gltf, .glb, .ply)",
        ),
        ("three".to_string(), "not the name of a scene", "did you mean `builtin:three`?"),
        ("knot:100".to_string(), "not the name of a scene", "did you mean `builtin:knot:100`?"),
        ("terrian:100".to_string(), "not the name of a scene", "did you mean `builtin:terrain:100`?"),
        ("terrain".to_string(), "not the name of a scene", "did you mean `builtin:terrain:N`?"),
        (String::new(), "not the name of a scene", "(.json), a model (.obj, .gltf, .glb, .ply)"),
    ];
    for (spec, what, mend) in cases {
        let error = load(&spec).unwrap_err();
        assert!(error.what.contains(what) && error.mend.as_ref().unwrap().contains(mend), "{spec}: {error}");
        assert_eq!(error.file.as_deref(), Some(Path::new(&spec)));
    }
}

#[cfg(unix)]
#[test]
fn devices_and_pipes_are_refused_instead_of_read_forever() {
    let folder = Folder::new();
    let link = folder.path("zero.json");
    std::os::unix::fs::symlink("/dev/zero", &link).unwrap();
    let error = load(link.to_str().unwrap()).unwrap_err();
    assert!(error.what.contains("not a regular file"), "{error}");
}

#[test]
fn unknown_builtin_lists_the_names() {
    let error = load("builtin:cornel").unwrap_err();
    let mend = error.mend.unwrap();
    assert!(error.what.contains("builtin:cornel"));
    assert!(mend.contains("did you mean `builtin:cornell`?") && mend.contains("chess"), "{mend}");
    for (name, near) in
        [("knott:5", "knot:5"), ("Knot:7", "knot:7"), ("terain", "terrain:N"), ("knots:", "knot:N")]
    {
        let error = load(&format!("builtin:{name}")).unwrap_err();
        assert!(error.what.contains(&format!("no scene `builtin:{name}`")), "{error}");
        let mend = error.mend.unwrap();
        assert!(mend.starts_with(&format!("did you mean `builtin:{near}`? ")), "{name}: {mend}");
        assert!(mend.contains("cornell") && mend.contains("knot:N"), "{name}: {mend}");
    }
}

#[test]
fn message_reads_what_where_and_remedy_in_three_lines() {
    let folder = Folder::new();
    let error = error_of(&folder, sphere(r#"{ "center": [0,0,0], "radius": 0 }"#));
    let path = folder.path("scene.json");
    let expected = format!(
        "the radius is 0\n  at {}: spheres[0].radius, line 1, column 47\n  a radius is at least 1e-18",
        path.display()
    );
    assert_eq!(error.to_string(), expected);
}
