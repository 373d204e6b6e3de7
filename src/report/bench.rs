//! What `octray bench` reports: frames per second, as two tables or as JSON.
//!
//! For: [`Report`]. May import: `lane` (its widths), `measure`, `machine`, `numbers`, `paragraph`, `stats`,
//! `busy`. Must not know: how the figures are measured.

use super::busy;
use super::numbers::{figure, ratio};
use super::paragraph::paragraph;
use super::stats::{self, engine};
use crate::lane::native_widths;
use crate::machine::Machine;
use crate::measure::bench::{FEWEST_FRAMES, Measurement};
use crate::measure::compare::Comparison;
use crate::measure::timed::Ratio;
use crate::wording::{counted, grouped};
use serde::Serialize;
use std::fmt::Write;

/// A 1 % low below this share of the median means that other programs took the processor.
const BUSY: f64 = 0.6;

/// The JSON report.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Name and version of the report's form.
    pub schema: &'static str,
    /// What the figures were measured with.
    pub machine: Machine,
    /// Milliseconds from the start of the command to the end of its first frame.
    pub first_frame_ms: f64,
    /// By scene, then by engine.
    pub results: Vec<Measurement>,
    /// One sample of each scene: SIMD against scalar and against the f64 reference. A speed is reported with
    /// its accuracy.
    pub accuracy: Vec<Comparison>,
}

impl Report {
    /// Without figures yet.
    pub fn of_this_machine() -> Self {
        Self {
            schema: "octray-bench-1",
            machine: Machine::current(),
            first_frame_ms: 0.0,
            results: Vec::new(),
            accuracy: Vec::new(),
        }
    }
}

/// The packets that have a column, the widest first.
fn packets() -> impl Iterator<Item = usize> {
    native_widths().filter(|&lanes| lanes > 1)
}

/// What stands above the rows of scenes.
pub fn heading(report: &Report, [width, height]: [u32; 2], max_bounces: u32) -> String {
    format!(
        "{}\n\
         {width}×{height}, 1 sample a frame, up to {}\n\
         frames per second: median (1 % low)\n\n\
         {:<24}{}{:>16}{:>16}{:>8}{:>8}{:>7}{:>9}\n",
        report.machine,
        counted(max_bounces, "bounce", "bounces"),
        "scene",
        packets().map(|lanes| format!("{:>16}", format!("{lanes} lanes"))).collect::<String>(),
        "scalar",
        "all cores",
        "Mray/s",
        "pixels≠",
        "hits≠",
        "rmse"
    )
}

/// A scene's row; cells without a measurement stay empty.
pub fn row(results: &[Measurement], accuracy: &Comparison) -> String {
    let first = &results[0];
    let of_width = |lanes| results.iter().find(move |result| result.lanes == lanes);
    let all = results.iter().skip(1).find(|result| result.threads > first.threads);
    let fps = |result: Option<&Measurement>| {
        result.map_or(String::new(), |result| {
            format!("{} ({})", rate(result.fps_median), rate(result.fps_low_1_percent))
        })
    };
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{:<24}{}{:>16}{:>16}{:>8}{:>8}{:>7}{:>9}",
        first.scene,
        packets().map(|lanes| format!("{:>16}", fps(of_width(lanes)))).collect::<String>(),
        fps(of_width(1)),
        fps(all),
        figure(first.mrays_per_s, 1),
        grouped(accuracy.mismatched_pixels),
        grouped(accuracy.reference.mismatched_hits),
        format!("{:.1e}", accuracy.reference.rmse),
    );
    text
}

/// Frames per second, in thousands (k) where a column would be too narrow.
fn rate(fps: f64) -> String {
    if fps < 100_000.0 { figure(fps, 0) } else { figure(fps / 1_000.0, 0) + "k" }
}

/// The ratios of the scenes, below the table of rates; nothing where no two engines were timed.
pub fn ratios(results: &[Measurement]) -> String {
    let mut rows = String::new();
    for of_scene in results.chunk_by(|a, b| a.scene == b.scene) {
        let cells = RATIOS.map(|(_, _, of)| {
            let Some(Ratio { median, spread, .. }) = of_scene.iter().find_map(of) else {
                return String::new();
            };
            ratio(median, spread)
        });
        if cells.iter().any(|cell| !cell.is_empty()) {
            rows += &ratio_row(&of_scene[0].scene, cells);
        }
    }
    if rows.is_empty() {
        return rows;
    }
    let meanings = RATIOS.map(|(name, meaning, _)| format!("{name}: {meaning}")).join("; ");
    let heading = ratio_row("scene", RATIOS.map(|(name, _, _)| name.to_owned()));
    let what = paragraph(&format!("Ratios, medians of the rounds (10 to 90 % of them). {meanings}."));
    format!("\n{what}\n{heading}{rows}")
}

/// A name, what it means, and where its values stand.
type RatioColumn = (&'static str, &'static str, fn(&Measurement) -> Option<Ratio>);
/// The columns of the table of ratios.
const RATIOS: [RatioColumn; 3] = [
    ("speed-up", "SIMD over scalar", |result| result.speedup),
    ("scaling", "all cores over one", |result| result.scaling),
    ("over general", "over the pipeline with every feature, empty where the scene uses that one", |result| {
        result.over_general
    }),
];

