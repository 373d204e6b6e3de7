//! Every way to get a scene wrong is answered with what is wrong, where, and how to mend it.

use octray::scene::{SceneError, load};
use std::fs;
use std::path::Path;
use tempfile::TempDir;

fn refuse(folder: &Path, text: impl AsRef<[u8]>) -> SceneError {
    let path = folder.join("scene.json");
    fs::write(&path, text).unwrap();
    let error = load(path.to_str().unwrap()).expect_err("the scene must be refused");
    assert_eq!(error.file.as_deref(), Some(path.as_path()), "{error}");
    error
}

/// Asserts that a scene text, beside a picture, is refused with these words in what is wrong, where, and how
/// to mend it.
#[track_caller]
fn assert_refused(text: impl AsRef<[u8]>, what: &str, at: &str, mend: &str) {
    let folder = TempDir::new().unwrap();
    image::RgbImage::new(1, 1).save(folder.path().join("p.png")).unwrap();
    let error = refuse(folder.path(), text);
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
    format!("{{ \"spheres\": [ {sphere} ], \"format\": \"octray-1\" }}")
}

fn material(keys: &str) -> String {
    with(&format!("\"materials\": {{ \"m\": {{ {keys} }} }}"))
}

#[test]
fn broken_json_names_line_and_column() {
    assert_refused("", "broken JSON", "line 1, column 1", "write a JSON object");
    assert_refused("{\n  \"max_bounces\": 3\n\n", "broken JSON", "line 2, column 19", "close the brackets");
    assert_refused(
        "{ \"format\": \"octray-1\",\n \"spheres\": [",
        "broken JSON",
        "spheres",
        "close the brackets",
    );
    assert_refused(
        "{ \"format\": \"octray-1\", }",
        "trailing comma",
        "line 1, column 25",
        "remove the comma",
    );
    assert_refused("{ \"format\"\n \"octray-1\" }", "broken JSON", "line 2, column 2", "mend the JSON");
    assert_refused(with("\"max_bounces\": 3 // few"), "broken JSON", "line 3", "comma");
    assert_refused("{} {}", "trailing characters", "line 1, column 4", "remove what follows");
    let four = r#"{"format": "octray-1", "camera": {"position": [0, 1, 5, 0]}}"#;
    assert_refused(four, "`position` cannot be [0,1,5,0]", "camera.position", "\"position\": [0, 1, 5]");
    assert_refused("[1, 2]", "not a scene", "", "octray-1");
    assert_refused("\"scene\"", "string", "line 1", "write an object");
}

#[test]
fn text_that_is_not_utf8_names_its_line() {
    assert_refused(b"{\n \"format\": \"octray-1\xff\" }", "not UTF-8", "line 2", "UTF-8");
}

#[test]
fn unknown_keys_are_refused_with_the_nearest_known_one() {
    assert_refused(
        with("\"skye\": {}"),
        "unknown key `skye`",
        "skye, line 3, column 11",
        "did you mean `sky`?",
    );
    let text = sphere("{ \"center\": [0,0,0], \"radius\": 1, \"colour\": 3 }");
    assert_refused(
        text,
        "unknown key `colour`",
        "spheres[0]",
        "center, radius, material, turn_degrees, picture_from",
    );
    assert_refused(material("\"type\": \"diffuse\", \"colour\": 1"), "`colour`", "materials.m", "`color`");
    assert_refused(with("\"camera\": { \"fov\": 40 }"), "`fov`", "camera", "vertical_fov");
}

#[test]
fn missing_and_doubled_keys_are_named() {
    assert_refused(
        sphere("{ \"center\": [0,0,0] }"),
        "`radius` is missing",
        "spheres[0], line 1",
        "add `radius`",
    );
    assert_refused(material("\"color\": [1,1,1]"), "`type` is missing", "materials.m", "add `type`");
    assert_refused(with("\"sky\": null, \"sky\": null"), "a second `sky`", "", "remove or rename");
    let twice = with("\"materials\": { \"a\": { \"type\": \"metal\" }, \"a\": { \"type\": \"metal\" } }");
    assert_refused(twice, "the name `a` occurs twice", "materials", "rename");
}

