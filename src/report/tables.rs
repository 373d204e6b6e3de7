//! A chart's figures as CSV, for spreadsheets and other programs: made from its JSON, a row for each of the
//! innermost objects.
//!
//! For: [`tables`].

use super::chart::Chart;
use serde_json::Value;

/// A CSV file.
struct Table {
    /// Without extension.
    name: &'static str,
    /// The lists of the JSON report, one inside the other, whose objects are rows.
    lists: &'static [&'static str],
    /// Names of columns, separated by blanks: see [`cell`].
    columns: &'static str,
}

/// All tables. `default_samples` is a time in samples of the default.
const TABLES: [Table; 5] = [
    Table {
        name: "pictures",
        lists: &["scenes", "pictures", "points"],
        columns: "scene configuration samples seconds seconds_p10 seconds_p90 rmse rmse_p10 rmse_p90 \
                  relmse relmse_p10 relmse_p90 relmse_trimmed relmse_trimmed_p10 relmse_trimmed_p90 \
                  flip flip_p10 flip_p90 on_front default_samples",
    },
    Table {
        name: "frames",
        lists: &["scenes", "frames", "moments"],
        columns: "scene configuration threads seeds fps fps_p10 fps_p90 after_s \
                  samples samples_p10 samples_p90 rmse rmse_p10 rmse_p90 flip flip_p10 flip_p90",
    },
    Table {
        name: "display",
        lists: &["scenes", "display"],
        columns: "scene filter samples threads seeds rmse rmse_p10 rmse_p90 flip flip_p10 flip_p90 \
                  frame_ms frame_ms_p10 frame_ms_p90 filter_ms filter_ms_p10 filter_ms_p90",
    },
    Table {
        name: "motion",
        lists: &["scenes", "motion"],
        columns: "scene path filter threads frames speed rmse times_lower \
                  frame_ms frame_ms_p10 frame_ms_p90 filter_ms filter_ms_p10 filter_ms_p90",
    },
    Table {
        name: "kernels",
        lists: &["kernels"],
        columns: "family method default lanes ns ns_p10 ns_p90 failures failure_recipe failure_place \
                  p99 error_recipe error_place",
    },
];

/// The names of all files, and their texts.
pub fn tables(chart: &Chart) -> Vec<(String, String)> {
    // Through text: an f32 in a `Value` would have the digits of an f64.
    let text = serde_json::to_string(chart).expect("a chart is JSON");
    let chart = serde_json::from_str(&text).expect("it was just written");
    TABLES.iter().map(|table| (format!("{}.csv", table.name), table.text(&chart))).collect()
}

impl Table {
    fn text(&self, chart: &Value) -> String {
        // Each row is the objects that contain it, the outermost first.
        let mut rows = vec![vec![chart]];
        for list in self.lists {
            rows = rows
                .into_iter()
                .flat_map(|row| {
                    let objects =
                        row.last().and_then(|object| object[*list].as_array()).into_iter().flatten();
                    objects.map(move |object| row.iter().copied().chain([object]).collect())
                })
                .collect();
        }
        let mut writer = csv::Writer::from_writer(Vec::new());
        // Writing into memory cannot fail, and all rows are as long as the header.
        let columns = || self.columns.split(' ');
        writer.write_record(columns()).expect("memory takes everything");
        for row in rows {
            writer.write_record(columns().map(|name| cell(name, &row))).expect("a row as long as the header");
        }
        let bytes = writer.into_inner().expect("memory takes everything");
        String::from_utf8(bytes).expect("all cells are text")
    }
}

/// The value of this name in the innermost object that has it; of a spread its median, or the quantile that
/// ends the name. Empty for null.
fn cell(name: &str, row: &[&Value]) -> String {
    let of = |key: &str| row.iter().rev().find_map(|object| object.get(key)).unwrap_or(&Value::Null);
    let value = match name {
        "default_samples" => {
            let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
            return (number(&of("seconds")["median"]) / number(of("default_sample_s"))).to_string();
        }
        "ns_p10" => &of("ns_spread")[0],
        "ns_p90" => &of("ns_spread")[1],
        "failure_recipe" => &of("failure_case")["recipe"],
        "failure_place" => &of("failure_case")["place"],
        "error_recipe" => &of("error_case")["recipe"],
        "error_place" => &of("error_case")["place"],
        _ => match name.rsplit_once('_') {
            Some((key, quantile @ ("p10" | "p90"))) => &of(key)[quantile],
            _ => of(name).get("median").unwrap_or(of(name)),
        },
    };
    match value {
        Value::Null => String::new(),
        Value::String(text) => text.clone(),
        // Not `2.0` but `2`.
        Value::Number(number) => number.as_f64().map_or_else(|| number.to_string(), |x| x.to_string()),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    /// The cells of a table's rows, as `name=cell`.
    fn rows(name: &str, chart: &Value) -> Vec<String> {
        let text = TABLES.iter().find(|table| table.name == name).unwrap().text(chart);
        let mut reader = csv::Reader::from_reader(text.as_bytes());
        let header = reader.headers().unwrap().clone();
        let rows = reader.records().map(|row| {
            let row = row.unwrap();
            let cells = header.iter().zip(&row).map(|(name, cell)| format!("{name}={cell}"));
            cells.collect::<Vec<_>>().join(" ")
        });
        rows.collect()
    }

    #[test]
    fn cells_are_those_of_the_innermost_objects_that_have_them() {
        let of = |median: f64| json!({ "median": median, "p10": median - 0.5, "p90": median + 0.25 });
        let moment = |rmse| json!({ "after_s": 0.5, "samples": of(20.0), "rmse": rmse, "flip": of(40.0) });
        let moments = [moment(of(30.0)), moment(Value::Null)];
        let frames = json!({ "configuration": "two, three", "threads": 7, "seeds": 9, "fps": of(10.0), "moments": moments });
        let point = json!({ "samples": 1.5, "seconds": of(2.0), "on_front": true });
        let pictures = json!([{ "configuration": "one", "points": [point] }]);
        let scene =
            json!({ "scene": "three", "default_sample_s": 0.5, "pictures": pictures, "frames": [frames] });
        let kernel = json!({
            "family": "box", "method": "fma", "default": false, "lanes": 8, "ns": 0.5, "ns_spread": [0.25, 0.75],
            "p99": null, "failures": 0.0625, "error_case": null, "failure_case": { "recipe": "lost", "place": 12.0 },
        });
        let chart = json!({ "seeds": 8, "scenes": [scene], "kernels": [kernel] });
        let of_frames = "scene=three configuration=two, three threads=7 seeds=9 fps=10 fps_p10=9.5 fps_p90=10.25 \
                         after_s=0.5 samples=20 samples_p10=19.5 samples_p90=20.25";
        let flip = "flip=40 flip_p10=39.5 flip_p90=40.25";
        assert_eq!(
            rows("frames", &chart),
            [
                format!("{of_frames} rmse=30 rmse_p10=29.5 rmse_p90=30.25 {flip}"),
                format!("{of_frames} rmse= rmse_p10= rmse_p90= {flip}"),
            ]
        );
        let pictures = &rows("pictures", &chart)[0];
        assert!(pictures.starts_with("scene=three configuration=one samples=1.5 seconds=2 "), "{pictures}");
        assert!(pictures.ends_with(" on_front=true default_samples=4"), "{pictures}");
        assert_eq!(
            rows("kernels", &chart),
            ["family=box method=fma default=false lanes=8 ns=0.5 ns_p10=0.25 ns_p90=0.75 failures=0.0625 \
              failure_recipe=lost failure_place=12 p99= error_recipe= error_place="]
        );
    }
}
