//! The built-in scenes by name, with suggestions for misspelt names.
//!
//! For: [`names`], [`text`], [`guess`].

use super::embedded::{PREFIX, SCENES};
use super::error::SceneError;
use super::procedural;
use super::spelling::nearest;

/// The names that may follow `builtin:`.
pub fn names() -> impl Iterator<Item = &'static str> {
    SCENES.iter().map(|&(name, _)| name)
}

/// The text of the built-in scene of that name.
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

/// The built-in or generated scene whose name is nearest to this one, as the command line takes it; `None` if
/// none is near.
pub fn guess(name: &str) -> Option<String> {
    let (word, count) = name.split_once(':').map_or((name, None), |(word, count)| (word, Some(count)));
    if let Some(word) = nearest(word, procedural::words()) {
        return Some(format!("{PREFIX}{word}:{}", count.filter(|count| !count.is_empty()).unwrap_or("N")));
    }
    nearest(name, names()).map(|near| format!("{PREFIX}{near}"))
}