#[test]
fn wrong_types_are_named_with_what_is_expected() {
    let text = sphere("{ \"center\": [0,\"0\",0], \"radius\": 1 }");
    assert_refused(text, "[0,\"0\",0]", "spheres[0].center[1], line 1, column 31", "\"center\": [0, 1, 5]");
    assert_refused(
        sphere("{ \"center\": [0,0], \"radius\": 1 }"),
        "`center` cannot be [0,0]",
        "spheres[0].center",
        "write it as in \"center\": [0, 1, 5]",
    );
    assert_refused(with("\"resolution\": [240.5, 135]"), "240.5", "resolution[0], line 3", "[240, 135]");
    assert_refused(with("\"max_bounces\": -1"), "-1", "max_bounces, line 3", "\"max_bounces\": 16");
    assert_refused(
        with("\"sky\": 3"),
        "`sky` cannot be 3",
        "sky, line 3",
        "\"sky\": { \"color\": [0.7, 0.8, 1] }",
    );
    let sky = "`sky` cannot be [0.7,0.8,1.0]";
    assert_refused(
        with("\"sky\": [0.7,0.8,1.0]"),
        sky,
        "sky[0], line 3",
        "\"sky\": { \"color\": [0.7, 0.8, 1] }",
    );
    assert_refused(
        with("\"materials\": [1]"),
        "cannot be [1]",
        "materials",
        "{ \"red\": { \"type\": \"diffuse\"",
    );
    let red = with("\"materials\": { \"m\": \"red\" }");
    assert_refused(red, "`m` cannot be \"red\"", "materials.m", "\"m\": { \"type\": \"diffuse\"");
    assert_refused(with("\"format2\": 1, \"sky\": 3"), "unknown key", "format2", "the keys known here");
    let long = sphere(&format!("{{ \"center\": \"{}\", \"radius\": 1 }}", "x".repeat(999)));
    assert_refused(long, "xxxxxxx…", "spheres[0].center", "[0, 1, 5]");
}

/// Words of *Ray Tracing in One Weekend*, Mitsuba, pbrt and Blender, and what is meant by them.
#[test]
fn words_of_other_programs_are_understood() {
    let camera = |key: &str| with(&format!("\"camera\": {{ \"{key}\": 1 }}"));
    let sphere = |key: &str| sphere(&format!("{{ \"{key}\": 1, \"center\": [0,0,0], \"radius\": 1 }}"));
    let mesh = |key: &str| with(&format!("\"meshes\": [ {{ \"{key}\": 1, \"model\": \"x.obj\" }} ]"));
    let of_type = |kind: &str, key: &str| material(&format!("\"type\": \"{kind}\", \"{key}\": 1"));
    let kind = |kind: &str| material(&format!("\"type\": \"{kind}\""));
    let cases = [
        (camera("lookfrom"), "position"),
        (camera("look_from"), "position"),
        (camera("center"), "position"),
        (camera("lookat"), "look_at"),
        (camera("vfov"), "vertical_fov"),
        (camera("vup"), "up"),
        (mesh("rotation"), "rotate_degrees"),
        (sphere("position"), "center"),
        (sphere("bsdf"), "material"),
        (mesh("position"), "translate"),
        (with("\"background\": 1"), "sky"),
        (with("\"max_depth\": 1"), "max_bounces"),
        (with("\"image_width\": 1"), "resolution"),
        (with("\"aspect_ratio\": 1"), "resolution"),
        (with("\"objects\": 1"), "spheres"),
        (of_type("diffuse", "albedo"), "color"),
        (of_type("diffuse", "baseColor"), "color"),
        (of_type("metal", "fuzz"), "roughness"),
        (of_type("glass", "refraction_index"), "ior"),
        (of_type("glass", "int_ior"), "ior"),
        (of_type("diffuse", "emissive"), "emission"),
        (of_type("diffuse", "emit"), "emission"),
        (of_type("diffuse", "light"), "emission"),
        (kind("lambertian"), "diffuse"),
        (kind("dielectric"), "glass"),
        (kind("diffuse_light"), "emitter"),
        (kind("conductor"), "metal"),
        (kind("principled"), "metal-rough"),
    ];
    for (text, meant) in cases {
        assert_refused(text, "unknown", "", &format!("did you mean `{meant}`?"));
    }
    for (text, instead) in [
        (camera("defocus_angle"), "the camera is a pinhole"),
        (camera("image_width"), "did you mean `resolution` of the scene?"),
        (camera("samples_per_pixel"), "octray render --samples N"),
        (with("\"samplesPerPixel\": 1"), "octray render --samples N"),
        (with("\"vfov\": 1"), "did you mean `vertical_fov` of `camera`?"),
        (with("\"up\": 1"), "did you mean `up` of `camera`?"),
        (with("\"world\": 1"), "`triangles` and `meshes` hold the objects"),
        (with("\"quads\": 1"), "write `triangles`"),
        (of_type("glass", "transmission"), "`glass` lets light through"),
    ] {
        assert_refused(text, "unknown key", "", instead);
    }
    assert_refused(sphere("color"), "unknown key `color`", "spheres[0].color", "an entry of `materials`");
    assert_refused(sphere("albedo"), "unknown key `albedo`", "spheres[0].albedo", "an entry of `materials`");
}

