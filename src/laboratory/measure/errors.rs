//! Image metrics without a model of vision: RMSE and relative MSE against the ground truth. [`super::flip`]
//! models vision.
//!
//! All are over channels and not over luminance: in luminance, an excess of red cancels a lack of green, and
//! colour noise costs nothing. Sums are f64.

use crate::film::Picture;
use serde::Serialize;

/// Keeps the relative error of dark channels finite: at a channel of 0.1 it halves the error. The value of
/// Rousselle et al., "Adaptive Sampling and Reconstruction using Greedy Error Minimization", SIGGRAPH Asia
/// 2011, and usual since.
pub const EPSILON: f64 = 1e-2;

/// The share of pixels that `relmse_trimmed` excludes, rounded up to whole pixels.
pub const TRIMMED: f64 = 1e-3;

/// The errors of a picture x against the ground truth y, both in linear RGB.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Errors {
    /// Root of the mean of (x − y)². In radiance; bright regions and fireflies dominate it.
    pub rmse: f64,
    /// Mean of (x − y)² / (y² + ε), ε = [`EPSILON`]. A ratio: dark and bright regions count alike.
    pub relmse: f64,
    /// `relmse` without the worst 0.1 % of pixels: robust against a few fireflies. Pixels and not channels,
    /// as a firefly is a pixel.
    pub relmse_trimmed: f64,
}

impl Errors {
    /// Computes the errors of a picture. A value that is not finite makes the error so, except in the
    /// excluded pixels.
    ///
    /// # Panics
    /// If the pictures differ in size, or have no pixel.
    pub fn of(picture: &Picture, expected: &Picture) -> Self {
        let size = |picture: &Picture| [picture.width, picture.height];
        assert_eq!(size(picture), size(expected), "pictures of one size");
        assert!(!expected.pixels.is_empty(), "a picture has pixels");
        let mut squares = 0.0;
        let pixel = |(seen, expected): (&[f32; 3], &[f32; 3])| {
            let mut relative = 0.0;
            for (&x, &y) in seen.iter().zip(expected) {
                let (x, y) = (f64::from(x), f64::from(y));
                let square = (x - y) * (x - y);
                squares += square;
                relative += square / (y * y + EPSILON);
            }
            relative
        };
        let mut relative: Vec<f64> = picture.pixels.iter().zip(&expected.pixels).map(pixel).collect();
        let mean = |sum: f64, pixels: usize| sum / (3 * pixels.max(1)) as f64;
        let (pixels, all) = (relative.len(), relative.iter().sum());
        let kept = pixels - (pixels as f64 * TRIMMED).ceil() as usize;
        relative.sort_by(f64::total_cmp);
        Self {
            rmse: mean(squares, pixels).sqrt(),
            relmse: mean(all, pixels),
            relmse_trimmed: mean(relative[..kept].iter().sum(), kept),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Picture {
        let pixels = values.iter().map(|&value| [value; 3]).collect();
        Picture { width: values.len() as u32, height: 1, pixels }
    }

    #[test]
    fn errors_are_those_worked_out_by_hand() {
        let expected = Picture { width: 2, height: 1, pixels: vec![[1.0, 0.0, 2.0], [0.5, 0.5, 0.5]] };
        let seen = Picture { width: 2, height: 1, pixels: vec![[1.5, 0.0, 1.0], [0.5, 0.25, 0.5]] };
        let errors = Errors::of(&seen, &expected);
        assert!((errors.rmse - ((0.25 + 1.0 + 0.0625) / 6.0f64).sqrt()).abs() < 1e-12);
        let (first, second) = (0.25 / 1.01 + 1.0 / 4.01, 0.0625 / 0.26);
        assert!((errors.relmse - (first + second) / 6.0).abs() < 1e-12);
        assert!((errors.relmse_trimmed - second / 3.0).abs() < 1e-12, "the first pixel is the worst");
    }

    #[test]
    fn trimmed_error_leaves_out_the_worst_pixels_and_no_others() {
        let expected = grey(&[1.0; 2000]);
        let mut values = [1.1; 2000];
        let even = Errors::of(&grey(&values), &expected);
        assert!((even.relmse_trimmed - even.relmse).abs() < 1e-12, "all are alike");
        (values[7], values[1234]) = (1e4, f32::INFINITY);
        let two = Errors::of(&grey(&values), &expected);
        assert!((two.relmse_trimmed - even.relmse).abs() < 1e-12, "one of a thousand is left out");
        assert!(two.relmse.is_infinite() && two.rmse.is_infinite());
        values[9] = 1e4;
        assert!(Errors::of(&grey(&values), &expected).relmse_trimmed > 1e3, "the third stays");
    }
}
