//! The settings of a run in its report: options, methods and traversal, size and bounces; and how two runs of
//! `bench` are compared.

use crate::desk::{Desk, SCENE, list, number};
use octray::lane::{NATIVE_WIDTH, WIDTHS};
use serde_json::{Value, json};

#[test]
fn every_report_has_the_settings_it_was_made_with() {
    let desk = Desk::new();
    let size = json!([6, 6]);
    for (line, own) in [
        ("bench scene.json --frames 1 --sphere naive", json!(["naive", 5, &size, 2])),
        ("compare scene.json --samples 1 --sphere naive", json!(["naive", 5, &size, 2])),
        ("render scene.json -o a.png --samples 1 --sphere naive", json!(["naive", 5, &size, 2])),
        ("rays scene.json --passes 1", json!(["robust", 5, &size, null])),
        ("chart scene.json -o charts --budget 0.1", json!(["robust", 0, &size, 2])),
    ] {
        let seed = if line.starts_with("chart") { "" } else { "--seed 5" };
        let bounces = if line.starts_with("rays") { "" } else { "--bounces 2" };
        let report = desk.json(&format!("{line} --size 6x6 {seed} {bounces}"));
        let settings = &report["settings"];
        let found = json!([settings["sphere"], settings["seed"], settings["size"], settings["bounces"]]);
        assert_eq!(found, own, "{line}");
        for key in ["triangle", "traversal", "lights", "sampler", "pipeline"] {
            assert!(settings[key].is_string(), "{key}: {settings}");
        }
        assert!(settings["lanes"][0].is_u64() && settings["threads"][0].is_u64(), "{settings}");
        assert!(settings["machine"]["flags"].is_string(), "{settings}");
    }
}

#[test]
fn texts_have_a_line_of_the_options_that_differ() {
    let desk = Desk::new();
    for (line, options) in [
        ("compare scene.json --samples 16 --seed 0", "the defaults"),
        ("bench scene.json --frames 1 --size 6x6 --lights off", "--frames 1 --lights off --size 6x6"),
        ("rays scene.json --passes 1 --size 6x6 --threads 5", "--passes 1 --size 6x6 --threads 5"),
        ("chart scene.json -o charts --budget 0.1 --size 6x6", "--budget 0.1 --size 6x6"),
        ("render scene.json -o a.png --samples 1 --size 8x8 --clamp 0.1", "--clamp 0.1"),
    ] {
        let said = desk.run(line);
        assert!(said.contains(&format!("options: {options}\n")), "{line}: {said}");
    }
}

/// Returns the traversal of the first scene and engine.
fn traversal(report: &Value) -> &Value {
    report.get("traversal").unwrap_or(&report["results"][0]["traversal"])
}

#[test]
fn every_method_has_a_hierarchy() {
    let desk = Desk::new();
    for (command, more) in [("bench", "--frames=1"), ("compare", "--samples=1"), ("render", "--output=a.png")]
    {
        let line = format!("{command} builtin:knot:200 --size 8x8 {more}");
        for method in ["--triangle moller-trumbore", "--sphere naive"] {
            let by = |more: &str| traversal(&desk.json(&format!("{line} {method} {more}"))).clone();
            let [auto, single, linear] = ["", "--traversal single", "--traversal linear"].map(by);
            assert_eq!([auto, single, linear], ["stream", "stream", "linear"], "{command} {method}");
        }
        assert_eq!(traversal(&desk.json(&line)), "hybrid", "{command}");
    }
}

#[test]
fn baseline_gives_ratios_of_what_both_have_and_lists_what_differs() {
    let desk = Desk::new();
    let line = "bench scene.json --frames 3 --size 16x16";
    let mut old = desk.json(line);
    old["settings"]["machine"]["cpu"] = json!("another");
    desk.write("old.json", old.to_string());
    let with = format!("{line} --baseline old.json");
    let new = desk.json(&with);
    let (ratios, news) = (list(&new["over_baseline"]), list(&new["results"]));
    assert_eq!(ratios.len(), news.len());
    for ((ratio, new), old) in ratios.iter().zip(news).zip(list(&old["results"])) {
        assert_eq!(json!([ratio["lanes"], ratio["threads"]]), json!([new["lanes"], new["threads"]]));
        assert_eq!(ratio["there"], json!([old["lanes"], old["threads"]]));
        let expected = number(&new["fps_median"]) / number(&old["fps_median"]);
        assert!((number(&ratio["median"]) / expected - 1.0).abs() < 1e-9, "{ratio}");
        assert_eq!(ratio["reliable"], false, "of three frames");
    }
    assert_eq!(new["baseline_differences"], json!({ "cpu": [new["settings"]["machine"]["cpu"], "another"] }));
    let shown = desk.run(&with);
    assert!(shown.contains("New over old") && shown.contains(", there another."), "{shown}");

    // Another scene of this name, other settings, an engine that the baseline has not.
    desk.write("scene.json", SCENE.replace("\"radius\": 1", "\"radius\": 2"));
    let new = desk.json(&format!("{with} --seed 7 --sphere naive --lanes 1 --threads 3"));
    let differences = &new["baseline_differences"];
    assert_eq!(json!([differences["seed"], differences["sphere"]]), json!([[7, 0], ["naive", "robust"]]));
    assert!(
        differences["spheres of scene.json"].is_array() && differences["lanes"][0] == json!([1]),
        "{new}"
    );
    let [first] = list(&new["over_baseline"]) else { panic!("{new}") };
    assert_eq!(json!([first["lanes"], first["there"]]), json!([1, [NATIVE_WIDTH, 1]]), "first to first");
    let none = desk.run("bench builtin:three --frames 1 --size 8x8 --baseline old.json").replace('\n', " ");
    assert!(none.contains("The baseline has none of these scenes"), "{none}");

    desk.write("old.json", "{}");
    desk.refuses(&with, &["no report of bench", "octray bench --json"]);
}

