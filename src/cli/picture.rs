//! How a picture is made: the validated options that `render` and `view` share.
//!
//! For: [`PictureOptions`].

use super::error::CliError;
use super::groups::PictureArgs;
use super::numbers::{bounces, clamp, exposure, lanes, seed, size, threads};
use super::overrides::Overrides;
use crate::render::LaneChoice;

/// `None` keeps the scene's own value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureOptions {
    pub size: Option<[u32; 2]>,
    pub bounces: Option<u32>,
    pub threads: usize,
    pub lanes: LaneChoice,
    /// Options that a view may give too; those given here override the view's. Their limits are set by
    /// `render` alone.
    pub overrides: Overrides,
}

impl TryFrom<PictureArgs> for PictureOptions {
    type Error = CliError;
    fn try_from(args: PictureArgs) -> Result<Self, CliError> {
        Ok(Self {
            size: args.size.as_deref().map(size).transpose()?,
            bounces: args.bounces.as_deref().map(bounces).transpose()?,
            threads: threads(args.threads.as_deref())?.unwrap_or_else(crate::machine::cores),
            lanes: lanes(args.lanes.unwrap_or_default())?,
            overrides: Overrides {
                limits: None,
                seed: args.seed.as_deref().map(seed).transpose()?,
                exposure: args.exposure.as_deref().map(exposure).transpose()?,
                tone: args.tone,
                clamp: args.clamp.as_deref().map(clamp).transpose()?,
                methods: args.methods.into(),
                pipeline: args.pipeline,
            },
        })
    }
}
