//! Holds the scene files and textures that are compiled into the program.

use std::path::Path;

/// Prefix of built-in scenes on the command line.
pub const PREFIX: &str = "builtin:";

/// A scene that shows why methods must be robust. It is no benchmark.
const FAR: &str = "far";

/// Includes scene files by their names.
macro_rules! scenes {
    ($($name:literal),*) => { &[$(($name, include_str!(concat!("../scenes/", $name, ".json")))),*] };
}

const SCENES: &[(&str, &str)] = scenes! {
    "thesis", "three", "spheres", "cornell", "cornell-spheres", "balls", "materials", "chess", "far"
};

const FILES: [(&str, &[u8]); 2] = [
    ("textures/sky.jpg", include_bytes!("../scenes/textures/sky.jpg")),
    ("textures/chess.png", include_bytes!("../scenes/textures/chess.png")),
];

/// Returns the names that may follow `builtin:`.
pub fn names() -> impl Iterator<Item = &'static str> {
    SCENES.iter().map(|&(name, _)| name)
}

/// Returns the names of the scenes that benchmarks use by default.
pub fn bench_names() -> impl Iterator<Item = &'static str> {
    names().filter(|&name| name != FAR)
}

/// Returns the text of a built-in scene.
pub fn scene(name: &str) -> Option<&'static str> {
    SCENES.iter().find(|&&(known, _)| known == name).map(|&(_, text)| text)
}

/// Returns the content of a file that a built-in scene refers to.
pub fn file(path: &Path) -> Option<&'static [u8]> {
    FILES.iter().find(|(known, _)| Path::new(known) == path).map(|&(_, content)| content)
}
