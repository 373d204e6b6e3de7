//! A chart's numbers as CSV, a row a point: for spreadsheets and other programs.
//!
//! For: [`pictures`], [`frames`], [`kernels`]. May import: `measure::chart`, `csv`. Must never know: files.

use crate::measure::chart::Chart;
use crate::measure::chart::pictures::Spread;

/// The header and the rows of a table.
struct Table(csv::Writer<Vec<u8>>);

impl Table {
    fn new(header: &[&str]) -> Self {
        let mut table = Self(csv::Writer::from_writer(Vec::new()));
        table.row(header.iter().map(|name| (*name).to_owned()));
        table
    }
    fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        // Writing into memory cannot fail, and all rows have as many cells as the header: a test holds them to it.
        self.0.write_record(cells).expect("rows as long as the header");
    }
    fn text(self) -> String {
        let bytes = self.0.into_inner().expect("memory takes everything");
        String::from_utf8(bytes).expect("all cells are text")
    }
}

/// The cells of a spread: median, and what 10 and 90 % stay below.
fn cells(spread: Spread) -> [String; 3] {
    [spread.median, spread.p10, spread.p90].map(|number| number.to_string())
}

/// A row for each configuration and number of samples.
pub fn pictures(chart: &Chart) -> String {
    let mut table = Table::new(&[
        "scene",
        "configuration",
        "samples",
        "seconds",
        "seconds_p10",
        "seconds_p90",
        "rmse",
        "rmse_p10",
        "rmse_p90",
        "relmse",
        "relmse_p10",
        "relmse_p90",
        "relmse_trimmed",
        "relmse_trimmed_p10",
        "relmse_trimmed_p90",
        "flip",
        "flip_p10",
        "flip_p90",
        "on_front",
    ]);
    for scene in &chart.scenes {
        for line in &scene.pictures {
            for point in &line.points {
                let mut row = vec![scene.scene.clone(), line.configuration.into(), point.samples.to_string()];
                for spread in [point.seconds, point.rmse, point.relmse, point.relmse_trimmed, point.flip] {
                    row.extend(cells(spread));
                }
                row.push(point.on_front.to_string());
                table.row(row);
            }
        }
    }
    table.text()
}

/// A row for each configuration and moment.
pub fn frames(chart: &Chart) -> String {
    let mut table = Table::new(&[
        "scene",
        "configuration",
        "threads",
        "seeds",
        "fps",
        "fps_p10",
        "fps_p90",
        "after_s",
        "samples",
        "samples_p10",
        "samples_p90",
        "rmse",
        "rmse_p10",
        "rmse_p90",
        "flip",
        "flip_p10",
        "flip_p90",
    ]);
    for scene in &chart.scenes {
        for frames in &scene.frames {
            for moment in &frames.moments {
                let mut row = vec![scene.scene.clone(), frames.configuration.into()];
                row.extend([frames.threads, frames.seeds].map(|count| count.to_string()));
                row.extend(cells(frames.fps));
                row.push(moment.after_s.to_string());
                row.extend(cells(moment.samples));
                row.extend(moment.rmse.map_or([const { String::new() }; 3], cells));
                row.extend(cells(moment.flip));
                table.row(row);
            }
        }
    }
    table.text()
}

/// A row for each method and width.
pub fn kernels(chart: &Chart) -> String {
    let mut table = Table::new(&[
        "family",
        "method",
        "default",
        "lanes",
        "ns",
        "ns_p10",
        "ns_p90",
        "failures",
        "failure_recipe",
        "failure_place",
        "p99",
        "error_recipe",
        "error_place",
    ]);
    for kernel in &chart.kernels {
        let case = kernel.error_case;
        table.row([
            kernel.family.into(),
            kernel.method.into(),
            kernel.default.to_string(),
            kernel.lanes.to_string(),
            kernel.ns.to_string(),
            kernel.ns_spread[0].to_string(),
            kernel.ns_spread[1].to_string(),
            kernel.failures.to_string(),
            kernel.failure_case.recipe.into(),
            kernel.failure_case.place.to_string(),
            kernel.p99.map_or(String::new(), |error| error.to_string()),
            case.map_or(String::new(), |case| case.recipe.into()),
            case.map_or(String::new(), |case| case.place.to_string()),
        ]);
    }
    table.text()
}
