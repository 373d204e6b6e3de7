//! The report of `octray bench`: frames per second, as two tables or as JSON.

use super::compare::agreement;
use super::numbers::{figure, mark, ratio};
use super::settings::{Differences, RunSettings, in_words, own_sizes, traversals};
use super::stats::{self, engine, engine_name};
use super::text::{self, paragraph};
use crate::checkpoint::Fingerprint;
use crate::lane::WIDTHS;
use crate::measure::bench::{FEWEST_FRAMES, Measurement};
use crate::measure::compare::Comparison;
use crate::measure::timed::Ratio;
use crate::render::Settings;
use crate::scene::Scene;
use crate::wording::{counted, grouped};
use serde::{Deserialize, Serialize};

#[derive(Debug, Default, Serialize)]
pub struct Report {
    pub schema: &'static str,
    pub settings: RunSettings,
    /// Whether neither a busy machine nor a debug build nor too few frames make the figures unreliable.
    pub reliable: bool,
    /// Milliseconds from the start of the command to the end of its first frame.
    pub first_frame_ms: f64,
    pub scenes: Vec<MeasuredScene>,
    /// Speeds by scene, then by engine.
    pub results: Vec<Measurement>,
    /// One sample of each scene: SIMD against scalar and against the f64 reference. A speed is reported with
    /// its accuracy.
    pub accuracy: Vec<Comparison>,
    /// Ratios to `--baseline`, by scene, then by engine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over_baseline: Option<Vec<Over>>,
    /// Differences between the baseline's settings, machine and scenes and these.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub baseline_differences: Option<Differences>,
    /// Ratios to `--against` or `--against-program`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub against: Option<Against>,
}

pub const SCHEMA: &str = "octray-bench-1";

/// A measured scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MeasuredScene {
    pub scene: String,
    size: [u32; 2],
    bounces: u32,
    pub content: Fingerprint,
}

impl MeasuredScene {
    /// Describes a scene with these settings.
    pub fn of(scene: &Scene, settings: &Settings) -> Self {
        let (size, bounces) = (settings.resolution, settings.max_bounces);
        Self { scene: scene.name.clone(), size, bounces, content: Fingerprint::from_scene(scene) }
    }
}

/// The speed of a scene and an engine over another one's.
#[derive(Debug, Serialize)]
pub struct Over {
    pub scene: String,
    pub lanes: usize,
    pub threads: usize,
    /// SIMD width and threads of the other one.
    pub there: [usize; 2],
    /// Above 1 where this run is faster. Over a baseline it is that of the median frames, and the spread is
    /// from the slow tenth of the new frames over the fast tenth of the old ones, to the reverse.
    #[serde(flatten)]
    pub ratio: Ratio,
}

/// Measurements in alternating rounds with a run.
#[derive(Debug, Default, Serialize)]
pub struct Against {
    /// The options, or the program.
    pub with: String,
    /// Differences between the two configurations.
    pub differences: Differences,
    /// Ratios by scene, then by engine.
    pub ratios: Vec<Over>,
    /// The second configuration's figures; a program's are not here.
    pub results: Vec<Measurement>,
    /// One sample of each scene in the second configuration.
    pub accuracy: Vec<Comparison>,
}

impl Against {
    /// Adds a scene; `first` are the engines of this run, `second` those they have ratios to.
    pub fn push(&mut self, first: &[Measurement], second: Vec<Measurement>, accuracy: Comparison) {
        self.ratios.extend(first.iter().zip(&second).filter_map(|(here, there)| {
            let (scene, there) = (here.scene.clone(), [there.lanes, there.threads]);
            Some(Over { scene, lanes: here.lanes, threads: here.threads, there, ratio: here.over_second? })
        }));
        self.results.extend(second);
        self.accuracy.push(accuracy);
    }

    /// Returns the ratios as a table.
    pub fn text(&self) -> String {
        let rmse = |one: &Comparison| format!(" rmse of {} there: {:.1e}.", one.scene, one.reference.rmse);
        let meaning = format!(
            "Here over {}, frames per second in alternating rounds: medians of the rounds, and in brackets \
             from 10 to 90 % of them. {}{}",
            self.with,
            in_words(&self.differences),
            self.accuracy.iter().map(rmse).collect::<String>()
        );
        table(&meaning, &self.ratios)
    }
}

