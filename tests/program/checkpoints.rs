//! `octray render --checkpoint`: killed at any moment, a rendering ends in the bits of an undisturbed run.

use crate::desk::{Desk, SCENE};
use crate::interrupt::{Running, assert_samples, put_heavy_picture};
use crate::program::{PROGRAM, away_from_home, octray, send_signal};
use crate::waiting::wait_for;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::Value;
use std::fs;
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, SystemTime};

/// Renderings that take a few tenths of a second on one thread.
const PLAIN: &str = "render builtin:cornell --size 48x32 --samples 96";
/// Of a round that is interrupted, the goals are saved too.
const ADAPTIVE: &str = "render builtin:chess --size 64x36 --target-error 0.05";
const SHARD: &str = "render builtin:cornell --size 64x48 --samples 160 --shard 2/2";

/// The picture of a rendering, or the part: its bytes.
fn render(desk: &Desk, arguments: &str, output: &str) -> Vec<u8> {
    let arguments = format!("{arguments} -o {output} --json");
    desk.json(&arguments.split(' ').collect::<Vec<_>>());
    fs::read(desk.path(output)).unwrap()
}

fn spawn(desk: &Desk, arguments: &str) -> Child {
    let mut command = octray();
    command.args(arguments.split(' ')).current_dir(desk.0.path());
    command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap()
}

fn wait_for_file(desk: &Desk, file: &str) {
    wait_for(file, || desk.path(file).exists().then_some(()));
}

/// Milliseconds from 1 to 120, by the clock.
fn moment() -> Duration {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap().as_nanos() as u64;
    Duration::from_millis(1 + (now.wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40) % 120)
}

/// Kills a rendering so many times, each time at another moment after its checkpoint is there; then lets it
/// end, and compares. A rendering that ends before it was killed begins anew.
fn kill(arguments: &str, kills: usize) {
    let desk = &Desk::new();
    // A shard's output and checkpoint may be one file.
    let output = if arguments.contains("--shard") { "c.part" } else { "a.exr" };
    let expected = render(desk, arguments, &format!("undisturbed-{output}"));
    let safe = format!("{arguments} --checkpoint c.part --checkpoint-interval 0.01");
    let mut killed = 0;
    while killed < kills {
        let mut child = spawn(desk, &format!("{safe} -o {output} --threads 1"));
        wait_for_file(desk, "c.part");
        sleep(moment());
        killed += usize::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        if child.wait().unwrap().success() {
            assert!(fs::read(desk.path(output)).unwrap() == expected, "after {killed} kills");
            fs::remove_file(desk.path("c.part")).unwrap();
        }
    }
    let words = format!("{safe} -o {output} --threads 2 --lanes 1 --json");
    let report = desk.json(&words.split(' ').collect::<Vec<_>>());
    assert!(desk.path("c.part").exists(), "the checkpoint stays");
    assert!(fs::read(desk.path(output)).unwrap() == expected, "after {killed} kills: {report}");
    assert!(!desk.names().iter().any(|name| name.ends_with(".tmp")), "{:?}", desk.names());
}

#[test]
fn killed_rendering_resumes_to_the_same_bits() {
    kill(PLAIN, 3);
}

#[test]
fn killed_rendering_to_a_target_error_resumes_to_the_same_bits() {
    kill(ADAPTIVE, 3);
}

#[test]
#[ignore = "takes a quarter of a minute"]
fn hundred_kills_resume_to_the_same_bits() {
    kill(PLAIN, 40);
    kill(ADAPTIVE, 40);
    kill(SHARD, 20);
}

#[test]
fn rendering_goes_on_from_its_checkpoint_to_more_samples() {
    let desk = Desk::new();
    let at = |samples: &str| format!("render builtin:three --size 40x24 --samples {samples}");
    let expected = [render(&desk, &at("5"), "b.exr"), render(&desk, &at("12"), "b.exr")];
    let with = |samples| format!("{} --checkpoint c.part", at(samples));
    assert!(render(&desk, &with("5"), "a.exr") == expected[0]);
    let first = fs::read(desk.path("c.part")).unwrap();
    let report = desk.json(&format!("{} -o a.exr --json", with("5")).split(' ').collect::<Vec<_>>());
    assert_eq!((&report["resumed_samples"], &report["samples"]), (&5.0.into(), &5.into()), "{report}");
    assert!(fs::read(desk.path("a.exr")).unwrap() == expected[0], "a complete one gives its picture again");
    assert!(fs::read(desk.path("c.part")).unwrap() == first);
    assert!(render(&desk, &with("12"), "a.exr") == expected[1], "and so does one with more samples");
    desk.octray(&format!("{} -o a.exr", with("12")).split(' ').collect::<Vec<_>>())
        .assert()
        .success()
        .stdout(contains("12 samples (12 resumed)"));
    let fewer = format!("{} -o a.exr", with("5"));
    desk.refuses(&fewer.split(' ').collect::<Vec<_>>(), &["--samples 5", "c.part", "give 12 or more"]);
}

