//! How a picture is made: options that commands share, and the settings made of them.

use super::groups::{METHODS, MethodArgs, choice, lanes, one_of};
use super::numbers::{clamp, exposure, seed, size, threads, whole};
use crate::machine;
use crate::render::Methods;
use crate::render::{LaneChoice, PipelineChoice, Settings};
use crate::report::settings::RunSettings;
use crate::scene::{Loaded, MAX_BOUNCES, Rendering};
use crate::tone::{Operator, Tone};

/// Without an option, a view has its own value; without a view, the scene.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct PictureOptions {
    /// Takes the scene's own size and bounces, as is the default here.
    #[arg(long, hide = true, conflicts_with_all = ["size", "bounces"])]
    as_scene: bool,
    /// Pixels of the picture [default: the scene's].
    #[arg(long, value_name = "WxH", value_parser = size, allow_hyphen_values = true)]
    pub size: Option<[u32; 2]>,
    /// Most scattering events [default: the scene's].
    #[arg(long, value_name = "N", value_parser = whole::<0, MAX_BOUNCES>, allow_hyphen_values = true)]
    pub bounces: Option<u32>,
    /// Seed of the random numbers [default: 0].
    #[arg(long, value_name = "N", value_parser = seed, allow_hyphen_values = true)]
    pub seed: Option<u32>,
    /// Worker threads [default: all cores].
    #[arg(long, value_name = "N", value_parser = threads, allow_hyphen_values = true)]
    pub threads: Option<usize>,
    /// Rays traced at a time, with the same picture.
    #[arg(long, value_name = "LANES", value_parser = lanes(), hide_possible_values = true, long_help = one_of::<LaneChoice>("Rays traced at a time"))]
    pub lanes: Option<LaneChoice>,
    /// Clamp samples, with bias [default: no limit].
    #[arg(long, value_name = "MOST", value_parser = clamp, allow_hyphen_values = true)]
    pub clamp: Option<f32>,
    /// Exposure of .png, .jpg and display [default: 0].
    #[arg(long, value_name = "STOPS", value_parser = exposure, allow_hyphen_values = true)]
    pub exposure: Option<f32>,
    /// Tone mapping of .png, .jpg and display.
    #[arg(long, value_name = "OPERATOR", value_parser = choice::<Operator>(), hide_possible_values = true, long_help = one_of::<Operator>("Tone mapping"))]
    pub tone: Option<Operator>,
    #[command(flatten)]
    pub methods: MethodArgs,
    /// Features of the compiled pipeline: the same picture.
    #[arg(long, value_name = "METHOD", value_parser = choice::<PipelineChoice>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<PipelineChoice>("Features of the compiled pipeline"))]
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

    /// What a report says of this scene's picture, and the options that differ from the defaults.
    pub fn run_settings(&self, scene: &Loaded) -> (RunSettings, String) {
        let (view, settings) = (of_view(scene), self.settings(scene));
        let default = Settings { threads: machine::cores(), ..Settings::of(scene) };
        let run = RunSettings::of_picture(&settings).with("exposure", self.exposure.or(view.exposure));
        let run = run.with("tone", self.tone.or(view.tone));
        let options = run.options(&RunSettings::of_picture(&default));
        (run, options)
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
