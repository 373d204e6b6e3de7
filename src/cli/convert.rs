//! `octray convert`: from a mesh to a scene file.

use super::error::CliError;
use super::options::ConvertOptions;
use super::terminal;
use crate::output::{self, Existing};
use crate::scene;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

/// Runs the command.
pub fn run(options: ConvertOptions) -> Result<ExitCode, CliError> {
    let existing = if options.force { Existing::Replace } else { Existing::Keep };
    output::check(&options.scene, existing)?;
    let folder = options.scene.parent().unwrap_or(Path::new(""));
    let text = scene::native_from_obj_in(&options.model, folder)?;
    output::write_atomically(&options.scene, existing, |file| file.write_all(text.as_bytes()))?;
    terminal::print(&format!(
        "wrote {}\n  to see it: octray render {} -o picture.png\n",
        options.scene.display(),
        options.scene.display()
    ))?;
    Ok(ExitCode::SUCCESS)
}
