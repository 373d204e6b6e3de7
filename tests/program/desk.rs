//! A folder to work in, and the program that runs there.

use crate::folder::Folder;
use crate::openexr;
use crate::program::octray;
use assert_cmd::Command;
use serde_json::{Value, json};
use std::ops::Deref;

/// The scene of every desk: one sphere, eight pixels in width and height.
pub const SCENE: &str = r#"{
  "format": "octray-1",
  "camera": { "position": [0, 0, 5], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov": 40 },
  "resolution": [8, 8],
  "max_bounces": 4,
  "sky": { "color": [0.5, 0.7, 1.0] },
  "materials": { "clay": { "type": "diffuse", "color": [0.8, 0.5, 0.3] } },
  "spheres": [ { "center": [0, 0, 0], "radius": 1, "material": "clay" } ]
}"#;

/// Asserts that a table is at most 120 columns wide, so that a terminal of that width shows its rows whole.
pub fn assert_fits(table: &str) {
    for line in table.lines() {
        assert!(line.chars().count() <= 120, "{} columns: {line}", line.chars().count());
    }
}

/// Asserts that a report has at least these values, also within its objects.
#[track_caller]
pub fn assert_has(report: &Value, expected: &Value) {
    match expected {
        Value::Object(values) => values.iter().for_each(|(key, value)| assert_has(&report[key], value)),
        _ => assert_eq!(report, expected),
    }
}

pub fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

/// Returns the elements of an array of a report.
pub fn list(value: &Value) -> &[Value] {
    value.as_array().unwrap_or_else(|| panic!("{value} is not an array"))
}

/// A folder with a scene and a model in it, in which the program runs.
pub struct Desk(Folder);

/// The functions of any folder.
impl Deref for Desk {
    type Target = Folder;
    fn deref(&self) -> &Folder {
        &self.0
    }
}

impl Desk {
    pub fn new() -> Self {
        let desk = Self(Folder::new());
        desk.write("scene.json", SCENE);
        desk.write("model.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        desk
    }

    /// Returns the program with the words of a line as its arguments, to be started.
    pub fn command(&self, line: &str) -> std::process::Command {
        let mut command = octray();
        command.args(line.split_whitespace()).current_dir(self.path(""));
        command
    }

    /// Returns the same, to be run to its end.
    pub fn octray(&self, line: &str) -> Command {
        Command::from_std(self.command(line))
    }

    /// Asserts that the arguments are refused: exit code 2, nothing on standard output, an error that
    /// contains all of `words`, no file. Returns the error.
    pub fn refuses(&self, line: &str, words: &[&str]) -> String {
        self.refuses_with(&line.split_whitespace().collect::<Vec<_>>(), words)
    }

    /// Variant of [`Desk::refuses`] for arguments that may be empty or hold spaces.
    pub fn refuses_with(&self, arguments: &[&str], words: &[&str]) -> String {
        let before = self.names();
        let refused = self.octray("").args(arguments).assert().code(2).stdout("");
        let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        // Warnings about the build may stand before it.
        let of_warning = |line: &&str| line.starts_with("warning: ") || line.starts_with("  ");
        let error = said.lines().find(|line| !of_warning(line)).unwrap_or_default();
        assert!(error.starts_with("error: ") && !said.contains("panicked"), "octray {arguments:?}: {said}");
        for word in words {
            assert!(said.contains(word), "octray {arguments:?} does not say {word:?}: {said}");
        }
        assert_eq!(self.names(), before, "octray {arguments:?} left a file");
        said
    }

    /// Runs the program, which succeeds; returns its standard output.
    pub fn run(&self, line: &str) -> String {
        String::from_utf8(self.octray(line).assert().success().get_output().stdout.clone()).unwrap()
    }

    /// Runs the program with `--json`, which succeeds; returns its report.
    pub fn json(&self, line: &str) -> Value {
        self.json_with_code(line, 0)
    }

    /// Variant of [`Desk::json`] for another exit code.
    pub fn json_with_code(&self, line: &str, code: i32) -> Value {
        let ended = self.octray(&format!("{line} --json")).assert().code(code);
        let printed = &ended.get_output().stdout;
        serde_json::from_slice(printed).unwrap_or_else(|error| panic!("octray {line}: {error}"))
    }

    /// Runs the program, which succeeds; returns its standard error.
    pub fn warnings(&self, line: &str) -> String {
        String::from_utf8(self.octray(line).assert().success().get_output().stderr.clone()).unwrap()
    }

    /// Renders a picture; returns its file.
    pub fn rendered(&self, line: &str, output: &str) -> Vec<u8> {
        self.run(&format!("render {line} -o {output}"));
        self.bytes(output)
    }

    /// Returns the pixels of a picture file.
    pub fn pixels(&self, name: &str) -> Vec<[f32; 3]> {
        let path = self.path(name);
        if name.ends_with(".exr") {
            return openexr::read(&path).2;
        }
        image::open(path).unwrap().to_rgb32f().pixels().map(|pixel| pixel.0).collect()
    }

    /// Puts a textured model into the folder `models`.
    pub fn put_textured_model(&self) {
        self.write("models/m.mtl", "newmtl paper\nmap_Kd paper.png\n");
        self.write(
            "models/m.obj",
            "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nusemtl paper\nf 1/1 2/2 3/3\n",
        );
        let paper = image::RgbImage::from_fn(2, 2, |x, y| image::Rgb([255, 100 * x as u8, 100 * y as u8]));
        paper.save(self.path("models/paper.png")).unwrap();
    }

    /// Writes a scene of a white room that emits light, with so many balls in it: every path has as many
    /// bounces as it may.
    pub fn put_endless_paths(&self, balls: usize) {
        let ball = |i: usize| {
            let [x, y, z] = [i % 16, i / 16 % 16, i / 256].map(|step| 0.1 * step as f64 - 0.7);
            json!({ "center": [x, y, z], "radius": 0.01, "material": "white" })
        };
        let room = json!({ "center": [0, 0, 0], "radius": 4, "material": "white" });
        let scene = json!({
            "format": "octray-1",
            "camera": { "position": [0, 0, 3], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov": 40 },
            "materials": { "white": { "type": "diffuse", "color": [1, 1, 1], "emission": [1, 1, 1] } },
            "spheres": (0..balls).map(ball).chain([room]).collect::<Vec<_>>(),
        });
        self.write("endless.json", scene.to_string());
    }

    /// Renders a scene to a few pixels, which are not all black.
    pub fn render_small(&self, scene: &str) -> Vec<[f32; 3]> {
        let report = self.json(&format!("render {scene} -o small.exr --samples 2 --size 24x14"));
        assert!(report["rays"].as_u64().unwrap() >= 24 * 14 * 2, "{scene}: {report}");
        assert_eq!(report["discarded_samples"], 0, "{scene}");
        let pixels = self.pixels("small.exr");
        assert!(pixels.iter().any(|pixel| *pixel != [0.0; 3]), "{scene} renders black");
        pixels
    }
}
