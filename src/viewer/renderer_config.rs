//! Renderer settings for a scene, from controls and options.
//!
//! For: [`RendererConfig`], [`settings`].

use super::controls::Controls;
use super::options::Options;
use octray_engine::render::{LaneChoice, Settings};
use octray_engine::traverse::Methods;
use octray_formats::scene::Loaded;

/// The settings that only a new renderer can change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RendererConfig {
    pub methods: Methods,
    pub threads: usize,
    pub lanes: usize,
}

impl RendererConfig {
    pub fn of(settings: &Settings) -> Self {
        let Settings { methods, threads, lanes, .. } = *settings;
        Self { methods, threads, lanes }
    }
    /// The configuration that the controls choose for a scene.
    pub fn wanted(scene: &Loaded, controls: &Controls, options: &Options) -> Self {
        let methods = controls.methods(scene, (options.methods)(scene));
        let lanes = if controls.scalar { LaneChoice::One } else { controls.lanes };
        Self { methods, threads: controls.threads, lanes: lanes.lanes() }
    }
}

pub fn pixels([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height)
}

/// The settings that the controls choose for a scene.
pub fn settings(scene: &Loaded, controls: &Controls, options: &Options) -> Settings {
    let RendererConfig { methods, threads, lanes } = RendererConfig::wanted(scene, controls, options);
    Settings {
        resolution: controls.resolution(options.size.unwrap_or(scene.resolution), 1.0),
        max_bounces: controls.bounces,
        seed: options.seed,
        pipeline: options.pipeline,
        clamp: options.clamp,
        methods,
        threads,
        lanes,
        ..Settings::of(scene)
    }
}
