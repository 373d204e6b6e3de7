//! Standard output and standard error that are closed or full.

use crate::desk::Desk;
#[cfg(target_os = "linux")]
use std::fs;
use std::process::Stdio;

/// A pipe that is closed at the other end.
fn closed() -> std::io::PipeWriter {
    std::io::pipe().unwrap().1
}

#[test]
fn a_closed_standard_output_is_quiet() {
    let desk = Desk::new();
    let render = "render scene.json -o a.png --samples 1";
    for line in ["", "inspect scene.json --json", render, "--help"] {
        let output = desk.command(line).stdout(closed()).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{line}");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(!said.contains("error") && !said.contains("panicked"), "{line}: {said}");
    }
}

#[test]
fn a_closed_standard_error_does_no_harm() {
    let desk = Desk::new();
    for (line, code) in
        [("inspect nowhere.json", 2), ("render scene.json -o a.exr --exposure 1 --samples 1", 0)]
    {
        let status = desk.command(line).stdout(Stdio::null()).stderr(closed()).status();
        assert_eq!(status.unwrap().code(), Some(code), "{line}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_standard_output_is_an_error() {
    let desk = Desk::new();
    let full = fs::File::options().write(true).open("/dev/full").unwrap();
    let output = desk.command("inspect scene.json").stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write to standard output"));
}