#[test]
fn ctrl_c_and_time_limits_leave_what_was_done() {
    let desk = Desk::new();
    let longer = PLAIN.replace("--samples 96", "--samples 480");
    let expected = render(&desk, &longer, "b.exr");
    let with = format!("{longer} --checkpoint c.part --checkpoint-interval 1000 -o a.exr --threads 1");
    let limited = format!("{with} --time-limit 0.1 --json");
    let report = desk.json(&limited.split(' ').collect::<Vec<_>>());
    assert_eq!(report["ended_by"], "time-limit", "{report}");
    let first = report["mean_samples"].as_f64().unwrap();
    let part = fs::read(desk.path("c.part")).unwrap();
    let mut child = spawn(&desk, &with.replace("-interval 1000", "-interval 0.001"));
    wait_for("a checkpoint of more", || (fs::read(desk.path("c.part")).ok()? != part).then_some(()));
    send_signal("INT", child.id());
    child.wait().unwrap();
    let report: Value = desk.json(&format!("{with} --json").split(' ').collect::<Vec<_>>());
    assert!(fs::read(desk.path("a.exr")).unwrap() == expected);
    let resumed = report["resumed_samples"].as_f64().unwrap();
    assert!(0.0 < first && first < resumed, "{first} samples, then {report}");
}

/// A sample of the picture takes minutes.
#[test]
fn checkpoint_is_saved_within_a_sample() {
    let desk = Desk::new();
    let picture = format!("render {} --shard 1/1", put_heavy_picture(&desk));
    let part = "-o c.part --checkpoint c.part --checkpoint-interval 0.05";
    let mut child = spawn(&desk, &format!("{picture} {part} --threads 1"));
    wait_for_file(&desk, "c.part");
    child.kill().unwrap();
    child.wait().unwrap();
    desk.octray(&["merge", "c.part", "-o", "a.exr"])
        .assert()
        .code(2)
        .stderr(contains("`c.part` is not complete"));
    let words = format!("{picture} {part} --time-limit 0.001 --json");
    let report = desk.json(&words.split(' ').collect::<Vec<_>>());
    let resumed = report["resumed_samples"].as_f64().unwrap();
    assert!(0.0 < resumed && resumed < 1.0, "{report}");
}

#[test]
fn checkpoint_of_something_else_is_refused_and_kept() {
    let desk = Desk::new();
    let with = |more: &str| {
        let scene = if more.contains("builtin") { "" } else { "scene.json " };
        format!("render {scene}{more} -o a.exr --checkpoint c.part")
    };
    desk.octray(&with("--samples 3").split(' ').collect::<Vec<_>>()).assert().success();
    let kept = fs::read(desk.path("c.part")).unwrap();
    let refused = |more: &str, words: &[&str]| {
        let words = [&["`c.part`"], words].concat();
        desk.refuses(&with(more).split(' ').collect::<Vec<_>>(), &words);
        assert!(fs::read(desk.path("c.part")).unwrap() == kept, "{more}");
    };
    for (more, words) in [
        (
            "builtin:three --size 8x8 --samples 4",
            &["another picture", "spheres of the scene: not the same"][..],
        ),
        ("--samples 4 --seed 7", &["seed: 0, and here 7"]),
        ("--samples 4 --size 9x8", &["resolution: [8,8], and here [9,8]"]),
        ("--samples 4 --bounces 3", &["max bounces: 4, and here 3"]),
        ("--samples 4 --sampler random", &["sampler: sobol, and here random"]),
        ("--samples 4 --clamp 0.5", &["clamp: none, and here 0.5"]),
        ("--samples 4 --sphere naive", &["sphere: robust, and here naive"]),
        ("--target-error 0.1", &["target: none, and here [0.1,16,16384]"]),
    ] {
        refused(more, words);
    }
    desk.write("scene.json", &SCENE.replace("0.8, 0.5, 0.3", "0.8, 0.5, 0.4"));
    refused("--samples 4", &["materials of the scene: not the same"]);
    desk.write("scene.json", SCENE);
    // What changes no bit may differ.
    let free = with("--samples 4 --threads 2 --lanes 1 --pipeline general --traversal linear --exposure 1");
    desk.octray(&free.split(' ').collect::<Vec<_>>()).assert().success();

    for (place, words) in [
        (8, &["version 4 of the format", "reads version 3"][..]),
        (40, &["damaged", "checksum"]),
        (kept.len() - 20, &["damaged", "checksum"]),
    ] {
        let mut bytes = kept.clone();
        bytes[place] ^= 1;
        fs::write(desk.path("d.part"), &bytes).unwrap();
        let arguments = with("--samples 4").replace("c.part", "d.part");
        desk.refuses(&arguments.split(' ').collect::<Vec<_>>(), words);
        assert!(fs::read(desk.path("d.part")).unwrap() == bytes);
    }
    let refuses = |arguments: &str, words: &[&str]| {
        desk.refuses(&arguments.split(' ').collect::<Vec<_>>(), words);
    };
    refuses("render scene.json -o a.exr --checkpoint scene.json", &["scene.json", "not a checkpoint"]);
    refuses("render scene.json -o a.exr --checkpoint b.png", &["--checkpoint b.png", ".part"]);
    refuses("render scene.json -o a.exr --checkpoint no/c.part", &["mkdir -p 'no'"]);
    refuses("render scene.json -o a.exr --checkpoint-interval 3", &["--checkpoint"]);
    assert_eq!(desk.path("scene.json").metadata().unwrap().len(), SCENE.len() as u64);
}

