//! The only writer to standard output and standard error: it never panics, whoever closes the other end.
//!
//! For: [`print()`], [`print_json`], [`note`], [`warn`]; and [`figure`], how numbers are written. May import: `error`. Must never know: what is said.

use super::error::CliError;
use crate::wording::grouped;
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

/// A number above 0 with so many decimals, or with as many more as leave it two digits that say something.
pub fn figure(x: f64, decimals: usize) -> String {
    // As a float's cast saturates, 0 and what is not finite get no decimals without end.
    let needed = (1.0 - x.log10().floor()).clamp(0.0, 12.0) as usize;
    grouped(format!("{x:.0$}", decimals.max(if x > 0.0 { needed } else { 0 })))
}

/// Writes a line to standard error. A closed standard error loses it: there is nowhere left to complain.
pub fn note(line: &str) {
    let _ = writeln!(io::stderr().lock(), "{line}");
}

/// Says on standard error that something is odd but not wrong.
pub fn warn(sentence: &str) {
    note(&format!("warning: {sentence}"));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figure_never_shows_less_than_two_digits() {
        for (x, decimals, text) in [
            (123.46, 1, "123.5"),
            (1.25, 1, "1.2"),
            (0.96, 1, "0.96"),
            (0.0432, 1, "0.043"),
            (1.2e-7, 1, "0.00000012"),
            (0.0, 1, "0.0"),
            (1667.3, 0, "1,667"),
            (12_345.678, 1, "12,345.7"),
            (12.3, 0, "12"),
            (5.31, 0, "5.3"),
            (0.27, 0, "0.27"),
        ] {
            assert_eq!(figure(x, decimals), text);
        }
    }
}
