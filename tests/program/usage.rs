//! Help, and refusals: wrong arguments, numbers out of range, outputs that cannot be written.

use crate::desk::{Desk, SCENE, assert_has};
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::json;
use std::fs;

const COMMANDS: [&str; 10] =
    ["bench", "compare", "render", "merge", "rays", "chart", "stability", "convert", "inspect", "methods"];

#[test]
fn octray_alone_says_what_to_try() {
    let desk = Desk::new();
    assert_eq!(desk.warnings(""), "");
    let said = desk.run("");
    for command in COMMANDS {
        assert!(said.contains(&format!("octray {command}")), "{command} is not in: {said}");
    }
}

#[test]
fn help_explains_every_command_with_an_example() {
    let desk = Desk::new();
    desk.octray("--help").assert().success().stdout(contains("Exit codes")).stderr("");
    assert!(desk.run("--version").contains(env!("CARGO_PKG_VERSION")));
    for command in COMMANDS.into_iter().chain(cfg!(feature = "viewer").then_some("view")) {
        let example = contains("Example").and(contains(format!("\n  octray {command} ")));
        let help = contains("Usage: octray").and(example);
        desk.octray(&format!("{command} --help")).assert().success().stderr("").stdout(help);
        let said = |line: String| {
            let mut octray = desk.octray(&line);
            let said = octray.env("COLUMNS", "80").assert().success().get_output().stdout.clone();
            String::from_utf8(said).unwrap()
        };
        let [short, long] = ["-h", "--help"].map(|option| said(format!("{command} {option}")));
        let lines = [&short, &long].map(|text| text.lines().count());
        assert!(lines[0] <= 40 && lines[1] <= 130, "{command}: {lines:?} lines; less help is read more");
        assert_eq!(said(format!("help -h {command}")), long);
    }
    assert_eq!(desk.run("help help"), desk.run("--help"));
}

#[test]
fn methods_have_a_sentence_each() {
    let desk = Desk::new();
    let said = desk.run("methods");
    assert!(said.contains("  woop *") && said.contains("  moller-trumbore  The classic"), "{said}");
    let report = desk.json("methods");
    assert_eq!(report["schema"], "octray-methods-1");
    let first = json!({ "option": "sphere", "name": "robust", "default": true });
    assert_has(&report["methods"][0], &first);
}

