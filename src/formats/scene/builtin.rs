//! The scenes inside the program, and the pictures they use.
//!
//! For: [`names`], [`text`], [`embedded`], [`guess`]. May import: `check` and `procedural` (for suggestions). Must never know: a file format.

use super::check::nearest;
use super::{SceneError, procedural};
use std::path::Path;

/// How the command line asks for a scene inside the program.
pub const PREFIX: &str = "builtin:";

const SCENES: [(&str, &str); 8] = [
    ("thesis", include_str!("../../../scenes/thesis.json")),
    ("three", include_str!("../../../scenes/three.json")),
    ("spheres", include_str!("../../../scenes/spheres.json")),
    ("cornell", include_str!("../../../scenes/cornell.json")),
    ("cornell-spheres", include_str!("../../../scenes/cornell-spheres.json")),
    ("balls", include_str!("../../../scenes/balls.json")),
    ("materials", include_str!("../../../scenes/materials.json")),
    ("chess", include_str!("../../../scenes/chess.json")),
];

const FILES: [(&str, &[u8]); 2] = [
    ("textures/sky.jpg", include_bytes!("../../../scenes/textures/sky.jpg")),
    ("textures/chess.png", include_bytes!("../../../scenes/textures/chess.png")),
];

/// The names that may follow `builtin:`.
pub fn names() -> impl Iterator<Item = &'static str> {
    SCENES.iter().map(|&(name, _)| name)
}

/// The scene file of that name.
pub fn text(name: &str) -> Result<&'static str, SceneError> {
    SCENES.iter().find(|&&(known, _)| known == name).map(|&(_, text)| text).ok_or_else(|| {
        let guess = guess(name).map(|near| format!("did you mean `{near}`? "));
        let made = procedural::words().map(|word| format!("{word}:N"));
        let names: Vec<String> = names().map(String::from).chain(made).collect();
        SceneError::new(format!("there is no scene `{PREFIX}{name}`")).mend(format!(
            "{}the names are {}",
            guess.unwrap_or_default(),
            names.join(", ")
        ))
    })
}

/// How to ask for the scene inside the program, or made by rule, whose name is next to this one; none if none is near.
pub fn guess(name: &str) -> Option<String> {
    let (word, count) = name.split_once(':').map_or((name, None), |(word, count)| (word, Some(count)));
    if let Some(word) = nearest(word, procedural::words()) {
        return Some(format!("{PREFIX}{word}:{}", count.filter(|count| !count.is_empty()).unwrap_or("N")));
    }
    nearest(name, names()).map(|near| format!("{PREFIX}{near}"))
}

/// The content of a file that a scene inside the program refers to.
pub fn embedded(path: &Path) -> Option<&'static [u8]> {
    FILES.iter().find(|(known, _)| Path::new(known) == path).map(|&(_, content)| content)
}