/// Returns a table of ratios below what they mean.
pub fn table(meaning: &str, ratios: &[Over]) -> String {
    let cells = |one: &Over| {
        let [here, there] =
            [[one.lanes, one.threads], one.there].map(|[lanes, threads]| engine_name(lanes, threads));
        let engines = if here == there { here } else { format!("{here} over {there}") };
        text::row(&[-24, -44, 24], [&one.scene, &engines, &ratio(one.ratio)])
    };
    format!("\n{}{}", paragraph(meaning), ratios.iter().map(cells).collect::<String>())
}

impl Report {
    /// Returns the results of each scene: all have the same engines.
    pub fn engines(&self) -> impl Iterator<Item = &[Measurement]> {
        let engines = self.results.len() / self.accuracy.len().max(1);
        self.results.chunks(engines.max(1))
    }
}

/// Explanation of the table of ratios.
const RATIOS: &str = "\
Ratios, medians of the rounds (10 to 90 % of them): speed-up is SIMD over scalar, scaling is all cores over one, \
specialisation is over the pipeline with every feature, where the scene does not use that one.";
/// Cell of a figure that was not measured.
const NOTHING: &str = "–";

/// Returns the widths of the table's columns: the scene, a column a width, and the rest.
fn widths() -> Vec<isize> {
    [&[-24][..], &vec![15; WIDTHS.len()], &[15, 7, 10, 11, 8]].concat()
}

/// Returns the lines above the rows of scenes.
pub fn heading(Report { settings, .. }: &Report, defaults: &RunSettings) -> String {
    let size =
        settings.size.map_or("each scene's size".into(), |[width, height]| format!("{width}×{height}"));
    let bounces = settings.bounces.map(|most| format!("up to {}", counted(most, "bounce", "bounces")));
    let names = std::iter::once("scene".into())
        .chain(WIDTHS.into_iter().rev().map(engine))
        .chain(["all cores", "Mray/s", "differing", "wrong hits", "rmse"].map(String::from));
    format!(
        "{}\n\
         {}{size}, 1 sample a frame, {}, {}\n\
         frames per second: median (1 % low)\n\n\
         {}",
        settings.machine,
        settings.line(defaults),
        bounces.unwrap_or("each scene's bounces".into()),
        counted(settings.threads[0], "thread", "threads"),
        text::row(&widths(), names)
    )
}

/// Returns a scene's row.
pub fn row(results: &[Measurement], accuracy: &Comparison) -> String {
    let first = &results[0];
    let of_width = |lanes| results.iter().find(move |result| result.lanes == lanes);
    let all = results.iter().skip(1).find(|result| result.threads > first.threads);
    let fps = |result: Option<&Measurement>| {
        result.map_or(NOTHING.into(), |result| {
            let [median, low] = [result.fps_median, result.fps_low_1_percent].map(rate);
            format!("{median}{} ({low})", mark(result.reliability))
        })
    };
    let cells = std::iter::once(first.scene.clone())
        .chain(WIDTHS.into_iter().rev().map(|lanes| fps(of_width(lanes))))
        .chain([
            fps(all),
            figure(first.mrays_per_s, 1),
            grouped(accuracy.mismatched_pixels),
            grouped(accuracy.reference.mismatched_hits),
            format!("{:.1e}", accuracy.reference.rmse),
        ]);
    text::row(&widths(), cells)
}

/// Frames per second, in thousands (k) where a column would be too narrow.
fn rate(fps: f64) -> String {
    let decimals = usize::from(fps < 100_000.0);
    if fps < 10_000.0 { figure(fps, 0) } else { figure(fps / 1_000.0, decimals) + "k" }
}

