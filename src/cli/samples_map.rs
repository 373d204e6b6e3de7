//! `--samples-map`: a picture of the number of samples of each pixel.
//!
//! For: [`check`], [`save`]. May import: `options`, `film`, `output`. Must not know: why the numbers differ.

use super::error::CliError;
use super::numbers::refuse;
use super::options::RenderOptions;
use crate::film::{Film, Picture};
use crate::output::{self, Existing, Format};
use crate::tone::{Tone, srgb_decode};
use std::path::{Path, PathBuf};

/// Checks that the map can be written; called before the rendering.
pub fn check(options: &RenderOptions) -> Result<(), CliError> {
    let Some(file) = &options.samples_map else { return Ok(()) };
    Format::of(file)?;
    if place(file) == place(&options.output) {
        let why = "it is also the output file: give another file";
        return Err(refuse("--samples-map", &file.display().to_string(), why));
    }
    Ok(output::check(file, Existing::Replace)?)
}

/// The canonical path of a file, there or not; the path itself where its folder does not exist.
fn place(path: &Path) -> PathBuf {
    let folder = path.parent().unwrap_or(Path::new("")).join(".").canonicalize();
    let of_new = |folder: PathBuf| path.file_name().map(|name| folder.join(name));
    path.canonicalize().ok().or_else(|| folder.ok().and_then(of_new)).unwrap_or_else(|| path.into())
}

/// Writes the map; fails and leaves no file once `given_up` returns true.
pub fn save(file: &Path, film: &Film, given_up: &dyn Fn() -> bool) -> Result<(), CliError> {
    let mut counts = film.counts();
    if !Format::of(file)?.is_linear() {
        shade(&mut counts, film.most_samples());
    }
    Ok(output::save_unless(file, &counts, &Tone::default(), given_up)?)
}

/// Replaces counts by shades: equal factors are equal steps to the eye, from black for 0 and 1 to white for
/// `most`.
fn shade(counts: &mut Picture, most: u32) {
    let whole = f64::from(most.max(2)).ln();
    for pixel in &mut counts.pixels {
        let shown = f64::from(pixel[0].max(1.0)).ln() / whole;
        *pixel = [srgb_decode(shown) as f32; 3];
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shade_gives_even_steps_for_even_factors() {
        let pixels = [0.0, 1.0, 4.0, 16.0, 64.0, 256.0].map(|count| [count; 3]).to_vec();
        let mut counts = Picture { width: 6, height: 1, pixels };
        shade(&mut counts, 256);
        let bytes = Tone::default().bytes(&counts);
        let shown: Vec<u8> = bytes.into_iter().step_by(3).collect();
        assert_eq!(shown, [0, 0, 64, 128, 191, 255]);
    }
}
