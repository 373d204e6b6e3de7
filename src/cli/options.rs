//! Options that commands share, and the settings made of them.

use super::error::{CliError, refuse};
use super::numbers::{clamp, exposure, seed, size, threads, whole};
use super::{memory, scenes};
use crate::choice::Choice;
use crate::lane::WIDTHS;
use crate::lights::LightChoice;
use crate::machine;
use crate::render::{
    LaneChoice, Methods, PipelineChoice, Settings, SphereChoice, TraversalChoice, TriangleChoice,
};
use crate::report::settings::RunSettings;
use crate::sampling::Sampler;
use crate::scene::{Loaded, MAX_BOUNCES, Rendering, Scene};
use crate::tone::{Operator, Tone};
use clap::builder::{PossibleValuesParser, TypedValueParser};
use std::ffi::OsStr;
use std::fs;
use std::path::Path;

/// Reads the earlier report that `--baseline` names.
pub fn baseline<T>(file: &Path, read: impl Fn(&str) -> Result<T, String>) -> Result<T, CliError> {
    let text = fs::read_to_string(file).map_err(|error| format!("it cannot be read ({error})"));
    text.and_then(|text| read(&text)).map_err(|why| refuse("--baseline", file.display(), why))
}

/// The help of an argument that is a scene.
pub const SCENE: &str = "A scene (.json), a model (.obj, .gltf, .glb, .ply), or builtin:NAME";

/// The heading of options that choose a method.
pub const METHODS: &str = "Methods, explained by `octray methods`";

/// Reads the name of a choice; errors list all names.
pub fn choice<C: Choice>() -> impl TypedValueParser<Value = C> {
    PossibleValuesParser::new(C::NAMES)
        .map(|name| C::from_name(&name).expect("the parser accepts the names of choices alone"))
}

/// Returns the long help of a choice: what is chosen, all names, and the default.
pub fn one_of<C: Choice + Default>(what: &str) -> String {
    format!("{what}: {} [default: {}]", C::NAMES.join(", "), C::default().name())
}

/// Reads a width that this build has.
pub fn lanes() -> impl TypedValueParser<Value = LaneChoice> {
    let instead = "this octray was built for processors without AVX-512: give auto, 1 or 8";
    let is_built = |choice: LaneChoice| WIDTHS.contains(&choice.lanes());
    choice::<LaneChoice>().try_map(move |choice| is_built(choice).then_some(choice).ok_or(instead))
}

/// The methods of a rendering.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::Args)]
pub struct MethodArgs {
    /// Ray-sphere intersection.
    #[arg(long, value_name = "METHOD", value_parser = choice::<SphereChoice>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<SphereChoice>("Ray-sphere intersection"))]
    pub sphere: Option<SphereChoice>,
    /// Ray-triangle intersection.
    #[arg(long, value_name = "METHOD", value_parser = choice::<TriangleChoice>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<TriangleChoice>("Ray-triangle intersection"))]
    pub triangle: Option<TriangleChoice>,
    /// How rays find primitives, with the same picture.
    #[arg(long, value_name = "METHOD", value_parser = choice::<TraversalChoice>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<TraversalChoice>("How rays find primitives"))]
    pub traversal: Option<TraversalChoice>,
    /// Next event estimation: other noise, the same mean.
    #[arg(long, value_name = "METHOD", value_parser = choice::<LightChoice>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<LightChoice>("Lights of next event estimation"))]
    pub lights: Option<LightChoice>,
    /// Source of random numbers: other noise, the same mean.
    #[arg(long, value_name = "METHOD", value_parser = choice::<Sampler>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<Sampler>("Source of random numbers"))]
    pub sampler: Option<Sampler>,
    /// Features of the compiled pipeline: the same picture.
    #[arg(long, value_name = "METHOD", value_parser = choice::<PipelineChoice>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<PipelineChoice>("Features of the compiled pipeline"))]
    pub pipeline: Option<PipelineChoice>,
}

