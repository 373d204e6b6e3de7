//! `octray chart`: its files, its JSON, its ground truth, which is kept for the next run.

use crate::desk::{Desk, SCENE, list, number};
use crate::ratios::assert_follow_from_points;
use crate::report_page;
use serde_json::{Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// A frame of 48×27, and pictures of 16×9. Half a second is what the truth and the least of all else take
/// here.
pub const SMALL: &str = "chart scene.json -o new/charts --budget 0.5 --size 48x27";

#[test]
fn chart_writes_a_page_drawings_tables_and_json_that_agree() {
    let desk = Desk::new();
    let report = desk.json(SMALL);
    assert_eq!((&report["schema"], &report["seeds"]), (&json!("octray-chart-1"), &json!(8)));
    let scene = &report["scenes"][0];
    assert_eq!((&scene["size"], &scene["frame_size"]), (&json!([16, 9]), &json!([48, 27])));
    assert_eq!(scene["truth"]["cached"], false);
    let lines = list(&scene["pictures"]);
    let names: Vec<&str> = lines.iter().map(|line| line["configuration"].as_str().unwrap()).collect();
    assert_eq!(names[..2], ["default", "scalar"]);
    assert!(names.contains(&"naive spheres") && !names.contains(&"no next event estimation"), "{names:?}");
    let mut points = 0;
    for line in lines {
        assert!(line["pictures_unlike_default"].is_null() || line["pictures_unlike_default"] == 0, "{line}");
        for point in list(&line["points"]) {
            points += 1;
            for error in ["rmse", "relmse", "relmse_trimmed", "flip", "seconds"] {
                let [p10, median, p90] = ["p10", "median", "p90"].map(|p| number(&point[error][p]));
                assert!(p10 <= median && median <= p90 && p10 > 0.0, "{error}: {point}");
            }
        }
    }
    assert_follow_from_points(lines);
    for kernel in list(&report["kernels"]) {
        assert!(number(&kernel["ns"]) > 0.0 && kernel["failure_case"]["test_case"].is_string(), "{kernel}");
    }

    let read = |name: &str| desk.text(&format!("new/charts/{name}"));
    let page = read("report.html");
    report_page::assert_stands_alone(&page, &report, desk.path("scene.json").to_str().unwrap());
    let kept: Value = serde_json::from_str(&read("chart.json")).unwrap();
    assert_eq!(kept, report, "the file and what is printed");
    let table = read("pictures.csv");
    assert_eq!(table.lines().count(), points + 1);
    let columns = table.lines().next().unwrap().split(',').count();
    assert!(table.lines().all(|row| row.split(',').count() == columns));
    assert_eq!(read("frames.csv").lines().count(), 3 * list(&scene["frames"]).len() + 1);
    let [shown, moving] = ["display", "motion"].map(|key| list(&scene[key]));
    assert_eq!((shown.len(), moving.len()), (3 * 4, 3 * 3), "samples and ways; paths and ways");
    for (table, rows) in [(read("display.csv"), shown), (read("motion.csv"), moving)] {
        assert_eq!(table.lines().count(), rows.len() + 1);
        for (row, line) in rows.iter().zip(table.lines().skip(1)) {
            assert!(line.contains(row["filter"].as_str().unwrap()), "{line}");
            assert!(number(&row["frame_ms"]["median"]) > 0.0, "{row}");
        }
    }
    assert_eq!(read("kernels.csv").lines().count(), list(&report["kernels"]).len() + 1);
    for name in ["pictures.csv", "frames.csv", "display.csv", "kernels.csv"] {
        let table = read(name);
        let mut rows = csv::Reader::from_reader(table.as_bytes());
        let mut empty: BTreeSet<String> = rows.headers().unwrap().iter().map(String::from).collect();
        for row in rows.deserialize::<BTreeMap<String, String>>() {
            row.unwrap().iter().filter(|(_, cell)| !cell.is_empty()).for_each(|(column, _)| {
                empty.remove(column);
            });
        }
        // Errors below that of the ground truth are unknown, and a system may not say what others took.
        assert!(
            empty.iter().all(|column| column.starts_with("rmse") || column == "taken"),
            "{name} has no cells in {empty:?}"
        );
    }
    for name in ["pictures", "pictures-flip", "frames", "display", "motion"] {
        let drawn = read(&format!("scene-json-{name}.svg"));
        assert!(drawn.starts_with("<svg") && page.contains(&drawn), "{name} is on the page");
    }
    assert!(page.contains(&read("kernels-box.svg")));
    let last = list(&lines[0]["points"]).last().unwrap();
    let [seconds, samples] = [&last["seconds"]["median"], &last["samples"]].map(number);
    assert_eq!(number(&scene["default_pass_s"]), seconds / samples);
}

#[test]
fn chart_tells_what_it_found_and_keeps_its_truth_for_the_next_run_of_the_same_scene() {
    let desk = Desk::new();
    let printed = desk.run(SMALL);
    assert!(printed.contains("\nscalar ") && printed.contains("new/charts/report.html"), "{printed}");
    let first: Value = serde_json::from_str(&desk.text("new/charts/chart.json")).unwrap();
    let second = desk.json(SMALL);
    let truth = |report: &Value| report["scenes"][0]["truth"].clone();
    assert_eq!(truth(&second)["cached"], true);
    for figure in ["samples", "frame_rmse", "small_rmse"] {
        assert_eq!(truth(&first)[figure], truth(&second)[figure], "{figure}");
    }
    desk.write("scene.json", SCENE.replace("[0.5, 0.7, 1.0]", "[0.5, 0.7, 1.5]"));
    assert_eq!(truth(&desk.json(SMALL))["cached"], false, "another scene of the same name");
}
