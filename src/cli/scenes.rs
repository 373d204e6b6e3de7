//! Loads the scenes of commands.
//!
//! For: [`load`], [`load_with_warnings`], [`checked`], [`or_built_in`].

use super::error::CliError;
use super::overrides::Overrides;
use super::terminal;
use crate::scene::{self, Loaded};

/// Loads a scene by name. Every command refuses a view with invalid overrides, also a command that does not
/// use them.
pub fn load(name: &str) -> Result<Loaded, CliError> {
    let scene = scene::load_with_view(name)?;
    Overrides::of_view(&scene)?;
    Ok(scene)
}

/// Loads a scene by name, and prints its warnings.
pub fn load_with_warnings(name: &str) -> Result<Loaded, CliError> {
    let scene = load(name)?;
    scene.warnings.iter().for_each(|warning| terminal::warn(warning));
    Ok(scene)
}

/// The names given, or those of the built-in scenes.
///
/// Several scenes are all loaded once here and dropped, so that a fault in the last one shows before the
/// others take their time, and only one is in memory at a time.
pub fn checked(names: &[String]) -> Result<Vec<String>, CliError> {
    if names.len() > 1 {
        for name in names {
            load(name)?;
        }
    }
    Ok(or_built_in(names))
}

/// The names given, or those of the built-in scenes if none is given.
pub fn or_built_in(names: &[String]) -> Vec<String> {
    match names {
        [] => scene::builtin_names().map(|name| format!("builtin:{name}")).collect(),
        some => some.to_vec(),
    }
}
