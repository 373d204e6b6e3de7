//! `octray render` with a target error, a time limit, a map of its samples.

use crate::desk::Desk;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::json;
use std::fs;

#[test]
fn target_error_ends_the_rendering_and_the_report_says_so() {
    let desk = Desk::new();
    let arguments = "render builtin:chess -o a.exr --size 96x54 --target-error 0.1 --json";
    let report = desk.json(&arguments.split(' ').collect::<Vec<_>>());
    assert_eq!((&report["ended_by"], &report["target_error"]), (&json!("target-error"), &json!(0.1)));
    let [rms, largest] = ["rms", "largest"].map(|key| report["estimated_error"][key].as_f64().unwrap());
    assert!(rms > 0.01 && rms <= 0.1 && largest > rms && largest <= 0.2, "{report}");
    let [least, mean, most] =
        ["samples", "mean_samples", "most_samples"].map(|key| report[key].as_f64().unwrap());
    assert!(least == 16.0 && least < mean && mean < most && most <= 1024.0, "{report}");

    let arguments = arguments.replace(" --json", " --lanes 1 --threads 2 --samples-map map.exr");
    let first = fs::read(desk.path("a.exr")).unwrap();
    let said = desk.octray(&arguments.split(' ').collect::<Vec<_>>()).assert().success();
    said.stdout(
        predicate::str::is_match(
            r"(?x)^a\.exr:\ 96×54,\ 16\ to\ \d+\ samples\ \(mean\ \d+\),\ \d+\.\d\d\ s,\ .*\n
            ended\ by\ the\ target\ error;\ estimated\ error\ 0\.0\d+\ \(0\.1\ asked\ for\),\ in\ the\ worst\ block\ 0\.\d+\ \(0\.2\)\n$",
        )
        .unwrap(),
    );
    assert!(fs::read(desk.path("a.exr")).unwrap() == first, "lanes and threads change no bit");
    let counts = desk.pixels("map.exr");
    let sum: f32 = counts.iter().map(|count| count[0]).sum();
    assert_eq!(f64::from(sum) / (96.0 * 54.0), mean, "the map holds the counts");
}

#[test]
fn samples_are_the_upper_limit_of_a_target() {
    let desk = Desk::new();
    let arguments = "render builtin:spheres -o a.exr --size 32x18 --target-error 0.001 --samples 24 --min-samples 8 --json";
    let report = desk.json(&arguments.split(' ').collect::<Vec<_>>());
    assert_eq!(report["ended_by"], "samples");
    assert_eq!([&report["samples"], &report["most_samples"]], [24, 24], "{report}");
    assert!(report["estimated_error"]["rms"].as_f64().unwrap() > 0.001, "{report}");
    let first = fs::read(desk.path("a.exr")).unwrap();
    desk.octray(&["render", "builtin:spheres", "-o", "a.exr", "--size", "32x18", "--samples", "24"])
        .assert()
        .success();
    assert!(fs::read(desk.path("a.exr")).unwrap() == first, "where nothing stops early, nothing changes");
}

#[test]
fn time_limit_ends_in_time_with_equal_pixels() {
    let desk = Desk::new();
    let report = desk.json(&["render", "scene.json", "-o", "a.exr", "--time-limit", "1", "--json"]);
    assert_eq!((&report["ended_by"], &report["time_limit"]), (&json!("time-limit"), &json!(1.0)));
    // It ends early only where the next chunk would take longer than what is left, and leaves pixels uneven
    // only where a busy machine keeps a chunk for longer than its grace.
    let seconds = report["seconds"].as_f64().unwrap();
    assert!(report["samples"] == report["most_samples"] || seconds > 1.3, "{report}");
    assert!(report["most_samples"].as_u64().unwrap() > 1 && (0.5..5.0).contains(&seconds), "{report}");
    assert_eq!((&report["interrupted"], &report["estimated_error"]), (&json!(false), &json!(null)));

    // One sample takes some ten seconds, far longer than that: what there is counts.
    let arguments = "render builtin:cornell -o a.exr --size 2000x1500 --lanes 1 --threads 1 --time-limit 0.3";
    let said = desk.octray(&arguments.split(' ').collect::<Vec<_>>()).assert().success();
    said.stdout(
        contains("2000×1500, 0 to 1 samples (mean 0.")
            .and(contains("% of the picture has had none and is black\nended by the time limit, too short for a sample of every pixel\n")),
    );
}

