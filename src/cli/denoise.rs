//! `--denoise`: denoised pictures beside their raw films.

use super::interrupt;
use crate::checkpoint::{GuideRows, Shard};
use crate::display::{Denoiser, Samples};
use crate::film::{Film, Picture};
use crate::integrate::edge_aovs::DenoiserAovs;
use crate::output::{OutputError, save_unless};
use crate::tone::Tone;
use std::path::{Path, PathBuf};

/// Returns the file of the raw film: the picture's name, ending in `.raw.exr`.
pub fn raw_file(output: &Path) -> PathBuf {
    output.with_extension("raw.exr")
}

/// Returns the rows of the denoiser's AOVs that a shard keeps.
pub fn rows_of_shard(guides: &DenoiserAovs, shard: Shard) -> GuideRows {
    shard.rows(guides.centers().resolution()[1]).map(|y| (y, guides.row_words(y))).collect()
}

/// Saves a film as a picture, and as a `raw` one beside it; fails and leaves no file after a second Ctrl-C.
/// With `guides` the picture is denoised, and its metadata say so, and of how many samples.
pub fn save(
    output: &Path,
    raw: Option<&Path>,
    film: Film,
    guides: Option<&DenoiserAovs>,
    tone: &Tone,
) -> Result<(), OutputError> {
    let save = |file: &Path, picture: &Picture, tone: &Tone, comment: &str| {
        save_unless(file, picture, (tone, comment), &interrupt::insisted)
    };
    let picture = film.picture();
    let samples = guides.map(|_| (film.counts(), (10.0 * film.mean_samples()).round() / 10.0));
    // Frees memory for the encoder.
    drop(film);
    if let Some(raw) = raw {
        save(raw, &picture, &Tone::default(), "")?;
    }
    let Some((guides, (counts, mean))) = guides.zip(samples) else {
        return save(output, &picture, tone, "");
    };
    let counts: Vec<f32> = counts.pixels.iter().map(|pixel| pixel[0]).collect();
    let mut denoiser = Denoiser::default();
    let denoised = denoiser.filter(&picture, Samples::Each(&counts), guides);
    save(output, denoised, tone, &format!("denoised by octray; mean samples of a pixel: {mean}"))
}

/// Returns a line for the report of a denoised picture.
pub fn line(raw: &Path) -> String {
    format!("denoised; the raw film is {}\n", raw.display())
}
