//! A chart's figures as rows of tables, and as CSV for spreadsheets and other programs: made from its JSON.

use serde_json::Value;

/// An object of the JSON report, last, and those that contain it.
#[derive(Clone, Debug)]
pub struct Row<'a>(Vec<&'a Value>);

impl<'a> Row<'a> {
    /// Returns the objects of lists inside lists of an object.
    pub fn all(object: &'a Value, lists: &[&str]) -> Vec<Self> {
        lists.iter().fold(vec![Self(vec![object])], |rows, list| {
            let inside = |row: Self| {
                let objects = row.0.last().and_then(|object| object[*list].as_array()).into_iter().flatten();
                objects.map(move |object| Self([&row.0[..], &[object]].concat())).collect::<Vec<_>>()
            };
            rows.into_iter().flat_map(inside).collect()
        })
    }

    /// Returns the value of a key in the innermost object that has it; a path goes on inside the value.
    pub fn get(&self, path: &str) -> &'a Value {
        let key = path.split('/').next().unwrap_or(path);
        let has = self.0.iter().rev().find(|object| object.get(key).is_some());
        let object = has.unwrap_or_else(|| panic!("no object of the report has `{key}`"));
        object.pointer(&format!("/{path}")).unwrap_or(&Value::Null)
    }
}

/// The CSV files, a line each: the name without extension; the lists, one inside the other, whose objects
/// are rows; the columns. A column is a key, or a name and the path of its value; one with an asterisk is a
/// spread and has three columns in the file.
const TABLES: &str = "\
pictures scenes/pictures/points scene configuration samples *seconds *wall_s *processor_s *rmse *relmse \
*relmse_trimmed *flip on_front reliable taken default_passes
frames scenes/frames/moments scene configuration threads seeds *fps after_s *samples *rmse *flip reliable taken
display scenes/display scene filter samples threads seeds *rmse *flip *frame_ms *filter_ms reliable taken
motion scenes/motion scene path filter threads frames speed rmse times_lower *frame_ms *filter_ms reliable taken
kernels kernels family method default lanes ns ns_p10=ns_spread/0 ns_p90=ns_spread/1 wall_ns processor_ns reliable \
taken failures failure_test_case=failure_case/test_case failure_place=failure_case/place \
p99 error_test_case=error_case/test_case error_place=error_case/place
";

/// Returns the names of all CSV files, and their texts.
pub fn tables(chart: &Value) -> impl Iterator<Item = (String, String)> {
    let table = |line: &str| {
        let [name, lists, columns] = line.splitn(3, ' ').collect::<Vec<_>>()[..] else { return None };
        Some((format!("{name}.csv"), csv(lists, columns, chart)))
    };
    TABLES.lines().filter_map(table)
}

fn csv(lists: &str, columns: &str, chart: &Value) -> String {
    let lists: Vec<&str> = lists.split('/').collect();
    let header = columns.split(' ').flat_map(|column| match column.strip_prefix('*') {
        Some(key) => vec![key.to_owned(), format!("{key}_p10"), format!("{key}_p90")],
        None => vec![column.split('=').next().unwrap_or(column).to_owned()],
    });
    let cells = |row: &Row| -> Vec<String> {
        let of = |column: &str| match column.strip_prefix('*') {
            Some(key) => ["median", "p10", "p90"].map(|part| cell(&row.get(key)[part])).to_vec(),
            None if column == "default_passes" => vec![default_passes(row)],
            None => vec![cell(row.get(column.split('=').next_back().unwrap_or(column)))],
        };
        columns.split(' ').flat_map(of).collect()
    };
    let mut writer = csv::Writer::from_writer(Vec::new());
    // Writing into memory cannot fail, and all rows are as long as the header.
    writer.write_record(header).expect("memory takes everything");
    for row in Row::all(chart, &lists) {
        writer.write_record(cells(&row)).expect("a row as long as the header");
    }
    let bytes = writer.into_inner().expect("memory takes everything");
    String::from_utf8(bytes).expect("all cells are text")
}

/// Returns the time of a picture in passes of the default.
fn default_passes(row: &Row) -> String {
    let [time, pass] = ["seconds/median", "default_pass_s"].map(|path| row.get(path).as_f64());
    (time.unwrap_or(f64::NAN) / pass.unwrap_or(f64::NAN)).to_string()
}

fn cell(value: &Value) -> String {
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

    #[test]
    fn cells_are_those_of_the_innermost_objects_that_have_them() {
        let of = |median: f64| json!({ "median": median, "p10": median - 0.5, "p90": median + 0.25 });
        let line = |name: &str, rmse: Value, test_case: Value| {
            let seconds = of(2.0);
            json!({ "name": name, "rmse": rmse, "spread": [0.25, 0.75], "test_case": test_case,
                    "reliable": true, "seconds": seconds })
        };
        let known = line("one, two", of(30.0), json!({ "of": "lost", "name": "no line's" }));
        let lines = [known, line("three", Value::Null, Value::Null)];
        let scene = json!({ "scene": "all", "name": "no line's", "default_pass_s": 0.5, "lines": lines });
        let columns = "scene name *rmse low=spread/0 of=test_case/of reliable default_passes";
        let text = csv("scenes/lines", columns, &json!({ "seeds": 8, "scenes": [scene] }));
        let expected = [
            "scene,name,rmse,rmse_p10,rmse_p90,low,of,reliable,default_passes",
            "all,\"one, two\",30,29.5,30.25,0.25,lost,true,4",
            "all,three,,,,0.25,,true,4",
        ];
        assert_eq!(text.lines().collect::<Vec<_>>(), expected);
    }
}
