//! Ctrl-C.

use crate::desk::Desk;
use serde_json::{Value, json};
use std::io::{BufRead, BufReader, Read};
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::{Duration, Instant};

/// How long hearing Ctrl-C, ending a few tiles and writing a picture may take: a few seconds, and a busy
/// machine's share.
const PATIENCE: Duration = Duration::from_secs(20);

/// Starts a command.
fn launch(desk: &Desk, line: &str) -> Child {
    let mut command = Command::new(env!("CARGO_BIN_EXE_octray"));
    command.args(line.split(' ')).current_dir(desk.0.path()).stdout(Stdio::piped());
    command.stderr(Stdio::piped()).spawn().unwrap()
}

/// Starts a rendering on one thread.
fn spawn(desk: &Desk, arguments: &str) -> Child {
    launch(desk, &format!("render {arguments} -o a.exr --threads 1"))
}

/// The same, and waits until it has rendered for two seconds: its own, which a busy machine makes longer.
fn start(desk: &Desk, arguments: &str) -> Child {
    let child = spawn(desk, arguments);
    let start = Instant::now();
    while processor_time(&child).unwrap_or(start.elapsed()) < Duration::from_secs(2) {
        assert!(start.elapsed() < 3 * PATIENCE, "it does nothing");
        sleep(Duration::from_millis(10));
    }
    child
}

/// What its threads have used of the processor; `None` where the system does not say so.
fn processor_time(child: &Child) -> Option<Duration> {
    let stat = std::fs::read_to_string(format!("/proc/{}/stat", child.id())).ok()?;
    // Behind the name, which ends with the last parenthesis, the 12th and 13th fields: of the program and of
    // the system for it, in hundredths of a second.
    let fields = stat.rsplit_once(')')?.1.split_whitespace();
    let ticks: u64 = fields.skip(11).take(2).filter_map(|field| field.parse::<u64>().ok()).sum();
    Some(Duration::from_millis(10 * ticks))
}

/// Starts a rendering, and answers at once when it listens.
#[cfg(target_os = "linux")]
fn start_listening(desk: &Desk, arguments: &str) -> Child {
    let child = spawn(desk, arguments);
    wait_until_listening(&child);
    child
}

#[cfg(target_os = "linux")]
fn wait_until_listening(child: &Child) {
    let listens = || {
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap();
        let caught = status.lines().find_map(|line| line.strip_prefix("SigCgt:")).unwrap();
        // The second bit is that of the second signal, which Ctrl-C sends.
        u64::from_str_radix(caught.trim(), 16).unwrap() & 2 > 0
    };
    while !listens() {
        sleep(Duration::from_millis(1));
    }
}

fn press_ctrl_c(child: &Child) {
    let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(sent.success());
}

/// Waits for the end, but not for long, and answers the exit code, what was printed, and what was said on
/// standard error.
fn end(mut child: Child) -> (Option<i32>, String, String) {
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
    (child.wait().unwrap().code(), said, complained)
}

/// What is printed of a rendering that Ctrl-C ends after two seconds of its own.
fn interrupted(desk: &Desk, arguments: &str) -> String {
    let child = start(desk, arguments);
    press_ctrl_c(&child);
    let (code, said, _) = end(child);
    assert_eq!(code, Some(130), "{said}");
    said
}

/// A white room that shines, and so many balls in it: every path has as many bounces as it may.
fn put_endless_paths(desk: &Desk, balls: usize) {
    let ball = |i: usize| {
        let [x, y, z] = [i % 16, i / 16 % 16, i / 256].map(|step| 0.1 * step as f64 - 0.7);
        json!({ "center": [x, y, z], "radius": 0.01, "material": "white" })
    };
    let room = json!({ "center": [0, 0, 0], "radius": 4, "material": "white" });
    let scene = json!({
        "format": "octray-1",
        "camera": { "position": [0, 0, 3], "look_at": [0, 0, 0], "up": [0, 1, 0], "vertical_fov": 40 },
        "materials": { "white": { "type": "diffuse", "color": [1, 1, 1], "emission": [1, 1, 1] } },
        "spheres": (0..balls).map(ball).chain([room]).collect::<Vec<_>>(),
    });
    desk.write("endless.json", &scene.to_string());
}

/// A picture whose first sample, of two thousand million rays, takes far longer than anyone waits; each of
/// its tiles is quick.
pub fn put_heavy_picture(desk: &Desk) -> &'static str {
    put_endless_paths(desk, 8);
    "endless.json --size 2048x1024 --bounces 1024 --lanes 1 --samples 4"
}

