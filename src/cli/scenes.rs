//! The scenes that commands take.
//!
//! For: [`load`], and [`asked_for`] and [`or_built_in`] for several. May import: `scene`, `asked`. Must never know: what is done with them.

use super::asked::Asked;
use super::error::CliError;
use crate::scene::{self, Loaded};

/// The scene of that name. A view that asks for what does not exist is refused by every command, not only by the one that would do it.
pub fn load(name: &str) -> Result<Loaded, CliError> {
    let scene = scene::load_with_view(name)?;
    Asked::of(&scene)?;
    Ok(scene)
}

/// The names of the scenes asked for, or of the built-in ones.
///
/// Of several each has been read once, so that a fault in the last one does not cost the time of all before it; and was forgotten again, so
/// that no two are in memory at a time.
pub fn asked_for(names: &[String]) -> Result<Vec<String>, CliError> {
    if names.len() > 1 {
        for name in names {
            load(name)?;
        }
    }
    Ok(or_built_in(names))
}

/// These names, or those of the built-in scenes if there are none.
pub fn or_built_in(names: &[String]) -> Vec<String> {
    match names {
        [] => scene::builtin_names().map(|name| format!("builtin:{name}")).collect(),
        some => some.to_vec(),
    }
}
