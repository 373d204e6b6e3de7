//! The command line has manners: what it refuses, how it says so, and that it never panics or leaves half a file.

use assert_cmd::Command;
use predicates::prelude::*;
use predicates::str::contains;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use tempfile::TempDir;

const COMMANDS: [&str; 5] = ["bench", "compare", "render", "convert", "inspect"];

const SCENE: &str = r#"{
  "format": "octray-1",
  "camera": { "position": [0, 0, 5], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov": 40 },
  "resolution": [8, 8],
  "max_bounces": 4,
  "sky": { "color": [0.5, 0.7, 1.0] },
  "materials": { "clay": { "type": "diffuse", "color": [0.8, 0.5, 0.3] } },
  "spheres": [ { "center": [0, 0, 0], "radius": 1, "material": "clay" } ]
}"#;

/// A folder with a scene and a model in it, in which the program runs.
struct Desk(TempDir);

impl Desk {
    fn new() -> Self {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("scene.json"), SCENE).unwrap();
        fs::write(folder.path().join("model.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        Self(folder)
    }

    fn octray(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_octray"));
        command.args(arguments).current_dir(self.0.path());
        command
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(self.0.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// The arguments are refused: exit code 2, nothing on standard output, an error that says all of `words`, no file.
    fn refuses(&self, arguments: &[&str], words: &[&str]) {
        let before = self.names();
        let refused = self.octray(arguments).assert().code(2).stdout("");
        let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(said.starts_with("error: ") && !said.contains("panicked"), "octray {arguments:?}: {said}");
        for word in words {
            assert!(said.contains(word), "octray {arguments:?} does not say {word:?}: {said}");
        }
        assert_eq!(self.names(), before, "octray {arguments:?} left a file");
    }
}

#[test]
fn octray_alone_says_what_to_try() {
    let desk = Desk::new();
    let shown = desk.octray(&[]).assert().success().stderr("");
    let said = String::from_utf8_lossy(&shown.get_output().stdout).into_owned();
    for command in COMMANDS {
        assert!(said.contains(&format!("octray {command}")), "{command} is not in: {said}");
    }
}

#[test]
fn help_explains_every_command_with_an_example() {
    let desk = Desk::new();
    desk.octray(&["--help"]).assert().success().stdout(contains("Exit codes")).stderr("");
    desk.octray(&["--version"]).assert().success().stdout(contains(env!("CARGO_PKG_VERSION")));
    for command in COMMANDS {
        desk.octray(&[command, "--help"]).assert().success().stderr("").stdout(
            contains("Usage: octray")
                .and(contains("Example"))
                .and(contains(format!("\n  octray {command} "))),
        );
        desk.octray(&[command, "-h"]).assert().success();
    }
    desk.octray(&["render", "--help"]).assert().stdout(contains("Ctrl-C").and(contains("130")));
}

#[test]
fn wrong_usage_is_refused() {
    let desk = Desk::new();
    for (arguments, word) in [
        (&["rendr"][..], "rendr"),
        (&["--frobnicate"], "--frobnicate"),
        (&["render"], "SCENE"),
        (&["render", "scene.json"], "--output"),
        (&["render", "scene.json", "-o"], "--output"),
        (&["render", "scene.json", "-o", "a.png", "b.png"], "b.png"),
        (&["render", "scene.json", "-o", "a.png", "--tone", "sepia"], "reinhard"),
        (&["render", "scene.json", "-o", "a.png", "--sphere", "exact"], "robust"),
        (&["render", "scene.json", "-o", "a.png", "--triangle", "exact"], "moller-trumbore"),
        (&["bench", "--triangle", "exact"], "baldwin-weber"),
        (&["compare", "--lanes", "8"], "--lanes"),
        (&["inspect"], "SCENE"),
        (&["inspect", "scene.json", "--force"], "--force"),
        (&["convert", "model.obj"], "SCENE"),
    ] {
        desk.refuses(arguments, &[word]);
    }
}

#[test]
fn numbers_out_of_range_are_refused_with_their_range() {
    let desk = Desk::new();
    let huge = "99999999999999999999999999";
    for (option, values, range) in [
        ("--samples", &["0", "-1", "16777217", huge, "1.5", "many", ""][..], "from 1 to 16777216"),
        ("--bounces", &["-1", "1025", huge, "4.0"], "from 0 to 1024"),
        ("--seed", &["-1", "4294967296", huge], "from 0 to 4294967295"),
        ("--threads", &["0", "-1", "1025", huge, "all"], "from 1 to 1024"),
        ("--lanes", &["0", "2", "16", "-8", huge], "1 (scalar) or 8 (SIMD)"),
        ("--exposure", &["nan", "inf", "-65", "1e39", "bright"], "from -64 to 64"),
        ("--size", &["0x0", "0x8", "8x0", "1000000000x1", "16385x1", "1x16385"], "from 1 to 16384"),
        (
            "--size",
            &["8", "8x", "x8", "-8x8", "8x-8", "8 x 8", "8x8x8", "eightxeight", ""],
            "such as 240x135",
        ),
    ] {
        for value in values {
            desk.refuses(&["render", "scene.json", "-o", "a.png", option, value], &[option, value, range]);
        }
    }
}

#[test]
fn bench_and_compare_refuse_the_same_numbers() {
    let desk = Desk::new();
    for command in ["bench", "compare"] {
        for (option, value) in [
            ("--threads", "0"),
            ("--size", "0x0"),
            ("--bounces", "1025"),
            ("--seed", "-1"),
            ("--size", "240"),
        ] {
            desk.refuses(&[command, "scene.json", option, value], &[option, value]);
        }
    }
    desk.refuses(&["bench", "--frames", "0"], &["--frames", "from 1 to"]);
    desk.refuses(&["bench", "--lanes", "4"], &["--lanes", "1 (scalar) or 8 (SIMD)"]);
    desk.refuses(&["compare", "--samples", "0"], &["--samples", "from 1 to"]);
}

#[test]
fn unknown_scenes_are_refused_by_name() {
    let desk = Desk::new();
    desk.refuses(&["inspect", "nowhere.json"], &["nowhere.json"]);
    desk.refuses(&["render", "nowhere.json", "-o", "a.png"], &["nowhere.json"]);
    desk.refuses(&["convert", "nowhere.obj", "new.json"], &["nowhere.obj"]);
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
        desk.refuses(&["render", "nowhere.json", "-o", output], words);
    }
    desk.refuses(&["convert", "model.obj", "no/such/new.json"], &["no/such", "mkdir -p"]);
    desk.refuses(&["convert", "model.obj", "folder"], &["is a folder"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_folder_that_takes_no_files_is_refused_with_the_systems_reason() {
    let desk = Desk::new();
    desk.refuses(
        &["render", "scene.json", "-o", "/proc/picture.png"],
        &["cannot write in the folder", "because: "],
    );
}

#[test]
fn render_writes_the_file_and_says_so_in_a_line() {
    let desk = Desk::new();
    let rendered = desk.octray(&["render", "scene.json", "-o", "a.png", "--samples", "3"]).assert().success();
    rendered.stderr(contains("error").not()).stdout(
        predicate::str::is_match(r"^a\.png: 8×8, 3 samples, \d+\.\d\d s, \d+\.\d Mray/s\n$").unwrap(),
    );
    assert_eq!(desk.names(), ["a.png", "model.obj", "scene.json"]);
    desk.octray(&["render", "scene.json", "-o", "a.png", "--samples", "1", "--size", "5×4"])
        .assert()
        .success();
    assert_eq!(
        image::image_dimensions(desk.path("a.png")).unwrap(),
        (5, 4),
        "the second file replaces the first"
    );
}

#[test]
fn render_writes_every_format_at_the_smallest_and_at_odd_sizes() {
    let desk = Desk::new();
    for (size, dimensions) in [("1x1", (1, 1)), ("9x1", (9, 1)), ("1x9", (1, 9)), ("17x13", (17, 13))] {
        for name in ["a.png", "a.jpg", "a.exr", "a.hdr"] {
            let arguments = ["render", "scene.json", "-o", name, "--samples", "1", "--size", size];
            desk.octray(&arguments).assert().success();
            assert_eq!(image::image_dimensions(desk.path(name)).unwrap(), dimensions, "{name}");
        }
    }
}

#[test]
fn render_reports_in_json_what_it_did() {
    let desk = Desk::new();
    let arguments =
        "render scene.json -o a.exr --samples 2 --size 4x3 --bounces 1 --seed 7 --threads 1 --lanes 1 --json";
    let arguments: Vec<&str> = arguments.split(' ').collect();
    let output = desk.octray(&arguments).assert().success().get_output().stdout.clone();
    let report: serde_json::Value = serde_json::from_slice(&output).unwrap();
    for (key, value) in [
        ("width", 4),
        ("height", 3),
        ("samples", 2),
        ("max_bounces", 1),
        ("seed", 7),
        ("discarded_samples", 0),
    ] {
        assert_eq!(report[key], value, "{key}");
    }
    for (key, value) in [("schema", "octray-render-1"), ("scene", "scene.json"), ("output", "a.exr")] {
        assert_eq!(report[key], value, "{key}");
    }
    assert_eq!(report["interrupted"], false);
    assert!(report["seconds"].is_f64() && report["mrays_per_s"].is_f64() && report["rays"].is_u64());
    assert_eq!(report.as_object().unwrap().len(), 13);
}

#[test]
fn render_warns_where_exposure_has_no_effect() {
    let desk = Desk::new();
    let render = |output, extra: &[&str]| {
        let arguments = [&["render", "scene.json", "--samples", "1", "-o", output], extra].concat();
        String::from_utf8(desk.octray(&arguments).assert().success().get_output().stderr.clone()).unwrap()
    };
    assert!(
        render("a.exr", &["--exposure", "-1"])
            .contains("warning: --exposure and --tone have no effect on a.exr")
    );
    assert!(render("a.hdr", &["--tone", "aces"]).contains("no effect on a.hdr"));
    assert!(!render("a.exr", &[]).contains("no effect"));
    assert!(!render("a.png", &["--exposure", "-1.5", "--tone", "reinhard"]).contains("no effect"));
}

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
fn inspect_shows_what_a_scene_holds() {
    let desk = Desk::new();
    let shown = desk.octray(&["inspect", "scene.json"]).assert().success().stderr("");
    shown.stdout(
        contains("spheres     1\n").and(contains("1 diffuse")).and(contains("(-1, -1, -1) to (1, 1, 1)")),
    );

    let output =
        desk.octray(&["inspect", "scene.json", "--json"]).assert().success().get_output().stdout.clone();
    let report: serde_json::Value = serde_json::from_slice(&output).unwrap();
    assert_eq!(report["schema"], "octray-inspect-1");
    assert_eq!(report["scene"], "scene.json");
    assert_eq!((&report["spheres"], &report["triangles"]), (&1.into(), &0.into()));
    assert_eq!(report["materials"]["diffuse"], 1);
    assert_eq!(report["resolution"], serde_json::json!([8, 8]));
    assert_eq!(report["bounds"]["upper"], serde_json::json!([1.0, 1.0, 1.0]));
    assert_eq!(report["warnings"], serde_json::json!([]));
}

/// Runs the program with standard output closed at the other end.
fn with_closed_output(folder: &Path, arguments: &[&str]) -> std::process::Output {
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_octray"));
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    command.args(arguments).current_dir(folder).stdout(writer).stderr(Stdio::piped());
    command.spawn().unwrap().wait_with_output().unwrap()
}

#[test]
fn a_closed_standard_output_is_quiet() {
    let desk = Desk::new();
    for arguments in [
        &[][..],
        &["inspect", "scene.json"],
        &["inspect", "scene.json", "--json"],
        &["render", "scene.json", "-o", "a.png", "--samples", "1"],
        &["--help"],
    ] {
        let output = with_closed_output(desk.0.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!said.contains("error") && !said.contains("panicked"), "{arguments:?}: {said}");
    }
}

#[test]
fn a_closed_standard_error_does_no_harm() {
    let desk = Desk::new();
    for (arguments, code) in [
        (&["inspect", "nowhere.json"][..], 2),
        (&["render", "scene.json", "-o", "a.exr", "--exposure", "1", "--samples", "1"], 0),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_octray"));
        command.args(arguments).current_dir(desk.0.path()).stdout(Stdio::null()).stderr(writer);
        assert_eq!(command.status().unwrap().code(), Some(code), "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_an_error() {
    let desk = Desk::new();
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_octray"));
    command.args(["inspect", "scene.json"]).current_dir(desk.0.path()).stdout(full).stderr(Stdio::piped());
    let output = command.spawn().unwrap().wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write to standard output"));
}