fn ratio_row(scene: &str, [speedup, scaling, over_general]: [String; 3]) -> String {
    format!("{scene:<24}{speedup:>20}{scaling:>20}{over_general:>20}\n")
}

/// A warning that the machine is busy; else that a scene has fewer frames than [`FEWEST_FRAMES`]: its 1 % low
/// is the slowest frame, which proves nothing.
pub fn warning(results: &[Measurement]) -> Option<String> {
    busy(results).or_else(|| {
        let few = results.iter().find(|result| result.frames < FEWEST_FRAMES)?;
        Some(format!(
            "{} was timed for {}, too few to tell whether other programs took the processor: give --frames \
             {FEWEST_FRAMES} or more.",
            few.scene,
            counted(few.frames, "frame", "frames")
        ))
    })
}

/// Names the engine with the lowest 1 % low, where that is below `BUSY` of its median.
fn busy(results: &[Measurement]) -> Option<String> {
    let timed = results.iter().filter(|result| result.frames >= FEWEST_FRAMES);
    let share = |result: &Measurement| result.fps_low_1_percent / result.fps_median;
    busy::warning(timed, share, BUSY, |Measurement { scene, lanes, threads, .. }, share| {
        let (engine, threads) = (engine(*lanes), counted(threads, "thread", "threads"));
        format!("the 1 % low of {scene} ({engine}, {threads}) is {share} of its median")
    })
}

/// The tables of `--stats`: one a scene with a column an engine, and what they mean.
pub fn stats_of(results: &[Measurement]) -> String {
    let tables = results.chunk_by(|a, b| a.scene == b.scene).map(|of_scene| {
        let columns: Vec<_> = of_scene.iter().filter_map(|result| result.stats.as_ref()).collect();
        stats::frames(&of_scene[0].scene, &columns)
    });
    tables.collect::<String>() + &stats::meaning_of_frames()
}

/// The tables in words.
pub fn meaning(report: &Report) -> String {
    let pixels: usize = report.accuracy.iter().map(|accuracy| accuracy.mismatched_pixels).sum();
    let hits: usize = report.accuracy.iter().map(|accuracy| accuracy.reference.mismatched_hits).sum();
    // Of each scene the first width alone: that of the default, or the one asked for.
    let firsts = report.results.chunk_by(|a, b| a.scene == b.scene).map(|of_scene| &of_scene[0]);
    let ratios: Vec<f64> = firsts.filter_map(|first| Some(first.speedup?.median)).collect();
    let speed = match (ratios.iter().copied().reduce(f64::min), ratios.iter().copied().reduce(f64::max)) {
        (Some(least), Some(most)) if ratios.len() > 1 => {
            format!("SIMD is {least:.1} to {most:.1} times as fast as scalar.")
        }
        (Some(ratio), _) => format!("SIMD is {ratio:.1} times as fast as scalar."),
        _ => "One width was timed.".into(),
    };
    let same = if pixels == 0 {
        "The pictures of all widths are the same, bit by bit.".into()
    } else {
        counted(pixels, "PIXEL DIFFERS.", "PIXELS DIFFER.")
    };
    let right = if hits == 0 {
        "Every primary hit is right by the f64 reference.".into()
    } else {
        counted(hits, "PRIMARY HIT IS", "PRIMARY HITS ARE") + " WRONG by the f64 reference."
    };
    format!("\n{speed}\n{same}\n{right}\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warning_names_the_engine_with_the_lowest_share_or_a_scene_of_few_frames() {
        let result = |scene: &str, frames, low| Measurement {
            scene: scene.into(),
            width: 240,
            height: 135,
            max_bounces: 4,
            engine: "simd",
            lanes: 8,
            threads: 2,
            frames,
            fps_median: 100.0,
            fps_low_1_percent: low,
            fps_spread: [low, 100.0],
            mrays_per_s: 1.0,
            rays_per_frame: 1e4,
            speedup: None,
            scaling: None,
            needs: Vec::new(),
            pipeline: "needed",
            over_general: None,
            stats: None,
        };
        let few = result("few", FEWEST_FRAMES - 1, 1.0);
        assert_eq!(warning(&[result("calm", 99, 61.0)]), None);
        let sentence = warning(&[few.clone(), result("calm", 99, 61.0)]).unwrap();
        assert!(sentence.starts_with("few was timed for 49 frames, too few"), "{sentence}");
        let sentence = warning(&[result("one", 1, 100.0)]).unwrap();
        assert!(sentence.starts_with("one was timed for 1 frame, too few"), "{sentence}");
        let sentence = warning(&[few, result("bad", 99, 50.0), result("worse", 99, 40.0)]).unwrap();
        assert!(
            sentence.contains("busy") && sentence.contains("worse (8 lanes, 2 threads) is 40 %"),
            "{sentence}"
        );
    }
}
