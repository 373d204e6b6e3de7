//! The scenes inside the program, and the pictures they use.
//!
//! For: [`names`], [`text`], [`embedded`]. May import: `check` and `procedural` (for suggestions). Must never know: a file format.

use super::check::nearest;
use super::{SceneError, procedural};
use std::path::Path;

/// How the command line asks for a scene inside the program.
pub const PREFIX: &str = "builtin:";

const SCENES: [(&str, &str); 7] = [
    ("thesis", include_str!("../../scenes/thesis.json")),
    ("three", include_str!("../../scenes/three.json")),
    ("spheres", include_str!("../../scenes/spheres.json")),
    ("cornell", include_str!("../../scenes/cornell.json")),
    ("cornell-spheres", include_str!("../../scenes/cornell-spheres.json")),
    ("materials", include_str!("../../scenes/materials.json")),
    ("chess", include_str!("../../scenes/chess.json")),
];

const FILES: [(&str, &[u8]); 2] = [
    ("textures/sky.jpg", include_bytes!("../../scenes/textures/sky.jpg")),
    ("textures/chess.png", include_bytes!("../../scenes/textures/chess.png")),
];

/// The names that may follow `builtin:`.
pub fn names() -> impl Iterator<Item = &'static str> {
    SCENES.iter().map(|&(name, _)| name)
}

/// The scene file of that name.
pub fn text(name: &str) -> Result<&'static str, SceneError> {
    SCENES.iter().find(|&&(known, _)| known == name).map(|&(_, text)| text).ok_or_else(|| {
        let guess = nearest(name, names()).map(|near| format!("did you mean `{PREFIX}{near}`? "));
        let names: Vec<String> = names().map(String::from).chain(procedural::names()).collect();
        SceneError::new(format!("there is no scene `{PREFIX}{name}`")).mend(format!(
            "{}the names are {}",
            guess.unwrap_or_default(),
            names.join(", ")
        ))
    })
}

/// The content of a file that a scene inside the program refers to.
pub fn embedded(path: &Path) -> Option<&'static [u8]> {
    FILES.iter().find(|(known, _)| Path::new(known) == path).map(|&(_, content)| content)
}