/// Returns the columns of the table of ratios for a scene: names and values.
fn columns(of_scene: &[Measurement]) -> Vec<(String, Option<Ratio>)> {
    let first = of_scene.iter().filter(|one| one.threads == of_scene[0].threads && one.lanes > 1);
    let speedups = first.map(|one| (format!("speed-up, {}", engine(one.lanes)), one.speedup));
    let scaling = of_scene.iter().find_map(|one| one.scaling);
    speedups
        .chain([("scaling".into(), scaling), ("specialisation".into(), of_scene[0].specialisation)])
        .collect()
}

/// Returns the ratios of the scenes, below the table of rates; nothing where no ratio was measured.
pub fn ratios(report: &Report) -> String {
    let row = |scene: &str, cells: Vec<String>| {
        let widths = [&[-24][..], &vec![24; cells.len()]].concat();
        text::row(&widths, std::iter::once(scene.to_owned()).chain(cells))
    };
    let mut rows = String::new();
    for of_scene in report.engines() {
        let (names, ratios): (Vec<_>, Vec<_>) = columns(of_scene).into_iter().unzip();
        if ratios.iter().any(Option::is_some) {
            if rows.is_empty() {
                rows = row("scene", names);
            }
            let cell = |of: Option<Ratio>| of.map_or(NOTHING.into(), ratio);
            rows += &row(&of_scene[0].scene, ratios.into_iter().map(cell).collect());
        }
    }
    if rows.is_empty() { rows } else { format!("\n{}{rows}", paragraph(RATIOS)) }
}

/// Returns why the figures are not reliable, in a few words and as a warning: the machine is busy, or a scene
/// has fewer frames than [`FEWEST_FRAMES`].
pub fn doubt(results: &[Measurement]) -> Option<(&'static str, String)> {
    let figures = results.iter().map(|Measurement { scene, lanes, threads, reliability, .. }| {
        (*reliability, format!("{scene} ({})", engine_name(*lanes, *threads)))
    });
    text::busy(figures).map(|warning| ("on a busy machine", warning)).or_else(|| {
        let few = results.iter().find(|result| result.frames < FEWEST_FRAMES)?;
        let (scene, frames) = (&few.scene, counted(few.frames, "frame", "frames"));
        let warning =
            format!("{scene} was timed for {frames}, too few: give --frames {FEWEST_FRAMES} or more.");
        Some(("of too few frames", warning))
    })
}

/// Returns the tables of `--stats`: one a scene with a column an engine, and what they mean.
pub fn stats_of(report: &Report) -> String {
    let tables = report.engines().map(|of_scene| {
        let columns: Vec<_> = of_scene.iter().filter_map(|result| result.stats.as_ref()).collect();
        stats::frames(&of_scene[0].scene, &columns)
    });
    tables.collect::<String>() + &stats::meaning_of_frames()
}

/// Returns one line to paste: frames per second of the first engine, the options, the machine and the commit.
pub fn summary(report: &Report, defaults: &RunSettings) -> String {
    let Some(first) = report.results.first() else { return String::new() };
    let rates = report.engines().map(|of_scene| {
        let name = of_scene[0].scene.trim_start_matches("builtin:");
        let speedup =
            of_scene[0].speedup.map_or(String::new(), |ratio| format!(" ({:.1} × scalar)", ratio.median));
        format!("{name} {} fps{speedup}", figure(of_scene[0].fps_median, 0))
    });
    let wrong = report.accuracy.iter().any(|a| a.mismatched_pixels + a.reference.mismatched_hits > 0);
    let wrong = if wrong { "; PIXELS OR HITS ARE WRONG" } else { "" };
    let options = match report.settings.options(defaults) {
        none if none.is_empty() => none,
        options => format!("; {options}"),
    };
    let debug = cfg!(debug_assertions).then_some("of a debug build");
    let why = debug.or_else(|| doubt(&report.results).map(|(why, _)| why));
    let machine = &report.settings.machine;
    format!(
        "\noctray bench: {}{}{wrong}; {}{options}; {}, commit {}\n",
        rates.collect::<Vec<_>>().join(", "),
        why.map(|why| format!(", {why}: not reliable")).unwrap_or_default(),
        engine_name(first.lanes, first.threads),
        machine.cpu,
        machine.commit
    )
}

