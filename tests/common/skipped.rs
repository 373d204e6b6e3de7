//! What is not tested where something is missing: a line says so, and with `CI=true` it is a failure.
#![allow(dead_code)] // Every test file takes its own part.

use std::io::Write;
use std::path::{Path, PathBuf};

/// Says that a test is skipped, and why; fails where nothing is to be skipped.
pub fn skip(reason: &str) {
    assert!(
        std::env::var_os("CI").is_none_or(|ci| ci != "true"),
        "with CI=true nothing is skipped: {reason}"
    );
    say(reason);
}

/// A mesh beside the project, in `../shared/meshes`; `None`, and a line about it, where it is missing: meshes
/// are no part of the project.
pub fn mesh(name: &str) -> Option<PathBuf> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let root = here.ancestors().find(|folder| folder.join("Cargo.lock").exists()).expect("a checkout");
    let path = root.join("../shared/meshes").join(name);
    if !path.is_file() {
        say(&format!("there is no ../shared/meshes/{name}"));
        return None;
    }
    Some(path)
}

/// Not by `eprintln!`, which tests keep to themselves.
fn say(reason: &str) {
    let _ = writeln!(std::io::stderr(), "skipped: {reason}");
}
