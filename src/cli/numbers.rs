//! Value parsers of the command line's numbers. Their errors say what to give instead.

use crate::scene::MAX_SIDE;
use crate::tone::MAX_EXPOSURE;
use crate::wording::grouped;
use std::str::FromStr;
use std::time::Duration;

/// Most samples per pixel: up to here a sum in f32 still resolves each one.
pub const MAX_SAMPLES: u32 = 1 << 24;
/// Most worker threads: beyond any machine, below what exhausts one.
const MAX_THREADS: u32 = 1_024;
/// Seconds: less is less than a tile takes, more is a year.
const SECONDS: [f64; 2] = [0.001, 31_536_000.0];

/// Parses a number that `fits`; the error is `instead`.
pub fn number<T: FromStr>(
    text: &str,
    fits: impl Fn(&T) -> bool,
    instead: impl Into<String>,
) -> Result<T, String> {
    text.parse().ok().filter(fits).ok_or(instead.into())
}

/// Parses a whole number in a range.
pub fn whole<const LEAST: u32, const MOST: u32>(text: &str) -> Result<u32, String> {
    let instead = format!("give a whole number from {} to {}", grouped(LEAST), grouped(MOST));
    number(text, |number| (LEAST..=MOST).contains(number), instead)
}

/// Parses a number of worker threads.
pub fn threads(text: &str) -> Result<usize, String> {
    whole::<1, MAX_THREADS>(text).map(|threads| threads as usize)
}

/// Parses a number of samples per pixel.
pub fn samples(text: &str) -> Result<u32, String> {
    whole::<1, MAX_SAMPLES>(text)
}

/// Parses a seed of the random numbers.
pub fn seed(text: &str) -> Result<u32, String> {
    whole::<0, { u32::MAX }>(text)
}

/// Parses an exposure in stops.
pub fn exposure(text: &str) -> Result<f32, String> {
    let instead = format!("give a number from -{MAX_EXPOSURE} to {MAX_EXPOSURE}");
    number(text, |stops: &f32| stops.abs() <= MAX_EXPOSURE, instead)
}

/// Parses the largest radiance of a sample.
pub fn clamp(text: &str) -> Result<f32, String> {
    let fits = |most: &f32| *most > 0.0 && most.is_finite();
    number(text, fits, "give a number above 0, or leave it out for no limit")
}

/// Parses a time in seconds.
pub fn seconds(text: &str) -> Result<Duration, String> {
    let [least, most] = SECONDS;
    let instead = format!("give seconds from {least} to {most}");
    number(text, |seconds| (least..=most).contains(seconds), instead).map(Duration::from_secs_f64)
}

/// Parses width and height: `WxH` or `W×H`.
pub fn size(text: &str) -> Result<[u32; 2], String> {
    let instead =
        format!("give width and height from 1 to {} as WIDTHxHEIGHT, such as 240x135", grouped(MAX_SIDE));
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or(&instead)?;
    let side = |text| number(text, |side| (1..=MAX_SIDE).contains(side), &instead);
    Ok([side(width)?, side(height)?])
}
