//! The program under test, away from the surroundings of whoever tests: none of their variables reaches it
//! (`COLUMNS`, `NO_COLOR`, `RAYON_NUM_THREADS` and the like), a test sets what it depends on.
#![allow(dead_code)] // Every test file takes its own part.

use std::process::Command;

/// What is kept of the environment: where programs and temporary files are, and what coverage writes to.
pub const KEPT: [&str; 4] = ["PATH", "TMPDIR", "SystemRoot", "LLVM_PROFILE_FILE"];

pub const PROGRAM: &str = env!("CARGO_BIN_EXE_octray");

/// The program, before its arguments.
pub fn octray() -> Command {
    away_from_home(PROGRAM)
}

/// A program with nothing but [`KEPT`] in its environment.
pub fn away_from_home(program: &str) -> Command {
    let mut command = Command::new(program);
    command.env_clear().envs(kept());
    command
}

pub fn kept() -> impl Iterator<Item = (&'static str, std::ffi::OsString)> {
    KEPT.into_iter().filter_map(|name| Some((name, std::env::var_os(name)?)))
}

/// Sends a signal by its name: `INT`, `TERM`.
#[cfg(unix)]
pub fn send_signal(name: &str, id: u32) {
    let sent = Command::new("sh").args(["-c", &format!("kill -{name} {id}")]).status().unwrap();
    assert!(sent.success(), "kill -{name} {id}");
}
