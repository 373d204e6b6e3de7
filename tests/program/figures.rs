//! The reports of `octray bench` and `octray compare`.

use crate::desk::{Desk, SCENE, assert_fits, assert_has, list, number};
use octray::lane::WIDTHS;
use serde_json::{Value, json};
use std::fs;
use std::path::Path;
use std::process::Command;

#[test]
fn bench_reports_every_engine_in_json() {
    let desk = Desk::new();
    let report = desk.json("bench scene.json builtin:three --frames 1 --size 16x9 --threads 1");
    assert_eq!(report["schema"], "octray-bench-1");
    for key in ["cpu", "cores", "target_features", "rustc", "flags", "commit"] {
        assert!(report["settings"]["machine"].get(key).is_some(), "{key} is not in {report}");
    }
    assert_eq!(report["reliable"], false, "of one frame");

    let results = list(&report["results"]);
    let engines: Vec<Value> =
        results.iter().map(|result| json!([result["scene"], result["engine"], result["lanes"]])).collect();
    let widths: Vec<usize> = WIDTHS.into_iter().rev().collect();
    let engine = |lanes| if lanes == 1 { "scalar" } else { "simd" };
    let expected: Vec<Value> = ["scene.json", "builtin:three"]
        .into_iter()
        .flat_map(|scene| widths.iter().map(move |&lanes| json!([scene, engine(lanes), lanes])))
        .collect();
    assert_eq!(engines, expected);
    for result in results {
        let known = json!({ "width": 16, "height": 9, "max_bounces": 4, "threads": 1, "frames": 1 });
        assert_has(result, &known);
        assert!(number(&result["fps_median"]) >= number(&result["fps_low_1_percent"]), "{result}");
        assert!(number(&result["rays_per_frame"]) >= 16.0 * 9.0, "{result}");
        let mrays_per_s = number(&result["rays_per_frame"]) * number(&result["fps_median"]) / 1e6;
        assert!((number(&result["mrays_per_s"]) / mrays_per_s - 1.0).abs() < 1e-9, "{result}");
        assert!(list(&result["needs"]).contains(&json!("spheres")), "{result}");
    }
    for engine in results {
        assert!(engine["scaling"].is_null() && engine["reliable"] == false, "of one frame: {engine}");
        let speedup = &engine["speedup"];
        assert_eq!(speedup.is_null(), engine["lanes"] == 1, "every other width has its own: {engine}");
        assert!(speedup.is_null() || speedup["rounds"] == 1, "{engine}");
    }
    // No speed without its accuracy.
    let accuracy = list(&report["accuracy"]);
    assert_eq!(accuracy.len(), 2);
    assert!(accuracy.iter().all(|scene| scene["mismatched_pixels"] == 0), "{report}");
    assert!(accuracy.iter().all(|scene| scene.get("speedup").is_none()), "{report}");
}

#[test]
fn bench_names_the_commit_it_was_built_from() {
    let desk = Desk::new();
    let report = desk.json("bench scene.json --frames 1 --size 8x8");
    let named = report["settings"]["machine"]["commit"].as_str().unwrap();
    let git = |arguments: &[&str]| {
        // In a checkout of another user, git, and so the build, reports nothing without this.
        let mut git = Command::new("git");
        git.args(["-c", "safe.directory=*"]).args(arguments).current_dir(env!("CARGO_MANIFEST_DIR"));
        let output = git.output();
        let output = output.ok().filter(|output| output.status.success());
        output.map(|output| String::from_utf8(output.stdout).unwrap().trim().to_owned())
    };
    let here = Path::new(env!("CARGO_MANIFEST_DIR")).canonicalize().unwrap();
    match git(&["rev-parse", "--show-toplevel"]) {
        Some(top) if Path::new(&top).canonicalize().unwrap() == here => {
            let head = git(&["rev-parse", "HEAD"]).unwrap();
            let commit = named.trim_end_matches("+changes");
            assert!(commit.len() >= 7 && head.starts_with(commit), "{named} is built in, {head} is here");
        }
        _ => assert_eq!(named, "unknown", "there is no checkout"),
    }
}

