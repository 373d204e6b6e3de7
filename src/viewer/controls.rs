//! Holds the settings that keys change while the viewer runs.

use super::display_mode::DisplayMode;
use super::options::Options;
use octray_engine::choice::Choice;
use octray_engine::render::{LaneChoice, Methods, Settings, SphereChoice, TraversalChoice, TriangleChoice};
use octray_engine::tone::Tone;
use octray_formats::scene::{Loaded, MAX_BOUNCES, MAX_SIDE};
use std::iter;

/// Image-space antialiasing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    #[default]
    None,
    /// The thesis's 3×3 blur.
    Blur,
    Fxaa,
}

impl Filter {
    pub const ALL: [Self; 3] = [Self::None, Self::Blur, Self::Fxaa];

    pub fn name(self) -> &'static str {
        match self {
            Self::None => "no filter",
            Self::Blur => "3×3 blur",
            Self::Fxaa => "FXAA",
        }
    }
}

/// Sets of intersection methods. A key cycles through those of the command line and these.
pub const PRESETS: [(&str, SphereChoice, TriangleChoice); 2] = [
    ("robust", SphereChoice::Robust, TriangleChoice::Woop),
    ("naive", SphereChoice::Naive, TriangleChoice::MollerTrumbore),
];

const SCALES: [i32; 2] = [-8, 6];
/// Most pixels that a key can choose: 3840×2160, about 1.5 GB.
const MAX_PIXELS: f64 = 3840.0 * 2160.0;
/// Bound of the exposure in stops, up and down.
const MAX_STOPS: f32 = 20.0;

/// The present settings.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Controls {
    /// Scattering events allowed on a path.
    pub bounces: u32,
    /// Each step makes the picture √2 times as wide and high.
    pub scale: i32,
    /// Frames per second to hold by a lower resolution.
    pub target: Option<u32>,
    pub threads: usize,
    /// All threads of the machine, or of the command line if more.
    pub max_threads: usize,
    /// The width of packets.
    pub lanes: usize,
    /// Renders with one lane instead.
    pub scalar: bool,
    /// One of [`PRESETS`]; the methods requested on the command line if `None`.
    pub preset: Option<usize>,
    /// The traversal; the command line's if `None`.
    pub traversal: Option<TraversalChoice>,
    pub tone: Tone,
    pub mode: DisplayMode,
    pub reprojection: bool,
    pub filter: Filter,
    pub denoiser: bool,
    pub minimap: bool,
    pub overlay: bool,
    pub help: bool,
}

impl Controls {
    /// Returns the controls at the start, for the settings requested on the command line.
    pub fn new(&Settings { max_bounces, threads, lanes, .. }: &Settings, tone: Tone) -> Self {
        let scalar = lanes == 1;
        Self {
            bounces: max_bounces,
            threads,
            max_threads: threads,
            lanes: if scalar { LaneChoice::Auto.lanes() } else { lanes },
            scalar,
            tone,
            reprojection: true,
            overlay: true,
            ..Self::default()
        }
    }

    pub fn add_bounces(&mut self, count: i32) {
        self.bounces = self.bounces.saturating_add_signed(count).min(MAX_BOUNCES);
    }
    pub fn add_scale(&mut self, steps: i32) {
        self.scale = (self.scale + steps).clamp(SCALES[0], SCALES[1]);
    }
    /// Changes the exposure within its bounds, or up to the command line's if that lies beyond them.
    pub fn add_exposure(&mut self, stops: f32) {
        let exposure = &mut self.tone.exposure;
        *exposure = (*exposure + stops).clamp(exposure.min(-MAX_STOPS), exposure.max(MAX_STOPS));
    }
    pub fn next_threads(&mut self) {
        let all = self.threads >= self.max_threads;
        self.threads = if all { 1 } else { (2 * self.threads).min(self.max_threads) };
    }
    pub fn next_traversal(&mut self) {
        let others = TraversalChoice::all().iter().filter(|&&choice| choice != TraversalChoice::Auto);
        let all: Vec<_> = iter::once(None).chain(others.copied().map(Some)).collect();
        cycle(&mut self.traversal, &all);
    }

