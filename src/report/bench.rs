//! What `octray bench` reports: frames per second, as two tables or as JSON.
//!
//! For: [`Report`].

use super::numbers::{figure, mark, ratio};
use super::settings::{RunSettings, json, own_sizes, traversals};
use super::stats::{self, engine};
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

/// The JSON report.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Name and version of the report's form.
    pub schema: &'static str,
    /// How the figures were measured.
    pub settings: RunSettings,
    /// Whether nothing tells of a busy machine, of too few frames or of a debug build.
    pub reliable: bool,
    /// Milliseconds from the start of the command to the end of its first frame.
    pub first_frame_ms: f64,
    /// In their order.
    pub scenes: Vec<MeasuredScene>,
    /// By scene, then by engine.
    pub results: Vec<Measurement>,
    /// One sample of each scene: SIMD against scalar and against the f64 reference. A speed is reported with
    /// its accuracy.
    pub accuracy: Vec<Comparison>,
    /// With `--baseline`, by scene, then by engine.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub over_baseline: Option<Vec<OverBaseline>>,
}

/// Name and version of the JSON report's form.
pub const SCHEMA: &str = "octray-bench-1";

/// What was measured of a scene.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct MeasuredScene {
    /// Its name.
    pub scene: String,
    /// Pixels.
    size: [u32; 2],
    /// Most scattering events of a path.
    bounces: u32,
    /// Its content, in checksums.
    content: Fingerprint,
}

impl MeasuredScene {
    /// A scene with these settings.
    pub fn of(scene: &Scene, settings: &Settings) -> Self {
        let (size, bounces) = (settings.resolution, settings.max_bounces);
        Self { scene: scene.name.clone(), size, bounces, content: Fingerprint::of(scene) }
    }

    /// Are both one scene, whatever its name?
    pub fn is_same(&self, other: &Self) -> bool {
        (self.size, self.bounces, &self.content) == (other.size, other.bounces, &other.content)
    }

    /// What differs, by name.
    pub fn changes(&self, other: &Self) -> String {
        let [here, there] = [self, other].map(|scene| json(&scene.content));
        let parts = here.as_object().into_iter().flatten().filter(|(part, mark)| there[*part] != **mark);
        let parts: Vec<&str> = parts.map(|(part, _)| part.as_str()).collect();
        if parts.is_empty() { "size or bounces".into() } else { parts.join(", ") }
    }
}

/// The speed of a scene and an engine over that in the baseline.
#[derive(Debug, Serialize)]
pub struct OverBaseline {
    /// Its name.
    pub scene: String,
    /// SIMD width.
    pub lanes: usize,
    /// Worker threads.
    pub threads: usize,
    /// Of the median frames; above 1 where the new one is faster. The spread is from the slow tenth of the
    /// new frames over the fast tenth of the old ones, to the reverse.
    #[serde(flatten)]
    pub ratio: Ratio,
}

impl Report {
    /// Without figures yet.
    pub fn new(settings: RunSettings) -> Self {
        Self {
            schema: SCHEMA,
            settings,
            reliable: false,
            first_frame_ms: 0.0,
            scenes: Vec::new(),
            results: Vec::new(),
            accuracy: Vec::new(),
            over_baseline: None,
        }
    }

    /// The results of each scene: all have the same engines.
    pub fn engines(&self) -> impl Iterator<Item = &[Measurement]> {
        let engines = self.results.len() / self.accuracy.len().max(1);
        self.results.chunks(engines.max(1))
    }
}

/// Stands for what was not measured.
const NOTHING: &str = "–";

/// The widths of the table's columns: the scene, a column a width, and the rest.
fn widths() -> Vec<isize> {
    [&[-24][..], &vec![15; WIDTHS.len()], &[15, 7, 10, 11, 8]].concat()
}

