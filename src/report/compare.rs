//! What `octray compare` reports, as a table or as JSON.

use super::Checked;
use super::numbers::ratio;
use super::settings::{RunSettings, traversals};
use super::text;
use crate::lane::FUSED;
use crate::measure::compare::Comparison;
use crate::wording::{counted, grouped};
use serde::Serialize;

/// The JSON report.
#[derive(Debug, Serialize)]
pub struct Report {
    /// Name and version of the report's form.
    pub schema: &'static str,
    /// How the pictures were made.
    pub settings: RunSettings,
    /// Whether nothing tells of a busy machine or of a debug build.
    pub reliable: bool,
    /// One a scene.
    pub results: Vec<Comparison>,
    /// Whether a comparison failed, by the methods of its scene.
    #[serde(skip)]
    pub failed: bool,
}

impl Checked for Report {
    fn has_failed(&self) -> bool {
        self.failed
    }
}

/// The JSON report of `--hash`.
#[derive(Debug, Serialize)]
pub struct HashReport {
    /// Name and version of the report's form.
    pub schema: &'static str,
    /// Whether this build has fused multiply-add.
    pub fused: bool,
    /// One a scene.
    pub results: Vec<FilmHash>,
}

impl Default for HashReport {
    fn default() -> Self {
        Self { schema: "octray-hash-1", fused: FUSED, results: Vec::new() }
    }
}

/// The hash of a scene's film: see [`crate::film::Picture::hash`].
#[derive(Debug, Serialize)]
pub struct FilmHash {
    /// Its name.
    pub scene: String,
    /// 16 hexadecimal digits.
    pub hash: String,
}

/// A scene's hash and which builds have the same.
pub fn hash_row(FilmHash { scene, hash }: &FilmHash) -> String {
    format!("{hash}  {}  {scene}\n", if FUSED { "fused" } else { "plain" })
}

/// The widths of the table's columns.
const WIDTHS: [isize; 8] = [-24, 11, 11, 11, 23, 12, 12, 12];

/// What stands above the rows of scenes.
pub fn heading(report: &Report, defaults: &RunSettings) -> String {
    let names = text::row(
        &WIDTHS,
        ["scene", "pixels", "samples", "differing", "speed-up", "rmse/f64", "max/f64", "wrong hits"],
    );
    report.settings.line(defaults) + &names
}

/// A scene's row, and below it what is odd about the scene.
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

/// The warning of a busy machine.
pub fn doubt(results: &[Comparison]) -> Option<String> {
    text::busy(results.iter().filter_map(|result| Some((result.speedup?.reliability, result.scene.clone()))))
}

/// The table in words.
pub fn meaning(report: &Report) -> String {
    let differ = report.results.iter().any(|result| result.mismatched_pixels > 0);
    let wrong: usize = report.results.iter().map(|result| result.reference.mismatched_hits).sum();
    let right = match wrong {
        0 => "Every compared primary hit is right".to_string(),
        _ => counted(wrong, "primary hit is", "primary hits are") + " WRONG by the f64 reference",
    };
    let same = match differ {
        false => "Pictures of 1, 8 and 16 lanes are the same, bit by bit",
        true => "SIMD and scalar DIFFER: a bug in octray, please report it with the scene",
    };
    let scenes = report.results.iter().map(|result| (result.scene.as_str(), result.traversal));
    let doubt = text::if_doubtful(report.reliable, "speed-ups");
    format!("\n{}{same}.\n{right}.{doubt}\n", traversals(scenes))
}
