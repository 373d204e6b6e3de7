//! Scenes on the command line: files, models, built-in ones, faults in them, and the report of `inspect`.

use crate::desk::{Desk, SCENE, assert_has, list, number};
use crate::skipped::mesh;
use octray::rays::bvh::LEAF;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::{Value, json};

#[test]
fn inspect_shows_what_a_scene_holds() {
    let desk = Desk::new();
    let shown = desk.octray("inspect scene.json").assert().success().stderr("");
    shown.stdout(contains("spheres     1\n").and(contains("(-1, -1, -1) to (1, 1, 1)")));
    let report = desk.json("inspect scene.json");
    let expected = json!({
        "schema": "octray-inspect-1", "scene": "scene.json", "spheres": 1, "triangles": 0,
        "materials": { "diffuse": 1 }, "resolution": [8, 8], "bounds": { "upper": [1.0, 1.0, 1.0] },
        "warnings": []
    });
    assert_has(&report, &expected);
}

/// A textured triangle under a gradient.
const GRADIENT: &str = r#"{
  "format": "octray-1",
  "sky": { "gradient": { "bottom": [0.25, 0.5, 1], "top": [1, 0.5, 0.25] } },
  "materials": { "paper": { "type": "diffuse", "texture": "models/paper.png", "filter": "nearest" } },
  "triangles": [
    { "vertices": [[0,0,0],[1,0,0],[0,1,0]], "uvs": [[0,0],[1,0],[0,1]], "material": "paper" }
  ]
}"#;

#[test]
fn scene_warnings_reach_standard_error() {
    let desk = Desk::new();
    desk.write("dark.json", SCENE.replace("[0.5, 0.7, 1.0]", "[0, 0, 0]"));
    for command in
        ["render -o a.png --samples 1", "bench --frames 1 --size 8x8", "compare --samples 1 --size 8x8"]
    {
        let said = desk.warnings(&format!("{command} dark.json"));
        assert!(said.contains("warning: Nothing in the scene emits light"), "{command}: {said}");
    }
    let report = desk.json("inspect dark.json");
    assert!(report["warnings"][0].as_str().unwrap().starts_with("Nothing in the scene emits light"));
}

