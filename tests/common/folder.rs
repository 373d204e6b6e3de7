//! A folder of the test's own, and files in it.
#![allow(dead_code)] // Every test file takes its own part.

use octray::scene::{Scene, SceneError, load};
use std::fs;
use std::path::PathBuf;
use tempfile::TempDir;

pub struct Folder(TempDir);

/// A glTF model of the triangle (0, 0, 0), (1, 0, 0), (0, 1, 0), whose numbers are at an address; `more` are
/// other keys of the model: its `materials`, at least one, and what they need.
pub fn gltf_triangle(address: &str, more: &str) -> String {
    format!(
        r#"{{ "asset": {{ "version": "2.0" }}, "scenes": [{{ "nodes": [0] }}], "nodes": [{{ "mesh": 0 }}],
        "meshes": [{{ "primitives": [{{ "attributes": {{ "POSITION": 0, "TEXCOORD_0": 1 }}, "material": 0 }}] }}],
        "accessors": [{{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3" }},
            {{ "bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC2" }}],
        "bufferViews": [{{ "buffer": 0, "byteLength": 36 }}],
        "buffers": [{{ "uri": "{address}", "byteLength": 36 }}], {more} }}"#
    )
}

impl Folder {
    pub fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    /// The place of a file; of the folder itself for "".
    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    /// The same as the command line would name it.
    pub fn name(&self, name: &str) -> String {
        self.path(name).to_str().unwrap().to_string()
    }

    /// Writes a file, and the folders that it lies in; returns its name.
    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        fs::create_dir_all(self.path(name).parent().unwrap()).unwrap();
        fs::write(self.path(name), content).unwrap();
        self.name(name)
    }

    /// Writes a file, and loads it as a scene.
    pub fn load(&self, name: &str, content: impl AsRef<[u8]>) -> Result<Scene, SceneError> {
        load(&self.write(name, content))
    }

    /// Writes a native scene of these keys, and loads it.
    pub fn load_keys(&self, keys: &str) -> Result<Scene, SceneError> {
        self.load("scene.json", format!(r#"{{ "format": "octray-1", {keys} }}"#))
    }

    /// Asserts that a file is refused as a scene: the message names the file and the place in it, contains
    /// these words, and says what to write instead.
    #[track_caller]
    pub fn assert_refused(&self, name: &str, content: impl AsRef<[u8]>, at: &str, words: &str) {
        let text = String::from_utf8_lossy(content.as_ref()).into_owned();
        let Err(error) = self.load(name, content) else { panic!("accepted: {text}") };
        assert_eq!(error.file, Some(self.path(name)), "{error}");
        assert!(error.at.as_deref().unwrap_or_default().starts_with(at), "not at {at:?}, {text}: {error}");
        assert!(error.to_string().contains(words), "without {words:?}, {text}: {error}");
        assert!(error.mend.is_some(), "without a remedy, {text}: {error}");
    }

    /// Writes [`gltf_triangle`], and its numbers into a file beside it.
    pub fn write_gltf_triangle(&self, name: &str, numbers: &str, more: &str) {
        self.write(numbers, [0_f32, 0., 0., 1., 0., 0., 0., 1., 0.].map(f32::to_le_bytes).concat());
        self.write(name, gltf_triangle(numbers, more));
    }

    /// Saves a picture of four pixels of one colour.
    pub fn save_picture(&self, name: &str) {
        self.write(name, "");
        image::RgbImage::from_pixel(2, 2, image::Rgb([200, 100, 50])).save(self.path(name)).unwrap();
    }

    pub fn text(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap()
    }

    pub fn bytes(&self, name: &str) -> Vec<u8> {
        fs::read(self.path(name)).unwrap()
    }

    /// The names of the files in it.
    pub fn names(&self) -> Vec<String> {
        self.names_in("")
    }

    /// Of those in a folder of it.
    pub fn names_in(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(folder)).unwrap();
        let mut names: Vec<_> =
            entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}
