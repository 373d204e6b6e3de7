//! How a picture is made: options that commands share, and the settings made of them.
//!
//! For: [`PictureOptions`] of `render` and `view`, [`FrameOptions`] of `bench` and `compare`.

use super::groups::{MethodArgs, choice, lanes};
use super::numbers::{clamp, exposure, seed, size, threads, whole};
use crate::machine;
use crate::render::{LaneChoice, PipelineChoice, Settings};
use crate::scene::{Loaded, MAX_BOUNCES, Rendering, Scene};
use crate::tone::{Operator, Tone};
use crate::traverse::Methods;

/// Without an option, a view has its own value; without a view, the scene.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct PictureOptions {
    /// Pixels of the picture [default: the scene's].
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    /// Most scattering events on a path; 0 shows only emission [default: the scene's].
    #[arg(long, value_name = "N", value_parser = whole::<0, MAX_BOUNCES>, allow_hyphen_values = true)]
    pub bounces: Option<u32>,
    /// Seed of the random numbers: the same seed gives the same picture, bit by bit [default: 0].
    #[arg(long, value_name = "N", value_parser = seed, allow_hyphen_values = true)]
    pub seed: Option<u32>,
    /// Worker threads; they do not change the picture [default: all cores].
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Rays traced at a time; they do not change the picture [default: auto].
    #[arg(long, value_name = "LANES", value_parser = lanes())]
    pub lanes: Option<LaneChoice>,
    /// Largest radiance of a sample in each channel. It removes fireflies and their light: the picture is
    /// biased, darker by the light that is cut off [default: no limit].
    #[arg(long, value_name = "MOST", value_parser = clamp, allow_hyphen_values = true)]
    pub clamp: Option<f32>,
    /// Brighten (above 0) or darken (below 0) the displayed picture, .png and .jpg included, by so many stops
    /// of a factor of two [default: 0].
    #[arg(long, value_name = "STOPS", value_parser = exposure, allow_hyphen_values = true)]
    pub exposure: Option<f32>,
    /// Tone mapping of the displayed picture, .png and .jpg included [default: clamp].
    #[arg(long, value_name = "OPERATOR", value_parser = choice::<Operator>())]
    pub tone: Option<Operator>,
    #[command(flatten)]
    pub methods: MethodArgs,
    /// Features that the pipeline is compiled for; it does not change the picture [default: needed].
    #[arg(long, value_name = "PIPELINE", value_parser = choice::<PipelineChoice>())]
    pub pipeline: Option<PipelineChoice>,
}

impl PictureOptions {
    /// The settings of this scene's picture.
    pub fn settings(&self, scene: &Loaded) -> Settings {
        let (view, default) = (of_view(scene), Settings::of(scene));
        Settings {
            resolution: self.size.unwrap_or(scene.resolution),
            max_bounces: self.bounces.unwrap_or(scene.max_bounces),
            seed: self.seed.or(view.seed).unwrap_or(default.seed),
            methods: self.methods(scene),
            lanes: self.lanes.unwrap_or_default().lanes(),
            threads: self.threads.unwrap_or_else(machine::cores),
            pipeline: self.pipeline.or(view.pipeline).unwrap_or(default.pipeline),
            clamp: self.clamp.or(view.clamp).unwrap_or(default.clamp),
            ..default
        }
    }

    /// The methods of this scene's picture.
    pub fn methods(&self, scene: &Loaded) -> Methods {
        let Rendering { sphere, triangle, traversal, lights, sampler, .. } = of_view(scene);
        self.methods.or(MethodArgs { sphere, triangle, traversal, lights, sampler }).methods()
    }

    /// The tone mapping of the displayed picture.
    pub fn tone(&self, scene: &Loaded) -> Tone {
        let view = of_view(scene);
        Tone {
            exposure: self.exposure.or(view.exposure).unwrap_or(0.0),
            operator: self.tone.or(view.tone).unwrap_or_default(),
        }
    }
}

/// The options in the view that the scene was loaded through, if it was loaded through one.
pub fn of_view(scene: &Loaded) -> Rendering {
    scene.view.as_ref().map(|view| view.render).unwrap_or_default()
}

/// How the measured frames of scenes are made.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct FrameOptions {
    /// Pixels of a frame.
    #[arg(long, value_name = "WxH", default_value = "240x135", value_parser = size, allow_hyphen_values = true)]
    pub size: [u32; 2],
    /// Most scattering events on a path.
    #[arg(long, value_name = "N", default_value = "4", value_parser = whole::<0, MAX_BOUNCES>, allow_hyphen_values = true)]
    pub bounces: u32,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value = "0", value_parser = seed, allow_hyphen_values = true)]
    pub seed: u32,
    #[command(flatten)]
    pub methods: MethodArgs,
    /// Features that the pipeline is compiled for: the pictures are the same, the speed is not.
    #[arg(long, value_name = "PIPELINE", default_value = PipelineChoice::default().name(), value_parser = choice::<PipelineChoice>())]
    pub pipeline: PipelineChoice,
}

impl FrameOptions {
    /// The settings of this scene's frames, on one thread.
    pub fn settings(&self, scene: &Scene) -> Settings {
        Settings {
            resolution: self.size,
            max_bounces: self.bounces,
            seed: self.seed,
            methods: self.methods.methods(),
            pipeline: self.pipeline,
            ..Settings::of(scene)
        }
    }
}
