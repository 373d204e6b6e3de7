//! `octray convert`: from a mesh to a scene file.

use super::args::ConvertArgs;
use super::error::CliError;
use super::terminal;
use crate::output::{self, Existing};
use crate::scene::{self, Converted, has_extension};
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

/// Runs the command.
pub fn run(options: &ConvertArgs) -> Result<ExitCode, CliError> {
    let scene = options.scene();
    let existing = if options.force { Existing::Replace } else { Existing::Keep };
    check_model(options)?;
    // Before the check of the extension, so that a folder is reported as a folder.
    output::check(scene, existing)?;
    check_scene(scene)?;
    let Converted { text, pictures, warnings } = scene::convert_model(&options.model, scene)?;
    for warning in &warnings {
        terminal::warn(warning);
    }
    let pictures = pictures.iter().map(|(name, content)| (scene.with_file_name(name), content));
    let pictures: Vec<_> = pictures.collect();
    for (path, _) in &pictures {
        output::check(path, existing)?;
    }
    for (path, content) in &pictures {
        output::write_atomically(path, existing, |file| file.write_all(content))?;
    }
    output::write_atomically(scene, existing, |file| file.write_all(text.as_bytes()))?;
    terminal::print(&format!(
        "wrote {}\n  to see it: octray render {} -o picture.png\n",
        scene.display(),
        scene.display()
    ))?;
    Ok(ExitCode::SUCCESS)
}

fn refuse(file: &Path, what: &'static str, mend: String) -> Result<(), CliError> {
    Err(CliError::Name { file: file.into(), what, mend })
}

// Scenes and models are recognised by their extensions: a file with another one would be read as something
// else, or not at all.

fn check_model(options: &ConvertArgs) -> Result<(), CliError> {
    let (model, to_write) = (options.model.as_path(), options.scene());
    let [from, to] = [model, to_write].map(|path| path.display());
    let name = model.to_string_lossy();
    let is_built_in = name.starts_with("builtin:");
    if is_built_in {
        // An unknown name is none of a scene.
        scene::load(&name)?;
    }
    if is_built_in || has_extension(model, "json") {
        let mend = match scene::is_model(to_write) {
            true => format!("the model comes first: octray convert {to} {from}"),
            false => format!("octray render {from} -o picture.png shows it as it is"),
        };
        return refuse(model, "is a scene already, not a model", mend);
    }
    if !scene::is_model(model) {
        let mend = "export the model as .obj, .gltf, .glb or .ply: those are the formats that convert reads";
        return refuse(model, "is not a model", mend.into());
    }
    if !model.exists() {
        return refuse(model, "does not exist", "give the path of a model: .obj, .gltf, .glb or .ply".into());
    }
    Ok(())
}

fn check_scene(scene: &Path) -> Result<(), CliError> {
    if has_extension(scene, "json") {
        return Ok(());
    }
    let better = scene.with_extension("json");
    refuse(
        scene,
        "would not be read as a scene, as it does not end in .json",
        format!("write to {}", better.display()),
    )
}
