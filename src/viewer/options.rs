//! Holds the options that the viewer starts with.

use octray_engine::render::{Renderer, Settings};
use octray_engine::scene::Scene;
use octray_engine::tone::Tone;
use octray_formats::scene::Loaded;
use std::path::PathBuf;
use std::sync::Arc;

/// Measured bytes of memory per pixel without filters: film, history, AOVs, frames.
pub const BYTES_PER_PIXEL: usize = 180;

/// The options that the viewer starts with.
pub struct Options {
    /// The settings requested on the command line for a scene. Keys change them, except seed, pipeline and
    /// clamp; width and threads are those of the first scene.
    pub settings: Box<dyn Fn(&Loaded) -> Settings + Send + Sync>,
    /// Upper bound of the thread count that keys can choose.
    pub max_threads: usize,
    /// Tone mapping at the start.
    pub tone: Tone,
    /// Frames per second that a lower resolution holds; `None` keeps the full resolution.
    pub target: Option<u32>,
    /// Builds the renderer of a scene with these settings, whatever methods they name.
    pub renderer: fn(&Scene, Settings) -> Renderer,
    /// Checks that memory suffices for a picture of this width and height; the error gives the reason if not.
    pub fits: Box<dyn Fn([u32; 2]) -> Result<(), String> + Send + Sync>,
    /// Ends after this many frames; `None` runs until the user quits.
    pub frames: Option<u64>,
    /// The folder for screenshots.
    pub screenshots: PathBuf,
}

/// A function that the render loop calls when a frame is ready.
pub type Wake = Arc<dyn Fn() + Send + Sync>;
