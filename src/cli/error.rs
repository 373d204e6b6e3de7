//! Errors of commands, and exit codes.
//!
//! For: [`CliError`], whose messages say what is wrong, where, and how to mend it.

use crate::checkpoint::CheckpointError;
use crate::output::OutputError;
use crate::scene::SceneError;
use std::error::Error;
use std::io;
use std::path::PathBuf;

/// Exit code of a failed check: pictures that differ, for example.
pub const CHECK_FAILED: u8 = 1;
/// Exit code where the input cannot be used: arguments, a scene, an output file, the machine.
pub const BAD_INPUT: u8 = 2;
/// Exit code after Ctrl-C.
pub const INTERRUPTED: u8 = 130;

/// How to build for the machine at hand, from a checkout or from a registry.
pub const REBUILD: &str = env!("OCTRAY_REBUILD");

/// An error and its causes, a line each.
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
    /// An argument's value cannot be used.
    #[error("{option} {value}: {why}")]
    Value { option: &'static str, value: String, why: String },
    /// The name of a file cannot be used.
    #[error("`{}` {what}\n  {mend}", .file.display())]
    Name { file: PathBuf, what: &'static str, mend: String },
    #[error(transparent)]
    Scene(#[from] SceneError),
    #[error(transparent)]
    Output(#[from] OutputError),
    #[error(transparent)]
    Checkpoint(#[from] CheckpointError),
    #[cfg(feature = "window")]
    #[error(transparent)]
    Window(#[from] crate::viewer::WindowError),
    /// There is nothing to show.
    #[cfg(feature = "viewer")]
    #[error("{what}\n  {mend}")]
    Nothing { what: String, mend: &'static str },
    #[cfg(feature = "viewer")]
    #[error("cannot draw in this terminal")]
    Terminal(#[source] io::Error),
    #[error("cannot write to standard output")]
    Stdout(#[source] io::Error),
    #[error(
        "{takes}, and {available} are available\n  give a smaller one, such as --size {}x{}, or end other programs",
        .fits[0], .fits[1]
    )]
    Memory { takes: String, available: String, fits: [u32; 2] },
    #[error(
        "this octray was compiled for instructions that this machine does not have: {}\n  rebuild it here: {}",
        .missing.join(", "), REBUILD
    )]
    Machine { missing: Vec<&'static str> },
}
