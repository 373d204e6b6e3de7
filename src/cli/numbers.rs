//! Numbers of the command line: read from text, checked against their ranges, or refused with what to give
//! instead.
//!
//! For: one function a kind of number, and the checks that view files share.

use super::error::CliError;
use crate::lane::WIDTHS;
use crate::render::LaneChoice;
use crate::scene::{MAX_BOUNCES, MAX_SIDE};
use crate::wording::grouped;
use std::time::Duration;

/// Most samples per pixel: up to here a sum in f32 still resolves each one.
pub const MAX_SAMPLES: u32 = 1 << 24;
/// Most worker threads: beyond any machine, below what exhausts one.
pub const MAX_THREADS: u32 = 1_024;
/// Largest exposure in stops, up or down: past f32's own range in visible light.
pub const MAX_EXPOSURE: f32 = 64.0;
/// Seconds: less is less than a tile takes, more is a year.
const SECONDS: [f64; 2] = [0.001, 31_536_000.0];

/// Worker threads, if given.
pub fn threads(text: Option<&str>) -> Result<Option<usize>, CliError> {
    text.map(|text| Ok(whole("--threads", text, 1, MAX_THREADS)? as usize)).transpose()
}

/// Samples per pixel.
pub fn samples(text: &str) -> Result<u32, CliError> {
    whole("--samples", text, 1, MAX_SAMPLES)
}

/// Most scattering events on a path.
pub fn bounces(text: &str) -> Result<u32, CliError> {
    whole("--bounces", text, 0, MAX_BOUNCES)
}

/// Seed of the random numbers.
pub fn seed(text: &str) -> Result<u32, CliError> {
    whole("--seed", text, 0, u32::MAX)
}

/// Exposure in stops.
pub fn exposure(text: &str) -> Result<f32, CliError> {
    single("--exposure", text, check_exposure)
}

/// Largest radiance of a sample.
pub fn clamp(text: &str) -> Result<f32, CliError> {
    single("--clamp", text, check_clamp)
}

/// Samples per pixel, or the numbers to give instead.
pub fn check_samples(samples: u32) -> Result<u32, String> {
    check_whole(u64::from(samples), 1, MAX_SAMPLES)
}

/// Stops, or the numbers to give instead.
pub fn check_exposure(stops: f32) -> Result<f32, String> {
    match stops.abs() <= MAX_EXPOSURE {
        true => Ok(stops),
        false => Err(format!("give a number from -{MAX_EXPOSURE} to {MAX_EXPOSURE}")),
    }
}

/// A largest radiance, or the numbers to give instead.
pub fn check_clamp(most: f32) -> Result<f32, String> {
    match most > 0.0 && most.is_finite() {
        true => Ok(most),
        false => Err("give a number above 0, or leave it out for no limit".into()),
    }
}

/// A number that is rounded once, from text to single precision.
fn single(option: &'static str, text: &str, check: fn(f32) -> Result<f32, String>) -> Result<f32, CliError> {
    // NaN is in no range, so its refusal names the range.
    check(text.parse().unwrap_or(f32::NAN)).map_err(|why| refuse(option, text, why))
}

/// A time in seconds.
pub fn seconds(option: &'static str, text: &str) -> Result<Duration, CliError> {
    let [least, most] = SECONDS;
    let number = within(option, text, SECONDS, || format!("give seconds from {least} to {most}"))?;
    Ok(Duration::from_secs_f64(number))
}

/// A number in a range.
pub fn within(
    option: &'static str,
    text: &str,
    [least, most]: [f64; 2],
    why: impl Fn() -> String,
) -> Result<f64, CliError> {
    match text.parse::<f64>() {
        Ok(number) if (least..=most).contains(&number) => Ok(number),
        _ => Err(refuse(option, text, why())),
    }
}

/// Reads `WxH` or `W×H`.
pub fn size(text: &str) -> Result<[u32; 2], CliError> {
    let shape = "give width and height as WIDTHxHEIGHT, such as 240x135";
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(|| refuse("--size", text, shape))?;
    let side = |digits: &str| match read(digits) {
        Reading::Number(side) if (1..=u64::from(MAX_SIDE)).contains(&side) => Ok(side as u32),
        Reading::Number(_) | Reading::TooLarge => Err(refuse(
            "--size",
            text,
            format!("width and height may be from 1 to {} pixels", grouped(MAX_SIDE)),
        )),
        Reading::Other => Err(refuse("--size", text, shape)),
    };
    Ok([side(width)?, side(height)?])
}

