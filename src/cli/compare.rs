//! `octray compare`.

use super::error::CliError;
use super::options::CompareOptions;
use std::process::ExitCode;

/// Runs the command.
pub fn run(_options: CompareOptions) -> Result<ExitCode, CliError> {
    Err(CliError::Unavailable { command: "compare" })
}
