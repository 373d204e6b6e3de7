//! `octray convert`: from a model to a scene file that shows the same.

use crate::desk::{Desk, SCENE};
use predicates::str::contains;
use std::fs;

#[test]
fn convert_writes_a_scene_and_keeps_what_is_there() {
    let desk = Desk::new();
    desk.octray(&["convert", "model.obj", "new.json"]).assert().success().stdout(contains("new.json"));
    let written = fs::read_to_string(desk.path("new.json")).unwrap();
    serde_json::from_str::<serde_json::Value>(&written).unwrap();

    desk.refuses(&["convert", "model.obj", "scene.json"], &["scene.json", "exists", "--force"]);
    assert_eq!(fs::read_to_string(desk.path("scene.json")).unwrap(), SCENE);
    desk.octray(&["convert", "model.obj", "scene.json", "--force"]).assert().success();
    assert_eq!(fs::read_to_string(desk.path("scene.json")).unwrap(), written);
    assert_eq!(desk.names(), ["model.obj", "new.json", "scene.json"]);
}

#[test]
fn converted_models_render_the_same_wherever_the_scene_file_stands() {
    let desk = Desk::new();
    desk.put_textured_model();
    fs::create_dir_all(desk.path("scenes/deep")).unwrap();
    let model = desk.render_small("models/m.obj");
    for scene in [
        "models/m.json",
        "m.json",
        "./scenes/m.json",
        "scenes/deep/m.json",
        "scenes/../beside.json",
        "scenes/deep/../../models/../scenes/around.json",
    ] {
        desk.octray(&["convert", "models/m.obj", scene]).assert().success().stderr("");
        assert_eq!(desk.json(&["inspect", scene, "--json"])["materials"]["textured"], 1, "{scene}");
        assert_eq!(desk.render_small(scene), model, "{scene}");
    }
    // The scene file stands alone: only the texture is still needed.
    fs::remove_file(desk.path("models/m.obj")).unwrap();
    fs::remove_file(desk.path("models/m.mtl")).unwrap();
    assert_eq!(desk.render_small("scenes/deep/m.json"), model);
}

#[test]
fn convert_says_what_of_a_model_it_leaves_out() {
    let desk = Desk::new();
    desk.write("odd.mtl", "newmtl a\nKd 1 1 1\nd 0.5\n");
    desk.write("odd.obj", "mtllib odd.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    let said = desk.warnings(&["convert", "odd.obj", "odd.json"]);
    assert!(said.contains("odd.mtl"), "{said}");
    let of_compare = desk.warnings(&["compare", "odd.obj", "--samples", "1", "--size", "4x4"]);
    // A plain build also says so there.
    assert!(of_compare.ends_with(&said), "{of_compare}");
}

#[test]
fn convert_refuses_names_that_no_command_would_read() {
    let desk = Desk::new();
    desk.write("model.stl", "solid\n");
    for (model, scene, words) in [
        (
            "model.obj",
            "new.txt",
            &["`new.txt` would not be read as a scene", "end in .json", "write to new.json"][..],
        ),
        ("model.obj", "new", &["write to new.json"]),
        (
            "model.stl",
            "new.json",
            &["error: `model.stl` is not an .obj file\n", "export the model as Wavefront OBJ"],
        ),
        ("scene.json", "new.json", &["`scene.json` is a scene already", "octray render scene.json"]),
        ("scene.json", "model.obj", &["the model comes first: octray convert model.obj scene.json"]),
        ("builtin:three", "new.json", &["a scene already"]),
    ] {
        desk.refuses(&["convert", model, scene], words);
    }
    desk.write("LOUD.OBJ", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    desk.octray(&["convert", "LOUD.OBJ", "LOUD.JSON"]).assert().success();
    desk.render_small("LOUD.JSON");
}