/// Explains the tables; `own` are the scenes whose size or bounces are not measured.
pub fn meaning(report: &Report, own: &[String]) -> String {
    let firsts = report.engines().map(|of_scene| (of_scene[0].scene.as_str(), of_scene[0].traversal));
    agreement(&report.accuracy) + &traversals(firsts) + &own_sizes(own)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::cores::Reliability;
    use crate::render::Methods;

    fn reliability(taken: f64) -> Reliability {
        Reliability { reliable: taken <= 0.05, pinned: true, taken: Some(taken) }
    }

    fn result(scene: &str, lanes: usize, frames: usize, taken: f64) -> Measurement {
        Measurement {
            scene: scene.into(),
            lanes,
            threads: 2,
            frames,
            fps_median: 100.0,
            reliability: reliability(taken),
            ..Measurement::default()
        }
    }

    fn times(median: f64) -> Option<Ratio> {
        let spread = [median - 0.25, median + 0.5];
        Some(Ratio { median, spread, rounds: 5, reliability: reliability(0.0) })
    }

    #[test]
    fn ratios_stand_below_their_names_in_a_row_for_each_scene() {
        // Three engines of two scenes that have one name.
        let engines = |speedup, scaling| {
            let of = |lanes| result("same", lanes, 99, 0.0);
            let first = Measurement { speedup, specialisation: times(1.5), ..of(16) };
            let all_cores = Measurement { scaling, threads: 4, ..of(16) };
            [first, Measurement { speedup: times(3.0), ..of(8) }, all_cores]
        };
        let mut report = Report {
            results: [engines(times(7.0), times(2.0)), engines(times(6.0), None)].concat(),
            accuracy: vec![Comparison::default(); 2],
            settings: RunSettings::of(Methods::default()),
            ..Report::default()
        };
        report.results[3].speedup.as_mut().unwrap().reliability.reliable = false;
        let rows = ratios(&report);
        let rows: Vec<String> =
            rows.lines().skip_while(|line| !line.starts_with("scene ")).map(words).collect();
        let expected = [
            "scene speed-up, 16 lanes speed-up, 8 lanes scaling specialisation",
            "same 7.00× (6.75–7.50) 3.00× (2.75–3.50) 2.00× (1.75–2.50) 1.50× (1.25–2.00)",
            "same 6.00×? (5.75–6.50) 3.00× (2.75–3.50) – 1.50× (1.25–2.00)",
        ];
        assert_eq!(rows, expected);
        report.results[0].reliability = reliability(0.1);
        let why = if cfg!(debug_assertions) { "of a debug build" } else { "on a busy machine" };
        let expected = format!("same 100 fps (6.0 × scalar), {why}: not reliable; 16 lanes, 2 threads;");
        let summary = summary(&report, &report.settings);
        assert!(summary.contains(&expected), "{summary}");
    }

    fn words(line: &str) -> String {
        line.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    #[test]
    fn rates_stand_below_their_names() {
        let engine = |lanes, threads, fps_median| Measurement {
            threads,
            fps_median,
            fps_low_1_percent: 10.0,
            mrays_per_s: 1.0,
            ..result("scene", lanes, 99, 0.0)
        };
        let engines = [engine(8, 1, 12_345.0), engine(1, 1, 40.0), engine(8, 2, 1_386_600.0)];
        let row = words(&row(&engines, &Comparison::default()));
        assert!(row.ends_with(" 12.3k (10) 40 (10) 1,387k (10) 1.0 0 0 0.0e0"), "{row}");
    }

    #[test]
    fn warning_names_the_figure_that_others_took_most_of_or_a_scene_of_few_frames() {
        let calm = result("calm", 8, 99, 0.05);
        assert_eq!(doubt(std::slice::from_ref(&calm)), None);
        let (_, sentence) = doubt(&[calm.clone(), result("few", 8, FEWEST_FRAMES - 1, 0.0)]).unwrap();
        assert!(sentence.contains("few was timed for 49 frames"), "{sentence}");
        let (_, sentence) = doubt(&[result("bad", 8, 9, 0.1), result("worse", 8, 99, 0.4), calm]).unwrap();
        assert!(sentence.contains("40 % of the time of worse (8 lanes, 2"), "{sentence}");
    }
}