#[test]
fn bench_measures_the_width_and_threads_asked_for() {
    let desk = Desk::new();
    for (lanes, threads, pipeline, expected) in
        [("1", 2, "auto", json!([1])), ("8", 1, "general", json!([8])), ("8,1,8", 1, "auto", json!([8, 1]))]
    {
        let own = format!("--lanes {lanes} --threads {threads} --pipeline {pipeline}");
        let report = desk.json(&format!("bench scene.json --frames 2 --size 8x8 {own}"));
        let results = list(&report["results"]);
        assert_eq!(json!(results.iter().map(|result| &result["lanes"]).collect::<Vec<_>>()), expected);
        assert!(
            results.iter().all(|one| one["threads"] == threads && one["pipeline"] == pipeline),
            "{report}"
        );
    }
    if !WIDTHS.contains(&16) {
        desk.refuses("bench scene.json --lanes 16", &["'16' for '--lanes", "AVX-512", "auto, 1 or 8"]);
    }
}

#[test]
fn bench_shows_what_leaving_features_out_gains_where_something_is_left_out() {
    let desk = Desk::new();
    let specialisation = |scene: &str| {
        let report = desk.json(&format!("bench {scene} --frames 11 --size 8x8 --threads 1"));
        let results = list(&report["results"]);
        assert!(results[1..].iter().all(|result| result["specialisation"].is_null()), "{report}");
        assert_eq!(results[0]["frames"], 11);
        results[0]["specialisation"].clone()
    };
    let three = specialisation("builtin:three");
    // Turns of two frames, and of fewer on a busy machine: ratios of several rounds.
    assert!(number(&three["median"]) > 0.0 && number(&three["rounds"]) >= 5.0, "{three}");
    // It has textures and maps that only the general pipeline has.
    assert!(specialisation(concat!(env!("CARGO_MANIFEST_DIR"), "/tests/films/everything.json")).is_null());
}

#[test]
fn bench_prints_a_row_a_scene_and_what_it_means() {
    let desk = Desk::new();
    let said = desk.run("bench scene.json scene.json --frames 2 --size 8x8");
    assert!(said.contains("speed-up") && said.contains("same, bit by bit"), "{said}");
    assert_eq!(said.matches("\nscene.json ").count(), 4, "two rows in each table: {said}");
    // The first line names the machine, the last one is a summary.
    let (table, summary) = said.trim_end().rsplit_once('\n').unwrap();
    assert_fits(table.split_once('\n').unwrap().1);
    let ways = format!("; {} lanes, 1 thread; ", octray::lane::NATIVE_WIDTH);
    let why = if cfg!(debug_assertions) { "a debug build" } else { "too few frames" };
    let why = format!(" × scalar), of {why}: not reliable");
    let words = ["octray bench: scene.json ", &why, &ways, ", commit "];
    assert!(words.iter().all(|words| summary.contains(words)), "{summary}");
}

#[test]
fn compare_reports_in_json_and_says_for_people_that_the_pictures_agree() {
    let desk = Desk::new();
    let report = desk.json("compare scene.json builtin:cornell --samples 2 --size 16x9");
    assert_eq!(report["schema"], "octray-compare-1");
    let results = list(&report["results"]);
    let scenes: Vec<&Value> = results.iter().map(|result| &result["scene"]).collect();
    assert_eq!(json!(scenes), json!(["scene.json", "builtin:cornell"]));
    for result in results {
        let known = json!({ "pixels": 144, "samples": 2, "mismatched_pixels": 0, "first_mismatch": null });
        assert_has(result, &known);
        assert_has(&result["reference"], &json!({ "mismatched_hits": 0 }));
        let ratio = &result["speedup"];
        let [low, median, high] = [&ratio["spread"][0], &ratio["median"], &ratio["spread"][1]].map(number);
        assert!(0.0 < low && low <= median && median <= high, "{result}");
        assert!(number(&result["reference"]["rmse"]) <= number(&result["reference"]["max_abs"]));
    }
    let said = desk.run("compare scene.json --samples 1 --size 8x8");
    assert!(said.contains("the same, bit by bit"), "{said}");
    assert!(!cfg!(debug_assertions) || report["reliable"] == false, "{report}");
}