    /// Returns the requested resolution, scaled by [`Self::scale`] and by `factor`, within bounds.
    pub fn resolution(&self, requested: [u32; 2], factor: f64) -> [u32; 2] {
        let [width, height] = requested.map(f64::from);
        let factor = (f64::from(self.scale) / 2.0).exp2() * factor;
        let least = (8.0 / width).max(8.0 / height).min(1.0);
        let most = (f64::from(MAX_SIDE) / width.max(height)).min((MAX_PIXELS / (width * height)).sqrt());
        let factor = factor.clamp(least, most.max(1.0));
        [width, height].map(|side| (side * factor).round().max(1.0) as u32)
    }

    /// Returns the methods for a scene, given those requested on the command line.
    fn methods(&self, requested: Methods) -> Methods {
        let methods = self.preset.map_or(requested, |preset| {
            let (_, sphere, triangle) = PRESETS[preset];
            Methods { sphere, triangle, ..Methods::default() }
        });
        let Methods { lights, sampler, .. } = requested;
        Methods { traversal: self.traversal.unwrap_or(requested.traversal), lights, sampler, ..methods }
    }

    /// Returns the renderer's settings for a scene.
    pub fn settings(&self, scene: &Loaded, options: &Options) -> Settings {
        let requested = (options.settings)(scene);
        Settings {
            resolution: self.resolution(requested.resolution, 1.0),
            max_bounces: self.bounces,
            methods: self.methods(requested.methods),
            lanes: if self.scalar { 1 } else { self.lanes },
            threads: self.threads,
            ..requested
        }
    }
}

/// Sets a value to the one after it in a cycle.
pub fn cycle<T: Copy + PartialEq>(value: &mut T, all: &[T]) {
    let next = all.iter().position(|one| one == value).map_or(0, |place| place + 1);
    *value = all[next % all.len()];
}

#[cfg(test)]
mod tests {
    use super::*;
    use octray_engine::lights::LightChoice;
    use octray_engine::sampling::Sampler;

    #[test]
    fn bounds_hold() {
        let mut controls = Controls { bounces: 4, ..Controls::default() };
        let exposed = |controls: &mut Controls, exposure, stops| {
            controls.tone.exposure = exposure;
            controls.add_exposure(stops);
            controls.tone.exposure
        };
        assert_eq!([19.75, 30.0].map(|from| exposed(&mut controls, from, 0.5)), [MAX_STOPS, 30.0]);
        assert_eq!([-19.75, 30.0].map(|from| exposed(&mut controls, from, -0.5)), [-MAX_STOPS, 29.5]);
        (0..9).for_each(|_| controls.add_bounces(-1));
        assert_eq!(controls.bounces, 0);
        (0..99).for_each(|_| controls.add_scale(-1));
        assert_eq!(controls.resolution([240, 135], 1.0), [15, 8]);
        assert_eq!(controls.resolution([240, 135], 1e-9), [14, 8], "a few pixels are left");
        assert_eq!(controls.resolution([3, 2], 1.0), [3, 2], "nothing is made larger by being coarse");
        (0..99).for_each(|_| controls.add_scale(1));
        assert_eq!(controls.resolution([240, 135], 1.0), [1920, 1080]);
        assert_eq!(controls.resolution([1920, 1080], 1.0), [3840, 2160]);
        assert_eq!(controls.resolution([5000, 4000], 1.0), [5000, 4000], "a scene's own resolution is kept");
        assert_eq!(controls.resolution([MAX_SIDE, 100], 1.0), [MAX_SIDE, 100]);
    }

    #[test]
    fn presets_keep_traversal_lights_and_sampler() {
        let (traversal, lights, sampler) = (TraversalChoice::Linear, LightChoice::Off, Sampler::Random);
        let requested = Methods { traversal, lights, sampler, ..Methods::default() };
        let mut controls = Controls::default();
        for preset in [None, Some(0), Some(1)] {
            controls.preset = preset;
            let chosen = controls.methods(requested);
            let kept = (chosen.traversal, chosen.lights, chosen.sampler);
            assert_eq!(kept, (traversal, lights, sampler), "{preset:?}");
        }
        assert_eq!(controls.methods(requested).sphere, SphereChoice::Naive);
        controls.next_traversal();
        controls.next_traversal();
        let chosen = TraversalChoice::all()[2];
        assert_eq!(controls.methods(requested).traversal, chosen);
    }
}
