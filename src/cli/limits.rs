//! When a rendering ends: `--samples`, `--target-error`, `--time-limit`.

use super::error::{CliError, refuse};
use super::numbers::{MAX_SAMPLES, number, samples, seconds, whole};
use crate::adaptive::Target;
use crate::wording::grouped;
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

const LIMITS: &str = "When to stop, at the first limit reached";
const SAMPLES_HELP: &str = "Samples per pixel (or --spp) [default: 64; with --target-error at most \
     16384; with --time-limit as many as fit]";
const TARGET_HELP: &str = "Stop at this relative standard error, such as 0.05 (in blocks, twice)";

/// When a rendering ends: at the limit that is reached first.
#[derive(Clone, Copy, Debug, Default, clap::Args)]
pub struct LimitOptions {
    /// Samples per pixel [default: 64].
    #[arg(long, help_heading = LIMITS, alias = "spp", value_name = "N", value_parser = samples, allow_hyphen_values = true, long_help = SAMPLES_HELP)]
    pub samples: Option<u32>,
    /// Stop at this relative standard error, such as 0.05.
    #[arg(long, help_heading = LIMITS, value_name = "E", value_parser = target_error, allow_hyphen_values = true, long_help = TARGET_HELP)]
    pub target_error: Option<f64>,
    /// With --target-error: samples before the first estimate [default: 16].
    #[arg(long, help_heading = LIMITS, value_name = "N", value_parser = whole::<FEWEST_SAMPLES, MAX_SAMPLES>, allow_hyphen_values = true, requires = "target_error", hide_short_help = true)]
    pub min_samples: Option<u32>,
    /// Stop after so many seconds, between passes.
    #[arg(long, help_heading = LIMITS, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true)]
    pub time_limit: Option<Duration>,
}

/// Targets outside the range are typing errors: they would take a hundred million samples, or none at all.
fn target_error(text: &str) -> Result<f64, String> {
    let [least, most] = [0.0001, 1.0];
    let instead = format!("give a number from {least} to {most}, such as 0.05 for five per cent");
    number(text, |error| (least..=most).contains(error), instead)
}

/// When to stop: at the limit that is reached first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Samples per pixel.
    pub samples: u32,
    /// Its `most` are `samples`.
    pub target: Option<Target>,
    pub time: Option<Duration>,
}

impl LimitOptions {
    /// Returns the limits. `of_view` are a view's samples, which any of these options overrides.
    pub fn limits(&self, of_view: Option<u32>) -> Result<Limits, CliError> {
        let samples = match (self.samples, self.target_error, self.time_limit) {
            (Some(samples), ..) => samples,
            (None, _, Some(_)) => MAX_SAMPLES,
            (None, Some(_), None) => MOST_SAMPLES,
            (None, None, None) => of_view.unwrap_or(SAMPLES),
        };
        let least = self.min_samples.unwrap_or(LEAST_SAMPLES.min(samples));
        let most = samples.max(FEWEST_SAMPLES);
        if least > most {
            let instead = format!("give a whole number from {FEWEST_SAMPLES} to {}", grouped(most));
            return Err(refuse("--min-samples", grouped(least), instead));
        }
        let target = self.target_error.map(|error| Target { error, least, most: samples });
        Ok(Limits { samples, target, time: self.time_limit })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_have_their_documented_defaults() {
        let second = Some(Duration::from_secs(1));
        let of = |samples, target_error, min_samples, time_limit| {
            LimitOptions { samples, target_error, min_samples, time_limit }.limits(None).unwrap()
        };
        let limits = |samples, target: Option<(f64, u32)>, time| {
            let target = target.map(|(error, least)| Target { error, least, most: samples });
            Limits { samples, target, time }
        };
        assert_eq!(of(None, None, None, None), limits(64, None, None));
        assert_eq!(of(None, Some(0.05), None, None), limits(16_384, Some((0.05, 16)), None));
        assert_eq!(of(None, None, None, second), limits(MAX_SAMPLES, None, second));
        assert_eq!(of(None, Some(1.0), None, second), limits(MAX_SAMPLES, Some((1.0, 16)), second));
        assert_eq!(of(Some(8), Some(0.001), None, second), limits(8, Some((0.001, 8)), second));
        assert_eq!(of(Some(99), Some(0.1), Some(99), None), limits(99, Some((0.1, 99)), None));
        assert_eq!(LimitOptions::default().limits(Some(37)).unwrap(), limits(37, None, None));
    }
}