/// A line for each kind of message.
#[test]
fn what_cannot_be_done_is_refused_with_what_to_do_instead() {
    let desk = Desk::new();
    fs::create_dir(desk.path("folder.png")).unwrap();
    desk.write("model.stl", "solid\n");
    // Too small for where it stands: every camera's position is rounded to what it looks at.
    let speck = r#""center": [1000000, 0, 1000000], "radius": 0.001"#;
    desk.write("speck.json", SCENE.replace(r#""center": [0, 0, 0], "radius": 1"#, speck));
    let picture = "render scene.json -o a.png";
    for (line, words) in [
        ("rendr", &["rendr"][..]),
        ("help rendr", &["rendr"]),
        ("render scene.json", &["--output"]),
        ("render scene.json -o a.png b.png", &["b.png"]),
        ("bench --triangle exact", &["moller-trumbore"]),
        ("compare --lanes 8", &["--lanes"]),
        ("stability --only spheres-fa", &["spheres-far"]),
        ("convert", &["<MODEL> <SCENE.json>"]),
        ("convert model.obj a.json -o b.json", &["--output"]),
        ("--json inspect scene.json", &["inspect --json"]),
        ("bench scene.json --as-scene --size 8x8", &["--as-scene", "--size"]),
        // Values of options.
        ("PICTURE --frames 12..10", &["'12..10' for '--frames", "is after the last", "A..B"]),
        ("PICTURE --shard 9/8", &["'9/8' for '--shard", "3/8"]),
        ("inspect scene.json --pixel 3", &["--pixel", "X,Y"]),
        ("inspect scene.json --pixel 8,0 --as-scene", &["--pixel 8,0", "0,0 to 7,7"]),
        ("chart scene.json -o c --size 64x36", &["--size", "66x36", "third"]),
        ("rays scene.json --size 4096x4096", &["at most 8,388,608 pixels"]),
        // Options that do not go together.
        ("PICTURE --min-samples 16", &["--target-error"]),
        ("PICTURE --target-error 0.1 --samples 8 --min-samples 9", &["from 4 to 8"]),
        ("PICTURE --samples-map ./a.png", &["--samples-map ./a.png", "give another file"]),
        ("PICTURE --shard 1/2", &["--output a.png", "octray merge", ".part"]),
        ("render scene.json -o 1.part --shard 1/2 --target-error 0.1", &["--target-error", "--samples"]),
        ("render scene.json -o 1.part --shard 1/2 --time-limit 9", &["--time-limit", "--samples"]),
        ("render scene.json -o 1.part --shard 1/2 --size 16x16", &["the picture has 1 tile"]),
        // Scenes.
        ("bench scene.json nothing.json", &["nothing.json", "no such file"]),
        ("render builtin:Three -o a.png", &["builtin:three"]),
        ("inspect three", &["did you mean `builtin:three`?"]),
        ("rays builtin:knot:1", &["`builtin:knot:1`: 1 is out of range", "from 2 to 4,000,000"]),
        ("rays speck.json", &["no camera can stand beside it"]),
        ("render scene.json -o a-#.png --frames 1..2", &["scene.json", "no keyframes"]),
        // Outputs, which are looked at before the scene.
        ("render nowhere.json -o picture.gif", &["picture.gif", ".png", ".jpg", ".exr", ".hdr"]),
        ("render nowhere.json -o no/such/picture.png", &["no/such", "does not exist", "mkdir -p"]),
        ("render nowhere.json -o scene.json/picture.png", &["scene.json", "not a folder"]),
        ("render nowhere.json -o folder.png", &["folder.png", "is a folder"]),
        ("rays nowhere.json --dump folder", &["nowhere.json"]),
        ("convert model.obj new.txt", &["would not be read as a scene", "write to new.json"]),
        ("convert model.stl new.json", &["`model.stl` is not a model\n", "export the model as"]),
        ("convert scene.json model.obj", &["the model comes first: octray convert model.obj scene.json"]),
    ] {
        desk.refuses(&line.replace("PICTURE", picture), words);
    }
    assert!(!desk.refuses("bench --frobnicate", &["--frobnicate"]).contains("tip:"));
}

#[test]
fn numbers_out_of_range_are_refused_with_their_range() {
    let desk = Desk::new();
    let huge = "99999999999999999999999999";
    for (option, values, range) in [
        ("--samples", &["0", "-1", "16777217", huge, "1.5", ""][..], "from 1 to 16,777,216"),
        ("--bounces", &["-1", "1025"], "from 0 to 1,024"),
        ("--seed", &["-1", "4294967296"], "from 0 to 4,294,967,295"),
        ("--threads", &["0", "1025", "all"], "from 1 to 1,024"),
        ("--lanes", &["0", "2", "all"], "auto, 1, 8, 16"),
        ("--exposure", &["nan", "-65", "1e39"], "from -64 to 64"),
        ("--clamp", &["0", "nan", "inf"], "above 0"),
        ("--size", &["0x8", "8x0", "16385x1", "8", "-8x8", "8 x 8", "8x8x8", ""], "from 1 to 16,384"),
        ("--target-error", &["0", "nan", "5%", "1.5"], "from 0.0001 to 1, such as 0.05"),
        ("--time-limit", &["0", "-1", "inf", "10s", "1e9"], "seconds from 0.001 to 31536000"),
    ] {
        for value in values {
            let arguments = ["render", "scene.json", "-o", "a.png", option, value];
            desk.refuses_with(&arguments, &[option, value, range]);
        }
    }
    desk.refuses("bench scene.json --frames 0", &["--frames", "from 1 to"]);
    desk.refuses("rays scene.json --passes 0", &["--passes", "from 1 to"]);
    desk.refuses("chart scene.json -o c --seeds 7", &["--seeds", "8"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_refused_with_the_systems_reason() {
    let desk = Desk::new();
    let line = "render scene.json -o /proc/picture.png";
    let said = desk.refuses(line, &["cannot write in the folder", "because: "]);
    assert!(!said.contains(".tmp"), "a file that nobody asked for is named: {said}");
}
