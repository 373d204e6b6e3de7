//! Each ratio of a report is that of the figures beside it, exactly, where each was measured once; an error
//! is that of its own seed and film.

use crate::desk::{Desk, SCENE, list, number};
use octray::film::Picture;
use octray::measure::compare::Mismatches;
use serde_json::Value;

#[track_caller]
fn assert_same(a: f64, b: f64, what: &Value) {
    assert!((a / b - 1.0).abs() < 1e-6, "{a} instead of {b}: {what}");
}

/// Every ratio of a frame of each engine.
#[test]
fn bench_has_the_ratios_of_its_rates() {
    let desk = Desk::new();
    let report = desk.json("bench builtin:three --frames 1 --size 64x64");
    let results = list(&report["results"]);
    let mut ratios = 0;
    for engine in results {
        // The base of a ratio is the engine that has 1 of this, and the same of the other.
        for (key, one, same) in [("speedup", "lanes", "threads"), ("scaling", "threads", "lanes")] {
            if !engine[key].is_null() {
                let is_base = |other: &&Value| other[one] == 1 && other[same] == engine[same];
                let base = results.iter().find(is_base).expect("the other engine");
                let [fps, base] = [engine, base].map(|engine| number(&engine["fps_median"]));
                assert_same(number(&engine[key]["median"]), fps / base, engine);
                ratios += 1;
            }
        }
    }
    let is_scaled = results.iter().any(|engine| number(&engine["threads"]) > 1.0);
    assert!(ratios > usize::from(is_scaled), "{report}");
}

#[test]
fn rays_have_the_ratios_of_their_rates() {
    let desk = Desk::new();
    let report = desk.json("rays builtin:knot:2000 --size 64x48 --passes 1");
    let results = list(&report["results"]);
    for one in results.iter().filter(|one| one["traversal"] != "scalar") {
        let same = |other: &Value| ["kind", "threads"].iter().all(|key| other[key] == one[key]);
        let scalar = results.iter().find(|other| other["traversal"] == "scalar" && same(other)).unwrap();
        let rates = number(&one["mrays_per_s"]) / number(&scalar["mrays_per_s"]);
        assert_same(number(&one["over_scalar"]["median"]), rates, one);
    }
}

/// Asserts that a chart's times to equal error are those of its points, and its errors those of every seed's
/// film. The scalar configuration has the default's pictures: its ratio is that of the times of the last
/// level that both have.
pub fn assert_follow_from_points(lines: &[Value]) {
    let named = |name: &str| lines.iter().find(|line| line["configuration"] == name).unwrap();
    let [default, scalar] = ["default", "scalar"].map(|name| list(&named(name)["points"]));
    let last = default.len().min(scalar.len()) - 1;
    let seconds = |points: &[Value]| number(&points[last]["seconds"]["median"]);
    let told = number(&named("scalar")["time_to_equal_error"]["median"]);
    assert_same(told, seconds(scalar) / seconds(default), named("scalar"));
    let rmse = &default[0]["rmse"];
    assert!(number(&rmse["p10"]) < number(&rmse["p90"]), "pictures of eight seeds: {rmse}");
}

/// In a closed room nearly all paths are the reference's: what is left are roundings. In a grey picture of
/// one pixel every channel has the largest error.
#[test]
fn errors_are_those_against_the_reference_of_the_same_seed() {
    let desk = Desk::new();
    let errors = |line: &str| {
        let report = desk.json(line);
        let reference = &report.get("accuracy").unwrap_or(&report["results"])[0]["reference"];
        ["rmse", "max_abs"].map(|key| number(&reference[key]))
    };
    for command in ["compare --samples 2", "bench --frames 1 --threads 1"] {
        let [rmse, _] = errors(&format!("{command} builtin:cornell --seed 7 --size 16x9"));
        assert!(rmse < 1e-5, "{command}: {rmse}");
    }
    desk.write(
        "grey.json",
        SCENE.replace("[0.5, 0.7, 1.0]", "[0.3, 0.3, 0.3]").replace("[0.8, 0.5, 0.3]", "[0.7, 0.7, 0.7]"),
    );
    let [rmse, most] = errors("compare grey.json --samples 1 --size 1x1");
    assert!(most > 0.0 && (rmse / most - 1.0).abs() < 1e-9, "{rmse} of {most}");
}

/// Doctored pictures, through the code that compares films.
#[test]
fn pictures_that_differ_in_any_bit_are_found() {
    let grey = Picture { width: 3, height: 2, pixels: vec![[0.5; 3]; 6] };
    let doctored = |index: usize, channel: usize, value: f32| {
        let mut picture = grey.clone();
        picture.pixels[index][channel] = value;
        picture
    };
    let mut found = Mismatches::default();
    found.add(8, &grey, &grey);
    assert!(found.pixels.is_empty() && found.first.is_none());
    found.add(16, &doctored(4, 2, 0.5f32.next_up()), &grey);
    found.add(8, &doctored(1, 0, f32::NAN), &grey);
    let first = found.first.unwrap();
    assert_eq!((first.lanes, first.x, first.y, first.simd[2]), (16, 1, 1, 0.5f32.next_up()));
    assert_eq!((first.scalar, found.pixels.len()), ([0.5; 3], 2));
}