#[test]
fn only_keys_that_the_type_has_are_offered() {
    let folder = TempDir::new().unwrap();
    let mend = refuse(folder.path(), material("\"type\": \"glass\", \"fuzz\": 1")).mend.unwrap();
    assert!(!mend.contains("roughness") && mend.contains("color, emission, ior"), "{mend}");
}

#[test]
fn all_faults_of_a_scene_are_told_at_once_in_its_order() {
    let text = r#"{ "format": "octray-1",
        "camera": { "lookfrom": [0,1,5], "look_at": [0,1,0], "vfov": 40 },
        "sky": [0.7, 0.8, 1],
        "materials": { "a": { "type": "lambertian", "albedo": [1,1,1] }, "b": { "type": "metal", "fuzz": 0 },
                       "c": { "type": "emitter", "color": [1,1,1], "ior": 2 } },
        "spheres": [ { "center": [0,0,0], "radius": -1, "material": "a" }, { "center": [0,0] },
                     { "center": [0,0,0], "radius": 1, "material": "x" } ] }"#;
    let folder = TempDir::new().unwrap();
    let error = refuse(folder.path(), text);
    let all: Vec<_> = std::iter::once(&error).chain(&error.others).collect();
    let places: Vec<&str> =
        all.iter().map(|error| error.at.as_ref().unwrap().split(',').next().unwrap()).collect();
    assert_eq!(places.len(), 10, "at most ten: {error}");
    let first_eight = [
        "camera.lookfrom",
        "camera.vfov",
        "sky[0]",
        "materials.a.type",
        "materials.a.albedo",
        "materials.b.fuzz",
    ];
    assert_eq!(places[..6], first_eight, "{error}");
    let lines = error.to_string();
    assert_eq!(lines.matches("\nalso: ").count(), 9, "{lines}");
    // A name that is left out, or a material with a fault, is no fault of what uses it.
    let text = r#"{ "format": "octray-1", "materials": 3,
        "spheres": [ { "center": [0,0,0], "radius": 1, "material": "a" }, { "radius": 1 }, { "center": 1 } ] }"#;
    let error = refuse(folder.path(), text);
    let whats: Vec<&str> =
        std::iter::once(&error).chain(&error.others).map(|error| error.what.as_str()).collect();
    let expected = [
        "`materials` cannot be 3",
        "the key `center` is missing",
        "the key `radius` is missing",
        "`center` cannot be 1",
    ];
    assert_eq!(whats, expected, "{error}");
    let error = refuse(folder.path(), with("\"meshes\": [ { \"file\": \"x.obj\" } ]"));
    assert!(error.others.is_empty() && error.what.contains("`file`"), "{error}");
    // Of a key that is there twice and wrong elsewhere, both are told.
    let error = refuse(folder.path(), with("\"sky\": null, \"sky\": null, \"world\": 1"));
    assert_eq!(error.others.len(), 1, "{error}");
}

#[test]
fn format_of_another_version_is_refused() {
    let text = "{ \"format\": \"octray-2\", \"spheres\": [] }";
    assert_refused(text, "`octray-2`", "format, line 1, column 13", "\"format\": \"octray-1\"");
}

