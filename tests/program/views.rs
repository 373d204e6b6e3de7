//! Views on the command line: their options, which options of the command line override.

use crate::desk::{Desk, SCENE, number};
use serde_json::{Value, json};

const CAMERA: &str = r#""camera": { "position": [0.7, 0.1, 5.3], "look_at": [0.1, 0.2, 0.3], "up": [0.1, 1, 0], "vertical_fov": 33.3 }"#;
const OPTIONS: &str = "--samples 3 --seed 4000000000 --exposure -0.7 --tone reinhard --clamp 0.61 --sphere naive \
    --triangle moller-trumbore --traversal linear --lights off --sampler random --pipeline general";
const RENDER: &str = r#""render": { "samples": 3, "seed": 4000000000, "exposure": -0.7, "tone": "reinhard", "clamp": 0.61,
    "sphere": "naive", "triangle": "moller-trumbore", "traversal": "linear", "lights": "off",
    "sampler": "random", "pipeline": "general" }"#;

fn view(scene: &str, more: &str) -> String {
    format!("{{\n  \"format\": \"octray-view-1\",\n  \"scene\": \"{scene}\",\n  {more}\n}}\n")
}

/// The desk's scene, seen by [`CAMERA`].
fn moved_scene() -> String {
    let start = SCENE.find(r#""camera""#).unwrap();
    let line = SCENE[start..].find(",\n").unwrap();
    SCENE.replace(&SCENE[start..start + line], CAMERA)
}

#[test]
fn view_renders_the_picture_of_the_same_options_by_hand() {
    let desk = Desk::new();
    let thesis = r#"{ "res": [8, 8], "sky": [1, 1, 1],
        "sphere": [ { "center": [0,0,0], "radius": 30, "color": [200, 99, 9], "roughness": 2000 } ] }"#;
    desk.write("thesis.json", thesis);
    for scene in ["scene.json", "thesis.json", "model.obj", "builtin:cornell"] {
        let rest = format!(r#""resolution": [13, 9], "max_bounces": 2, {RENDER}"#);
        desk.write("view.json", view(scene, &rest));
        let by_hand = format!("{scene} {OPTIONS} --size 13x9 --bounces 2");
        let plain = desk.rendered(&format!("{scene} --size 13x9"), "plain.png");
        for file in ["a.png", "a.exr"] {
            let of_view = desk.rendered("view.json", file);
            assert!(of_view == desk.rendered(&by_hand, file), "{scene}: {file} differs");
            assert!(of_view != plain, "{scene}: nothing that the view says shows");
        }
    }
    // No option places a camera: the scene's own file does.
    desk.write("moved.json", moved_scene());
    desk.write("shots/view.json", view("../scene.json", CAMERA));
    let [moved, of_view, plain] = ["moved.json", "shots/view.json", "scene.json"]
        .map(|scene| desk.rendered(&format!("{scene} --samples 2 --size 24x16"), "a.exr"));
    assert!(moved == of_view && moved != plain);
}

#[test]
fn options_win_over_the_view() {
    let desk = Desk::new();
    desk.write("view.json", view("builtin:cornell", &format!(r#""resolution": [13, 9], {RENDER}"#)));
    let report = |options: &str| desk.json(&format!("render view.json -o a.png {options}"));
    let figures =
        |report: &Value| ["samples", "seed", "width", "max_bounces"].map(|key| report[key].as_u64().unwrap());
    let of_view = report("");
    assert_eq!(figures(&of_view), [3, 4_000_000_000, 13, 4]);
    assert!((number(&of_view["clamp"]) - 0.61).abs() < 1e-7);
    // Options that change no bit are in the settings.
    let ways = ["traversal", "pipeline"].map(|key| &of_view["settings"][key]);
    assert_eq!(ways, ["linear", "general"], "{of_view}");
    let given = report("--samples 2 --seed 7 --clamp 5 --size 8x8 --bounces 1");
    assert_eq!((figures(&given), &given["clamp"]), ([2, 7, 8, 1], &json!(5.0)));
    // The view's three samples do not end what another limit is to end.
    let most = report("--target-error 0.9 --time-limit 60");
    assert!(number(&most["samples"]) >= 16.0, "{most}");
    // All of it overruled is the scene itself.
    let all = "--samples 64 --seed 0 --exposure 0 --tone clamp --clamp 1e30 --sphere robust --triangle woop --traversal auto --lights auto \
               --sampler sobol --pipeline auto";
    let overruled = desk.rendered(&format!("view.json {all}"), "a.png");
    assert!(overruled == desk.rendered("builtin:cornell --size 13x9", "b.png"));
}

#[test]
fn what_a_view_asks_for_and_does_not_exist_is_refused_by_every_command() {
    let desk = Desk::new();
    for (key, value, words) in [
        ("tone", "\"sepia\"", ["`tone` cannot be `sepia`", "clamp, reinhard, aces"]),
        ("traversal", "\"fast\"", ["`traversal`", "auto, linear, scalar"]),
        ("samples", "0", ["`samples` cannot be 0", "from 1 to 16,777,216"]),
        ("exposure", "65", ["`exposure` cannot be 65", "from -64 to 64"]),
        ("clamp", "-0.5", ["`clamp` cannot be -0.5", "above 0"]),
    ] {
        desk.write(
            "view.json",
            view("scene.json", &format!(r#""render": {{ "seed": 1, "{key}": {value} }}"#)),
        );
        let key = format!("render.{key},");
        let words = [&words[..], &["view.json: ", "line 4, column ", &key]].concat();
        for command in ["inspect", "render -o a.png --clamp 5", "compare scene.json", "bench", "rays"] {
            desk.refuses(&format!("{command} view.json"), &words);
        }
    }
}

#[test]
fn inspect_says_that_a_scene_is_a_view_of_another() {
    let desk = Desk::new();
    desk.write("shots/view.json", view("../scene.json", &format!("{CAMERA}, {RENDER}")));
    let report = desk.json("inspect shots/view.json");
    assert_eq!(report["view"]["of"], "../scene.json");
    assert_eq!(report["view"]["render"]["tone"], "reinhard");
    assert_eq!((&report["name"], &report["spheres"]), (&json!("view.json"), &json!(1)));
    let said = desk.run("inspect shots/view.json");
    assert!(said.contains("\nview of     ../scene.json\nrender      --"), "{said}");
    assert!(said.contains(" --exposure -0.7 ") && said.contains("field of view 33.3°"), "{said}");
    assert_eq!(desk.json("inspect scene.json")["view"], Value::Null);
}

#[test]
fn a_views_tone_is_no_mistake_where_a_format_has_none() {
    let desk = Desk::new();
    let render = r#""render": { "samples": 1, "exposure": 2, "tone": "aces" }"#;
    desk.write("view.json", view("scene.json", render));
    assert!(!desk.warnings("render view.json -o a.exr").contains("no effect"));
    assert!(desk.warnings("render view.json -o a.exr --tone aces").contains("no effect on a.exr"));
}

#[test]
fn other_commands_take_a_views_camera_and_none_of_its_options() {
    let desk = Desk::new();
    desk.write("moved.json", moved_scene());
    desk.write("view.json", view("scene.json", &format!("{CAMERA}, {RENDER}")));
    let rays = |scene: &str| {
        let report = desk.json(&format!("bench {scene} --frames 1 --size 64x64"));
        report["results"][0]["rays_per_frame"].clone()
    };
    // Another camera, seed or sampler would trace other paths, and other numbers of rays.
    assert_eq!(rays("view.json"), rays("moved.json"));
    assert_ne!(rays("view.json"), rays("scene.json"));
}
