//! `octray render`: files, reports, and the same picture from every way to compute it.

use crate::desk::{Desk, assert_has};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::json;

#[test]
fn render_writes_the_file_and_says_so_in_a_line() {
    let desk = Desk::new();
    let rendered = desk.octray("render scene.json -o a.png --samples 3").assert().success();
    rendered.stderr(contains("error").not()).stdout(
        predicate::str::is_match(
            r"^a\.png: 8×8, 3 samples, \d+\.\d\d s, \d+\.\d+ Mray/s, traversal linear\n$",
        )
        .unwrap(),
    );
    assert_eq!(desk.names(), ["a.png", "model.obj", "scene.json"]);
    desk.run("render scene.json -o a.png --samples 1 --size 5×4");
    let size = image::image_dimensions(desk.path("a.png")).unwrap();
    assert_eq!(size, (5, 4), "the second file replaces the first");
}

#[test]
fn render_reports_in_json_what_it_did() {
    let desk = Desk::new();
    let options = "--samples 2 --size 4x3 --bounces 1 --seed 7 --threads 1 --lanes 1";
    let report = desk.json(&format!("render scene.json -o a.exr {options}"));
    let expected = json!({
        "schema": "octray-render-1", "scene": "scene.json", "output": "a.exr", "width": 4, "height": 3,
        "samples": 2, "most_samples": 2, "mean_samples": 2.0, "max_bounces": 1, "seed": 7,
        "discarded_samples": 0, "interrupted": false, "denoised": false, "ended_by": "samples",
        "time_limit": null, "target_error": null, "estimated_error": null
    });
    assert_has(&report, &expected);
    assert!(report["seconds"].is_f64() && report["mrays_per_s"].is_f64() && report["rays"].is_u64());
    assert_eq!(report.as_object().unwrap().len(), 23);
}

#[test]
fn render_shows_the_scene() {
    let desk = Desk::new();
    let report = desk.json("render scene.json -o a.exr --samples 4");
    // A primary ray a sample, at least, and one more from the sphere in the middle.
    assert!(report["rays"].as_u64().unwrap() > 8 * 8 * 4, "{report}");
    assert_eq!(report["discarded_samples"], 0);
    let pixels = desk.pixels("a.exr");
    // The sphere is convex and alone: sky in the corner, clay times sky in the middle.
    for (place, pixel, expected) in
        [("corner", pixels[0], [0.5, 0.7, 1.0]), ("middle", pixels[4 * 8 + 4], [0.4, 0.35, 0.3])]
    {
        let near = pixel.iter().zip(expected).all(|(channel, expected)| (channel - expected).abs() < 1e-4);
        assert!(near, "{place}: {pixel:?}, expected {expected:?}");
    }
}

#[test]
fn clamp_cuts_bright_samples_off_and_is_told() {
    let desk = Desk::new();
    let line = "render builtin:cornell --samples 4 --size 24x16";
    assert!(desk.json(&format!("{line} -o plain.exr"))["clamp"].is_null(), "no limit by default");
    assert_eq!(desk.json(&format!("{line} -o clamped.exr --clamp 0.5"))["clamp"], 0.5);
    let [plain, clamped] = ["plain.exr", "clamped.exr"].map(|file| desk.pixels(file));
    assert!(clamped.iter().flatten().all(|&value| value <= 0.5));
    // Pixels that are dark in every sample stay as they are, and bright ones lose light: a lamp is in the
    // picture.
    assert!(plain.iter().zip(&clamped).any(|(plain, clamped)| plain == clamped && *plain != [0.0; 3]));
    assert!(plain.iter().zip(&clamped).all(|(p, c)| (0..3).all(|i| c[i] <= p[i])));
    assert!(plain.iter().flatten().any(|&value| value > 5.0));
}

/// The scene of the book's last balls: a hollow one of glass, a diffuse one, a metal one.
fn balls(camera: &str, sky: f64, more: &str) -> String {
    format!(
        r#"{{ "format": "octray-1", "resolution": [120, 68], "camera": {{ {camera} }},
        "sky": {{ "color": [{sky}, {sky}, {sky}] }},
        "materials": {{ "ground": {{ "type": "diffuse", "color": [0.8, 0.8, 0] }}, "glass": {{ "type": "glass" }},
            "air": {{ "type": "glass", "ior": 0.667 }}, "gold": {{ "type": "metal", "color": [0.8, 0.6, 0.2] }},
            "lamp": {{ "type": "emitter", "emission": [0.01, 0.01, 0.01] }} }},
        "spheres": [ {{ "center": [0, 0, -1.2], "radius": 0.5 }},
            {{ "center": [0, -100.5, -1], "radius": 100, "material": "ground" }},
            {{ "center": [-1, 0, -1], "radius": 0.5, "material": "glass" }},
            {{ "center": [1, 0, -1], "radius": 0.5, "material": "gold" }}{more} ] }}"#
    )
}

const HOLLOW: &str = r#", { "center": [-1, 0, -1], "radius": 0.4, "material": "air" }"#;
const FRONT: &str = r#""position": [0, 0, 0.5], "look_at": [0, 0, -1], "vertical_fov": 90"#;