#[test]
fn json_that_is_no_scene_says_what_both_formats_need() {
    let folder = TempDir::new().unwrap();
    let error = refuse(folder.path(), "{ \"sky\": [1, 1, 1], \"name\": \"x\" }");
    let mend = error.mend.unwrap();
    assert!(mend.contains("octray-1") && mend.contains("`sphere`, `triangle` or `res`"), "{mend}");
}

#[test]
fn numbers_that_are_not_finite_are_refused() {
    for bad in ["NaN", "1e400", "-1e400", "Infinity", "-Infinity"] {
        let text = sphere(&format!("{{ \"center\": [0,{bad},0], \"radius\": 1 }}"));
        assert_refused(text, "finite number", "spheres[0].center[1], line 1", "JSON has no NaN");
    }
    for bad in ["1e39", "-1.1e18"] {
        let text = sphere(&format!("{{ \"center\": [0,0,{bad}], \"radius\": 1 }}"));
        assert_refused(text, "too large", "spheres[0].center[2], line 1, column 33", "-1e18 to 1e18");
    }
}

#[test]
fn radii_that_are_not_above_zero_are_refused() {
    for (bad, what) in [("0", "the radius is 0"), ("-1", "the radius is -1"), ("1e-50", "too small")] {
        let other = "{ \"center\": [9,0,0], \"radius\": 1 }";
        let text = sphere(&format!("{{ \"center\": [0,0,0], \"radius\": {bad} }}, {other}"));
        assert_refused(text, what, "spheres[0].radius, line 1, column 47", "at least 1e-18");
    }
    assert_refused(
        sphere("{ \"center\": [0,0,0], \"radius\": 1e19 }"),
        "too large",
        "spheres[0].radius",
        "1e18",
    );
}

#[test]
fn triangles_without_area_are_refused() {
    let triangle = |vertices: &str| {
        format!("{{ \"format\": \"octray-1\",\n \"triangles\": [ {{ \"vertices\": {vertices} }} ] }}")
    };
    let at = "triangles[0].vertices, line 2, column 31";
    assert_refused(
        triangle("[[0,0,0],[1,0,0],[1,0,0]]"),
        "vertices are the same",
        at,
        "move its vertices apart",
    );
    // Different in double precision, the same in single.
    assert_refused(triangle("[[0,0,0],[1,0,0],[1.000000001,0,0]]"), "the same in single", at, "remove");
    assert_refused(triangle("[[0,0,0],[1,1,1],[2,2,2]]"), "on one line", at, "remove the triangle");
    assert_refused(triangle("[[0,0,0],[1e-39,0,0],[0,1,0]]"), "zero area", at, "move");
    assert_refused(
        triangle("[[0,0,0],[1,0,0],[0,1e30,0]]"),
        "too large",
        "triangles[0].vertices[2][1]",
        "1e18",
    );
}

#[test]
fn unknown_material_names_suggest_the_nearest() {
    let text = |materials: &str| {
        format!(
            "{{ \"format\": \"octray-1\", \"materials\": {{ {materials} }},\n\"spheres\": [ {{ \"center\": [0,0,0], \
             \"radius\": 1, \"material\": \"crome\" }} ] }}"
        )
    };
    let at = "spheres[0].material, line 2, column 60";
    assert_refused(text("\"chrome\": { \"type\": \"metal\" }"), "`crome`", at, "did you mean `chrome`?");
    assert_refused(text("\"velvet\": { \"type\": \"metal\" }"), "`crome`", at, "use one of velvet");
    assert_refused(text(""), "`crome`", at, "the scene has no `materials`");
    let triangle = "{ \"format\": \"octray-1\", \"triangles\": [ { \"vertices\": [[0,0,0],[1,0,0],[0,1,0]], \
                    \"material\": \"x\" } ] }";
    assert_refused(triangle, "`x`", "triangles[0].material", "no `materials`");
}

#[test]
fn colours_outside_their_range_are_refused() {
    let text = material("\"type\": \"diffuse\", \"color\": [1, 1.5, 0]");
    assert_refused(text, "1.5 is outside 0 to 1", "materials.m.color[1], line 3", "use `emission`");
    let text = material("\"type\": \"metal\", \"color\": [-0.1, 0, 0]");
    assert_refused(text, "-0.1", "materials.m.color[0]", "from 0 to 1");
    let text = material("\"type\": \"diffuse\", \"emission\": [1, 1, -2]");
    assert_refused(text, "-2 is negative", "materials.m.emission[2]", "0 or more");
    assert_refused(with("\"sky\": { \"color\": [0, -1, 0] }"), "-1 is negative", "sky.color[1]", "0 or more");
    let text = with("\"sky\": { \"gradient\": { \"bottom\": [0,0,0], \"top\": [0,0,1e300] } }");
    assert_refused(text, "too large", "sky.gradient.top[2]", "1e18");
}

