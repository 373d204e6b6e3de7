//! The scenes of commands that take several.
//!
//! For: [`asked_for`]. May import: `scene`. Must never know: what is done with them.

use super::error::CliError;
use crate::scene;

/// The names of the scenes asked for, or of the built-in ones.
///
/// Of several each has been read once, so that a fault in the last one does not cost the time of all before it; and was forgotten again, so
/// that no two are in memory at a time.
pub fn asked_for(names: &[String]) -> Result<Vec<String>, CliError> {
    if names.is_empty() {
        return Ok(scene::builtin_names().map(|name| format!("builtin:{name}")).collect());
    }
    if names.len() > 1 {
        for name in names {
            scene::load(name)?;
        }
    }
    Ok(names.to_vec())
}