#[test]
fn faults_in_a_scene_are_refused_with_file_and_json_path() {
    let desk = Desk::new();
    for (right, wrong, place) in [
        (r#""radius": 1"#, r#""radius": -1"#, "spheres[0].radius"),
        (r#""vertical_fov": 40"#, r#""vertical_fov": "wide""#, "camera.vertical_fov"),
    ] {
        assert!(SCENE.contains(right), "{right}");
        desk.write("bad.json", SCENE.replace(right, wrong));
        desk.refuses("inspect bad.json", &["bad.json", place]);
    }
    // The last of them, before a good scene is measured.
    for command in ["render -o a.png", "compare scene.json", "bench scene.json --json"] {
        desk.refuses(&format!("{command} bad.json"), &["bad.json", "camera.vertical_fov"]);
    }
}

#[test]
fn inspect_reports_textures_gradient_and_needs() {
    let desk = Desk::new();
    desk.put_textured_model();
    desk.write("gradient.json", GRADIENT);
    let report = desk.json("inspect gradient.json");
    let texture = json!({
        "name": "models/paper.png", "width": 2, "height": 2, "filter": "nearest",
        "wrap": ["repeat", "repeat"], "memory_bytes": 16
    });
    let expected = json!({
        "sky": { "type": "gradient", "bottom": [0.25, 0.5, 1.0], "top": [1.0, 0.5, 0.25] },
        "textures": [texture], "materials": { "textured": 1 },
        "needs": ["triangles", "diffuse", "textures", "sky-gradient"]
    });
    assert_has(&report, &expected);
    // A level more, of one texel.
    desk.write("levels.json", GRADIENT.replace("nearest", "trilinear"));
    let said = inspected(&desk, "levels.json");
    for words in [
        "models/paper.png: 2×2, trilinear, 20 B",
        "bilinear, sky-gradient, levels-of-detail\n",
        "(0.25, 0.5, 1) below to (1, 0.5, 0.25) above",
    ] {
        assert!(said.contains(words), "{words} is not in {said}");
    }
}

/// Returns the text of `inspect --why`, a fact a line: on the terminal, long facts take several lines.
fn inspected(desk: &Desk, scene: &str) -> String {
    let said = desk.run(&format!("inspect {scene} --why"));
    assert!(said.lines().all(|line| line.chars().count() <= 100), "{said}");
    said.replace(&format!("\n{:12}", ""), " ")
}

#[test]
fn inspect_shows_which_way_rays_go_and_why() {
    let desk = Desk::new();
    let balls = |count: usize| {
        let ball = |x: usize| json!({ "center": [3 * x, 0, 0], "radius": 1 });
        json!({ "format": "octray-1", "spheres": (0..count).map(ball).collect::<Vec<_>>() }).to_string()
    };
    desk.write("few.json", balls(240));
    desk.write("many.json", balls(241));
    for (scene, cost, way) in [
        ("scene.json", 1, "linear"),
        ("model.obj", 6, "linear"),
        ("builtin:cornell", 192, "linear"),
        ("few.json", 240, "linear"),
        ("many.json", 241, "hybrid"),
        ("builtin:knot:2000", 12_000, "hybrid"),
    ] {
        let report = desk.json(&format!("inspect {scene}"));
        let mut traversal = report["traversal"].clone();
        let found = traversal["linear_cost"].take().as_u64().unwrap();
        assert!(found.abs_diff(cost) <= cost / 50, "{scene}: {found}");
        let expected =
            json!({ "primary": way, "bounces": way, "linear_cost": null, "most_linear_cost": 240 });
        assert_eq!(traversal, expected, "{scene}");
        assert_eq!(report["hierarchy"].is_null(), way == "linear", "{scene}");
        assert_eq!(list(&report["needs"]).contains(&json!("hierarchy")), way != "linear");
    }
    let said = inspected(&desk, "scene.json");
    assert!(said.contains("cost a ray 1 (1 a sphere, 6 a triangle); up to 240, that is faster"), "{said}");
    let short = desk.run("inspect scene.json");
    assert!(short.contains("\ntraversal") && !short.contains("\nwhy"), "{short}");
}

#[test]
fn inspect_shows_the_hierarchy_that_rays_go_through() {
    let desk = Desk::new();
    let report = desk.json("inspect builtin:knot:2000");
    let (hierarchy, triangles) = (&report["hierarchy"], number(&report["triangles"]));
    assert_eq!(hierarchy["fault"], Value::Null);
    let build = &hierarchy["build"];
    assert!(number(&build["ms"]) > 0.0 && number(&build["threads"]) >= 1.0, "{hierarchy}");
    let [bytes, each] = ["bytes", "bytes_per_primitive"].map(|key| number(&hierarchy[key]));
    assert!((each * triangles - bytes).abs() < 1.0 && each > 36.0, "{hierarchy}");
    let [nodes, leaves, levels] = ["wide_nodes", "leaves", "wide_depth"].map(|key| &hierarchy["tree"][key]);
    assert!(number(leaves) >= triangles / LEAF as f64, "{hierarchy}");
    // `rays` counts the same.
    let rays = desk.json("rays builtin:knot:2000 --size 8x8 --passes 1 --threads 1");
    assert_eq!((&rays["tree"], &rays["bvh_bytes"]), (&hierarchy["tree"], &hierarchy["bytes"]));

    let said = inspected(&desk, "builtin:knot:2000");
    for words in [
        "above 240, a hierarchy is faster",
        &format!("hierarchy   {nodes} nodes of "),
        &format!(" boxes in {levels} levels, {leaves} leaves of "),
        &format!(", {each:.0} bytes a primitive; built in "),
    ] {
        assert!(said.contains(words), "{words} is not in {said}");
    }
}

#[test]
fn meshes_beside_the_project_render() {
    let desk = Desk::new();
    for name in ["bunny.obj", "dragon-48k.obj"] {
        let Some(mesh) = mesh(name) else { continue };
        desk.render_small(mesh.to_str().unwrap());
    }
}

/// Names of files are bytes.
#[cfg(target_os = "linux")]
#[test]
fn files_whose_names_are_not_utf_8_are_scenes_too() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let desk = Desk::new();
    let name = OsStr::from_bytes(b"gr\xfcn.obj");
    std::fs::write(desk.path("").join(name), "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        .unwrap();
    for arguments in [["inspect"].as_slice(), &["compare", "--samples", "1", "--size", "8x8"]] {
        let mut command = desk.octray(&arguments.join(" "));
        command.arg(name).assert().success().stdout(contains("gr\u{fffd}n.obj"));
    }
    let refused = desk.octray("render -o x.png").arg(OsStr::from_bytes(b"\xfc.obj")).assert().code(2);
    refused.stderr(contains("cannot read the scene: no such file\n  in \u{fffd}.obj"));
}