#[test]
fn material_types_that_do_not_exist_are_refused() {
    assert_refused(material("\"type\": \"metl\""), "`metl`", "materials.m.type", "did you mean `metal`?");
    assert_refused(
        material("\"type\": \"velvet\""),
        "`velvet`",
        "materials.m.type",
        "diffuse, metal, plastic",
    );
}

#[test]
fn coats_and_maps_that_make_no_sense_are_refused() {
    for ior in ["0.9", "3.5", "-1"] {
        let text = material(&format!("\"type\": \"plastic\", \"ior\": {ior}"));
        assert_refused(text, ior, "materials.m.ior, line 3", "from 1 to 3");
    }
    let text = material("\"type\": \"plastic\", \"roughness\": 1.5");
    assert_refused(text, "1.5 is outside", "materials.m.roughness", "from 0 to 1");
    let text = material("\"type\": \"metal\", \"roughness\": 0, \"roughness_map\": \"r.png\"");
    assert_refused(text, "cannot change a `roughness` of 0", "materials.m.roughness_map", "above 0");
    for key in ["roughness_map", "normal_map"] {
        let text = material(&format!("\"type\": \"metal\", \"{key}\": \"gone.png\""));
        assert_refused(text, "gone.png", &format!("materials.m.{key}"), "relative to the scene file");
    }
}

#[test]
fn normals_without_a_direction_are_refused() {
    let text = "{ \"format\": \"octray-1\", \"triangles\": [ { \"vertices\": [[0,0,0],[1,0,0],[0,1,0]], \
                \"normals\": [[0,0,1],[0,0,0],[0,0,1]] } ] }";
    assert_refused(text, "length zero", "triangles[0].normals[1]", "away from the surface");
}

#[test]
fn keys_of_another_material_type_are_refused() {
    let cases = [
        ("\"type\": \"diffuse\", \"ior\": 1.5", "ior", "glass"),
        ("\"type\": \"diffuse\", \"roughness\": 0.5", "roughness", "`metal-rough` or `scatter`"),
        (
            "\"type\": \"diffuse\", \"roughness_map\": \"r.png\"",
            "roughness_map",
            "`metal-rough` or `scatter`",
        ),
        ("\"type\": \"emitter\", \"normal_map\": \"n.png\"", "normal_map", "scatters nothing"),
        ("\"type\": \"metal\", \"metallic\": 0.5", "metallic", "make the type `metal-rough`"),
        ("\"type\": \"metal\", \"thin\": true", "thin", "make the type `glass`"),
        ("\"type\": \"emitter\", \"emission_map\": \"e.png\"", "emission_map", "`texture`"),
        ("\"type\": \"glass\", \"roughness\": 0.5", "roughness", "`metal-rough` or `scatter`"),
        ("\"type\": \"emitter\", \"color\": [1,1,1]", "color", "`emission`"),
        ("\"type\": \"diffuse\", \"filter\": \"nearest\"", "filter", "add a `texture`"),
        ("\"type\": \"diffuse\", \"texture_size\": 2", "texture_size", "add a `texture`"),
    ];
    for (keys, key, mend) in cases {
        assert_refused(material(keys), &format!("`{key}`"), &format!("materials.m.{key}, line 3"), mend);
    }
}

#[test]
fn roughness_ior_and_texture_size_out_of_range_are_refused() {
    let text = material("\"type\": \"metal\", \"roughness\": 1.1");
    assert_refused(text, "1.1 is outside 0 to 1", "materials.m.roughness", "from 0 to 1");
    let text = material("\"type\": \"scatter\", \"roughness\": -1");
    assert_refused(text, "-1 is negative", "materials.m.roughness", "0 or more");
    for bad in ["0", "-1.5"] {
        let text = material(&format!("\"type\": \"glass\", \"ior\": {bad}"));
        assert_refused(text, "index of refraction", "materials.m.ior", "glass 1.5");
    }
    let text = material("\"type\": \"metal-rough\", \"ior\": 0.9");
    assert_refused(text, "index of refraction of 0.9", "materials.m.ior", "1 or more");
    for bad in ["0", "-2"] {
        let keys = format!("\"type\": \"diffuse\", \"texture\": \"p.png\", \"texture_size\": {bad}");
        assert_refused(material(&keys), &format!("size {bad}"), "materials.m.texture_size", "above 0");
    }
}

