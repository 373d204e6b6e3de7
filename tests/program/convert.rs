//! `octray convert`: from a model to a scene file that shows the same.

use crate::desk::{Desk, SCENE};
use std::fs;

#[test]
fn convert_writes_a_scene_and_keeps_what_is_there() {
    let desk = Desk::new();
    assert!(desk.run("convert model.obj new.json").contains("new.json"));
    let written = desk.text("new.json");
    serde_json::from_str::<serde_json::Value>(&written).unwrap();

    desk.refuses("convert model.obj scene.json", &["scene.json", "exists", "--force"]);
    assert_eq!(desk.text("scene.json"), SCENE);
    desk.run("convert model.obj scene.json --force");
    assert_eq!(desk.text("scene.json"), written);
    assert_eq!(desk.names(), ["model.obj", "new.json", "scene.json"]);
    desk.run("convert model.obj -o option.json");
    assert_eq!(desk.text("option.json"), written, "the scene file as an option");
    fs::rename(desk.path("model.obj"), desk.path("LOUD.OBJ")).unwrap();
    desk.run("convert LOUD.OBJ LOUD.JSON");
    assert_eq!(desk.text("LOUD.JSON"), written);
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
        assert_eq!(desk.warnings(&format!("convert models/m.obj {scene}")), "");
        assert_eq!(desk.json(&format!("inspect {scene}"))["materials"]["textured"], 1, "{scene}");
        assert_eq!(desk.render_small(scene), model, "{scene}");
    }
    // The scene file stands alone: only the texture is still needed.
    fs::remove_file(desk.path("models/m.obj")).unwrap();
    fs::remove_file(desk.path("models/m.mtl")).unwrap();
    assert_eq!(desk.render_small("scenes/deep/m.json"), model);
}

#[test]
fn models_of_every_format_are_read_by_every_command() {
    let desk = Desk::new();
    let shining = r#""emissiveFactor": [0.5, 0.25, 1], "pbrMetallicRoughness": { "metallicFactor": 0.5 }"#;
    desk.write_gltf_triangle("t.gltf", "t.bin", &format!(r#""materials": [{{ {shining} }}]"#));
    desk.write(
        "t.ply",
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nelement face 1\n\
         property list uchar int vertex_indices\nend_header\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n3 0 1 2\n",
    );
    // Vertex colours add a variant of the material.
    for (model, kind, count) in [("t.gltf", "metal-rough", 1), ("t.ply", "diffuse", 2)] {
        let shown = desk.render_small(model);
        assert!(shown.iter().any(|pixel| *pixel != shown[0]), "{model}");
        assert_eq!(desk.warnings(&format!("convert {model} t.json --force")), "");
        assert_eq!(desk.render_small("t.json"), shown, "{model}");
        let placed = format!(r#"{{ "format": "octray-1", "meshes": [{{ "model": "{model}" }}] }}"#);
        desk.write("placed.json", &placed);
        assert_eq!(desk.json("inspect placed.json")["materials"][kind], count, "{model}");
        desk.json(&format!("rays {model} --size 8x8 --passes 1"));
    }
}

#[test]
fn convert_says_what_of_a_model_it_leaves_out() {
    let desk = Desk::new();
    desk.write("odd.mtl", "newmtl a\nKd 1 1 1\nillum 10\n");
    desk.write("odd.obj", "mtllib odd.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n");
    let said = desk.warnings("convert odd.obj odd.json");
    assert!(said.contains("odd.mtl"), "{said}");
    let of_compare = desk.warnings("compare odd.obj --samples 1 --size 4x4");
    // A plain build and a busy machine also say so there.
    assert!(of_compare.contains(&said), "{of_compare}");
}
