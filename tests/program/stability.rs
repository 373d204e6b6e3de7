//! `octray stability`: its table, its JSON, its charts.

use crate::desk::Desk;
use octray::measure::stability::recipe;
use predicates::prelude::*;
use predicates::str::contains;
use serde_json::{Value, json};
use std::fs;

/// Of the cheapest.
const QUICK: [&str; 4] = ["stability", "--only", "spheres-tangent", "spheres-inside"];

#[test]
fn stability_reports_in_json_every_method_at_every_place() {
    let desk = Desk::new();
    let report = desk.json(&[&QUICK[..], &["--json"]].concat());
    assert_eq!((&report["schema"], &report["holds"]), (&json!("octray-stability-1"), &json!(true)));
    assert!(report["machine"]["cpu"].is_string());
    let recipes = report["recipes"].as_array().unwrap();
    let names: Vec<&Value> = recipes.iter().map(|recipe| &recipe["recipe"]).collect();
    assert_eq!(json!(names), json!(["spheres-tangent", "spheres-inside"]));
    for told in recipes {
        let known = recipe(told["recipe"].as_str().unwrap()).unwrap();
        for key in ["title", "axis", "failure", "source"] {
            assert!(told[key].as_str().is_some_and(|text| !text.is_empty()), "{key}: {told}");
        }
        let curves = told["curves"].as_array().unwrap();
        let methods: Vec<&Value> = curves.iter().map(|curve| &curve["method"]).collect();
        assert_eq!(json!(methods), json!(["robust", "robust-any-length", "naive"]));
        for (curve, default) in curves.iter().zip([true, false, false]) {
            assert_eq!(curve["default"], default);
            let points = curve["points"].as_array().unwrap();
            let places: Vec<f64> = points.iter().map(|point| point["x"].as_f64().unwrap()).collect();
            assert_eq!(places, known.places);
            for point in points {
                assert_eq!(point["tested"], known.cases);
                assert!(point["failures"].as_u64().unwrap() <= known.cases as u64);
                assert_eq!(point["p99"].is_f64(), known.error.is_some(), "{point}");
                assert!(point["p50"].as_f64() <= point["p90"].as_f64());
                assert!(point["p90"].as_f64() <= point["p99"].as_f64());
                assert!(point["p99"].as_f64() <= point["max"].as_f64());
                assert_eq!(point["bound"].is_null(), !default);
            }
        }
    }
}

#[test]
fn stability_gives_the_same_figures_every_time_on_any_number_of_threads() {
    let desk = Desk::new();
    let figures = |threads: &str| {
        let mut command = desk.octray(&[&QUICK[..], &["--json"]].concat());
        let done = command.env("RAYON_NUM_THREADS", threads).assert().success();
        serde_json::from_slice::<Value>(&done.get_output().stdout).unwrap()["recipes"].clone()
    };
    let first = figures("1");
    assert_eq!((&first, &first), (&figures("1"), &figures("3")));
}

#[test]
fn thorough_stability_tries_ten_times_as_many_cases() {
    let desk = Desk::new();
    let known = recipe("textures-seam").unwrap();
    let report = desk.json(&["stability", "--only", known.name, "--thorough", "--json"]);
    assert_eq!(report["thorough"], true);
    assert_eq!(report["recipes"][0]["curves"][0]["points"][0]["tested"], 10 * known.cases);
}

#[test]
fn stability_prints_a_table_a_recipe_and_what_it_means() {
    let desk = Desk::new();
    let shown = desk.octray(&QUICK).assert().success();
    let printed = String::from_utf8_lossy(&shown.get_output().stdout).into_owned();
    let at = |words: &str| printed.find(words).unwrap_or_else(|| panic!("{words} is not in {printed}"));
    assert!(at("keep their bounds") < at("\nspheres-tangent: "), "the verdict comes first");
    shown.stdout(
        contains("\nspheres-tangent: ")
            .and(contains("robust *"))
            .and(contains("\n  naive "))
            .and(contains("hit or miss misjudged"))
            .and(contains("The default methods (*) keep their bounds in 2 recipes.")),
    );
    assert_eq!(desk.names(), Desk::new().names(), "nothing is written unless it is asked for");
}

#[test]
fn stability_writes_charts_and_json_into_a_folder_that_it_makes() {
    let desk = Desk::new();
    desk.octray(&[&QUICK[..], &["-o", "new/charts"]].concat()).assert().success();
    let mut names: Vec<String> = fs::read_dir(desk.path("new/charts"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    names.sort();
    let expected =
        ["spheres-inside-error.svg", "spheres-inside.svg", "spheres-tangent.svg", "stability.json"];
    assert_eq!(names, expected);
    for name in &expected[..3] {
        let drawn = fs::read_to_string(desk.path("new/charts").join(name)).unwrap();
        assert!(
            drawn.starts_with("<svg") && drawn.contains("robust (default)") && drawn.contains("naive"),
            "{name}"
        );
    }
    let text = fs::read_to_string(desk.path("new/charts/stability.json")).unwrap();
    let report: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(report["recipes"].as_array().unwrap().len(), 2);
}

#[test]
fn stability_refuses_a_folder_that_cannot_be_before_it_works() {
    let desk = Desk::new();
    desk.refuses(&["stability", "-o", "scene.json"], &["cannot make the folder", "scene.json"]);
}
