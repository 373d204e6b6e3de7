//! What a run says of itself: options, methods and traversal, size and bounces; and how two runs of `bench`
//! are compared.

use crate::desk::{Desk, SCENE, number};
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
        ("compare scene.json --samples 1 --size 6x6 --lights off", "--lights off --samples 1 --size 6x6"),
        ("compare scene.json --samples 16 --seed 0", "the defaults"),
        ("bench scene.json --frames 1 --size 6x6 --threads 5", "--frames 1 --size 6x6 --threads 5"),
        (
            "rays scene.json --passes 1 --size 6x6 --traversal stream",
            "--passes 1 --size 6x6 --traversal stream",
        ),
        ("chart scene.json -o charts --budget 0.1 --size 6x6", "--budget 0.1 --size 6x6"),
        ("render scene.json -o a.png --samples 1 --size 8x8 --seed 5", "--seed 5"),
    ] {
        let said = desk.run(line);
        assert!(said.contains(&format!("options: {options}\n")), "{line}: {said}");
    }
}

/// Of the first scene and engine.
fn traversal(report: &Value) -> &Value {
    report.get("traversal").unwrap_or(&report["results"][0]["traversal"])
}

#[test]
fn methods_without_a_hierarchy_say_that_every_primitive_is_tested() {
    let desk = Desk::new();
    for (command, more) in [("bench", "--frames=1"), ("compare", "--samples=1"), ("render", "--output=a.png")]
    {
        let line = format!("{command} builtin:knot:200 --size 8x8 {more}");
        for (option, method) in [("--triangle", "moller-trumbore"), ("--sphere", "naive")] {
            for traversal in ["hybrid", "stream"] {
                desk.refuses(
                    &format!("{line} {option} {method} --traversal {traversal}"),
                    &["--traversal", traversal, option, method, "tests every primitive", "leave out"],
                );
            }
            for more in ["", "--traversal linear", "--traversal auto"] {
                let report = desk.json(&format!("{line} {option} {method} {more}"));
                assert_eq!(traversal(&report), "linear", "{command}");
            }
            #[cfg(feature = "viewer")]
            desk.refuses(
                &format!("view scene.json {option} {method} --traversal single"),
                &["tests every primitive"],
            );
            let said = desk.warnings(&format!("{line} {option} {method}"));
            assert_eq!(said.matches("every primitive of builtin:knot:200 is tested").count(), 1, "{said}");
        }
        assert_eq!(traversal(&desk.json(&line)), "hybrid", "{command}");
        let asked = desk.warnings(&format!("{line} --traversal linear"));
        assert!(!asked.contains("every primitive"), "{asked}");
        let said = desk.run(&line);
        assert!(said.contains("Traversal: hybrid in") || said.contains("traversal hybrid"), "{said}");
    }
}

#[test]
fn a_views_traversal_gives_way_to_a_method_and_one_on_the_command_line_does_not() {
    let desk = Desk::new();
    desk.write(
        "view.json",
        r#"{ "format": "octray-view-1", "scene": "builtin:knot:200", "resolution": [8, 8],
             "render": { "triangle": "moller-trumbore", "traversal": "hybrid", "samples": 1 } }"#,
    );
    let line = "render view.json -o a.png";
    assert!(desk.warnings(line).contains("every primitive of"));
    assert_eq!(desk.json(line)["traversal"], "linear");
    desk.refuses(&format!("{line} --traversal single"), &["--traversal single", "moller-trumbore"]);
    let robust = desk.json(&format!("{line} --triangle woop --traversal single"));
    assert_eq!(robust["traversal"], "single");
}

#[test]
fn baseline_gives_ratios_and_refuses_what_cannot_be_compared() {
    let desk = Desk::new();
    let line = "bench scene.json --frames 3 --size 16x16";
    let mut old = desk.json(line);
    for result in old["results"].as_array_mut().unwrap() {
        for key in ["/fps_median", "/fps_spread/0", "/fps_spread/1"] {
            let value = result.pointer_mut(key).unwrap();
            *value = json!(1e-3 * number(value));
        }
    }
    old["settings"]["machine"]["cpu"] = json!("another");
    desk.write("old.json", old.to_string());
    let with = format!("{line} --baseline old.json");
    let new = desk.json(&with);
    let (ratios, results) = (new["over_baseline"].as_array().unwrap(), new["results"].as_array().unwrap());
    assert_eq!(ratios.len(), results.len());
    for (ratio, result) in ratios.iter().zip(results) {
        assert_eq!((&ratio["lanes"], &ratio["threads"]), (&result["lanes"], &result["threads"]));
        let [median, low, high] = [&ratio["median"], &ratio["spread"][0], &ratio["spread"][1]].map(number);
        assert!(50.0 < median && low <= median && median <= high, "a thousand times the speed: {ratio}");
    }
    assert!(desk.warnings(&with).contains("another machine"));
    let shown = desk.run(&with).replace('\n', " ");
    for words in ["New over old", "scalar, 1 thread", "The ratios are not reliable: see"] {
        assert!(shown.contains(words), "{words} is not in {shown}");
    }
    // Engines are paired, and another number of frames is the same rate.
    let one = desk.json("bench scene.json --frames 2 --size 16x16 --lanes 1 --threads 1 --baseline old.json");
    assert_eq!(one["over_baseline"].as_array().unwrap().len(), 1);
    let lines = "bench scene.json builtin:three --frames 1 --size 16x16 --threads 1";
    desk.write("two.json", desk.json(lines).to_string());
    let said = desk.warnings(&format!("{line} --lanes 1 --threads 1 --baseline two.json"));
    let lacking = said.lines().find(|line| line.contains("only the baseline has builtin:three; "));
    assert!(lacking.unwrap().ends_with("8 lanes, 1 thread."), "{said}");

    let refused = |more: &str, words: &[&str]| desk.refuses(&format!("{with} {more}"), words);
    refused("--seed 7", &["old.json", "other settings: --seed 0, here --seed 7"]);
    refused("--sphere naive", &["--sphere robust, here --sphere naive"]);
    refused("builtin:three", &["not measured `builtin:three`", "scene.json"]);
    refused("--threads 5", &["none of the widths and threads"]);
    desk.write("scene.json", SCENE.replace("\"radius\": 1", "\"radius\": 2"));
    refused("", &["`scene.json` has changed since (spheres)"]);
    desk.write("old.json", "{}");
    refused("", &["no report of bench", "octray bench --json"]);
    desk.refuses(&format!("{line} --baseline gone.json"), &["gone.json", "cannot be read"]);
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
    desk.refuses(&with("--as-scene --size 8x8"), &["--as-scene", "--size"]);

    let chart = "chart scene.json -o charts --budget 0.1";
    let other = desk.run(&format!("{chart} --size 6x6"));
    assert!(other.contains("scene.json has 8×8 and 4 bounces; --as-scene takes them"), "{other}");
    let own = desk.json(&format!("{chart} --as-scene"));
    assert_eq!(own["scenes"][0]["frame_size"], json!([9, 9]), "multiples of 3");
    desk.refuses(&format!("{chart} --as-scene --bounces 1"), &["--as-scene", "--bounces"]);
}
