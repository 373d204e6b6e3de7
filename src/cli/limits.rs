//! When a rendering ends: `--samples`, `--target-error`, `--time-limit`.
//!
//! For: [`Limits`], made from raw arguments or refused.

use super::error::CliError;
use super::groups::LimitArgs;
use super::numbers::{MAX_SAMPLES, samples, seconds, whole, within};
use crate::adaptive::Target;
use std::time::Duration;

/// Samples per pixel without limits.
const SAMPLES: u32 = 64;
/// Most samples per pixel with `--target-error`: a pixel that needs more depends on light that hardly any
/// path finds.
const MOST_SAMPLES: u32 = 1 << 14;
/// Samples before the first estimate of a block's error: four groups in each of 256 pixels.
const LEAST_SAMPLES: u32 = 16;
/// Fewest samples from which a variance can be estimated.
const FEWEST_SAMPLES: u32 = crate::film::noise::GROUP;
/// Targets outside this range are typing errors: they would take a hundred million samples, or none at all.
const TARGETS: [f64; 2] = [0.0001, 1.0];

/// When to stop: at the limit that is reached first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Samples per pixel.
    pub samples: u32,
    /// Its `most` are `samples`.
    pub target: Option<Target>,
    pub time: Option<Duration>,
}

impl Limits {
    /// A number of samples per pixel, without other limits.
    pub fn of_samples(samples: u32) -> Self {
        Self { samples, target: None, time: None }
    }
    /// Those given, if any.
    pub fn of_args(args: LimitArgs) -> Result<Option<Self>, CliError> {
        if args.samples.is_none() && args.target_error.is_none() && args.time_limit.is_none() {
            return Ok(None);
        }
        let error = args.target_error.as_deref().map(target).transpose()?;
        let time = args.time_limit.as_deref().map(|text| seconds("--time-limit", text)).transpose()?;
        let samples = match (&args.samples, time) {
            (Some(text), _) => samples(text)?,
            (None, Some(_)) => MAX_SAMPLES,
            (None, None) => MOST_SAMPLES,
        };
        let least = match &args.min_samples {
            Some(text) => whole("--min-samples", text, FEWEST_SAMPLES, samples.max(FEWEST_SAMPLES))?,
            None => LEAST_SAMPLES.min(samples),
        };
        let target = error.map(|error| Target { error, least, most: samples });
        Ok(Some(Self { samples, target, time }))
    }
}

impl Default for Limits {
    fn default() -> Self {
        Self::of_samples(SAMPLES)
    }
}

fn target(text: &str) -> Result<f64, CliError> {
    let [least, most] = TARGETS;
    within("--target-error", text, TARGETS, || {
        format!("give a number from {least} to {most}, such as 0.05 for five per cent")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn limits(
        samples: Option<&str>,
        target_error: Option<&str>,
        min_samples: Option<&str>,
        time_limit: Option<&str>,
    ) -> Result<Limits, CliError> {
        let [samples, target_error, min_samples, time_limit] =
            [samples, target_error, min_samples, time_limit].map(|text| text.map(String::from));
        Limits::of_args(LimitArgs { samples, target_error, min_samples, time_limit })
            .map(Option::unwrap_or_default)
    }

    #[test]
    fn limits_have_their_documented_defaults() {
        let of = |samples, target, least, time| limits(samples, target, least, time).unwrap();
        let target = |error, least, most| Some(Target { error, least, most });
        let second = Some(Duration::from_secs(1));
        let plain = Limits { samples: 64, target: None, time: None };
        assert_eq!(of(None, None, None, None), plain);
        let to_target = Limits { samples: 16_384, target: target(0.05, 16, 16_384), time: None };
        assert_eq!(of(None, Some("0.05"), None, None), to_target);
        assert_eq!(
            of(None, None, None, Some("1")),
            Limits { samples: MAX_SAMPLES, target: None, time: second }
        );
        assert_eq!(of(None, Some("1"), None, Some("1")).target, target(1.0, 16, MAX_SAMPLES));
        assert_eq!(of(Some("8"), Some("1e-3"), None, Some("1")).target, target(0.001, 8, 8));
        assert_eq!(of(Some("99"), Some("0.1"), Some("99"), None).target, target(0.1, 99, 99));
        assert_eq!(of(Some("8"), None, None, Some("0.5")).samples, 8);
    }

    #[test]
    fn limits_refuse_the_rest_with_a_remedy() {
        for text in ["0", "-0.1", "nan", "inf", "-inf", "", "five", "5%", "2", "1e-9", "0,05"] {
            let message = limits(None, Some(text), None, None).unwrap_err().to_string();
            assert!(message.contains("--target-error") && message.contains("0.05"), "{text}: {message}");
        }
        for text in ["0", "-1", "nan", "inf", "", "ten", "1e9", "1e999", "10s"] {
            let message = limits(None, None, None, Some(text)).unwrap_err().to_string();
            assert!(message.contains("--time-limit") && message.contains("seconds"), "{text}: {message}");
        }
        for text in ["0", "3", "65", "-1", "x"] {
            let message = limits(Some("64"), Some("0.1"), Some(text), None).unwrap_err().to_string();
            assert!(
                message.contains("--min-samples") && message.contains("from 4 to 64"),
                "{text}: {message}"
            );
        }
    }
}