#[test]
fn vertex_colours_beside_textures_are_refused() {
    let text = "{ \"format\": \"octray-1\", \"materials\": { \"m\": { \"type\": \"diffuse\", \"texture\": \"p.png\" } }, \
                \"triangles\": [ { \"vertices\": [[0,0,0],[1,0,0],[0,1,0]], \"material\": \"m\", \
                \"colors\": [[1,0,0],[0,1,0],[0,0,1]] } ] }";
    assert_refused(text, "has textures", "triangles[0].colors", "without textures");
}

#[test]
fn textures_that_cannot_be_used_are_refused() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("text.png"), "not a picture").unwrap();
    fs::create_dir(folder.path().join("folder.png")).unwrap();
    let mut png = Vec::new();
    image::RgbImage::new(8, 8)
        .write_to(&mut std::io::Cursor::new(&mut png), image::ImageFormat::Png)
        .unwrap();
    fs::write(folder.path().join("cut.png"), &png[..png.len() / 2]).unwrap();
    let cases = [
        ("missing.png", "no such file"),
        ("text.png", "broken"),
        ("cut.png", "broken"),
        ("folder.png", "folder"),
    ];
    for (name, what) in cases {
        let text = material(&format!("\"type\": \"diffuse\", \"texture\": \"{name}\""));
        let error = refuse(folder.path(), text);
        assert!(error.what.contains(name) && error.what.contains(what), "{error}");
        assert!(error.at.as_ref().unwrap().starts_with("materials.m.texture, line 3"), "{error}");
        // The remedy says where the file was looked for.
        assert!(error.mend.as_ref().unwrap().contains(folder.path().join(name).to_str().unwrap()), "{error}");
        let error = refuse(folder.path(), with(&format!("\"sky\": {{ \"texture\": \"{name}\" }}")));
        assert!(
            error.what.contains(what) && error.at.as_ref().unwrap().starts_with("sky.texture"),
            "{error}"
        );
    }
}

#[test]
fn skies_with_conflicting_keys_are_refused() {
    let gradient = "\"gradient\": { \"bottom\": [0,0,0], \"top\": [1,1,1] }";
    for other in ["\"color\": [1,1,1]", "\"texture\": \"x.hdr\""] {
        let text = with(&format!("\"sky\": {{ {gradient}, {other} }}"));
        assert_refused(text, "`gradient`", "sky, line 3, column 10", "keep `gradient` alone");
    }
    assert_refused(with("\"sky\": {}"), "empty", "sky, line 3", "remove `sky`");
    for (keys, what, key, mend) in [
        ("\"color\": [1,1,1], \"filter\": \"nearest\"", "`filter`", "filter", "texture"),
        (
            "\"color\": [1,1,1], \"turn_degrees\": 5",
            "`turn_degrees`",
            "turn_degrees",
            "the same from all sides",
        ),
        ("\"filter\": \"cubic\"", "`cubic`", "filter", "one of nearest, bilinear, trilinear"),
    ] {
        assert_refused(with(&format!("\"sky\": {{ {keys} }}")), what, &format!("sky.{key}"), mend);
    }
}

#[test]
fn empty_scenes_are_refused() {
    let folder = TempDir::new().unwrap();
    let error = refuse(folder.path(), "{ \"format\": \"octray-1\", \"spheres\": [] }");
    assert!(error.what.contains("nothing to see") && error.mend.unwrap().contains("`spheres`"));
}

#[test]
fn resolution_and_bounces_out_of_range_are_refused() {
    assert_refused(with("\"resolution\": [0, 135]"), "0 pixels wide", "resolution[0], line 3", "1 to 16384");
    assert_refused(with("\"resolution\": [240, 16385]"), "16385 pixels high", "resolution[1]", "1 to 16384");
    assert_refused(with("\"max_bounces\": 1025"), "1025", "max_bounces, line 3, column 18", "0 to 1024");
}

