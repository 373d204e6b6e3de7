//! `octray bench`.

use super::error::CliError;
use super::options::BenchOptions;
use std::process::ExitCode;

/// Runs the command.
pub fn run(_options: BenchOptions) -> Result<ExitCode, CliError> {
    Err(CliError::Unavailable { command: "bench" })
}
