//! `octray stability`: its table, its JSON, its charts.

use crate::desk::{Desk, assert_fits, list, number};
use octray::measure::stability::test_case;
use serde_json::{Value, json};

/// Runs two of the cheapest test cases.
const QUICK: &str = "stability --only spheres-tangent spheres-inside";

#[test]
fn stability_reports_in_json_every_method_at_every_place() {
    let desk = Desk::new();
    let report = desk.json(QUICK);
    assert_eq!((&report["schema"], &report["holds"]), (&json!("octray-stability-1"), &json!(true)));
    assert!(report["machine"]["cpu"].is_string());
    let test_cases = list(&report["test_cases"]);
    let names = |of: &[Value], key: &str| of.iter().map(|one| one[key].clone()).collect::<Vec<_>>();
    assert_eq!(names(test_cases, "test_case"), ["spheres-tangent", "spheres-inside"]);
    for told in test_cases {
        let known = test_case(told["test_case"].as_str().unwrap()).unwrap();
        for key in ["title", "axis", "failure", "source"] {
            assert!(told[key].as_str().is_some_and(|text| !text.is_empty()), "{key}: {told}");
        }
        let curves = list(&told["curves"]);
        assert_eq!(names(curves, "method"), ["robust", "robust-any-length", "naive"]);
        for (curve, default) in curves.iter().zip([true, false, false]) {
            assert_eq!(curve["default"], default);
            let points = list(&curve["points"]);
            assert_eq!(json!(names(points, "x")), json!(known.places));
            for point in points {
                assert_eq!(point["tested"], known.inputs);
                assert!(number(&point["failures"]) <= known.inputs as f64);
                assert_eq!(point["p99"].is_f64(), known.error.is_some(), "{point}");
                let errors = ["p50", "p90", "p99", "max"].map(|key| point[key].as_f64());
                assert!(errors.is_sorted(), "{point}");
                assert_eq!(point["bound"].is_null(), !default);
            }
        }
    }
}

#[test]
fn stability_gives_the_same_figures_every_time_on_any_number_of_threads() {
    let desk = Desk::new();
    let figures = |threads: &str| {
        let mut command = desk.octray(&format!("{QUICK} --json"));
        let done = command.env("RAYON_NUM_THREADS", threads).assert().success();
        serde_json::from_slice::<Value>(&done.get_output().stdout).unwrap()["test_cases"].clone()
    };
    let first = figures("1");
    assert_eq!((&first, &first), (&figures("1"), &figures("3")));
}

#[test]
fn thorough_stability_tries_ten_times_as_many_cases() {
    let desk = Desk::new();
    let known = test_case("textures-seam").unwrap();
    let report = desk.json(&format!("stability --only {} --thorough", known.name));
    assert_eq!(report["thorough"], true);
    assert_eq!(report["test_cases"][0]["curves"][0]["points"][0]["tested"], 10 * known.inputs);
}

#[test]
fn stability_prints_a_row_a_test_case_its_tables_on_request_and_what_they_mean() {
    let desk = Desk::new();
    let brief = desk.run(QUICK);
    assert!(brief.contains("\nspheres-inside ") && !brief.contains("\n  naive "), "{brief}");
    assert_fits(brief.split_once('\n').unwrap().1);
    let printed = desk.run(&format!("{QUICK} --tables"));
    let places = ["keep their bounds in 2 ", "\nspheres-tangent ", "\nspheres-tangent: ", "\n  naive "];
    let places = places.map(|words| printed.find(words));
    assert!(places.is_sorted() && places[0].is_some(), "the verdict comes first: {printed}");
    assert_eq!(desk.names(), Desk::new().names(), "nothing is written unless it is asked for");
}

#[test]
fn stability_writes_charts_and_json_into_a_folder_that_it_makes_or_refuses() {
    let desk = Desk::new();
    desk.run(&format!("{QUICK} -o new/charts"));
    let expected =
        ["spheres-inside-error.svg", "spheres-inside.svg", "spheres-tangent.svg", "stability.json"];
    assert_eq!(desk.names_in("new/charts"), expected);
    for name in &expected[..3] {
        let drawn = desk.text(&format!("new/charts/{name}"));
        assert!(drawn.starts_with("<svg"), "{name}");
        assert!(drawn.contains("robust (default)") && drawn.contains("naive"), "{name}");
    }
    let report: Value = serde_json::from_str(&desk.text("new/charts/stability.json")).unwrap();
    assert_eq!(list(&report["test_cases"]).len(), 2);
    // Before it works.
    desk.refuses("stability -o scene.json", &["cannot make the folder", "scene.json", "because: "]);
}
