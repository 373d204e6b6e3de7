//! A viewer without a window: the test is its front end.

use octray::render::{LaneChoice, PipelineChoice};
use octray::tone::Tone;
use octray::traverse::Methods;
use octray::viewer::Options;
use std::path::Path;

/// What `octray view` starts with where nothing is said, with frames as large as these.
pub fn options(size: [u32; 2], threads: usize, screenshots: &Path) -> Options {
    Options {
        size: Some(size),
        bounces: None,
        seed: 0,
        pipeline: PipelineChoice::default(),
        clamp: f32::INFINITY,
        threads,
        max_threads: threads,
        lanes: LaneChoice::Eight,
        tone: Tone::default(),
        target: None,
        methods: Box::new(|_| Methods::default()),
        fits: Box::new(|_| Ok(())),
        frames: None,
        screenshots: screenshots.into(),
    }
}
