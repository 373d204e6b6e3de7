//! What `render` and `view` are told in the same words: how a picture is made.
//!
//! For: [`PictureArgs`] as typed, [`PictureOptions`] as accepted. May import: `asked`, `choices`, `numbers`. Must never know: where the picture goes.

use super::asked::Asked;
use super::choices::{MethodArgs, PipelineArg, ToneArg};
use super::error::CliError;
use super::numbers::{bounces, clamp, exposure, lanes, seed, size, threads};

#[derive(Debug, clap::Args)]
pub struct PictureArgs {
    /// Pixels of the picture [default: the scene's].
    #[arg(long, value_name = "WxH", allow_hyphen_values = true)]
    size: Option<String>,
    /// Scattering events allowed on a path; 0 shows only what shines [default: the scene's].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    bounces: Option<String>,
    /// Which random numbers to use: the same seed gives the same picture, bit by bit [default: 0].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    seed: Option<String>,
    /// Worker threads; they do not change the picture [default: all cores].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    threads: Option<String>,
    /// Rays traced at a time: 1 (scalar) or 8 (SIMD); they do not change the picture.
    #[arg(long, value_name = "1|8", default_value = "8", allow_hyphen_values = true)]
    lanes: String,
    /// The most radiance that a sample may bring to a channel. It takes bright specks away, and light with them: the picture is
    /// biased, darker than the truth by what is cut off [default: no limit].
    #[arg(long, value_name = "MOST", allow_hyphen_values = true)]
    clamp: Option<String>,
    /// Brighten (above 0) or darken (below 0) what a screen shows, .png and .jpg among it, by so many stops, a factor of two each [default: 0].
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true)]
    exposure: Option<String>,
    /// How a screen, .png and .jpg show what is brighter than a screen [default: clamp].
    #[arg(long, value_enum)]
    tone: Option<ToneArg>,
    #[command(flatten)]
    methods: MethodArgs,
    /// Compiled for what the scene needs, or with every feature: it does not change the picture [default: needed].
    #[arg(long, value_enum, value_name = "PIPELINE")]
    pipeline: Option<PipelineArg>,
}

/// What a picture is made of; `None` is what nothing was said of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureOptions {
    pub size: Option<[u32; 2]>,
    pub bounces: Option<u32>,
    pub threads: usize,
    pub lanes: usize,
    /// Without limits, which are not `view`'s; stronger than what a view says itself.
    pub asked: Asked,
}

impl TryFrom<PictureArgs> for PictureOptions {
    type Error = CliError;
    fn try_from(args: PictureArgs) -> Result<Self, CliError> {
        Ok(Self {
            size: args.size.as_deref().map(size).transpose()?,
            bounces: args.bounces.as_deref().map(bounces).transpose()?,
            threads: threads(args.threads)?,
            lanes: lanes(&args.lanes)?,
            asked: Asked {
                limits: None,
                seed: args.seed.as_deref().map(seed).transpose()?,
                exposure: args.exposure.as_deref().map(exposure).transpose()?,
                tone: args.tone.map(Into::into),
                clamp: args.clamp.as_deref().map(clamp).transpose()?,
                methods: args.methods.into(),
                pipeline: args.pipeline.map(Into::into),
            },
        })
    }
}
