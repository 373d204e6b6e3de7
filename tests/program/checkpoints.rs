//! `octray render --checkpoint`: killed at any moment, a rendering ends in the bits of an undisturbed run.

use crate::desk::{Desk, SCENE, number};
use crate::interrupt::{Running, assert_samples, put_heavy_picture};
use crate::program::{PROGRAM, away_from_home, send_signal};
use crate::waiting::wait_for;
use serde_json::Value;
use std::fs;
use std::process::{Child, Stdio};
use std::thread::sleep;
use std::time::{Duration, SystemTime};

/// Renderings that take a few tenths of a second on one thread.
const PLAIN: &str = "builtin:cornell --size 48x32 --samples 96";
/// An adaptive rendering, whose checkpoint also has the goals of an interrupted round.
const ADAPTIVE: &str = "builtin:chess --size 64x36 --target-error 0.05";
const SHARD: &str = "builtin:cornell --size 64x48 --samples 160 --shard 2/2";

fn spawn(desk: &Desk, arguments: &str) -> Child {
    let mut command = desk.command(&format!("render {arguments}"));
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
    let expected = desk.rendered(arguments, &format!("undisturbed-{output}"));
    let safe = format!("{arguments} --checkpoint c.part --checkpoint-interval 0.01");
    let mut killed = 0;
    while killed < kills {
        let mut child = spawn(desk, &format!("{safe} -o {output} --threads 1"));
        wait_for_file(desk, "c.part");
        sleep(moment());
        killed += usize::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        if child.wait().unwrap().success() {
            assert!(desk.bytes(output) == expected, "after {killed} kills");
            fs::remove_file(desk.path("c.part")).unwrap();
        }
    }
    let resumed = desk.rendered(&format!("{safe} --threads 2 --lanes 1"), output);
    assert!(desk.path("c.part").exists(), "the checkpoint stays");
    assert!(resumed == expected, "after {killed} kills");
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
    let at = |samples: &str| format!("builtin:three --size 40x24 --samples {samples}");
    let expected = ["5", "12"].map(|samples| desk.rendered(&at(samples), "b.exr"));
    let with = |samples| format!("{} --checkpoint c.part", at(samples));
    assert!(desk.rendered(&with("5"), "a.exr") == expected[0]);
    let first = desk.bytes("c.part");
    let report = desk.json(&format!("render {} -o a.exr", with("5")));
    assert_eq!((&report["resumed_samples"], &report["samples"]), (&5.0.into(), &5.into()), "{report}");
    assert!(desk.bytes("a.exr") == expected[0], "a complete one gives its picture again");
    assert!(desk.bytes("c.part") == first);
    assert!(desk.rendered(&with("12"), "a.exr") == expected[1], "and so does one with more samples");
    let printed = desk.run(&format!("render {} -o a.exr", with("12")));
    assert!(printed.contains("12 samples (12 resumed)"), "{printed}");
    desk.refuses(&format!("render {} -o a.exr", with("5")), &["--samples 5", "c.part", "give 12 or more"]);
}

#[test]
fn ctrl_c_and_time_limits_leave_what_was_done() {
    let desk = Desk::new();
    let longer = PLAIN.replace("--samples 96", "--samples 480");
    let expected = desk.rendered(&longer, "b.exr");
    let with = format!("{longer} --checkpoint c.part --checkpoint-interval 1000 -o a.exr --threads 1");
    let report = desk.json(&format!("render {with} --time-limit 0.1"));
    assert_eq!(report["ended_by"], "time-limit", "{report}");
    let first = number(&report["mean_samples"]);
    let part = desk.bytes("c.part");
    let mut child = spawn(&desk, &with.replace("-interval 1000", "-interval 0.001"));
    wait_for("a checkpoint of more", || (fs::read(desk.path("c.part")).ok()? != part).then_some(()));
    send_signal("INT", child.id());
    child.wait().unwrap();
    let report = desk.json(&format!("render {with}"));
    assert!(desk.bytes("a.exr") == expected);
    let resumed = number(&report["resumed_samples"]);
    assert!(0.0 < first && first < resumed, "{first} samples, then {report}");
}

/// A sample of the picture takes minutes.
#[test]
fn checkpoint_is_saved_within_a_sample() {
    let desk = Desk::new();
    let picture = format!("{} --shard 1/1", put_heavy_picture(&desk));
    let part = "-o c.part --checkpoint c.part --checkpoint-interval 0.05";
    let mut child = spawn(&desk, &format!("{picture} {part} --threads 1"));
    wait_for_file(&desk, "c.part");
    child.kill().unwrap();
    child.wait().unwrap();
    desk.refuses("merge c.part -o a.exr", &["`c.part` is not complete"]);
    let report = desk.json(&format!("render {picture} {part} --time-limit 0.001"));
    let resumed = number(&report["resumed_samples"]);
    assert!(0.0 < resumed && resumed < 1.0, "{report}");
}