#[test]
fn cameras_that_cannot_see_are_refused() {
    let camera = |keys: &str| with(&format!("\"camera\": {{ {keys} }}"));
    let text = camera("\"position\": [1,2,3], \"look_at\": [1,2,3]");
    assert_refused(text, "its own position", "camera.look_at, line 3", "so that the two differ");
    let text = camera("\"position\": [1,2,3], \"look_at\": [1,2,3.0000000000000001]");
    assert_refused(text, "its own position", "camera.look_at", "single precision");
    let text = camera("\"position\": [0,5,0], \"look_at\": [0,0,0]");
    assert_refused(text, "parallel", "camera.up", "give an `up`");
    let text = camera("\"position\": [0,5,0], \"look_at\": [0,0,1], \"up\": [0,0,0]");
    assert_refused(text, "zero", "camera.up, line 3", "give an `up`");
    for bad in ["0", "180", "-40"] {
        let text = camera(&format!("\"vertical_fov\": {bad}"));
        assert_refused(text, "field of view", "camera.vertical_fov, line 3, column 31", "below 180");
    }
}

#[test]
fn meshes_that_cannot_be_used_are_refused() {
    let folder = TempDir::new().unwrap();
    fs::write(folder.path().join("one.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
    fs::create_dir(folder.path().join("folder.obj")).unwrap();
    let mesh =
        |keys: &str| with(&format!("\"camera\": {{ \"look_at\": [0,0,0] }}, \"meshes\": [ {{ {keys} }} ]"));
    let cases = [
        ("\"obj\": \"missing.obj\"", "no such file", "meshes[0].obj, line 3", "relative to the scene file"),
        ("\"obj\": \"folder.obj\"", "folder", "meshes[0].obj", "relative to the scene file"),
        ("\"obj\": \"one.obj\", \"scale\": 0", "scaled by 0", "meshes[0].scale", "above 0"),
        ("\"obj\": \"one.obj\", \"scale\": -1", "scaled by -1", "meshes[0].scale", "cannot be mirrored"),
        ("\"obj\": \"one.obj\", \"material\": \"x\"", "`x`", "meshes[0].material", "no `materials`"),
        ("\"obj\": \"one.obj\", \"translate\": [0,0,1e30]", "too large", "meshes[0].translate[2]", "1e18"),
        ("\"obj\": \"one.obj\", \"translate\": [1e13,0,0]", "too far", "meshes[0], line 3", "smaller"),
    ];
    fs::write(folder.path().join("flat.obj"), "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n").unwrap();
    let collapsed = [
        ("\"obj\": \"one.obj\", \"scale\": 1e-30", "`one.obj`", "meshes[0], line 3", "larger `scale`"),
        ("\"obj\": \"one.obj\", \"translate\": [1e11,0,0]", "zero area", "meshes[0]", "smaller `translate`"),
        ("\"obj\": \"flat.obj\"", "zero area", "meshes[0]", "export the model again"),
    ];
    for (keys, what, at, mend) in cases.into_iter().chain(collapsed) {
        let error = refuse(folder.path(), mesh(keys));
        assert!(error.what.contains(what), "{error}");
        assert!(error.at.as_ref().unwrap().starts_with(at), "{error}");
        assert!(error.mend.as_ref().unwrap().contains(mend), "{error}");
    }
}

#[test]
fn names_that_are_no_scenes_are_refused() {
    let folder = TempDir::new().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_string();
    fs::create_dir(folder.path().join("folder.json")).unwrap();
    fs::write(folder.path().join("scene.txt"), "{}").unwrap();
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
    let folder = TempDir::new().unwrap();
    let link = folder.path().join("zero.json");
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
    let folder = TempDir::new().unwrap();
    let error = refuse(folder.path(), sphere("{ \"center\": [0,0,0], \"radius\": 0 }"));
    let path = folder.path().join("scene.json");
    let expected = format!(
        "the radius is 0\n  at {}: spheres[0].radius, line 1, column 47\n  in a scene of this size a radius is at least 1e-18",
        path.display()
    );
    assert_eq!(error.to_string(), expected);
}
