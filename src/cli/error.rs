//! Errors of commands, and exit codes.

use crate::checkpoint::CheckpointError;
use crate::output::OutputError;
use crate::scene::SceneError;
use std::error::Error;
use std::fmt::Display;
use std::io;

/// Exit code where the input cannot be used: arguments, a scene, an output file, the machine.
pub const BAD_INPUT: u8 = 2;
/// Exit code after Ctrl-C.
pub const INTERRUPTED: u8 = 130;

/// How to build for the machine at hand, from a checkout or from a registry.
pub const REBUILD: &str = env!("OCTRAY_REBUILD");

/// Returns an error and its causes, a line each.
pub fn describe(error: &dyn Error) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text.push_str(&format!("\n  because: {error}"));
        cause = error.source();
    }
    text
}

/// Why a command failed.
#[derive(Debug, thiserror::Error)]
pub enum CliError {
    /// Arguments, or the machine, cannot be used.
    #[error("{0}")]
    Input(String),
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    #[cfg(feature = "window")]
    #[error(transparent)]
    Window(#[from] crate::viewer::WindowError),
    #[cfg(feature = "viewer")]
    #[error("cannot draw in this terminal")]
    Terminal(#[source] io::Error),
    #[error("cannot write to standard output")]
    Stdout(#[source] io::Error),
}

/// Returns the error for an input that cannot be used, with what to do instead.
pub fn refuse_input(what: impl Display, instead: impl Display) -> CliError {
    CliError::Input(format!("{what}\n  {instead}"))
}

/// Returns the error for an option's value that cannot be used, with what to give instead.
pub fn refuse(option: &str, value: impl Display, instead: impl Display) -> CliError {
    CliError::Input(format!("{option} {value}: {instead}"))
}
