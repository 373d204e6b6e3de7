//! `octray convert`: from a mesh to a scene file.

use super::error::{CliError, refuse_input};
use super::outputs::keep_inputs;
use super::terminal;
use crate::output::{self, Existing};
use crate::scene::{self, Converted, has_extension};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

/// Convert a mesh to a scene file.
///
/// Writes a scene in octray's own format: the model, its materials, its camera or one that frames it, and a
/// plain sky. The scene file holds every triangle and does not need the model file. Textures stay where they
/// are, and the scene file names them relative to its own folder; those inside the model are written beside
/// it. An existing scene file is kept unless --force is given.
#[derive(Debug, clap::Parser)]
#[command(
    after_help = "Example:\n  octray convert bunny.obj bunny.json && octray render bunny.json -o bunny.png"
)]
pub struct Options {
    /// A model: Wavefront OBJ, glTF 2.0 (.gltf, .glb) or PLY.
    #[arg(value_name = "MODEL")]
    model: PathBuf,
    /// The scene file to write.
    #[arg(value_name = "SCENE.json", required_unless_present = "output")]
    scene: Option<PathBuf>,
    /// The scene file to write, instead of the second argument.
    #[arg(short, long, value_name = "SCENE.json", conflicts_with = "scene")]
    output: Option<PathBuf>,
    /// Replace SCENE.json if it exists.
    #[arg(long)]
    force: bool,
}

pub fn run(options: Options) -> Result<ExitCode, CliError> {
    let scene = options.scene.or(options.output).expect("clap requires one of the two");
    let existing = if options.force { Existing::Replace } else { Existing::Keep };
    check_model(&options.model, &scene)?;
    // Before the check of the extension, so that a folder is reported as a folder.
    output::check(&scene, existing)?;
    if !has_extension(&scene, "json") {
        let mend = format!("write to {}", scene.with_extension("json").display());
        refuse(&scene, "would not be read as a scene, as it does not end in .json", mend)?;
    }
    let Converted { text, pictures, files: read, warnings } = scene::convert_model(&options.model, &scene)?;
    warnings.iter().for_each(|warning| terminal::warn(warning));
    let pictures = pictures.iter().map(|(name, content)| (scene.with_file_name(name), content.as_slice()));
    let mut files: Vec<(PathBuf, &[u8])> = pictures.collect();
    files.iter().try_for_each(|(path, _)| output::check(path, existing))?;
    files.push((scene.clone(), text.as_bytes()));
    keep_inputs(&read, files.iter().map(|(path, _)| ("the output", path.as_path())))?;
    for (path, content) in files {
        output::write_atomically(&path, existing, |file| file.write_all(content))?;
    }
    let scene = scene.display();
    terminal::print(&format!("wrote {scene}\n  to see it: octray render {scene} -o picture.png\n"))?;
    Ok(ExitCode::SUCCESS)
}

fn refuse(file: &Path, what: &str, mend: impl AsRef<str>) -> Result<(), CliError> {
    Err(refuse_input(format!("`{}` {what}", file.display()), mend.as_ref()))
}

/// Refuses what is no model. Scenes and models are recognised by their extensions: a file with another one
/// would be read as something else, or not at all.
fn check_model(model: &Path, scene: &Path) -> Result<(), CliError> {
    let [from, to] = [model, scene].map(|path| path.display());
    let name = model.to_string_lossy();
    let is_built_in = name.starts_with("builtin:");
    if is_built_in {
        // An unknown name is none of a scene.
        scene::load(model)?;
    }
    if is_built_in || has_extension(model, "json") {
        let mend = match scene::is_model(scene) {
            true => format!("the model comes first: octray convert {to} {from}"),
            false => format!("octray render {from} -o picture.png shows it as it is"),
        };
        return refuse(model, "is a scene already, not a model", mend);
    }
    if !scene::is_model(model) {
        let mend = "export the model as .obj, .gltf, .glb or .ply: those are the formats that convert reads";
        return refuse(model, "is not a model", mend);
    }
    if !model.exists() {
        return refuse(model, "does not exist", "give the path of a model: .obj, .gltf, .glb or .ply");
    }
    Ok(())
}
