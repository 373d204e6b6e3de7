//! `--denoise` and `--aovs`: denoised pictures beside their raw films, and what is seen in each pixel.

use super::interrupt;
use crate::checkpoint::{GuideRows, Shard};
use crate::display::{Denoiser, Samples};
use crate::film::Film;
use crate::integrate::aovs::Aovs;
use crate::integrate::edge_aovs::DenoiserAovs;
use crate::output::{self, OutputError, save_unless};
use crate::render::Renderer;
use crate::scene::Scene;
use crate::tone::Tone;
use std::path::{Path, PathBuf};

/// Returns the file of the raw film: the picture's name, ending in `.raw.exr`.
pub fn raw_file(output: &Path) -> PathBuf {
    output.with_extension("raw.exr")
}

/// Computes the denoiser's AOVs at the renderer's camera.
pub fn guides(renderer: &Renderer) -> DenoiserAovs {
    let (mut first, mut guides) = (Aovs::default(), DenoiserAovs::default());
    renderer.aovs_into(&mut first);
    renderer.denoiser_aovs_into(&first, &mut guides);
    guides
}

/// Returns the rows of a shard: every `count`-th one.
pub fn rows_of_shard(guides: &DenoiserAovs, Shard { number, count }: Shard) -> GuideRows {
    let rows = (number - 1..guides.centers().resolution()[1]).step_by(count as usize);
    rows.map(|y| (y, guides.row_words(y))).collect()
}

/// Saves a film denoised, and raw. The picture's metadata say that it is denoised, and of how many samples.
pub fn save(
    output: &Path,
    raw: &Path,
    film: &Film,
    guides: &DenoiserAovs,
    tone: &Tone,
) -> Result<(), OutputError> {
    let picture = film.picture();
    save_unless(raw, &picture, (&Tone::default(), ""), &interrupt::insisted)?;
    let counts: Vec<f32> = film.counts().pixels.iter().map(|pixel| pixel[0]).collect();
    let mean = (10.0 * film.mean_samples()).round() / 10.0;
    let comment = format!("denoised by octray; mean samples of a pixel: {mean}");
    let mut denoiser = Denoiser::default();
    let denoised = denoiser.filter(&picture, Samples::Each(&counts), guides);
    save_unless(output, denoised, (tone, &comment), &interrupt::insisted)
}

/// Returns a line for the report of a denoised picture.
pub fn line(raw: &Path) -> String {
    format!("denoised; the raw film is {}\n", raw.display())
}

/// Saves the AOVs of a film's camera, and the film itself, as layers of one EXR file.
pub fn save_aovs(
    file: &Path,
    renderer: &Renderer,
    scene: &Scene,
    film: &Film,
    guides: &DenoiserAovs,
) -> Result<(), OutputError> {
    output::save_channels(file, film.resolution(), renderer.channels(scene, film, guides))
}