impl MethodArgs {
    /// Returns the methods and the pipeline of these options, else those of the view, else the defaults.
    fn chosen(self, view: Rendering) -> (Methods, PipelineChoice) {
        let methods = Methods {
            sphere: self.sphere.or(view.sphere).unwrap_or_default(),
            triangle: self.triangle.or(view.triangle).unwrap_or_default(),
            traversal: self.traversal.or(view.traversal).unwrap_or_default(),
            lights: self.lights.or(view.lights).unwrap_or_default(),
            sampler: self.sampler.or(view.sampler).unwrap_or_default(),
        };
        (methods, self.pipeline.or(view.pipeline).unwrap_or_default())
    }
}

/// How the measured frames of scenes are made.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct FrameOptions {
    /// Take each scene's own size and bounces.
    #[arg(long, conflicts_with_all = ["size", "bounces"])]
    pub as_scene: bool,
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
    methods: MethodArgs,
}

impl FrameOptions {
    /// Returns the settings of this scene's frames, on one thread.
    fn settings(&self, scene: &Scene) -> Settings {
        let (methods, pipeline) = self.methods.chosen(Rendering::default());
        let own = Settings { seed: self.seed, methods, pipeline, ..Settings::of(scene) };
        match self.as_scene {
            true => own,
            false => Settings { resolution: self.size, max_bounces: self.bounces, ..own },
        }
    }

    /// Returns the settings that a report shows.
    pub fn run_settings(&self) -> RunSettings {
        let (methods, pipeline) = self.methods.chosen(Rendering::default());
        let run = RunSettings { seed: self.seed, pipeline, ..RunSettings::of(methods) };
        run.sized(self.size, self.bounces, self.as_scene)
    }

    /// Refuses frames that do not fit into memory.
    pub fn check(&self, bytes_per_pixel: usize) -> Result<(), CliError> {
        if self.as_scene { Ok(()) } else { memory::check(self.size, bytes_per_pixel) }
    }

    /// Loads a scene for the reference, prints its warnings, and checks the memory of its own size.
    pub fn load(&self, name: &OsStr, bytes_per_pixel: usize) -> Result<(Loaded, Settings), CliError> {
        let scene = scenes::load_with_warnings(name, true)?;
        let settings = self.checked(&scene, bytes_per_pixel)?;
        Ok((scene, settings))
    }

    /// Returns the settings of this scene's frames, checked as by [`FrameOptions::load`].
    pub fn checked(&self, scene: &Scene, bytes_per_pixel: usize) -> Result<Settings, CliError> {
        let settings = self.settings(scene);
        if self.as_scene {
            memory::check(settings.resolution, bytes_per_pixel)?;
        }
        Ok(settings)
    }
}

/// Options of a picture. The default of each is the view's value, or else the scene's.
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
}

impl PictureOptions {
    /// Returns the settings of this scene's picture.
    pub fn settings(&self, scene: &Loaded) -> Settings {
        let (view, default) = (scenes::of_view(scene), Settings::of(scene));
        let (methods, pipeline) = self.methods.chosen(view);
        Settings {
            resolution: self.size.unwrap_or(scene.resolution),
            max_bounces: self.bounces.unwrap_or(scene.max_bounces),
            seed: self.seed.or(view.seed).unwrap_or(default.seed),
            methods,
            lanes: self.lanes.unwrap_or_default().lanes(),
            threads: self.threads.unwrap_or_else(machine::cores),
            pipeline,
            clamp: self.clamp.or(view.clamp).unwrap_or(default.clamp),
            ..default
        }
    }

    /// Returns the settings that a report shows for this scene's picture, and the options that differ from
    /// the defaults.
    pub fn run_settings(&self, scene: &Loaded) -> (RunSettings, String) {
        let (view, settings) = (scenes::of_view(scene), self.settings(scene));
        let default = Settings { threads: machine::cores(), ..Settings::of(scene) };
        let run = RunSettings::of_picture(&settings).with("exposure", self.exposure.or(view.exposure));
        let run = run.with("tone", self.tone.or(view.tone));
        let options = run.options(&RunSettings::of_picture(&default));
        (run, options)
    }

    /// Returns the tone mapping of the displayed picture.
    pub fn tone(&self, scene: &Loaded) -> Tone {
        let view = scenes::of_view(scene);
        Tone {
            exposure: self.exposure.or(view.exposure).unwrap_or(0.0),
            operator: self.tone.or(view.tone).unwrap_or_default(),
        }
    }
}
