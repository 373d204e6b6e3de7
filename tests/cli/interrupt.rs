//! Ctrl-C.

use crate::desk::Desk;
use serde_json::Value;
use std::io::Read;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// How long hearing Ctrl-C, ending a few tiles and writing a picture may take: a second, and a busy machine's share.
const PATIENCE: Duration = Duration::from_secs(10);

/// Starts a rendering on one thread, and waits until it listens: before, Ctrl-C ends it as it ends any program.
fn start(desk: &Desk, arguments: &str) -> Child {
    let arguments = format!("render {arguments} -o a.exr --threads 1 --json");
    let mut command = Command::new(env!("CARGO_BIN_EXE_octray"));
    command.args(arguments.split(' ')).current_dir(desk.0.path()).stdout(Stdio::piped());
    let child = command.stderr(Stdio::piped()).spawn().unwrap();
    sleep(Duration::from_secs(2));
    child
}

fn press_ctrl_c(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// Waits for the end, but not for long, and answers the exit code and what was printed.
fn end(mut child: Child) -> (Option<i32>, String) {
    let start = Instant::now();
    while child.try_wait().unwrap().is_none() {
        if start.elapsed() > PATIENCE {
            child.kill().unwrap();
            panic!("Ctrl-C did not end the rendering");
        }
        sleep(Duration::from_millis(10));
    }
    let (mut said, mut complained) = (String::new(), String::new());
    child.stdout.take().unwrap().read_to_string(&mut said).unwrap();
    child.stderr.take().unwrap().read_to_string(&mut complained).unwrap();
    assert!(!complained.contains("samples  "), "progress is for terminals: {complained}");
    (child.wait().unwrap().code(), said)
}

/// A scene whose first sample takes far longer than anyone waits: a ball of many triangles on many pixels, one lane at a time.
fn put_heavy_model(desk: &Desk) -> &'static str {
    let (rows, columns) = (100, 200);
    let mut model = String::new();
    for row in 0..=rows {
        for column in 0..columns {
            let theta = std::f64::consts::PI * f64::from(row) / f64::from(rows);
            let phi = std::f64::consts::TAU * f64::from(column) / f64::from(columns);
            let [x, y, z] = [theta.sin() * phi.cos(), theta.cos(), theta.sin() * phi.sin()];
            model += &format!("v {x} {y} {z}\n");
        }
    }
    for row in 0..rows {
        for column in 0..columns {
            let at = |row: i32, column: i32| row * columns + column % columns + 1;
            let [a, b, c, d] = [(0, 0), (0, 1), (1, 1), (1, 0)].map(|(r, c)| at(row + r, column + c));
            model += &format!("f {a} {b} {c} {d}\n");
        }
    }
    desk.write("heavy.obj", &model);
    "heavy.obj --size 2048x2048 --lanes 1 --samples 4"
}

#[test]
fn ctrl_c_saves_the_samples_so_far() {
    let desk = Desk::new();
    let child = start(&desk, "builtin:three --samples 10000000 --size 64x36");
    press_ctrl_c(&child);
    let (code, said) = end(child);
    assert_eq!(code, Some(130), "{said}");
    let report: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(report["interrupted"], true);
    let [samples, most] = ["samples", "most_samples"].map(|key| report[key].as_u64().unwrap());
    assert!((1..10_000_000).contains(&samples) && samples <= most, "{report}");
    assert_eq!(desk.names(), ["a.exr", "model.obj", "scene.json"], "no temporary file stays");
    let pixels = desk.pixels("a.exr");
    assert_eq!(pixels.len(), 64 * 36);

    // Every pixel is that of so many samples, to the bit. Only where the machine was very busy is it not the same number for all.
    let render = |samples: u64| {
        let samples = samples.to_string();
        let again = ["render", "builtin:three", "-o", "b.exr", "--size", "64x36", "--samples", &samples];
        desk.octray(&again).assert().success();
        desk.pixels("b.exr")
    };
    let mut unknown: Vec<usize> = (0..pixels.len()).collect();
    for samples in samples..=most {
        let again = render(samples);
        unknown.retain(|&index| again[index] != pixels[index]);
    }
    assert!(unknown.is_empty(), "{unknown:?} differ from {samples} to {most} samples");
}

#[test]
fn ctrl_c_ends_a_sample_that_takes_minutes_and_keeps_its_tiles() {
    let desk = Desk::new();
    let child = start(&desk, put_heavy_model(&desk));
    press_ctrl_c(&child);
    let (code, said) = end(child);
    assert_eq!(code, Some(130), "{said}");
    let report: Value = serde_json::from_str(&said).unwrap();
    assert_eq!([&report["samples"], &report["most_samples"]], [0, 1], "{report}");
    // White sky and clay under it: what has had a sample is not black.
    let pixels = desk.pixels("a.exr");
    let begun = pixels.iter().filter(|pixel| **pixel != [0.0; 3]).count();
    assert!((256..2048 * 2048).contains(&begun) && pixels.len() == 2048 * 2048, "{begun} pixels");
    assert_eq!(desk.names(), ["a.exr", "heavy.obj", "model.obj", "scene.json"]);
}

#[test]
fn ctrl_c_twice_ends_at_once_and_writes_nothing() {
    let desk = Desk::new();
    let child = start(&desk, put_heavy_model(&desk));
    press_ctrl_c(&child);
    // Far less than the tiles under way are given to end, and enough for the two signals not to become one.
    sleep(Duration::from_millis(30));
    press_ctrl_c(&child);
    let (code, said) = end(child);
    assert_eq!((code, said.as_str()), (Some(130), ""));
    assert_eq!(desk.names(), ["heavy.obj", "model.obj", "scene.json"]);
}
