//! Holds the options that the viewer starts with.

use octray_engine::render::{LaneChoice, Methods, PipelineChoice, Renderer, Settings};
use octray_engine::scene::Scene;
use octray_engine::tone::Tone;
use octray_formats::scene::Loaded;
use std::path::PathBuf;
use std::sync::Arc;

/// Measured bytes of memory per pixel without filters: film, history, AOVs, frames.
pub const BYTES_PER_PIXEL: usize = 180;

/// The options that the viewer starts with.
pub struct Options {
    /// Resolution of all scenes; each scene's own if `None`.
    pub size: Option<[u32; 2]>,
    /// Maximum number of scattering events for all scenes; each scene's own if `None`.
    pub bounces: Option<u32>,
    /// Seed of a resting camera's samples: its film has the bits of a still of this seed.
    pub seed: u32,
    /// Whether the pipeline is compiled for the scene's features or for all.
    pub pipeline: PipelineChoice,
    /// Largest radiance of a sample; infinite without a limit.
    pub clamp: f32,
    /// Worker threads at the start.
    pub threads: usize,
    /// Upper bound of the thread count that keys can choose.
    pub max_threads: usize,
    /// SIMD width at the start; a key switches between it and 1.
    pub lanes: LaneChoice,
    /// Tone mapping at the start.
    pub tone: Tone,
    /// Frames per second that a lower resolution holds; `None` keeps the full resolution.
    pub target: Option<u32>,
    /// The methods requested on the command line, which may depend on the scene.
    pub methods: Box<dyn Fn(&Loaded) -> Methods + Send + Sync>,
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
