//! `octray inspect`: what a scene contains, and which methods and traversal it gets.

use super::args::InspectArgs;
use super::error::{CHECK_FAILED, CliError};
use super::scenes;
use super::terminal;
use crate::report::inspection::Inspection;
use std::process::ExitCode;

/// Runs the command.
pub fn run(options: InspectArgs) -> Result<ExitCode, CliError> {
    let scene = scenes::load(&options.scene)?;
    let inspection = Inspection::of(options.scene, &scene);
    if options.json {
        terminal::print_json(&inspection)?;
    } else {
        terminal::print(&inspection.text())?;
    }
    Ok(if inspection.is_valid() { ExitCode::SUCCESS } else { ExitCode::from(CHECK_FAILED) })
}
