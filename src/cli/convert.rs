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
    // Before the scene file's name is judged, so that a folder is called a folder.
    output::check(&options.scene, existing)?;
    check_names(&options)?;
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

/// Scenes and models are known by their extensions: another one would be read as something else, or not at all.
fn check_names(ConvertOptions { model, scene, .. }: &ConvertOptions) -> Result<(), CliError> {
    let ends_in = |path: &Path, wanted: &str| {
        path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
    };
    let refuse = |option, path: &Path, why: String| {
        Err(CliError::Value { option, value: path.display().to_string(), why })
    };
    if ends_in(model, "json") || model.to_string_lossy().starts_with("builtin:") {
        return refuse("MODEL.obj", model, "this is a scene already: octray render shows it as it is".into());
    }
    if !ends_in(model, "obj") {
        return refuse(
            "MODEL.obj",
            model,
            "only Wavefront OBJ is read: export the model as an .obj file".into(),
        );
    }
    if !ends_in(scene, "json") {
        let better = scene.with_extension("json");
        let why = format!("scenes are read from files that end in .json: write to {}", better.display());
        return refuse("SCENE.json", scene, why);
    }
    Ok(())
}
