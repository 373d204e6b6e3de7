//! Ctrl-C.

use crate::desk::Desk;
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// Far longer than it takes to notice Ctrl-C, even on a busy machine.
const PATIENCE: Duration = Duration::from_secs(60);

/// Starts a rendering that would take hours.
fn start(desk: &Desk) -> Child {
    let arguments = "render builtin:three -o a.exr --samples 10000000 --size 64x36 --threads 1 --json";
    let mut command = Command::new(env!("CARGO_BIN_EXE_octray"));
    command.args(arguments.split(' ')).current_dir(desk.0.path()).stdout(Stdio::piped());
    command.spawn().unwrap()
}

/// Waits for the end, but not for ever, and answers the exit code and what was printed.
fn end(mut child: Child) -> (Option<i32>, String) {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("Ctrl-C did not end the rendering");
        }
        sleep(Duration::from_millis(10));
    }
    let mut said = String::new();
    child.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    (child.wait().unwrap().code(), said)
}

#[test]
fn ctrl_c_saves_the_samples_so_far() {
    let desk = Desk::new();
    let child = start(&desk);
    // Until the program listens, Ctrl-C ends it as it ends any; it listens after some milliseconds.
    sleep(Duration::from_secs(2));
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
    let (code, said) = end(child);
    assert_eq!(code, Some(130), "{said}");
    let report: serde_json::Value = serde_json::from_str(&said).unwrap();
    assert_eq!(report["interrupted"], true);
    let samples = report["samples"].as_u64().unwrap();
    assert!((1..10_000_000).contains(&samples), "{report}");
    assert_eq!(desk.names(), ["a.exr", "model.obj", "scene.json"], "no temporary file stays");
    let pixels = desk.pixels("a.exr");
    assert_eq!(pixels.len(), 64 * 36);

    // The picture is that of so many samples, to the bit.
    let again =
        ["render", "builtin:three", "-o", "b.exr", "--size", "64x36", "--samples", &samples.to_string()];
    desk.octray(&again).assert().success();
    assert!(desk.pixels("b.exr") == pixels, "{samples} samples differ from {samples} samples");
}