#[test]
fn compare_finds_hits_that_the_rounding_of_coordinates_moved() {
    let desk = Desk::new();
    desk.write("far.json", SCENE.replacen('{', r#"{ "origin": [0, 0, 100000003],"#, 1));
    let report = desk.json_with_code("compare far.json --samples 1 --size 8x8", 1);
    assert!(number(&report["results"][0]["reference"]["mismatched_hits"]) > 0.0, "{report}");
}

/// Light beyond single precision: a picture of nearly the brightest texel there is, brightened further.
#[test]
fn bench_and_compare_exit_with_1_when_a_check_failed() {
    let desk = Desk::new();
    let texel = [128, 128, 128, 255];
    desk.write("sun.hdr", [b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n", &texel[..]].concat());
    let sky = r#"{ "texture": "sun.hdr", "color": [1e18, 1e18, 1e18] }"#;
    desk.write("overflow.json", SCENE.replace(r#"{ "color": [0.5, 0.7, 1.0] }"#, sky));
    // The good scene comes last: it must not make up for the other.
    for command in ["compare --samples 1", "bench --frames 1"] {
        desk.octray(&format!("{command} overflow.json scene.json --size 8x8")).assert().code(1);
    }
    let report = desk.json_with_code("compare overflow.json --samples 1 --size 8x8", 1);
    assert!(number(&report["results"][0]["discarded_samples"]) > 0.0, "{report}");
}

#[test]
fn compare_counts_the_wrong_hits_of_a_naive_method_and_forgives_them() {
    let desk = Desk::new();
    let wrong_hits = |methods: &str| {
        let report = desk.json(&format!("compare builtin:far --samples 1 {methods}"));
        number(&report["results"][0]["reference"]["mismatched_hits"])
    };
    assert_eq!(wrong_hits(""), 0.0);
    let naive = "--sphere naive --triangle moller-trumbore";
    assert!(wrong_hits(&format!("{naive} --traversal linear")) > 10_000.0);
    // Hits outside of the boxes of their primitives are missed.
    assert!((5_000.0..10_000.0).contains(&wrong_hits(naive)));
}

/// The command and `tests/films` agree on settings, on the bytes that are hashed, and on the table.
#[test]
fn compare_hash_prints_the_expected_hash_of_a_film() {
    let desk = Desk::new();
    let table = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/films/hashes.txt");
    let table = fs::read_to_string(table).unwrap();
    let [_, fused, plain] = table
        .lines()
        .map(|line| line.split_whitespace().collect::<Vec<_>>())
        .find(|columns| columns[0] == "builtin:three")
        .and_then(|columns| <[&str; 3]>::try_from(columns).ok())
        .unwrap();
    let (hash, build) = if octray::lane::FUSED { (fused, "fused") } else { (plain, "plain") };
    assert_eq!(desk.run("compare --hash builtin:three"), format!("{hash}  {build}  builtin:three\n"));
    let report = desk.json("compare --hash builtin:three");
    let results = json!([{ "scene": "builtin:three", "hash": hash }]);
    let expected = json!({ "schema": "octray-hash-1", "fused": octray::lane::FUSED, "results": results });
    assert_has(&report, &expected);
    let other = desk.json("compare --hash builtin:three --seed 1");
    assert_ne!(other["results"][0]["hash"], hash, "another seed is another film");
}
