//! When a rendering ends: `--samples`, `--target-error`, `--time-limit`.
//!
//! For: [`Limits`], made from its raw arguments or refused. May import: `args`, `numbers`, `adaptive`. Must never know: how samples are
//! taken.

use super::args::LimitArgs;
use super::error::CliError;
use super::numbers::{MAX_SAMPLES, refuse, samples, whole};
use crate::adaptive::Target;
use std::time::Duration;

/// Samples of a pixel where nothing is said.
const SAMPLES: u32 = 64;
/// Most samples of a pixel with `--target-error`: one that needs more waits for light that hardly any path finds.
const MOST_SAMPLES: u32 = 1 << 14;
/// Samples before a block is judged: four groups in each of 256 pixels.
const LEAST_SAMPLES: u32 = 16;
/// Fewest samples that say anything of their differences.
const FEWEST_SAMPLES: u32 = crate::film::noise::GROUP;
/// Beyond these a target is a slip of the finger: it would take a hundred million samples, or none at all.
const TARGETS: [f64; 2] = [0.0001, 1.0];
/// Seconds: less is less than a tile takes, more is a year.
const SECONDS: [f64; 2] = [0.001, 31_536_000.0];

/// When to stop: at whichever comes first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Samples of a pixel.
    pub samples: u32,
    /// Its `most` are `samples`.
    pub target: Option<Target>,
    pub time: Option<Duration>,
}

impl Limits {
    /// So many samples of every pixel, however long they take.
    pub fn of_samples(samples: u32) -> Self {
        Self { samples, target: None, time: None }
    }
    /// Those that were asked for, if any were.
    pub fn asked(args: LimitArgs) -> Result<Option<Self>, CliError> {
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

/// A time, in seconds.
pub fn seconds(option: &'static str, text: &str) -> Result<Duration, CliError> {
    let [least, most] = SECONDS;
    within(option, text, SECONDS, || format!("give seconds from {least} to {most}"))
        .map(Duration::from_secs_f64)
}

fn within(
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
        Limits::asked(LimitArgs { samples, target_error, min_samples, time_limit })
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
