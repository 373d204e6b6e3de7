//! Maps radiance to displayed bytes: exposure, tone curve, sRGB transfer function, eight bits.

use crate::choice::choices;
use crate::film::Picture;
use crate::scene::SRGB_BORDERS;
use std::sync::LazyLock;

/// The largest exposure in stops, up or down: past f32's own range in visible light.
pub const MAX_EXPOSURE: f32 = 64.0;

/// Exposure and tone curve, which map radiance to displayed intensity.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub struct Tone {
    /// The exposure in stops: radiance is first multiplied by 2^exposure.
    pub exposure: f32,
    /// The tone curve.
    pub operator: Operator,
}

choices! {
    /// A tone curve, applied to each channel by itself.
    pub enum Operator {
        #[default]
        Clamp = "clamp", "min(x, 1): linear up to 1; highlights clip.";
        /// Source: Reinhard et al., "Photographic Tone Reproduction for Digital Images", SIGGRAPH 2002,
        /// equation 3.
        Reinhard = "reinhard", "x / (1 + x): nothing clips, everything is darker.";
        /// Source: Krzysztof Narkowicz, "ACES Filmic Tone Mapping Curve" (2016), a rational fit of the ACES
        /// curve; without its customary factor of 0.6 before it.
        Aces = "aces", "Filmic: deep shadows, soft highlights.";
    }
}

impl Operator {
    /// Returns the displayed intensity in [0, 1] for a radiance. Domain: all of f32; NaN and negative values
    /// give 0, infinity 1.
    pub fn map(self, radiance: f32) -> f32 {
        // `NaN > 0` is false. From 1e6 on every curve is 1 to within half an eight-bit step; the bound keeps
        // the polynomials finite.
        let x = if radiance > 0.0 { radiance.min(1e6) } else { 0.0 };
        let shown = match self {
            Self::Clamp => x,
            Self::Reinhard => x / (1.0 + x),
            Self::Aces => x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14),
        };
        shown.min(1.0)
    }
}

impl Tone {
    /// Writes the eight-bit sRGB values of pixels in a window's format, 0x00RRGGBB.
    pub fn words(&self, pixels: &[[f32; 3]], words: &mut [u32]) {
        let scale = self.exposure.exp2();
        for (word, pixel) in words.iter_mut().zip(pixels) {
            let [r, g, b] = pixel.map(|channel| srgb_byte(self.operator.map(channel * scale)));
            *word = u32::from_be_bytes([0, r, g, b]);
        }
    }

    /// Returns the eight-bit sRGB values of a picture: three bytes per pixel, row by row from the top.
    pub fn bytes(&self, picture: &Picture) -> Vec<u8> {
        let scale = self.exposure.exp2();
        let shown = |&channel: &f32| srgb_byte(self.operator.map(channel * scale));
        picture.pixels.as_flattened().iter().map(shown).collect()
    }
}

/// Returns the nearest of the 256 sRGB bytes for an intensity in [0, 1].
///
/// The byte is the number of [`SRGB_BORDERS`] at or below the intensity. A table by exponent and leading
/// digits holds their number for all intensities that share these; one or two comparisons remain. No power is
/// computed, which matters for a window that shows many frames a second.
pub fn srgb_byte(linear: f32) -> u8 {
    static CURVE: LazyLock<Curve> = LazyLock::new(Curve::new);
    CURVE.byte(linear)
}

struct Curve {
    /// [`SRGB_BORDERS`], rounded, and infinity at the end.
    borders: [f32; 256],
    /// The number of borders at or below the smallest float of each part.
    below: [u8; Self::PARTS],
}

impl Curve {
    /// Floats that differ only in this many lowest bits form a part.
    const SHIFT: u32 = 17;
    /// The smallest intensity of the table: 2⁻¹³. Smaller ones encode to 0.
    const LEAST: f32 = 1.0 / 8192.0;
    /// The number of parts up to 1, which is a part by itself.
    const PARTS: usize = ((1.0f32.to_bits() - Self::LEAST.to_bits()) >> Self::SHIFT) as usize + 1;

    fn new() -> Self {
        let border = |byte: usize| SRGB_BORDERS.get(byte).map_or(f32::INFINITY, |&border| border as f32);
        let borders: [f32; 256] = std::array::from_fn(border);
        let least = |part: usize| f32::from_bits(Self::LEAST.to_bits() + ((part as u32) << Self::SHIFT));
        let below =
            std::array::from_fn(|part| borders.partition_point(|&border| border <= least(part)) as u8);
        Self { borders, below }
    }
    fn byte(&self, linear: f32) -> u8 {
        if linear.is_nan() || linear < Self::LEAST {
            return 0;
        }
        let linear = linear.min(1.0);
        let part = ((linear.to_bits() - Self::LEAST.to_bits()) >> Self::SHIFT) as usize;
        let mut count = self.below[part];
        while self.borders[count as usize] <= linear {
            count += 1;
        }
        count
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns the stored value of an intensity, as IEC 61966-2-1:1999 defines it.
    fn srgb_encode(linear: f64) -> f64 {
        if linear <= 0.003_130_8 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
    }

    #[test]
    fn srgb_byte_equals_rounding_the_curve_away_from_borders() {
        for step in 0..=200_000 {
            let linear = step as f32 / 200_000.0;
            let exact = srgb_encode(f64::from(linear)) * 255.0;
            // The two pieces of the standard's curve miss each other by 3e-8, and borders are rounded to f32.
            if (exact - exact.floor() - 0.5).abs() > 1e-4 {
                assert_eq!(srgb_byte(linear), exact.round() as u8, "at {linear}");
            }
        }
    }

    #[test]
    fn srgb_byte_counts_the_borders_below_it() {
        let curve = Curve::new();
        let count = |linear: f32| curve.borders.iter().filter(|&&border| border <= linear).count() as u8;
        assert!(curve.borders[0] > Curve::LEAST && curve.borders.is_sorted());
        let near = |x: f32| [x.next_down(), x, x.next_up()];
        let parts = (0..Curve::PARTS as u32).map(|part| Curve::LEAST.to_bits() + (part << Curve::SHIFT));
        let edges = parts.map(f32::from_bits).chain(curve.borders[..255].iter().copied());
        for linear in edges.flat_map(near) {
            assert_eq!(srgb_byte(linear), count(linear.min(1.0)), "at {linear:e}");
        }
        assert_eq!([-1.0, 0.0, f32::NAN, 1e-30, 2.0, f32::INFINITY].map(srgb_byte), [0, 0, 0, 0, 255, 255]);
    }
}