#[test]
fn against_times_two_configurations_in_alternation() {
    let desk = Desk::new();
    let line = "bench scene.json --frames 9 --size 16x16 --threads 1";
    let against = desk.json(&format!("{line} --against=--size=160x160"))["against"].take();
    let ratios = list(&against["ratios"]);
    assert_eq!([ratios.len(), list(&against["results"]).len()], [WIDTHS.len(); 2]);
    let is_right = |ratio: &Value| number(&ratio["median"]) > 3.0 && number(&ratio["rounds"]) >= 5.0;
    assert!(ratios.iter().all(is_right), "of a hundred times the pixels: {against}");
    assert_eq!(against["differences"], json!({ "size": [[16, 16], [160, 160]] }));
    assert_eq!(against["accuracy"][0]["mismatched_pixels"], 0);
    let said = desk.run(&format!("{line} --against=--lanes=1")).replace('\n', " ");
    let engines = format!(" {NATIVE_WIDTH} lanes, 1 thread over scalar, 1 thread ");
    assert!(said.contains(&engines) && said.contains(", there 1."), "{said}");
    for (wrong, word) in [("--traversal=singl", "'single'"), ("--json", "'--json'"), ("", "name the")] {
        desk.refuses(&format!("{line} --against={wrong}"), &[&format!("--against \"{wrong}\": "), word]);
    }
}

#[cfg(unix)]
#[test]
fn against_program_runs_another_program_in_alternation() {
    use std::os::unix::fs::PermissionsExt;
    let desk = Desk::new();
    let line = "bench scene.json --size 8x8 --threads 1";
    let mut old = desk.json(&format!("{line} --frames 2"));
    for result in old["results"].as_array_mut().unwrap() {
        result["fps_median"] = json!(1e-3 * number(&result["fps_median"]));
    }
    old["settings"]["machine"]["commit"] = json!("older");
    desk.write("old.json", old.to_string());
    let rival = |script: &str| {
        desk.write("rival", format!("#!/bin/sh\n{script}\n"));
        std::fs::set_permissions(desk.path("rival"), PermissionsExt::from_mode(0o755)).unwrap();
        format!("{line} --frames 2 --against-program rival")
    };
    // On one core, one thread is the default, and is not passed.
    let asked = "case \"$*\" in 'bench scene.json --size 8x8 '*'--frames '?' --json') cat old.json;; *) exit 9;; esac";
    let against = desk.json(&rival(asked))["against"].take();
    assert_eq!(list(&against["ratios"]).len(), WIDTHS.len());
    for ratio in list(&against["ratios"]) {
        assert!(number(&ratio["median"]) > 30.0 && ratio["rounds"] == 10, "a thousand times: {ratio}");
    }
    assert_eq!(against["differences"]["commit"][1], "older");
    desk.refuses(&rival("echo no >&2; exit 3"), &["--against-program rival: ", "exit status: 3: no"]);
}

#[test]
fn size_and_bounces_of_the_scene_are_offered_and_taken() {
    let desk = Desk::new();
    let with = |more: &str| format!("bench scene.json --frames 1 --threads 1 {more}");
    let other = desk.run(&with("--size 9x9"));
    assert!(other.contains("scene.json has 8×8 and 4 bounces; --as-scene takes them"), "{other}");
    assert!(!desk.run(&with("--size 8x8")).contains("--as-scene"), "they are the same");
    let own = desk.run(&with("--as-scene"));
    assert!(own.contains("options: --as-scene") && !own.contains("takes them"), "{own}");
    let report = desk.json(&with("--as-scene"));
    let first = &report["results"][0];
    assert_eq!(json!([first["width"], first["height"], first["max_bounces"]]), json!([8, 8, 4]));
    assert_eq!(report["settings"].get("size"), None);

    let rendered = |more: &str| desk.rendered(&format!("scene.json --samples 1{more}"), "own.exr");
    assert_eq!(rendered(" --as-scene"), rendered(""), "render takes them anyway");
    let own = desk.json("chart scene.json -o charts --budget 0.1 --as-scene");
    assert_eq!(own["scenes"][0]["frame_size"], json!([9, 9]), "multiples of 3");
}