#[test]
fn ctrl_c_saves_the_samples_so_far() {
    let desk = Desk::new();
    let said = interrupted(&desk, "builtin:three --samples 10000000 --size 64x36 --json");
    let report: Value = serde_json::from_str(&said).unwrap();
    assert_eq!(report["interrupted"], true);
    let [samples, most] = ["samples", "most_samples"].map(|key| report[key].as_u64().unwrap());
    assert!((1..10_000_000).contains(&samples) && samples <= most, "{report}");
    assert_eq!(desk.names(), ["a.exr", "model.obj", "scene.json"], "no temporary file stays");
    let pixels = desk.pixels("a.exr");
    assert_eq!(pixels.len(), 64 * 36);

    // Every pixel is that of so many samples, to the bit. Only where the machine was very busy is it not the
    // same number for all.
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
    let said = interrupted(&desk, &format!("{} --json", put_heavy_picture(&desk)));
    let report: Value = serde_json::from_str(&said).unwrap();
    assert_eq!([&report["samples"], &report["most_samples"]], [0, 1], "{report}");
    // Everything shines: what has had a sample is not black.
    let pixels = desk.pixels("a.exr");
    let begun = pixels.iter().filter(|pixel| **pixel != [0.0; 3]).count();
    assert!((256..2048 * 1024).contains(&begun) && pixels.len() == 2048 * 1024, "{begun} pixels");
    assert_eq!(desk.names(), ["a.exr", "endless.json", "model.obj", "scene.json"]);
}

#[test]
fn ctrl_c_is_named_as_the_end() {
    let desk = Desk::new();
    let said = interrupted(&desk, "builtin:three --samples 10000000 --size 64x36");
    assert!(said.contains(" of 10,000,000 samples") && said.ends_with("ended by Ctrl-C\n"), "{said}");
}

/// Two thousand balls, each of which every ray is tested against: the first tile takes a second or some.
#[cfg(target_os = "linux")]
#[test]
fn ctrl_c_before_the_first_tile_is_done_writes_nothing_and_says_so() {
    let desk = Desk::new();
    put_endless_paths(&desk, 2_000);
    desk.write("a.exr", "of yesterday");
    let arguments = "endless.json --size 64x64 --bounces 1024 --lanes 1 --traversal linear --samples 4";
    let child = start_listening(&desk, arguments);
    press_ctrl_c(&child);
    let (code, said, complained) = end(child);
    assert_eq!((code, said.as_str()), (Some(130), ""));
    assert!(complained.contains("nothing was written"), "{complained}");
    assert_eq!(std::fs::read_to_string(desk.path("a.exr")).unwrap(), "of yesterday");
    assert_eq!(desk.names(), ["a.exr", "endless.json", "model.obj", "scene.json"]);
}

#[test]
fn ctrl_c_twice_ends_at_once_and_writes_nothing() {
    let desk = Desk::new();
    let child = start(&desk, put_heavy_picture(&desk));
    press_ctrl_c(&child);
    // Far less than the tiles under way are given to end, and enough for the two signals not to become one.
    sleep(Duration::from_millis(30));
    press_ctrl_c(&child);
    let (code, said, _) = end(child);
    assert_eq!((code, said.as_str()), (Some(130), ""));
    assert_eq!(desk.names(), ["endless.json", "model.obj", "scene.json"]);
}

/// What is said of a command that Ctrl-C ends as soon as it listens, and that prints nothing.
#[cfg(target_os = "linux")]
fn interrupted_at_once(line: &str) -> String {
    let desk = Desk::new();
    let child = launch(&desk, line);
    wait_until_listening(&child);
    press_ctrl_c(&child);
    let (code, printed, said) = end(child);
    assert_eq!((code, printed.as_str()), (Some(130), ""), "{said}");
    said
}

#[cfg(target_os = "linux")]
#[test]
fn interrupted_chart_says_what_it_leaves() {
    let said = interrupted_at_once("chart builtin:three -o charts");
    assert!(said.contains("Ctrl-C: nothing was drawn in `charts`."), "{said}");
}

#[test]
fn interrupted_bench_prints_the_ratios_of_what_it_measured() {
    let desk = Desk::new();
    let mut child = launch(&desk, "bench builtin:three builtin:cornell --size 64x36 --threads 1");
    let printed = BufReader::new(child.stdout.as_mut().unwrap());
    let row = printed.lines().map_while(Result::ok).find(|line| line.starts_with("builtin:three"));
    press_ctrl_c(&child);
    let (code, _, said) = end(child);
    assert_eq!(code, Some(130), "{said}");
    assert!(row.is_some(), "no row of the first scene: {said}");
    let ratios = said.lines().find(|line| line.starts_with("builtin:three")).unwrap_or_default();
    assert!(ratios.contains('×') && !said.contains("builtin:cornell"), "{said}");
    assert!(said.ends_with("Ctrl-C came after 1 of 2 scenes.\n"), "{said}");
}

#[cfg(target_os = "linux")]
#[test]
fn interrupted_bench_says_that_there_is_no_report() {
    let said = interrupted_at_once("bench builtin:three --json");
    assert!(said.contains("Ctrl-C came after 0 of 1 scenes: the report was not written."), "{said}");
}