/// What stands above the rows of scenes.
pub fn heading(Report { settings, .. }: &Report, defaults: &RunSettings) -> String {
    let size =
        settings.size.map_or("each scene's size".into(), |[width, height]| format!("{width}×{height}"));
    let bounces = match settings.bounces {
        Some(bounces) => format!("up to {}", counted(bounces, "bounce", "bounces")),
        None => "each scene's bounces".into(),
    };
    let names = std::iter::once("scene".into())
        .chain(WIDTHS.into_iter().rev().map(engine))
        .chain(["all cores", "Mray/s", "differing", "wrong hits", "rmse"].map(String::from));
    format!(
        "{}\n\
         {}{size}, 1 sample a frame, {bounces}, {}\n\
         frames per second: median (1 % low)\n\n\
         {}",
        settings.machine,
        settings.line(defaults),
        counted(settings.threads[0], "thread", "threads"),
        text::row(&widths(), names)
    )
}

/// A scene's row.
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

type RatioOf = fn(&Measurement) -> Option<Ratio>;
/// The columns of the table of ratios: name, meaning, value.
const RATIOS: [(&str, &str, RatioOf); 3] = [
    ("speed-up", "SIMD over scalar", |result| result.speedup),
    ("scaling", "all cores over one", |result| result.scaling),
    (
        "specialisation",
        "over the pipeline with every feature, where the scene does not use that one",
        |result| result.specialisation,
    ),
];

/// The ratios of the scenes, below the table of rates; nothing where no ratio was measured.
pub fn ratios(report: &Report) -> String {
    let row = |scene: &str, cells: [String; 3]| {
        text::row(&[-24, 24, 24, 24], std::iter::once(scene.to_owned()).chain(cells))
    };
    let mut rows = String::new();
    for of_scene in report.engines() {
        let ratios = RATIOS.map(|(.., of)| of_scene.iter().find_map(of));
        if ratios.iter().any(Option::is_some) {
            let cell = |of: Option<Ratio>| of.map_or(NOTHING.into(), ratio);
            rows += &row(&of_scene[0].scene, ratios.map(cell));
        }
    }
    if rows.is_empty() {
        return rows;
    }
    let meanings = RATIOS.map(|(name, meaning, _)| format!("{name} is {meaning}")).join(", ");
    let meanings = format!("Ratios, medians of the rounds (10 to 90 % of them): {meanings}.");
    format!("\n{}\n{}{rows}", paragraph(&meanings), row("scene", RATIOS.map(|(name, ..)| name.into())))
}

/// Why the figures are not reliable, in a few words and as a warning: the machine is busy, or a scene has
/// fewer frames than [`FEWEST_FRAMES`].
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

/// The doubt in a sentence about a figure; a debug build is the first.
fn unreliable(report: &Report) -> String {
    let debug = cfg!(debug_assertions).then_some("of a debug build");
    let why = debug.or_else(|| doubt(&report.results).map(|(why, _)| why));
    why.map(|why| format!(", {why}: not reliable")).unwrap_or_default()
}

/// A width and a number of threads in words.
pub fn engine_name(lanes: usize, threads: usize) -> String {
    format!("{}, {}", engine(lanes), counted(threads, "thread", "threads"))
}

/// The tables of `--stats`: one a scene with a column an engine, and what they mean.
pub fn stats_of(report: &Report) -> String {
    let tables = report.engines().map(|of_scene| {
        let columns: Vec<_> = of_scene.iter().filter_map(|result| result.stats.as_ref()).collect();
        stats::frames(&of_scene[0].scene, &columns)
    });
    tables.collect::<String>() + &stats::meaning_of_frames()
}

