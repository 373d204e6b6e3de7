//! `octray convert`: from a mesh to a scene file.

use super::args::ConvertArgs;
use super::error::CliError;
use super::terminal;
use crate::output::{self, Existing};
use crate::scene;
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

/// Runs the command.
pub fn run(options: &ConvertArgs) -> Result<ExitCode, CliError> {
    let existing = if options.force { Existing::Replace } else { Existing::Keep };
    check_model(options)?;
    // Before the check of the extension, so that a folder is reported as a folder.
    output::check(&options.scene, existing)?;
    check_scene(&options.scene)?;
    let folder = options.scene.parent().unwrap_or(Path::new(""));
    let (text, warnings) = scene::native_from_obj_in(&options.model, folder)?;
    for warning in &warnings {
        terminal::warn(warning);
    }
    output::write_atomically(&options.scene, existing, |file| file.write_all(text.as_bytes()))?;
    terminal::print(&format!(
        "wrote {}\n  to see it: octray render {} -o picture.png\n",
        options.scene.display(),
        options.scene.display()
    ))?;
    Ok(ExitCode::SUCCESS)
}

// Scenes and models are recognised by their extensions: a file with another one would be read as something
// else, or not at all.

fn ends_in(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

fn refuse(file: &Path, what: &'static str, mend: String) -> Result<(), CliError> {
    Err(CliError::Name { file: file.into(), what, mend })
}

fn check_model(ConvertArgs { model, scene, .. }: &ConvertArgs) -> Result<(), CliError> {
    let [from, to] = [model, scene].map(|path| path.display());
    if ends_in(model, "json") || model.to_string_lossy().starts_with("builtin:") {
        let mend = match ends_in(scene, "obj") {
            true => format!("the model comes first: octray convert {to} {from}"),
            false => format!("octray render {from} -o picture.png shows it as it is"),
        };
        return refuse(model, "is a scene already, not a model", mend);
    }
    if !ends_in(model, "obj") {
        let mend = "export the model as Wavefront OBJ: that is the one format that convert reads";
        return refuse(model, "is not an .obj file", mend.into());
    }
    Ok(())
}

fn check_scene(scene: &Path) -> Result<(), CliError> {
    if ends_in(scene, "json") {
        return Ok(());
    }
    let better = scene.with_extension("json");
    refuse(
        scene,
        "would not be read as a scene, as it does not end in .json",
        format!("write to {}", better.display()),
    )
}
