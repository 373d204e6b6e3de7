//! The report of `octray render`, as a line or as JSON.

use super::numbers::figure;
use super::settings::RunSettings;
use crate::adaptive::{ErrorEstimate, MAX_BLOCK_ERROR};
use crate::measure::stats::FrameStats;
use crate::wording::grouped;
use serde::Serialize;
use std::path::PathBuf;

/// Why a rendering ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum End {
    /// Every pixel has the samples asked for.
    Samples,
    /// The estimated error is at most the target.
    TargetError,
    /// The time of `--time-limit` is over.
    TimeLimit,
    /// Ctrl-C; the picture so far is written.
    Interrupt,
}

#[derive(Debug, Serialize)]
pub struct Report {
    pub schema: &'static str,
    pub scene: String,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub frame: Option<u32>,
    /// Number of the shard, and of all shards, with `--shard`. Samples and rays are those of the shard.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shard: Option<[u32; 2]>,
    /// Path of the picture, or of the part of a shard.
    pub output: String,
    /// Path of the raw film with `--denoise`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub raw: Option<PathBuf>,
    /// Whether the picture is denoised: all of its pixels have samples.
    pub denoised: bool,
    pub width: u32,
    pub height: u32,
    /// The fewest samples of a pixel.
    pub samples: u32,
    /// The most: more than the fewest only with a target error, or where the rendering stopped in the middle
    /// of a sample.
    pub most_samples: u32,
    pub mean_samples: f64,
    /// The mean number of samples that the checkpoint had, if there was one: they are among the others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub resumed_samples: Option<f64>,
    /// Why this run took no more samples.
    pub ended_by: End,
    pub time_limit: Option<f64>,
    /// Relative standard error asked for, 0.05 for 5 %; null without one.
    pub target_error: Option<f64>,
    /// Estimate with a target error, relative like it; null values are unknown.
    pub estimated_error: Option<ErrorEstimate>,
    pub max_bounces: u32,
    pub seed: u32,
    /// The traversal of the scene's primitives: `linear` where every one is tested.
    pub traversal: &'static str,
    pub settings: RunSettings,
    /// Largest radiance of a sample in each channel, with which the picture is biased. Null without a limit.
    pub clamp: Option<f32>,
    /// Wall time of tracing of this run, without loading and writing.
    pub seconds: f64,
    /// Rays of all samples.
    pub rays: u64,
    /// Speed of this run.
    pub mrays_per_s: f64,
    /// Samples with a NaN or infinite channel, which count for nothing. 0 expected.
    pub discarded_samples: u64,
    /// `ended_by` is `interrupt`.
    pub interrupted: bool,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stats: Option<FrameStats>,
}

impl Report {
    /// Returns one line. `wanted` is the limit of samples, `begun` the share of pixels with at least one
    /// sample, `options` those that differ from the defaults.
    pub fn line(&self, wanted: u32, begun: f64, options: &str) -> String {
        let Self { output, width, height, samples, most_samples, seconds, mrays_per_s, .. } = self;
        let range = |[least, most]: [&u32; 2]| format!("{} to {}", grouped(least), grouped(most));
        let (had, mean) = match samples == most_samples {
            true => (grouped(samples), String::new()),
            false => (range([samples, most_samples]), format!(" (mean {})", figure(self.mean_samples, 0))),
        };
        let of_wanted = if self.interrupted { format!(" of {}", grouped(wanted)) } else { String::new() };
        let rate = figure(*mrays_per_s, 1);
        let plural = if had == "1" && !self.interrupted { "" } else { "s" };
        let shard = self.shard.map(|[number, of]| format!("shard {number} of {of}, ")).unwrap_or_default();
        let resumed = self.resumed_samples.map(|samples| format!(" ({} resumed)", figure(samples, 0)));
        let resumed = resumed.unwrap_or_default();
        let options = if options.is_empty() { String::new() } else { format!(", options: {options}") };
        let black = match begun < 1.0 {
            true => format!("; {:.0} % of the picture has had none and is black", 100.0 * (1.0 - begun)),
            false => String::new(),
        };
        format!(
            "{output}: {shard}{width}×{height}, {had}{of_wanted} sample{plural}{mean}{resumed}, {seconds:.2} s, {rate} Mray/s, traversal {}{options}{black}\n{}",
            self.traversal,
            self.ending()
        )
    }

    /// Returns why the rendering ended, with a target error or a time limit or by Ctrl-C, and the estimated
    /// error.
    fn ending(&self) -> String {
        if self.target_error.is_none() && self.time_limit.is_none() && !self.interrupted {
            return String::new();
        }
        let is_over = self.time_limit.is_some_and(|limit| limit < self.seconds);
        let by = match self.ended_by {
            End::Samples => "the limit of samples",
            End::TargetError => "the target error",
            End::TimeLimit if self.samples == 0 => "the time limit, too short for one pass",
            End::TimeLimit if is_over && self.samples == 1 => {
                "the time limit, too short for more than the first sample"
            }
            End::TimeLimit => "the time limit",
            End::Interrupt => "Ctrl-C or a signal",
        };
        let errors = match (&self.estimated_error, self.target_error) {
            (Some(error), Some(target)) if error.rms.is_finite() => {
                let [rms, largest] = [error.rms, error.largest].map(|error| figure(error, 1));
                let worst = MAX_BLOCK_ERROR * target;
                format!(
                    "; estimated error {rms} ({target} asked for), in the worst block {largest} ({worst})"
                )
            }
            (Some(_), _) => "; too few samples to estimate the error".to_string(),
            _ => String::new(),
        };
        format!("ended by {by}{errors}\n")
    }
}
