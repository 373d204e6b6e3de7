//! `--samples-map`: a picture of the number of samples of each pixel.

use super::interrupt;
use crate::film::{Film, Picture};
use crate::output::{self, Format, OutputError};
use crate::scene::srgb_to_linear;
use crate::tone::Tone;
use std::path::Path;

/// Writes the map; fails and leaves no file after a second Ctrl-C.
pub fn save(file: &Path, film: &Film) -> Result<(), OutputError> {
    let mut counts = film.counts();
    if !Format::of(file)?.is_linear() {
        shade(&mut counts, film.most_samples());
    }
    output::save_unless(file, &counts, &Tone::default(), &interrupt::insisted)
}

/// Replaces counts by shades: equal factors are equal steps to the eye, from black for 0 and 1 to white for
/// `most`.
fn shade(counts: &mut Picture, most: u32) {
    let whole = f64::from(most.max(2)).ln();
    for pixel in &mut counts.pixels {
        let shown = f64::from(pixel[0].max(1.0)).ln() / whole;
        *pixel = [srgb_to_linear(shown) as f32; 3];
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