#[test]
fn pictures_that_lack_light_say_why() {
    let desk = Desk::new();
    let lamp = r#", { "center": [0, 3, -1], "radius": 0.5, "material": "lamp" }"#;
    let hidden = lamp.to_owned() + r#", { "center": [0, 3, -1], "radius": 1 }"#;
    let inside = r#""position": [0, 0, -1.1], "look_at": [0, 0, 3]"#;
    let away = r#""position": [0, 5, 9], "look_at": [0, 99, 60]"#;
    let down = r#""position": [0, 1, 1], "look_at": [0, 0, 0.9]"#;
    for (camera, light, more, options, told) in [
        (FRONT, 1.0, HOLLOW, "", "of the picture: try --bounces 16."),
        (inside, 1.0, "", "", "is black: the camera is inside spheres[0]: move its `position`"),
        (away, 0.0, lamp, "", "is black: nothing is in view"),
        (FRONT, 0.0, &hidden, "", "is black: no path has found a light"),
        (down, 1.0, "", "--bounces 0", "is black: no light is reached within 0 bounces: try --bounces 4"),
        // The advice is the exposure in all, whatever was given, or that none helps.
        (FRONT, 0.003, "", "", "its brightest pixel is 0.0030: try --exposure +8, or brighter lights."),
        (
            FRONT,
            1e-12,
            "",
            "--exposure 20",
            "its brightest pixel is 1.0e-12: try --exposure +40, or brighter",
        ),
        (FRONT, 1e-30, "", "--exposure 64", "beyond any --exposure: make all lights 1e30 times as bright"),
        (FRONT, 30.0, "", "", "half of the picture is white"),
        (FRONT, 1e12, "", "", "e11: try --exposure -"),
    ] {
        desk.write("scene.json", balls(camera, light, more));
        let warned = |lanes: &str| {
            desk.warnings(&format!("render scene.json -o a.png --samples 4 --lanes {lanes} {options}"))
        };
        let said = warned("1 --threads 1");
        assert!(said.contains(told) && warnings_of_pictures(&said) == 1, "{told}: {said}");
        assert_eq!(said, warned("8 --threads 3"));
    }
    let black = r#"{ "format": "octray-1", "materials": { "k": { "type": "diffuse", "color": [0, 0, 0] } },
        "spheres": [{ "center": [0, 0, 0], "radius": 1, "material": "k" }],
        "camera": { "position": [0, 0, 3], "look_at": [0, 0, 0], "vertical_fov": 10 } }"#;
    desk.write("scene.json", black);
    let said = desk.warnings("render scene.json -o a.png --samples 4");
    assert!(said.contains("is black: nothing in view reflects light"), "{said}");
}

/// The number of warnings but those of a build for another processor.
fn warnings_of_pictures(said: &str) -> usize {
    said.matches("warning: ").count() - said.matches("warning: this machine").count()
}

#[test]
fn pictures_that_are_dark_or_white_on_purpose_have_no_warning() {
    let desk = Desk::new();
    let star = r#", { "center": [0, 3, -1], "radius": 0.5, "material": "star" }"#;
    let night = balls(FRONT, 0.0, star).replace(r#""lamp":"#, r#""star": { "type": "emitter" }, "lamp":"#);
    for (text, options) in [
        (balls(FRONT, 1.0, HOLLOW), "-o a.png --bounces 16"),
        (balls(FRONT, 1.0, HOLLOW), "-o a.png --bounces 1"),
        (balls(FRONT, 1.0, ""), "-o a.png"),
        (night, "-o a.png"),
        (balls(FRONT, 0.003, ""), "-o a.png --exposure 8"),
        (balls(FRONT, 1e-12, ""), "-o a.png --exposure 40"),
        // The numbers of a linear file are right at any exposure.
        (balls(FRONT, 0.003, ""), "-o a.exr"),
        (balls(FRONT, 30.0, ""), "-o a.png --tone reinhard"),
    ] {
        desk.write("scene.json", &text);
        let said = desk.warnings(&format!("render scene.json --samples 4 {options}"));
        assert_eq!(warnings_of_pictures(&said), 0, "{options}: {said}");
    }
    for scene in octray::scene::builtin_names() {
        let said = desk.warnings(&format!("render builtin:{scene} -o a.png --samples 1"));
        assert_eq!(warnings_of_pictures(&said), 0, "{said}");
    }
}

#[test]
fn no_command_replaces_a_file_that_it_reads() {
    let desk = Desk::new();
    desk.put_textured_model();
    // A model whose numbers are in a file of this name.
    let read = ["models/paper.png", "triangles.bin"];
    desk.write_gltf_triangle("t.gltf", "triangles.bin", r#""materials": [{}]"#);
    let before = read.map(|name| desk.bytes(name));
    for (line, name) in [
        ("render models/m.obj --target-error 1 -o models/../models/paper.png", "paper.png"),
        ("render models/m.obj --target-error 1 -o a.png --samples-map models/paper.png", "paper.png"),
        ("rays t.gltf --dump .", "triangles.bin"),
        ("merge models/paper.png -o ./models/paper.png", "paper.png"),
    ] {
        desk.refuses(line, &[name, "reads this file", "another name"]);
    }
    assert_eq!(read.map(|name| desk.bytes(name)), before);
    desk.run("render models/m.obj -o models/other.png --samples 1 --size 4x4");
}
