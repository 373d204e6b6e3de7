//! Standard output and standard error that are closed or full.

use crate::desk::Desk;
use crate::program::octray;
#[cfg(target_os = "linux")]
use std::fs;
use std::path::Path;
use std::process::Stdio;

/// Runs the program with standard output closed at the other end.
fn with_closed_output(folder: &Path, arguments: &[&str]) -> std::process::Output {
    let mut command = octray();
    let (reader, writer) = std::io::pipe().unwrap();
    drop(reader);
    command.args(arguments).current_dir(folder).stdout(writer).stderr(Stdio::piped());
    command.spawn().unwrap().wait_with_output().unwrap()
}

#[test]
fn a_closed_standard_output_is_quiet() {
    let desk = Desk::new();
    for arguments in [
        &[][..],
        &["inspect", "scene.json"],
        &["inspect", "scene.json", "--json"],
        &["render", "scene.json", "-o", "a.png", "--samples", "1"],
        &["--help"],
    ] {
        let output = with_closed_output(desk.0.path(), arguments);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!said.contains("error") && !said.contains("panicked"), "{arguments:?}: {said}");
    }
}

#[test]
fn a_closed_standard_error_does_no_harm() {
    let desk = Desk::new();
    for (arguments, code) in [
        (&["inspect", "nowhere.json"][..], 2),
        (&["render", "scene.json", "-o", "a.exr", "--exposure", "1", "--samples", "1"], 0),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut command = octray();
        command.args(arguments).current_dir(desk.0.path()).stdout(Stdio::null()).stderr(writer);
        assert_eq!(command.status().unwrap().code(), Some(code), "{arguments:?}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_an_error() {
    let desk = Desk::new();
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let mut command = octray();
    command.args(["inspect", "scene.json"]).current_dir(desk.0.path()).stdout(full).stderr(Stdio::piped());
    let output = command.spawn().unwrap().wait_with_output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write to standard output"));
}
