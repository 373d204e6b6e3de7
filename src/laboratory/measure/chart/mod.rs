//! Speed against accuracy: what every way to render costs, and what it gets wrong.
//!
//! For: [`SceneChart`], the data of `octray chart`: [`mod@kernels`], [`mod@pictures`], [`mod@frames`], [`mod@display`], [`mod@motion`], held against a
//! [`mod@truth`]. May import: what `measure` may. Must never know: files, drawings.

pub mod configurations;
pub mod display;
pub mod frames;
pub mod front;
pub mod kernels;
pub mod motion;
pub mod pictures;
pub mod truth;

use crate::render::Settings;
use crate::scene::Scene;
use configurations::Configuration;
use serde::Serialize;
use std::time::{Duration, Instant};
use truth::{Quality, SHRINK, Truth};

/// What was found on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneChart {
    pub scene: String,
    /// Pixels of `pictures`, and of all others.
    pub size: [u32; 2],
    pub frame_size: [u32; 2],
    pub truth: Quality,
    pub pictures: Vec<pictures::Line>,
    pub frames: Vec<frames::Frames>,
    pub display: Vec<display::Shown>,
    pub motion: Vec<motion::Moving>,
}

/// Shares of a scene's time: up to where the truth is rendered, up to where pictures are, and so on; motion has the rest.
const TRUTH_SHARE: f64 = 0.25;
const PICTURES_SHARE: f64 = 0.55;
const FRAMES_SHARE: f64 = 0.67;
const DISPLAY_SHARE: f64 = 0.72;
/// Enough for the truth: [`pictures::TRUTH_FACTOR`] times the samples of the best picture, at the small size; and that many times the
/// samples of a frame after half a second at a thousand a second.
const MOST_TRUTH_SAMPLES: u32 = 16_384;
/// The configurations that are worth looking at in a window; those of the same bits are one picture at another rate.
const AT_THE_WINDOW: [&str; 5] =
    [configurations::DEFAULT, "scalar", "random numbers", "lights off", "lights on"];

/// How one scene is charted.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Of the pictures; frames have [`SHRINK`] times as many pixels in width and in height.
    pub size: [u32; 2],
    pub max_bounces: u32,
    pub seeds: u32,
    /// All of the machine's; pictures are timed on one.
    pub threads: usize,
    pub start: Instant,
    pub time: Duration,
    /// What the user allowed for this scene; `time` is what other work has left of it.
    pub budget: Duration,
}

impl Plan {
    fn at(&self, share: f64) -> Instant {
        self.start + self.time.mul_f64(share)
    }

    /// The default's, for a frame.
    pub fn frame(&self, scene: &Scene) -> Settings {
        let resolution = self.size.map(|side| side * SHRINK);
        Settings { resolution, max_bounces: self.max_bounces, ..Settings::of(scene) }
    }

    /// Renders the truth.
    pub fn truth(&self, scene: &Scene) -> Truth {
        let mut making = truth::Making::new(scene, self.frame(scene), self.threads);
        making.until(self.at(TRUTH_SHARE), MOST_TRUTH_SAMPLES, self.budget)
    }

    /// Is a truth that was kept worth its place? One that a run with much less time made would limit the samples of all pictures.
    pub fn is_content_with(&self, kept: &Quality) -> bool {
        kept.samples >= MOST_TRUTH_SAMPLES || kept.budget_s >= 0.5 * self.budget.as_secs_f64()
    }

    /// Charts the scene in the time that is left of the plan's; `step` is told what begins.
    pub fn chart(&self, scene: &Scene, truth: &Truth, step: &dyn Fn(&str)) -> SceneChart {
        let default = Settings { resolution: self.size, ..self.frame(scene) };
        let configurations = configurations::of_scene(scene, default);
        step("pictures");
        let end = self.at(PICTURES_SHARE);
        let pictures = pictures::measure(scene, &configurations, truth, self.seeds, end);
        step("frames");
        let watched: Vec<Configuration> =
            configurations.into_iter().filter(|one| AT_THE_WINDOW.contains(&one.name)).collect();
        let frames = frames::measure(scene, &watched, truth, self.threads, self.at(FRAMES_SHARE));
        step("display");
        let (frame, end) = (self.frame(scene), self.at(DISPLAY_SHARE));
        let display = display::measure(scene, frame, truth, self.threads, end);
        step("motion");
        let motion = motion::measure(scene, frame, self.threads, self.at(1.0));
        SceneChart {
            scene: scene.name.clone(),
            size: self.size,
            frame_size: self.size.map(|side| side * SHRINK),
            truth: truth.quality,
            pictures,
            frames,
            display,
            motion,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn truths_of_hasty_runs_are_not_for_patient_ones() {
        let plan = |seconds| Plan {
            size: [16, 9],
            max_bounces: 4,
            seeds: 8,
            threads: 1,
            start: Instant::now(),
            time: Duration::from_secs(1),
            budget: Duration::from_secs(seconds),
        };
        let kept =
            |samples| Quality { samples, frame_rmse: 0.1, small_rmse: 0.03, budget_s: 20.0, cached: true };
        assert!(plan(20).is_content_with(&kept(100)) && plan(30).is_content_with(&kept(100)));
        assert!(!plan(50).is_content_with(&kept(100)));
        assert!(plan(5000).is_content_with(&kept(MOST_TRUTH_SAMPLES)), "there is none better");
    }
}