#[test]
fn whichever_limit_comes_first_ends_the_rendering() {
    let desk = Desk::new();
    for (options, end, words) in [
        ("--time-limit 600 --samples 8", "samples", "ended by the limit of samples\n"),
        (
            "--time-limit 600 --target-error 0.2",
            "target-error",
            "ended by the target error; estimated error 0.",
        ),
        ("--time-limit 0.5 --target-error 0.0001 --size 96x54", "time-limit", "ended by the time limit; "),
        (
            "--target-error 0.1 --samples 3",
            "samples",
            "limit of samples; too few samples to estimate the error\n",
        ),
    ] {
        let arguments = format!("render builtin:chess -o a.png --size 32x18 {options}");
        // The last size counts.
        let arguments = arguments.replace("--size 32x18 --time-limit 0.5", "--time-limit 0.5");
        let arguments: Vec<&str> = arguments.split(' ').collect();
        desk.octray(&arguments).assert().success().stdout(contains(words));
        assert_eq!(desk.json(&[&arguments[..], &["--json"]].concat())["ended_by"], end, "{options}");
    }
}

#[test]
fn black_scene_ends_with_a_target() {
    let desk = Desk::new();
    let black = r#"{ "format": "octray-1", "resolution": [40, 24], "sky": { "color": [0, 0, 0] },
        "materials": { "clay": { "type": "diffuse" } }, "spheres": [ { "center": [0, 0, 0], "radius": 1, "material": "clay" } ] }"#;
    desk.write("black.json", black);
    let report = desk.json(&["render", "black.json", "-o", "a.exr", "--target-error", "0.01", "--json"]);
    assert_eq!((&report["ended_by"], &report["samples"]), (&json!("target-error"), &json!(256)));
    assert_eq!(report["estimated_error"]["largest"], 0.0);
}

#[test]
fn samples_map_shows_more_samples_as_brighter() {
    let desk = Desk::new();
    let arguments = "render builtin:chess -o a.exr --size 96x54 --target-error 0.1 --samples-map map";
    for name in ["map.png", "map.hdr", "map.exr"] {
        let arguments = arguments.replace("-map map", &format!("-map {name}"));
        desk.octray(&arguments.split(' ').collect::<Vec<_>>()).assert().success();
    }
    let [png, hdr, exr] = ["map.png", "map.hdr", "map.exr"].map(|name| desk.pixels(name));
    assert!(png.contains(&[1.0; 3]), "white for the most");
    assert_eq!(hdr, exr, "powers of two are what .hdr holds exactly");
    for (a, b) in png
        .iter()
        .zip(&exr)
        .zip(png.iter().zip(&exr).skip(1))
        .map(|((p, e), (q, f))| ([p[0], e[0]], [q[0], f[0]]))
    {
        assert_eq!(a[0].partial_cmp(&b[0]), a[1].partial_cmp(&b[1]), "{a:?}, {b:?}");
    }
}

#[test]
fn limits_out_of_range_are_refused_with_their_range() {
    let desk = Desk::new();
    for (option, values, range) in [
        (
            "--target-error",
            &["0", "-0.1", "nan", "inf", "", "5%", "1.5"][..],
            "from 0.0001 to 1, such as 0.05",
        ),
        ("--time-limit", &["0", "-1", "nan", "inf", "", "10s", "1e9"], "seconds from 0.001 to 31536000"),
    ] {
        for value in values {
            desk.refuses(&["render", "scene.json", "-o", "a.png", option, value], &[option, value, range]);
        }
        desk.refuses(&["render", "scene.json", "-o", "a.png", option], &[option]);
    }
    let with = |extra: &[&str], words: &[&str]| {
        desk.refuses(&[&["render", "scene.json", "-o", "a.png"], extra].concat(), words);
    };
    with(&["--min-samples", "16"], &["--target-error"]);
    with(&["--target-error", "0.1", "--min-samples", "3"], &["--min-samples", "from 4 to"]);
    with(&["--target-error", "0.1", "--samples", "8", "--min-samples", "9"], &["from 4 to 8"]);
    with(&["--samples-map", "a.png"], &["--samples-map a.png", "give another file"]);
    with(&["--samples-map", "./a.png"], &["--samples-map ./a.png", "give another file"]);
    with(&["--samples-map", "b.txt"], &["b.txt", ".png"]);
    with(&["--samples-map", "no/such/b.png"], &["no/such", "mkdir -p"]);
}
