//! The only writer to standard output and standard error. It never panics when the other end is closed.

use super::error::CliError;
use serde::Serialize;
use std::io::{self, Write};
use std::process::ExitCode;

/// Writes text to standard output.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(CliError::Stdout)
}

/// Prints what a command found: text or, with `--json`, a report.
#[derive(Clone, Copy)]
pub struct Printer {
    pub json: bool,
}

impl Printer {
    /// Prints text, but not with `--json`.
    pub fn text(self, text: &str) -> Result<(), CliError> {
        if self.json { Ok(()) } else { print(text) }
    }

    /// Prints a report as indented JSON, but only with `--json`. Returns the exit code of its checks, which
    /// is 1 if one of them `failed`.
    pub fn end(self, report: &impl Serialize, failed: bool) -> Result<ExitCode, CliError> {
        if self.json {
            let text =
                serde_json::to_string_pretty(report).map_err(|error| CliError::Stdout(error.into()))?;
            print(&(text + "\n"))?;
        }
        Ok(if failed { ExitCode::FAILURE } else { ExitCode::SUCCESS })
    }
}

/// Writes a line to standard error. A closed standard error loses the line.
pub fn note(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Warns in a debug build that its speeds mean nothing; `command` as typed after `octray`.
pub fn warn_of_debug_build(command: &str) {
    if cfg!(debug_assertions) {
        warn(&format!(
            "this is a debug build: its speeds mean nothing. Use cargo run --release -- {command}."
        ));
    }
}

/// Writes a warning to standard error.
pub fn warn(sentence: &str) {
    note(&format!("warning: {sentence}"));
}
