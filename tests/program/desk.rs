//! A folder to work in, and the program that runs there.

use crate::openexr;
use crate::program::octray;
use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

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

/// Tables are at most 120 columns wide, so that a terminal of that width shows their rows whole.
pub fn assert_fits(table: &str) {
    for line in table.lines() {
        assert!(line.chars().count() <= 120, "{} columns: {line}", line.chars().count());
    }
}

/// A folder with a scene and a model in it, in which the program runs.
pub struct Desk(pub TempDir);

impl Desk {
    pub fn new() -> Self {
        let folder = TempDir::new().unwrap();
        fs::write(folder.path().join("scene.json"), SCENE).unwrap();
        fs::write(folder.path().join("model.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").unwrap();
        Self(folder)
    }

    pub fn octray(&self, arguments: &[&str]) -> Command {
        let mut command = Command::from_std(octray());
        command.args(arguments).current_dir(self.0.path());
        command
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn names(&self) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(self.0.path())
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    /// The arguments are refused: exit code 2, nothing on standard output, an error that says all of `words`,
    /// no file.
    pub fn refuses(&self, arguments: &[&str], words: &[&str]) {
        let before = self.names();
        let refused = self.octray(arguments).assert().code(2).stdout("");
        let said = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        // Warnings about the build may stand before it.
        let error = said
            .lines()
            .find(|line| !line.starts_with("warning: ") && !line.starts_with("  "))
            .unwrap_or_default();
        assert!(error.starts_with("error: ") && !said.contains("panicked"), "octray {arguments:?}: {said}");
        for word in words {
            assert!(said.contains(word), "octray {arguments:?} does not say {word:?}: {said}");
        }
        assert_eq!(self.names(), before, "octray {arguments:?} left a file");
    }

    /// Writes a file, and the folders it lies in.
    pub fn write(&self, name: &str, text: &str) {
        fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        fs::write(self.path(name), text).unwrap();
    }

    /// The program succeeds: its report in JSON.
    pub fn json(&self, arguments: &[&str]) -> Value {
        let output = self.octray(arguments).assert().success().get_output().stdout.clone();
        serde_json::from_slice(&output).unwrap_or_else(|error| panic!("octray {arguments:?}: {error}"))
    }

    /// The program succeeds: what it says on standard error.
    pub fn warnings(&self, arguments: &[&str]) -> String {
        String::from_utf8(self.octray(arguments).assert().success().get_output().stderr.clone()).unwrap()
    }

    /// The pixels of a picture file.
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

    /// Renders a scene to a few pixels, which are not all black.
    pub fn render_small(&self, scene: &str) -> Vec<[f32; 3]> {
        let arguments = ["-o", "small.exr", "--samples", "2", "--size", "24x14", "--json"];
        let report = self.json(&[&["render", scene][..], &arguments].concat());
        assert!(report["rays"].as_u64().unwrap() >= 24 * 14 * 2, "{scene}: {report}");
        assert_eq!(report["discarded_samples"], 0, "{scene}");
        let pixels = self.pixels("small.exr");
        assert!(pixels.iter().any(|pixel| *pixel != [0.0; 3]), "{scene} renders black");
        pixels
    }
}
