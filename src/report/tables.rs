//! A chart's figures as CSV, one row a point, for spreadsheets and other programs.
//!
//! For: [`pictures`], [`frames`], [`display`], [`motion`], [`kernels`].

use super::chart::Chart;
use crate::measure::quantiles::Spread;

/// The header and the rows of a table.
struct Table(csv::Writer<Vec<u8>>);

impl Table {
    fn new(header: &[&str]) -> Self {
        let mut table = Self(csv::Writer::from_writer(Vec::new()));
        table.row(header.iter().map(|name| (*name).to_owned()));
        table
    }
    fn row(&mut self, cells: impl IntoIterator<Item = String>) {
        // Writing into memory cannot fail, and all rows have as many cells as the header, which a test
        // checks.
        self.0.write_record(cells).expect("rows as long as the header");
    }
    fn text(self) -> String {
        let bytes = self.0.into_inner().expect("memory takes everything");
        String::from_utf8(bytes).expect("all cells are text")
    }
}

/// The cells of a spread: median, 10 % and 90 % quantiles.
fn cells(spread: Spread) -> [String; 3] {
    [spread.median, spread.p10, spread.p90].map(|number| number.to_string())
}

/// A value, or an empty cell.
fn cell(what: Option<impl ToString>) -> String {
    what.map_or_else(String::new, |what| what.to_string())
}

/// A row for each configuration and number of samples; `default_samples` is its time in samples of the
/// default.
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
        "default_samples",
    ]);
    for scene in &chart.scenes {
        for line in &scene.pictures {
            for point in &line.points {
                let mut row = vec![scene.scene.clone(), line.configuration.into(), point.samples.to_string()];
                for spread in [point.seconds, point.rmse, point.relmse, point.relmse_trimmed, point.flip] {
                    row.extend(cells(spread));
                }
                row.push(point.on_front.to_string());
                row.push((point.seconds.median / scene.default_sample_s).to_string());
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
                row.extend(moment.rmse.map_or_else(Default::default, cells));
                row.extend(cells(moment.flip));
                table.row(row);
            }
        }
    }
    table.text()
}

/// A row for each display filter and number of samples.
pub fn display(chart: &Chart) -> String {
    let mut table = Table::new(&[
        "scene",
        "filter",
        "samples",
        "threads",
        "seeds",
        "rmse",
        "rmse_p10",
        "rmse_p90",
        "flip",
        "flip_p10",
        "flip_p90",
        "frame_ms",
        "frame_ms_p10",
        "frame_ms_p90",
        "filter_ms",
        "filter_ms_p10",
        "filter_ms_p90",
    ]);
    for scene in &chart.scenes {
        for shown in &scene.display {
            let mut row = vec![scene.scene.clone(), shown.filter.into(), shown.samples.to_string()];
            row.extend([shown.threads, shown.seeds].map(|count| count.to_string()));
            row.extend(shown.rmse.map_or_else(Default::default, cells));
            for spread in [shown.flip, shown.frame_ms, shown.filter_ms] {
                row.extend(cells(spread));
            }
            table.row(row);
        }
    }
    table.text()
}

