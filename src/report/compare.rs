//! The report of `octray compare`, as a table or as JSON.

use super::numbers::ratio;
use super::settings::{RunSettings, traversals};
use super::text;
use crate::measure::compare::Comparison;
use crate::wording::{counted, grouped};
use serde::Serialize;

#[derive(Debug, Default, Serialize)]
pub struct Report {
    pub schema: &'static str,
    pub settings: RunSettings,
    /// Whether neither a busy machine nor a debug build makes the figures unreliable.
    pub reliable: bool,
    pub results: Vec<Comparison>,
}

/// The JSON report of `--hash`.
#[derive(Debug, Serialize)]
pub struct HashReport {
    pub schema: &'static str,
    /// Whether this build has fused multiply-add.
    pub fused: bool,
    pub results: Vec<FilmHash>,
}

/// The hash of a scene's film: see [`crate::film::Picture::hash`].
#[derive(Debug, Serialize)]
pub struct FilmHash {
    pub scene: String,
    /// 16 hexadecimal digits.
    pub hash: String,
}

const WIDTHS: [isize; 8] = [-24, 11, 11, 11, 23, 12, 12, 12];

/// Returns the lines above the rows of scenes.
pub fn heading(report: &Report, defaults: &RunSettings) -> String {
    let names = text::row(
        &WIDTHS,
        ["scene", "pixels", "samples", "differing", "speed-up", "rmse/f64", "max/f64", "wrong hits"],
    );
    report.settings.line(defaults) + &names
}

/// Returns a scene's row, and below it what is wrong with the scene.
pub fn row(result: &Comparison) -> String {
    let Comparison { scene, pixels, samples, mismatched_pixels, first_mismatch, reference, .. } = result;
    let cells = [
        scene.clone(),
        grouped(pixels),
        grouped(samples),
        grouped(mismatched_pixels),
        result.speedup.map_or("–".into(), ratio),
        format!("{:.2e}", reference.rmse),
        format!("{:.2e}", reference.max_abs),
        grouped(reference.mismatched_hits),
    ];
    let mut row = text::row(&WIDTHS, cells);
    if result.discarded_samples > 0 {
        let discarded = counted(result.discarded_samples, "sample was", "samples were");
        row += &format!("  {discarded} not finite and left out\n");
    }
    if let Some(first) = first_mismatch {
        row += &format!(
            "  first at ({}, {}): {} lanes {:?}, scalar {:?}\n",
            first.x, first.y, first.lanes, first.simd, first.scalar
        );
    }
    row
}

/// Returns the warning of a busy machine.
pub fn doubt(results: &[Comparison]) -> Option<String> {
    text::busy(results.iter().filter_map(|result| Some((result.speedup?.reliability, result.scene.clone()))))
}

/// Explains the table.
pub fn meaning(report: &Report) -> String {
    let scenes = report.results.iter().map(|result| (result.scene.as_str(), result.traversal));
    let doubt = if report.reliable { "" } else { "The speed-ups are not reliable: see the warnings.\n" };
    agreement(&report.results) + &traversals(scenes) + doubt
}

/// Says in two lines whether the pictures of all widths are equal, and whether primary hits are right.
pub fn agreement(comparisons: &[Comparison]) -> String {
    let sum = |of: fn(&Comparison) -> usize| comparisons.iter().map(of).sum::<usize>();
    let same = match sum(|one| one.mismatched_pixels) {
        0 => "The pictures of all widths are the same, bit by bit.".into(),
        pixels => {
            let differ = counted(pixels, "PIXEL DIFFERS", "PIXELS DIFFER");
            format!("{differ} between SIMD and scalar: a bug in octray, please report it with the scene.")
        }
    };
    let right = match sum(|one| one.reference.mismatched_hits) {
        0 => "Every compared primary hit is right by the f64 reference.".into(),
        hits => counted(hits, "PRIMARY HIT IS", "PRIMARY HITS ARE") + " WRONG by the f64 reference.",
    };
    format!("\n{same}\n{right}\n")
}