/// The speed-up, once: over the scenes, with the spread of the rounds, and whether it is reliable.
fn speedup(report: &Report) -> String {
    let ratios: Vec<Ratio> = report.engines().filter_map(|of_scene| of_scene[0].speedup).collect();
    let range = |least: fn(&Ratio) -> f64, most: fn(&Ratio) -> f64| {
        let least = ratios.iter().map(least).fold(f64::INFINITY, f64::min);
        let most = ratios.iter().map(most).fold(0.0, f64::max);
        let [least, most] = [least, most].map(|x| format!("{x:.1}"));
        if least == most { least } else { format!("{least} to {most}") }
    };
    let Some(first) = report.results.first().filter(|_| !ratios.is_empty()) else {
        return "One width was timed.\n".into();
    };
    paragraph(&format!(
        "Speed-up: {} are {} times as fast as scalar (10 to 90 % of the rounds: {}){}.",
        engine(first.lanes),
        range(|ratio| ratio.median, |ratio| ratio.median),
        range(|ratio| ratio.spread[0], |ratio| ratio.spread[1]),
        unreliable(report)
    ))
}

/// One line to paste: frames per second of the first engine, how, where, and of which commit.
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
    let machine = &report.settings.machine;
    format!(
        "\noctray bench: {}{}{wrong}; {}{options}; {}, commit {}\n",
        rates.collect::<Vec<_>>().join(", "),
        unreliable(report),
        engine_name(first.lanes, first.threads),
        machine.cpu,
        machine.commit
    )
}

