//! `octray render` with a target error, a time limit, a map of its samples.

use crate::desk::{Desk, number};
use predicates::prelude::*;
use serde_json::json;

#[test]
fn target_error_ends_the_rendering_and_report_and_map_say_so() {
    let desk = Desk::new();
    let line = "render builtin:chess -o a.exr --size 96x54 --target-error 0.1";
    let report = desk.json(line);
    assert_eq!((&report["ended_by"], &report["target_error"]), (&json!("target-error"), &json!(0.1)));
    let [rms, largest] = ["rms", "largest"].map(|key| number(&report["estimated_error"][key]));
    assert!(rms > 0.01 && rms <= 0.1 && largest > rms && largest <= 0.2, "{report}");
    let [least, mean, most] = ["samples", "mean_samples", "most_samples"].map(|key| number(&report[key]));
    assert!(least == 16.0 && least < mean && mean < most && most <= 1024.0, "{report}");

    let first = desk.bytes("a.exr");
    let said = desk.octray(&format!("{line} --lanes 1 --threads 2 --samples-map map.exr")).assert().success();
    said.stdout(
        predicate::str::is_match(
            r"(?x)^a\.exr:\ 96×54,\ 16\ to\ \d+\ samples\ \(mean\ \d+\),\ \d+\.\d\d\ s,\ .*\n
            ended\ by\ the\ target\ error;\ estimated\ error\ 0\.0\d+\ \(0\.1\ asked\ for\),\ in\ the\ worst\ block\ 0\.\d+\ \(0\.2\)\n$",
        )
        .unwrap(),
    );
    assert!(desk.bytes("a.exr") == first, "lanes and threads change no bit");
    let counts = desk.pixels("map.exr");
    let sum: f32 = counts.iter().map(|count| count[0]).sum();
    assert_eq!(f64::from(sum) / (96.0 * 54.0), mean, "the map holds the counts");

    // More samples are brighter.
    for name in ["map.png", "map.hdr"] {
        desk.run(&format!("{line} --samples-map {name}"));
    }
    let [png, hdr] = ["map.png", "map.hdr"].map(|name| desk.pixels(name));
    assert!(png.contains(&[1.0; 3]), "white for the most");
    assert_eq!(hdr, counts, "powers of two are what .hdr holds exactly");
    for (shades, counts) in png.windows(2).zip(counts.windows(2)) {
        let order = |pixels: &[[f32; 3]]| pixels[0][0].partial_cmp(&pixels[1][0]);
        assert_eq!(order(shades), order(counts), "{shades:?}, {counts:?}");
    }
}

#[test]
fn time_limit_ends_in_time_with_equal_pixels() {
    let desk = Desk::new();
    let report = desk.json("render scene.json -o a.exr --time-limit 1");
    assert_eq!((&report["ended_by"], &report["time_limit"]), (&json!("time-limit"), &json!(1.0)));
    // It ends early only where the next chunk would take longer than what is left, and leaves pixels uneven
    // only where a busy machine keeps a chunk for longer than its grace.
    let seconds = number(&report["seconds"]);
    assert!(report["samples"] == report["most_samples"] || seconds > 1.3, "{report}");
    assert!(number(&report["most_samples"]) > 1.0 && (0.5..5.0).contains(&seconds), "{report}");
    assert_eq!((&report["interrupted"], &report["estimated_error"]), (&json!(false), &json!(null)));

    // One sample takes some ten seconds, far longer than that: what there is counts.
    desk.put_endless_paths(8);
    let line =
        "render endless.json -o a.exr --size 512x256 --bounces 64 --lanes 1 --threads 1 --time-limit 0.3";
    let said = desk.run(line);
    assert!(said.contains("512×256, 0 to 1 samples (mean 0."), "{said}");
    assert!(said.contains("% of the picture has had none and is black\nended by the time limit, "), "{said}");
}

#[test]
fn whichever_limit_comes_first_ends_the_rendering() {
    let desk = Desk::new();
    for (options, end, words) in [
        ("--time-limit 600 --samples 8", "samples", "ended by the limit of samples\n"),
        ("--time-limit 600 --target-error 0.2", "target-error", "the target error; estimated error 0."),
        ("--time-limit 0.5 --target-error 0.0001", "time-limit", "ended by the time limit; "),
        ("--target-error 0.0001 --samples 24 --min-samples 8", "samples", "samples; estimated error "),
        ("--target-error 0.1 --samples 3", "samples", "samples; too few samples to estimate the error\n"),
    ] {
        let size = if end == "time-limit" { "96x54" } else { "32x18" };
        let line = format!("render builtin:chess -o a.png --size {size} {options}");
        let said = desk.run(&line);
        assert!(said.contains(words), "{options}: {said}");
        assert_eq!(desk.json(&line)["ended_by"], end, "{options}");
    }
}
