//! The only writer to standard output and standard error. It never panics when the other end is closed.
//!
//! For: [`print()`], [`print_json`], [`note`], [`warn`], [`warn_of_debug_build`].

use super::error::CliError;
use serde::Serialize;
use std::io::{self, Write};

/// Writes text to standard output.
pub fn print(text: &str) -> Result<(), CliError> {
    let mut out = io::stdout().lock();
    out.write_all(text.as_bytes()).and_then(|()| out.flush()).map_err(CliError::Stdout)
}

/// Writes a report to standard output as indented JSON.
pub fn print_json(report: &impl Serialize) -> Result<(), CliError> {
    let text = serde_json::to_string_pretty(report).map_err(|error| CliError::Stdout(error.into()))?;
    print(&(text + "\n"))
}

/// Writes a line to standard error. A closed standard error loses the line.
pub fn note(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Warns in a debug build that measured figures mean nothing; `command` as typed after `octray`.
pub fn warn_of_debug_build(command: &str) {
    if cfg!(debug_assertions) {
        warn(&format!(
            "this is a debug build: its figures mean nothing. Use cargo run --release -- {command}."
        ));
    }
}

/// Writes a warning to standard error.
pub fn warn(sentence: &str) {
    note(&format!("warning: {sentence}"));
}
