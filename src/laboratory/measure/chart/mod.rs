//! Speed against accuracy: cost and error of every configuration.

pub mod clock;
pub mod configurations;
pub mod display;
pub mod frames;
pub mod ground_truth;
pub mod kernels;
pub mod motion;
pub mod pareto;
pub mod pictures;

use crate::render::Settings;
use crate::scene::Scene;
use clock::Clock;
use configurations::Configuration;
use ground_truth::{GroundTruth, GroundTruthInfo, GroundTruthRenderer, SHRINK};
use serde::Serialize;
use std::time::{Duration, Instant};

/// The measurements of one scene.
#[derive(Clone, Debug, Serialize)]
pub struct SceneChart {
    /// Its name.
    pub scene: String,
    /// Pixels of `pictures`: width, height.
    pub size: [u32; 2],
    /// Pixels of everything else: [`SHRINK`] times `size`.
    pub frame_size: [u32; 2],
    /// Most scattering events of a path.
    pub max_bounces: u32,
    /// The ground truth of all but `motion`, which has its own.
    pub truth: GroundTruthInfo,
    /// Seconds of one pass of the default in `pictures`: the unit of times that charts of two machines
    /// share.
    pub default_pass_s: f64,
    /// Decides the times of `pictures`.
    pub clock: Clock,
    /// Error against time, a line a configuration; the default first.
    pub pictures: Vec<pictures::Line>,
    /// Interactive frames of a few configurations, on all threads.
    pub frames: Vec<frames::Frames>,
    /// The display filters on frames of few samples.
    pub display: Vec<display::FilterResult>,
    /// Frames of a moving camera, with and without reprojection.
    pub motion: Vec<motion::MotionResult>,
}

/// Ends of the steps as shares of a scene's time. Motion has the rest.
const GROUND_TRUTH_SHARE: f64 = 0.25;
const PICTURES_SHARE: f64 = 0.55;
const FRAMES_SHARE: f64 = 0.67;
const DISPLAY_SHARE: f64 = 0.72;
/// The configurations that `frames` compares: of those with equal bits, only the scalar one.
const IN_FRAMES: [&str; 5] =
    [configurations::DEFAULT, "scalar", "random numbers", "no next event estimation", "all lights"];

/// Size and time of one scene's chart.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Pixels of the pictures; frames have [`SHRINK`] times as many in width and in height.
    pub size: [u32; 2],
    /// Most scattering events of a path.
    pub max_bounces: u32,
    /// Seeds behind a median of `pictures`; at least [`pictures::SEEDS`].
    pub seeds: u32,
    /// Worker threads. `pictures` are timed on one thread.
    pub threads: usize,
    /// When the steps begin.
    pub start: Instant,
    /// Time for all steps, counted from `start`.
    pub time: Duration,
    /// The user's time for this scene; `time` is the part of it that remains.
    pub budget: Duration,
}

impl Plan {
    fn at(&self, share: f64) -> Instant {
        self.start + self.time.mul_f64(share)
    }

    /// Returns the default settings of a frame.
    pub(crate) fn frame(&self, scene: &Scene) -> Settings {
        let resolution = self.size.map(|side| side * SHRINK);
        Settings { resolution, max_bounces: self.max_bounces, ..Settings::of(scene) }
    }

    /// Renders the ground truth.
    pub fn ground_truth(&self, scene: &Scene) -> GroundTruth {
        let mut renderer = GroundTruthRenderer::new(scene, self.frame(scene), self.threads);
        renderer.render_until(self.at(GROUND_TRUTH_SHARE), ground_truth::MOST_SAMPLES, self.budget)
    }

    /// Charts the scene in the remaining time; `step` takes the name of each step as it begins.
    pub fn chart(&self, scene: &Scene, ground_truth: &GroundTruth, step: &dyn Fn(&str)) -> SceneChart {
        let default = Settings { resolution: self.size, ..self.frame(scene) };
        let configurations = configurations::of_scene(scene, default);
        step("pictures");
        let end = self.at(PICTURES_SHARE);
        let runs = pictures::runs(scene, &configurations, ground_truth, self.seeds, end);
        let (clock, pictures) = pictures::lines(&runs);
        step("frames");
        let in_frames: Vec<Configuration> =
            configurations.into_iter().filter(|one| IN_FRAMES.contains(&one.name)).collect();
        let frames = frames::measure(scene, &in_frames, ground_truth, self.threads, self.at(FRAMES_SHARE));
        step("display");
        let (frame, end) = (self.frame(scene), self.at(DISPLAY_SHARE));
        let display = display::measure(scene, frame, ground_truth, self.threads, end);
        step("motion");
        let motion =
            motion::measure(scene, frame, self.threads, self.at(1.0), motion::MOST_GROUND_TRUTH_SAMPLES);
        SceneChart {
            scene: scene.name.clone(),
            size: self.size,
            frame_size: self.size.map(|side| side * SHRINK),
            max_bounces: self.max_bounces,
            truth: ground_truth.info,
            default_pass_s: pictures::pass_time(&pictures[0]),
            clock,
            pictures,
            frames,
            display,
            motion,
        }
    }
}
