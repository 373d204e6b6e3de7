//! Help, and what is refused: wrong arguments, numbers out of range, outputs that cannot be written.

use crate::desk::Desk;
use predicates::prelude::*;
use predicates::str::contains;
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
        for line in [format!("help {command}"), format!("help {command} -h"), format!("help -h {command}")] {
            assert_eq!(said(line), long);
        }
    }
    let whole = desk.run("--help");
    assert!(["help", "help -h", "help --help", "help help"].iter().all(|line| desk.run(line) == whole));
    desk.refuses("help rendr", &["rendr"]);
    desk.octray("render --help").assert().stdout(contains("Ctrl-C").and(contains("130")));
}

#[test]
fn methods_have_a_sentence_each() {
    let desk = Desk::new();
    let said = desk.run("methods");
    for words in ["--triangle: ray-triangle", "  woop *", "  moller-trumbore  The classic", "  padded-sobol "]
    {
        assert!(said.contains(words), "{words} is not in: {said}");
    }
    let report = desk.json("methods");
    assert_eq!(
        (&report["schema"], &report["methods"][0]["option"]),
        (&"octray-methods-1".into(), &"sphere".into())
    );
    assert_eq!(report["methods"][0]["default"], true);
}

#[test]
fn wrong_usage_is_refused() {
    let desk = Desk::new();
    for (line, word) in [
        ("rendr", "rendr"),
        ("--frobnicate", "--frobnicate"),
        ("render", "SCENE"),
        ("render scene.json", "--output"),
        ("render scene.json -o", "--output"),
        ("render scene.json -o a.png b.png", "b.png"),
        ("render scene.json -o a.png --tone sepia", "reinhard"),
        ("render scene.json -o a.png --sphere exact", "robust"),
        ("render scene.json -o a.png --triangle exact", "moller-trumbore"),
        ("bench --triangle exact", "moller-trumbore"),
        ("bench --pipeline special", "general"),
        ("compare --lanes 8", "--lanes"),
        ("stability --only spheres-fa", "spheres-far"),
        ("stability --only", "--only"),
        ("stability spheres-far", "spheres-far"),
        ("inspect", "SCENE"),
        ("inspect scene.json --force", "--force"),
        ("convert model.obj", "SCENE"),
        ("convert model.obj a.json -o b.json", "--output"),
        ("convert", "<MODEL> <SCENE.json>"),
        ("--json inspect scene.json", "inspect --json"),
    ] {
        desk.refuses(line, &[word]);
    }
    assert!(!desk.refuses("bench --frobnicate", &["--frobnicate"]).contains("tip:"));
}

#[test]
fn numbers_out_of_range_are_refused_with_their_range() {
    let desk = Desk::new();
    let huge = "99999999999999999999999999";
    for (option, values, range) in [
        ("--samples", &["0", "-1", "16777217", huge, "1.5", "many", ""][..], "from 1 to 16,777,216"),
        ("--bounces", &["-1", "1025", huge, "4.0"], "from 0 to 1,024"),
        ("--seed", &["-1", "4294967296", huge], "from 0 to 4,294,967,295"),
        ("--threads", &["0", "-1", "1025", huge, "all"], "from 1 to 1,024"),
        ("--lanes", &["0", "2", "32", huge, "all"], "auto, 1, 8, 16"),
        ("--exposure", &["nan", "inf", "-65", "1e39", "bright"], "from -64 to 64"),
        ("--clamp", &["0", "-1", "nan", "inf", "", "ten"], "above 0"),
        ("--size", &["0x0", "0x8", "8x0", "1000000000x1", "16385x1", "1x16385"], "from 1 to 16,384"),
        (
            "--size",
            &["8", "8x", "x8", "-8x8", "8x-8", "8 x 8", "8x8x8", "eightxeight", ""],
            "such as 240x135",
        ),
    ] {
        for value in values {
            let arguments = ["render", "scene.json", "-o", "a.png", option, value];
            desk.refuses_with(&arguments, &[option, value, range]);
        }
    }
    for (option, value) in
        [("--threads", "0"), ("--size", "0x0"), ("--bounces", "1025"), ("--seed", "-1"), ("--size", "240")]
    {
        for command in ["bench", "compare"] {
            desk.refuses(&format!("{command} scene.json {option} {value}"), &[option, value]);
        }
    }
    desk.refuses("bench --frames 0", &["--frames", "from 1 to"]);
    desk.refuses("bench --lanes 4", &["--lanes", "auto, 1, 8, 16"]);
    desk.refuses("compare --samples 0", &["--samples", "from 1 to"]);
    // The name of other renderers.
    desk.refuses("render scene.json -o a.png --spp 0", &["--samples", "from 1 to"]);
}

#[test]
fn unknown_scenes_are_refused_by_name() {
    let desk = Desk::new();
    for command in ["bench", "compare", "rays"] {
        desk.refuses(&format!("{command} nothing.json"), &["nothing.json"]);
    }
    desk.refuses("inspect nowhere.json", &["nowhere.json"]);
    desk.refuses("render nowhere.json -o a.png", &["nowhere.json"]);
    desk.refuses("convert nowhere.obj new.json", &["nowhere.obj"]);
}

#[test]
fn outputs_that_cannot_be_written_are_refused_before_the_scene_is_read() {
    let desk = Desk::new();
    fs::create_dir(desk.path("folder.png")).unwrap();
    fs::create_dir(desk.path("folder")).unwrap();
    for (output, words) in [
        ("picture", &[".png", ".jpg", ".exr", ".hdr"][..]),
        ("picture.gif", &["picture.gif", ".png", ".jpg", ".exr", ".hdr"]),
        ("-", &[".png"]),
        ("folder", &[".png"]),
        ("no/such/picture.png", &["no/such", "does not exist", "mkdir -p"]),
        ("scene.json/picture.png", &["scene.json", "not a folder"]),
        ("folder.png", &["folder.png", "is a folder"]),
        ("new.png/", &["new.png/", "is a folder"]),
    ] {
        // The scene does not exist either: that the output is named shows which was looked at first.
        desk.refuses(&format!("render nowhere.json -o {output}"), words);
    }
    desk.refuses("convert model.obj no/such/new.json", &["no/such", "mkdir -p"]);
    let said = desk.refuses("convert model.obj folder", &["is a folder", "add the name of a file"]);
    assert!(!said.contains("picture"), "convert writes no picture");
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_refused_with_the_systems_reason() {
    let desk = Desk::new();
    let line = "render scene.json -o /proc/picture.png";
    let said = desk.refuses(line, &["cannot write in the folder", "because: "]);
    assert!(!said.contains(".tmp"), "a file that nobody asked for is named: {said}");
}