#[test]
fn checkpoint_of_something_else_is_refused_and_kept() {
    let desk = Desk::new();
    let with = |more: &str| format!("render {more} -o a.exr --checkpoint c.part");
    desk.run(&with("scene.json --samples 3"));
    let kept = desk.bytes("c.part");
    desk.write("other.json", SCENE.replace("0.8, 0.5, 0.3", "0.8, 0.5, 0.4"));
    for (more, words) in [
        ("other.json --samples 4", "materials of the scene: not the same"),
        ("scene.json --samples 4 --size 9x8", "resolution: [8,8], and here [9,8]"),
        ("scene.json --samples 4 --sampler random", "sampler: sobol, and here random"),
        ("scene.json --target-error 0.1", "target: none, and here [0.1,16,16384]"),
    ] {
        desk.refuses(&with(more), &["`c.part`", "another picture", words]);
        assert!(desk.bytes("c.part") == kept, "{more}");
    }
    // Options that change no bit may differ.
    let free =
        "scene.json --samples 4 --threads 2 --lanes 1 --pipeline general --traversal linear --exposure 1";
    desk.run(&with(free));

    let version = kept[8];
    let versions = [format!("version {} of the format", version ^ 1), format!("reads version {version}")];
    let damage = ["damaged", "checksum"];
    for (place, words) in
        [(8, versions.each_ref().map(|words| &words[..])), (40, damage), (kept.len() - 20, damage)]
    {
        let mut bytes = kept.clone();
        bytes[place] ^= 1;
        fs::write(desk.path("d.part"), &bytes).unwrap();
        desk.refuses("render scene.json -o a.exr --checkpoint d.part --samples 4", &words);
        assert!(desk.bytes("d.part") == bytes);
    }
    desk.refuses("render scene.json -o a.exr --checkpoint scene.json", &["scene.json", "not a checkpoint"]);
    desk.refuses("render scene.json -o a.exr --checkpoint b.png", &["--checkpoint b.png", ".part"]);
    assert_eq!(desk.text("scene.json"), SCENE);
}

/// A limit on the size of files makes writing fail half way, as a full disk does.
#[test]
fn full_disk_costs_neither_the_picture_nor_the_earlier_checkpoint() {
    let desk = Desk::new();
    let expected = desk.rendered(PLAIN, "b.exr");
    let with = format!("render {PLAIN} --checkpoint c.part --checkpoint-interval 0.001 -o a.exr --threads 1");
    desk.run(&with.replace("--samples 96", "--samples 20"));
    let kept = desk.bytes("c.part");
    // The limit is in blocks of 512 bytes: more than the picture takes, less than the checkpoint.
    let limit = 512 * 48;
    assert!(expected.len() < limit && limit < kept.len(), "{} and {}", expected.len(), kept.len());
    let script = format!("trap '' XFSZ; ulimit -f 48; exec '{PROGRAM}' {with}");
    let ended = away_from_home("sh").args(["-c", &script]).current_dir(desk.path("")).output().unwrap();
    let said = String::from_utf8(ended.stderr).unwrap();
    assert_eq!(ended.status.code(), Some(2), "{said}");
    for words in ["warning: no checkpoint was saved", "error: writing `c.part` failed", "disk has room"] {
        assert!(said.contains(words), "{words}: {said}");
    }
    assert!(desk.bytes("a.exr") == expected, "the picture is written");
    assert!(desk.bytes("c.part") == kept, "the earlier checkpoint is whole");
    assert!(!desk.names().iter().any(|name| name.ends_with(".tmp")), "{:?}", desk.names());
}

#[test]
fn folder_that_vanishes_costs_no_picture() {
    let desk = Desk::new();
    fs::create_dir(desk.path("gone")).unwrap();
    let of = |samples: u64| format!("builtin:cornell --size 48x32 --samples {samples}");
    let with = "--checkpoint gone/c.part --checkpoint-interval 0.001 --threads 1";
    let running = Running::start(&desk, &format!("render {} {with} -o a.exr --json", of(1_000_000)));
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
    let expected = desk.rendered(&of(more), "b.exr");
    let said = desk.warnings(&format!("render {} {with} -o a.exr", of(more)));
    assert!(!said.contains("error"), "{said}");
    assert!(desk.bytes("a.exr") == expected);
}