/// A limit on the size of files makes writing fail half way, as a full disk does.
#[test]
fn full_disk_costs_neither_the_picture_nor_the_earlier_checkpoint() {
    let desk = Desk::new();
    let expected = render(&desk, PLAIN, "b.exr");
    let with = format!("{PLAIN} --checkpoint c.part --checkpoint-interval 0.001 -o a.exr --threads 1");
    let first = with.replace("--samples 96", "--samples 20");
    desk.octray(&first.split(' ').collect::<Vec<_>>()).assert().success();
    let kept = fs::read(desk.path("c.part")).unwrap();
    // In blocks of 512 bytes: more than the picture takes, less than the checkpoint.
    let limit = 512 * 48;
    assert!(expected.len() < limit && limit < kept.len(), "{} and {}", expected.len(), kept.len());
    let script = format!("trap '' XFSZ; ulimit -f 48; exec '{PROGRAM}' {with}");
    let ended = away_from_home("sh").args(["-c", &script]).current_dir(desk.0.path()).output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(2), "{said}");
    for words in ["warning: no checkpoint was saved", "error: writing `c.part` failed", "disk has room"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert!(fs::read(desk.path("a.exr")).unwrap() == expected, "the picture is written");
    assert!(fs::read(desk.path("c.part")).unwrap() == kept, "the earlier checkpoint is whole");
    assert!(!desk.names().iter().any(|name| name.ends_with(".tmp")), "{:?}", desk.names());
}

#[test]
fn folder_that_vanishes_costs_no_picture() {
    let desk = Desk::new();
    fs::create_dir(desk.path("gone")).unwrap();
    let of =
        |samples: u64| format!("render builtin:cornell --size 48x32 --samples {samples} -o a.exr --json");
    let with = "--checkpoint gone/c.part --checkpoint-interval 0.001 --threads 1";
    let running = Running::start(&desk, &format!("{} {with}", of(1_000_000)));
    wait_for_file(&desk, "gone/c.part");
    fs::rename(desk.path("gone"), desk.path("elsewhere")).unwrap();
    running.wait_until_it_says("warning: no checkpoint was saved");
    running.press_ctrl_c();
    let (code, printed, said) = running.end();
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("error: the folder `gone`"), "{said}");
    assert_eq!(said.matches("warning: no checkpoint").count(), 1, "{said}");
    let report: Value = serde_json::from_str(&printed).unwrap();
    let samples = ["samples", "most_samples"].map(|key| report[key].as_u64().unwrap());
    assert_samples(&desk, "builtin:cornell", [48, 32], &desk.pixels("a.exr"), samples);
    // The earlier checkpoint is whole.
    fs::rename(desk.path("elsewhere"), desk.path("gone")).unwrap();
    let more = samples[1] + 1;
    let expected = render(&desk, &of(more).replace(" -o a.exr --json", ""), "b.exr");
    desk.octray(&format!("{} {with}", of(more)).split(' ').collect::<Vec<_>>())
        .assert()
        .success()
        .stderr(contains("error").not());
    assert!(fs::read(desk.path("a.exr")).unwrap() == expected);
}