/// A row for each camera path and display filter.
pub fn motion(chart: &Chart) -> String {
    let mut table = Table::new(&[
        "scene",
        "path",
        "filter",
        "threads",
        "frames",
        "speed",
        "rmse",
        "times_lower",
        "frame_ms",
        "frame_ms_p10",
        "frame_ms_p90",
        "filter_ms",
        "filter_ms_p10",
        "filter_ms_p90",
    ]);
    for scene in &chart.scenes {
        for moving in &scene.motion {
            let mut row = vec![scene.scene.clone(), moving.path.name().into(), moving.filter.into()];
            row.extend([moving.threads.to_string(), moving.frames.to_string(), moving.speed.to_string()]);
            row.extend([moving.rmse, moving.times_lower].map(cell));
            for spread in [moving.frame_ms, moving.filter_ms] {
                row.extend(cells(spread));
            }
            table.row(row);
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
            cell(kernel.p99),
            cell(case.map(|case| case.recipe)),
            cell(case.map(|case| case.place)),
        ]);
    }
    table.text()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::Machine;
    use crate::measure::chart::SceneChart;
    use crate::measure::chart::display::FilterResult;
    use crate::measure::chart::frames::{Frames, Moment};
    use crate::measure::chart::ground_truth::GroundTruthInfo;
    use crate::measure::chart::kernels::{Case, Kernel};
    use crate::measure::chart::motion::{CameraPath, MotionResult};
    use crate::measure::chart::pictures::{Line, Point};
    use crate::report::chart::SCHEMA;

    /// A spread around this median whose numbers all differ.
    fn around(median: f64) -> Spread {
        Spread { median, p10: median - 0.2, p90: median + 0.25 }
    }

    fn chart() -> Chart {
        let point = Point {
            samples: 1.5,
            seconds: around(2.0),
            rmse: around(3.0),
            relmse: around(4.0),
            relmse_trimmed: around(5.0),
            flip: around(6.0),
            on_front: true,
        };
        let line = Line {
            configuration: "one, with a comma",
            group: None,
            points: vec![point],
            robust: true,
            pictures_unlike_default: None,
            time_to_equal_error: 1.0,
            dominated_by: None,
        };
        let moment = |after_s, rmse| Moment { after_s, samples: around(20.0), rmse, flip: around(40.0) };
        let frames = Frames {
            configuration: "two",
            threads: 7,
            seeds: 9,
            fps: around(10.0),
            moments: vec![moment(0.5, Some(around(30.0))), moment(0.75, None)],
        };
        let scene = SceneChart {
            scene: "three".into(),
            size: [1, 1],
            frame_size: [3, 3],
            truth: GroundTruthInfo {
                samples: 2,
                frame_rmse: 0.1,
                small_rmse: 0.1,
                budget_s: 1.0,
                cached: false,
            },
            default_sample_s: 0.5,
            pictures: vec![line],
            frames: vec![frames],
            display: vec![FilterResult {
                filter: "blurred",
                samples: 4,
                threads: 7,
                seeds: 9,
                rmse: Some(around(30.0)),
                flip: around(40.0),
                frame_ms: around(50.0),
                filter_ms: around(60.0),
            }],
            motion: vec![MotionResult {
                path: CameraPath::Forwards,
                filter: "reprojected",
                threads: 7,
                frames: 48,
                speed: 1.5,
                rmse: Some(0.25),
                times_lower: None,
                frame_ms: around(50.0),
                filter_ms: around(60.0),
            }],
        };
        let kernel = Kernel {
            family: "box",
            method: "fma",
            default: false,
            lanes: 8,
            ns: 0.5,
            ns_spread: [0.25, 0.75],
            p99: Some(0.125),
            failures: 0.0625,
            error_case: Some(Case { recipe: "off", place: 11.0 }),
            failure_case: Case { recipe: "lost", place: 12.0 },
        };
        Chart {
            schema: SCHEMA,
            machine: Machine::current(),
            budget_s: 1.0,
            seconds: 1.0,
            max_bounces: 4,
            seeds: 8,
            kernels: vec![kernel],
            scenes: vec![scene],
        }
    }

    /// The cells of a row, as `name=cell`.
    fn named(table: &str, row: usize) -> String {
        let mut reader = csv::Reader::from_reader(table.as_bytes());
        let header = reader.headers().unwrap().clone();
        let row = reader.records().nth(row).unwrap().unwrap();
        let cells: Vec<String> =
            header.iter().zip(&row).map(|(name, cell)| format!("{name}={cell}")).collect();
        cells.join(" ")
    }

    #[test]
    fn cells_stand_below_their_names() {
        let chart = chart();
        assert_eq!(
            named(&pictures(&chart), 0),
            "scene=three configuration=one, with a comma samples=1.5 seconds=2 seconds_p10=1.8 seconds_p90=2.25 \
             rmse=3 rmse_p10=2.8 rmse_p90=3.25 relmse=4 relmse_p10=3.8 relmse_p90=4.25 \
             relmse_trimmed=5 relmse_trimmed_p10=4.8 relmse_trimmed_p90=5.25 flip=6 flip_p10=5.8 flip_p90=6.25 on_front=true default_samples=4"
        );
        let of_frames = "scene=three configuration=two threads=7 seeds=9 fps=10 fps_p10=9.8 fps_p90=10.25";
        let samples = "samples=20 samples_p10=19.8 samples_p90=20.25";
        let flip = "flip=40 flip_p10=39.8 flip_p90=40.25";
        assert_eq!(
            named(&frames(&chart), 0),
            format!("{of_frames} after_s=0.5 {samples} rmse=30 rmse_p10=29.8 rmse_p90=30.25 {flip}")
        );
        assert_eq!(
            named(&frames(&chart), 1),
            format!("{of_frames} after_s=0.75 {samples} rmse= rmse_p10= rmse_p90= {flip}")
        );
        let times = "frame_ms=50 frame_ms_p10=49.8 frame_ms_p90=50.25 filter_ms=60 filter_ms_p10=59.8 filter_ms_p90=60.25";
        assert_eq!(
            named(&display(&chart), 0),
            format!(
                "scene=three filter=blurred samples=4 threads=7 seeds=9 rmse=30 rmse_p10=29.8 rmse_p90=30.25 {flip} {times}"
            )
        );
        assert_eq!(
            named(&motion(&chart), 0),
            format!(
                "scene=three path=forwards filter=reprojected threads=7 frames=48 speed=1.5 rmse=0.25 times_lower= {times}"
            )
        );
        assert_eq!(
            named(&kernels(&chart), 0),
            "family=box method=fma default=false lanes=8 ns=0.5 ns_p10=0.25 ns_p90=0.75 failures=0.0625 failure_recipe=lost \
             failure_place=12 p99=0.125 error_recipe=off error_place=11"
        );
    }
}
