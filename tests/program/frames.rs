//! `octray render --frames`: pictures along the keyframes of a view.

use crate::desk::Desk;
use std::fs;

const KEYFRAMES: &str = r#"[ { "frame": 10, "camera": { "position": [0, 0, 5] } },
    { "frame": 12, "camera": { "position": [3, 1, 4], "vertical_fov": 30 } },
    { "frame": 20, "camera": { "position": [5, 0, 0], "look_at": [0, 0.2, 0] } } ]"#;

fn put_view(desk: &Desk, name: &str, more: &str) {
    desk.write(
        name,
        &format!(
            r#"{{ "format": "octray-view-1", "scene": "scene.json", "resolution": [40, 40], "render": {{ "samples": 2 }}{more} }}"#
        ),
    );
}

fn run(desk: &Desk, arguments: &str) {
    desk.octray(&arguments.split(' ').collect::<Vec<_>>()).assert().success();
}

#[test]
fn frames_follow_the_keyframes_in_any_shard() {
    let desk = Desk::new();
    put_view(&desk, "path.json", &format!(r#", "keyframes": {KEYFRAMES}"#));
    let report = desk
        .octray(&["render", "path.json", "-o", "a-###.exr", "--frames", "10..14", "--json"])
        .assert()
        .success();
    let said = String::from_utf8(report.get_output().stdout.clone()).unwrap();
    let frames: Vec<_> = serde_json::Deserializer::from_str(&said)
        .into_iter()
        .map(|report: Result<serde_json::Value, _>| {
            let report = report.unwrap();
            (report["frame"].as_u64().unwrap(), report["output"].as_str().unwrap().to_owned())
        })
        .collect();
    assert_eq!(frames.len(), 5, "a report a frame: {said}");
    assert_eq!(frames[4], (14, "a-014.exr".into()));
    let pixels = |name: &str| fs::read(desk.path(name)).unwrap();
    // A keyframe is a view of its own, with what it leaves out from the view.
    put_view(&desk, "key.json", r#", "camera": { "position": [3, 1, 4], "vertical_fov": 30 }"#);
    run(&desk, "render key.json -o key.exr");
    assert!(pixels("key.exr") == pixels("a-012.exr") && pixels("key.exr") != pixels("a-013.exr"));
    // Without --frames, the view's own camera.
    run(&desk, "render path.json -o own.exr");
    run(&desk, "render scene.json -o scene.exr --samples 2 --size 40x40");
    assert!(pixels("own.exr") == pixels("scene.exr"));
    for number in 1..=2 {
        run(
            &desk,
            &format!("render path.json -o b-###.exr --frames 10..14 --shard {number}/2 --checkpoint c-#"),
        );
    }
    // Again, from complete checkpoints; and a single one.
    run(&desk, "render path.json -o b-###.exr --frames 10..14 --checkpoint c-#");
    run(&desk, "render path.json -o single-#.exr --frames 11");
    for frame in 10..=14 {
        assert!(pixels(&format!("a-{frame:03}.exr")) == pixels(&format!("b-{frame:03}.exr")), "{frame}");
    }
    assert!(pixels("single-11.exr") == pixels("a-011.exr"));
}

#[test]
fn frames_that_cannot_be_are_refused_before_the_first() {
    let desk = Desk::new();
    put_view(&desk, "path.json", &format!(r#", "keyframes": {KEYFRAMES}"#));
    put_view(&desk, "still.json", "");
    put_view(
        &desk,
        "back.json",
        r#", "keyframes": [{ "frame": 2, "camera": {} }, { "frame": 2, "camera": {} }]"#,
    );
    // Half way, the camera is where it looks.
    let through = r#", "keyframes": [{ "frame": 0, "camera": { "position": [0, 0, 5] } }, { "frame": 2, "camera": { "position": [0, 0, -5] } }]"#;
    put_view(&desk, "through.json", through);
    for (arguments, words) in [
        ("path.json -o a-#.png --frames 9..12", &["--frames 9..12", "go from 10 to 20"][..]),
        (
            "path.json -o a-#.png --frames 12..10",
            &["'12..10' for '--frames", "the first frame is after the last", "A..B"],
        ),
        ("path.json -o a.png --frames 10..12", &["--output a.png", "shot-####.png"]),
        ("path.json -o a-#.png --frames 10..12 --checkpoint c.part", &["--checkpoint c.part", "#"]),
        ("path.json -o a-#.png --frames 10..12 --samples-map m.png", &["--samples-map m.png", "#"]),
        ("path.json -o a-#.png --frames 10..12 --shard 1/4", &["--shard 1/4", "3 frames"]),
        ("still.json -o a-#.png --frames 1..2", &["still.json", "no keyframes"]),
        ("scene.json -o a-#.png --frames 1..2", &["scene.json", "no keyframes"]),
        ("back.json -o a.png", &["keyframes[1].frame", "ascending"]),
        ("through.json -o a-#.png --frames 0..2", &["frame 1", "look_at"]),
    ] {
        desk.refuses(&format!("render {arguments}").split(' ').collect::<Vec<_>>(), words);
    }
}
