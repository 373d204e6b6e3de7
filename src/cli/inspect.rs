//! `octray inspect`: what a scene contains, and which methods and traversal it gets.

use super::error::{CliError, checked};
use super::groups::SCENE;
use super::scenes;
use super::terminal::Printer;
use crate::report::inspection::Inspection;
use std::ffi::OsString;
use std::process::ExitCode;

/// Show what a scene contains.
///
/// Prints the numbers of objects, materials and textures, their memory, the camera, and warnings about the
/// file; the features that the scene needs; the traversal and why, either testing every primitive or a
/// hierarchy of boxes, which is built, timed and checked; and the default methods and why. Exits with 1 if
/// the hierarchy is invalid.
#[derive(Debug, clap::Parser)]
#[command(after_help = "Example:\n  octray inspect builtin:three --json")]
pub struct Options {
    #[arg(value_name = "SCENE", help = SCENE)]
    scene: OsString,
    /// Print the report as JSON (schema octray-inspect-1).
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(options: Options) -> Result<ExitCode, CliError> {
    let scene = scenes::load(&options.scene)?;
    let inspection = Inspection::of(options.scene.to_string_lossy().into_owned(), &scene);
    let out = Printer { json: options.json };
    out.text(&inspection.text())?;
    out.report(&inspection)?;
    Ok(checked(!inspection.is_valid()))
}
