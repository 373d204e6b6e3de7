//! `octray render --frames`: pictures along the keyframes of a view.

use crate::desk::Desk;
use serde_json::{Value, json};

const KEYFRAMES: &str = r#"[ { "frame": 10, "camera": { "position": [0, 0, 5] } },
    { "frame": 12, "camera": { "position": [3, 1, 4], "vertical_fov": 30 } },
    { "frame": 20, "camera": { "position": [5, 0, 0], "look_at": [0, 0.2, 0] } } ]"#;

fn put_view(desk: &Desk, name: &str, more: &str) {
    let base = r#""format": "octray-view-1", "scene": "scene.json", "resolution": [40, 40]"#;
    desk.write(name, format!(r#"{{ {base}, "render": {{ "samples": 2 }}{more} }}"#));
}

#[test]
fn frames_follow_the_keyframes_in_any_shard() {
    let desk = Desk::new();
    put_view(&desk, "path.json", &format!(r#", "keyframes": {KEYFRAMES}"#));
    let said = desk.run("render path.json -o a-###.exr --frames 10..14 --json");
    let reports = serde_json::Deserializer::from_str(&said).into_iter::<Value>();
    let reports: Vec<_> = reports.map(Result::unwrap).collect();
    assert_eq!(reports.len(), 5, "a report a frame: {said}");
    assert_eq!(json!([reports[4]["frame"], reports[4]["output"]]), json!([14, "a-014.exr"]));
    let pixels = |name: &str| desk.bytes(name);
    // A keyframe is a view of its own, with what it leaves out from the view.
    put_view(&desk, "key.json", r#", "camera": { "position": [3, 1, 4], "vertical_fov": 30 }"#);
    let key = desk.rendered(&format!("key.json --seed {}", reports[2]["seed"]), "key.exr");
    assert!(key == pixels("a-012.exr") && key != pixels("a-013.exr"));
    // Without --frames, the view's own camera is used.
    let own = desk.rendered("path.json", "own.exr");
    assert!(own == desk.rendered("scene.json --samples 2 --size 40x40", "scene.exr"));
    // Frames of a camera that stands have noise of their own, that of frame 0 being a still's.
    let stands = r#", "keyframes": [{ "frame": 0, "camera": {} }, { "frame": 9, "camera": {} }]"#;
    put_view(&desk, "stands.json", stands);
    desk.run("render stands.json -o s-#.exr --frames 0..1");
    assert!(own == pixels("s-0.exr") && own != pixels("s-1.exr"));
    // Renders in shards; again, from complete checkpoints; and a single frame.
    for shard in ["--shard 1/2", "--shard 2/2", ""] {
        desk.run(&format!("render path.json -o b-###.exr --frames 10..14 {shard} --checkpoint c-#"));
    }
    desk.run("render path.json -o single-#.exr --frames 11");
    let said = desk.octray("render path.json -o still.exr").assert().success();
    assert!(String::from_utf8_lossy(&said.get_output().stderr).contains("add --frames 10..20 to render its"));
    for frame in 10..=14 {
        assert!(pixels(&format!("a-{frame:03}.exr")) == pixels(&format!("b-{frame:03}.exr")), "{frame}");
    }
    assert!(pixels("single-11.exr") == pixels("a-011.exr"));
}

#[test]
fn frames_that_cannot_be_are_refused_before_the_first() {
    let desk = Desk::new();
    // Half way, the camera is where it looks.
    let key = |frame, z| format!(r#"{{ "frame": {frame}, "camera": {{ "position": [0, 0, {z}] }} }}"#);
    put_view(&desk, "path.json", &format!(r#", "keyframes": [{}, {}]"#, key(0, 5), key(2, -5)));
    for (arguments, words) in [
        ("-o a-#.png --frames 2..3", ["--frames 2..3", "go from 0 to 2"]),
        ("-o a-#.png --frames 0..2", ["frame 1", "look_at"]),
        ("-o a.png --frames 0..2", ["--output a.png", "shot-####.png"]),
        ("-o a-#.png --frames 0..2 --shard 1/4", ["--shard 1/4", "3 frames"]),
        ("-o a-#.png", ["--output a-#.png", "add --frames 0..2, or"]),
    ] {
        desk.refuses(&format!("render path.json {arguments}"), &words);
    }
}