/// A whole number in a range.
pub fn whole(option: &'static str, text: &str, least: u32, most: u32) -> Result<u32, CliError> {
    // Text that is no number, or too large for u64, is out of every range.
    let number = match read(text) {
        Reading::Number(number) => number,
        Reading::TooLarge | Reading::Other => u64::MAX,
    };
    check_whole(number, least, most).map_err(|why| refuse(option, text, why))
}

fn check_whole(number: u64, least: u32, most: u32) -> Result<u32, String> {
    match u32::try_from(number) {
        Ok(number) if (least..=most).contains(&number) => Ok(number),
        _ => Err(format!("give a whole number from {} to {}", grouped(least), grouped(most))),
    }
}

/// Decimal digits and nothing else, up to the largest u32.
pub fn read_whole(text: &str) -> Option<u32> {
    match read(text) {
        Reading::Number(number) => u32::try_from(number).ok(),
        Reading::TooLarge | Reading::Other => None,
    }
}

enum Reading {
    Number(u64),
    TooLarge,
    Other,
}

/// Reads decimal digits and nothing else: no sign, no spaces.
fn read(text: &str) -> Reading {
    if text.is_empty() || !text.bytes().all(|byte| byte.is_ascii_digit()) {
        return Reading::Other;
    }
    text.parse().map_or(Reading::TooLarge, Reading::Number)
}

/// A width that this build has.
pub fn lanes(choice: LaneChoice) -> Result<LaneChoice, CliError> {
    let why = "this octray was built for processors without AVX-512: give auto, 1 or 8";
    if WIDTHS.contains(&choice.lanes()) { Ok(choice) } else { Err(refuse("--lanes", choice.name(), why)) }
}

/// The error for an option's value that cannot be used, with what to give instead.
pub fn refuse(option: &'static str, value: &str, why: impl Into<String>) -> CliError {
    CliError::Value { option, value: value.to_string(), why: why.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_accepts_every_cross() {
        for text in ["240x135", "240X135", "240×135"] {
            assert_eq!(size(text).unwrap(), [240, 135], "{text}");
        }
        assert_eq!(size("1x16384").unwrap(), [1, 16_384]);
    }

    #[test]
    fn size_refuses_the_rest_with_a_remedy() {
        for text in [
            "",
            "x",
            "240",
            "240x",
            "x135",
            "240x135x1",
            "-1x1",
            "+1x1",
            " 1x1",
            "1 x 1",
            "1.5x2",
            "axb",
            "١x١",
        ] {
            let message = size(text).unwrap_err().to_string();
            assert!(message.starts_with("--size ") && message.contains("240x135"), "{text}: {message}");
        }
        for text in ["0x0", "0x1", "1x0", "16385x1", "1x16385", "1000000000x1", "99999999999999999999999x1"] {
            let message = size(text).unwrap_err().to_string();
            assert!(message.contains("from 1 to 16,384"), "{text}: {message}");
        }
    }

    #[test]
    fn whole_keeps_to_its_range() {
        assert_eq!(whole("--n", "1", 1, 9).unwrap(), 1);
        assert_eq!(whole("--n", "9", 1, 9).unwrap(), 9);
        assert_eq!(seed("4294967295").unwrap(), u32::MAX);
        for text in ["0", "10", "-1", "1.0", "1e0", "", "nan", "4294967297", "18446744073709551617"] {
            assert!(whole("--n", text, 1, 9).unwrap_err().to_string().contains("from 1 to 9"), "{text}");
        }
    }

    #[test]
    fn clamp_is_finite_and_above_zero() {
        assert_eq!(clamp("10").unwrap(), 10.0);
        for text in ["0", "-1", "nan", "inf", "", "ten"] {
            let message = clamp(text).unwrap_err().to_string();
            assert!(message.contains("--clamp") && message.contains("above 0"), "{text}: {message}");
        }
    }

    #[test]
    fn exposure_is_finite_and_bounded() {
        assert_eq!(exposure("-1.5").unwrap(), -1.5);
        for text in ["nan", "inf", "-inf", "65", "-65", "1e99", "bright", ""] {
            assert!(exposure(text).is_err(), "{text}");
        }
    }
}