/// The tables in words; `own` are the scenes whose size or bounces are not measured.
pub fn meaning(report: &Report, own: &[String]) -> String {
    let pixels: usize = report.accuracy.iter().map(|accuracy| accuracy.mismatched_pixels).sum();
    let hits: usize = report.accuracy.iter().map(|accuracy| accuracy.reference.mismatched_hits).sum();
    let firsts = report.engines().map(|of_scene| (of_scene[0].scene.as_str(), of_scene[0].traversal));
    let (speedup, traversals, own) = (speedup(report), traversals(firsts), own_sizes(own));
    let same = match pixels {
        0 => "The pictures of all widths are the same, bit by bit.".into(),
        _ => counted(pixels, "PIXEL DIFFERS.", "PIXELS DIFFER."),
    };
    let right = match hits {
        0 => "Every primary hit is right by the f64 reference.".into(),
        _ => counted(hits, "PRIMARY HIT IS", "PRIMARY HITS ARE") + " WRONG by the f64 reference.",
    };
    format!("\n{speedup}{same}\n{right}\n{traversals}{own}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::measure::compare::ReferenceCheck;
    use crate::measure::cores::Reliability;
    use crate::traverse::Methods;

    fn reliability(taken: f64) -> Reliability {
        Reliability { reliable: taken <= 0.05, pinned: true, taken: Some(taken) }
    }

    fn result(scene: &str, frames: usize, taken: f64) -> Measurement {
        Measurement {
            scene: scene.into(),
            width: 240,
            height: 135,
            max_bounces: 4,
            engine: "simd",
            lanes: 8,
            threads: 2,
            frames,
            fps_median: 100.0,
            fps_low_1_percent: 10.0,
            fps_spread: [10.0, 100.0],
            mrays_per_s: 1.0,
            rays_per_frame: 1e4,
            reliability: reliability(taken),
            speedup: None,
            scaling: None,
            needs: Vec::new(),
            traversal: "linear",
            pipeline: "auto",
            specialisation: None,
            over_second: None,
            stats: None,
        }
    }

    fn times(median: f64) -> Option<Ratio> {
        Some(Ratio {
            median,
            spread: [median - 0.25, median + 0.5],
            rounds: 5,
            reliability: reliability(0.0),
        })
    }

    fn equal_pictures() -> Comparison {
        Comparison {
            scene: "same".into(),
            pixels: 1,
            samples: 1,
            lanes: vec![8],
            mismatched_pixels: 0,
            first_mismatch: None,
            discarded_samples: 0,
            speedup: None,
            traversal: "linear",
            reference: ReferenceCheck { rmse: 0.0, max_abs: 0.0, mismatched_hits: 0, pixels: 1, samples: 1 },
        }
    }

    #[test]
    fn ratios_stand_below_their_names_in_a_row_for_each_scene() {
        // Two engines of two scenes that have one name.
        let engines = |speedup, scaling| {
            let first = Measurement { speedup, specialisation: times(1.5), ..result("same", 99, 0.0) };
            [first, Measurement { scaling, threads: 4, ..result("same", 99, 0.0) }]
        };
        let mut report = Report {
            results: [engines(times(7.0), times(2.0)), engines(times(6.0), None)].concat(),
            accuracy: vec![equal_pictures(), equal_pictures()],
            ..Report::new(RunSettings::of(Methods::default()))
        };
        let rows = ratios(&report);
        let rows: Vec<Vec<&str>> =
            rows.lines().skip_while(|line| !line.starts_with("scene ")).map(words).collect();
        assert_eq!(rows[0], ["scene", "speed-up", "scaling", "specialisation"]);
        assert_eq!(rows[1], ["same", "7.00×", "(6.75–7.50)", "2.00×", "(1.75–2.50)", "1.50×", "(1.25–2.00)"]);
        assert_eq!(rows[2], ["same", "6.00×", "(5.75–6.50)", "–", "1.50×", "(1.25–2.00)"]);
        assert_eq!(rows.len(), 3);
        let told = |report: &Report| speedup(report).replace('\n', " ");
        let expected =
            "Speed-up: 8 lanes are 6.0 to 7.0 times as fast as scalar (10 to 90 % of the rounds: 5.8 to 7.5)";
        assert!(told(&report).starts_with(expected), "{}", told(&report));
        report.results[0].reliability = reliability(0.1);
        let why = if cfg!(debug_assertions) { "of a debug build" } else { "on a busy machine" };
        let why = format!(", {why}: not reliable");
        assert!(told(&report).ends_with(&format!("{why}. ")), "{}", told(&report));
        let summary = summary(&report, &report.settings);
        assert!(
            summary.contains(&format!("same 100 fps (6.0 × scalar){why}; 8 lanes, 2 threads;")),
            "{summary}"
        );
        report.results.iter_mut().for_each(|result| *result = self::result("same", 99, 0.0));
        assert_eq!(ratios(&report), "");
    }

    fn words(line: &str) -> Vec<&str> {
        line.split_whitespace().collect()
    }

    #[test]
    fn rates_stand_below_their_names() {
        let engine = |lanes, threads, fps_median| Measurement {
            lanes,
            threads,
            fps_median,
            ..result("scene", 99, 0.0)
        };
        let engines = [engine(8, 1, 12_345.0), engine(1, 1, 40.0), engine(8, 2, 1_386_600.0)];
        let row = row(&engines, &equal_pictures());
        let cells = words(&row).into_iter().rev().collect::<Vec<_>>();
        assert_eq!(cells[..4], ["0.0e0", "0", "0", "1.0"], "{row}");
        assert_eq!(cells[4..8], ["(10)", "1,387k", "(10)", "40"], "{row}");
        assert_eq!(cells[8..10], ["(10)", "12.3k"], "{row}");
    }

    #[test]
    fn warning_names_the_figure_that_others_took_most_of_or_a_scene_of_few_frames() {
        let calm = result("calm", 99, 0.05);
        assert_eq!(doubt(&[calm.clone()]), None);
        let (_, sentence) = doubt(&[calm.clone(), result("few", FEWEST_FRAMES - 1, 0.0)]).unwrap();
        assert!(sentence.starts_with("few was timed for 49 frames, too few"), "{sentence}");
        let busy = [result("bad", 9, 0.1), result("worse", 99, 0.4), calm];
        let (_, sentence) = doubt(&busy).unwrap();
        assert!(
            sentence.contains("busy") && sentence.contains("40 % of the time of worse (8 lanes, 2"),
            "{sentence}"
        );
    }
}
