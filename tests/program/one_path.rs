//! `octray inspect --pixel`: one path, vertex by vertex.

use crate::desk::{Desk, SCENE, assert_fits, list, number};
use serde_json::{Value, json};

#[test]
fn a_path_is_shown_from_the_camera_to_the_sky() {
    let desk = Desk::new();
    let said = desk.run("inspect scene.json --pixel 4,3 --as-scene");
    assert_fits(&said);
    for words in ["vertex 0: spheres[0], `clay` (diffuse), reflection\n", "vertex 1: the environment\n"] {
        assert!(said.contains(words) && !said.contains("part here"), "{words} is not in {said}");
    }
    let report = desk.json("inspect scene.json --pixel 4,3 --size 8x8 --sample 5 --seed 9 --lights off");
    assert_eq!((&report["schema"], &report["sample"]), (&json!("octray-path-1"), &json!(5)));
    assert_eq!((&report["part_at"], &report["settings"]["seed"]), (&Value::Null, &json!(9)));
    for precision in ["f64", "f32"] {
        let [ball, sky] = list(&report[precision]) else { panic!("not two vertices: {report}") };
        assert_eq!((&ball["primitive"], &sky["primitive"]), (&json!(0), &Value::Null));
        // A unit sphere from five units away; colour times sky.
        assert!((4.0..4.1).contains(&number(&ball["distance"])), "{ball}");
        for (channel, expected) in list(&sky["radiance"]).iter().zip([0.8 * 0.5, 0.5 * 0.7, 0.3]) {
            assert!((number(channel) - expected).abs() < 1e-7, "{precision}: {sky}");
        }
    }
    let said = desk.run("inspect builtin:cornell --pixel 60,90 --lights on");
    assert!(said.contains("\n+ light  ") && said.contains("\n= radiance "), "{said}");
    assert_fits(&said);

    // The reason that `render` prints for a black picture; a pixel that is not black has none.
    let told = |line: &str| desk.warnings(line).contains("black: the camera is inside spheres[0]");
    desk.write("inside.json", SCENE.replace("[0, 0, 5]", "[0, 0, 0.5]"));
    assert!(
        told("inspect inside.json --pixel 4,3") && told("inspect inside.json --pixel 4,3 --size 3000x2000")
    );
    assert!(!told("inspect scene.json --pixel 4,3 --as-scene"));

    desk.refuses("inspect scene.json --sampler random", &["--pixel"]);
}
