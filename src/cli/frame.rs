//! How measured frames are made: options of `bench` and `compare`, and the settings made of them.

use super::error::CliError;
use super::groups::{METHODS, MethodArgs, choice, one_of, warn_of_lost_hierarchy};
use super::memory;
use super::numbers::{seed, size, whole};
use super::scenes;
use crate::render::{PipelineChoice, Settings};
use crate::report::settings::RunSettings;
use crate::scene::{Loaded, MAX_BOUNCES, Scene};
use std::ffi::OsStr;

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
    pub methods: MethodArgs,
    /// Features of the compiled pipeline: the same picture.
    #[arg(long, value_name = "METHOD", default_value = PipelineChoice::default().name(), hide_default_value = true, value_parser = choice::<PipelineChoice>(), hide_possible_values = true, help_heading = METHODS, long_help = one_of::<PipelineChoice>("Features of the compiled pipeline"))]
    pub pipeline: PipelineChoice,
}

impl FrameOptions {
    /// The settings of this scene's frames, on one thread.
    fn settings(&self, scene: &Scene) -> Settings {
        let own = Settings::of(scene);
        let sized = match self.as_scene {
            true => own,
            false => Settings { resolution: self.size, max_bounces: self.bounces, ..own },
        };
        Settings { seed: self.seed, methods: self.methods.methods(), pipeline: self.pipeline, ..sized }
    }

    /// What a report says of them.
    pub fn run_settings(&self) -> RunSettings {
        let run = RunSettings::of(self.methods.methods());
        let run = RunSettings { seed: self.seed, pipeline: self.pipeline, ..run };
        run.sized(self.size, self.bounces, self.as_scene)
    }

    /// Refuses a traversal that a method does not have, and frames that do not fit into memory.
    pub fn check(&self, bytes_per_pixel: usize) -> Result<(), CliError> {
        self.methods.check(&self.methods.methods())?;
        if self.as_scene { Ok(()) } else { memory::check(self.size, bytes_per_pixel) }
    }

    /// Loads a scene for the reference, with its warnings, checks the memory of its own size, and says where
    /// a method tests every primitive.
    pub fn load(&self, name: &OsStr, bytes_per_pixel: usize) -> Result<(Loaded, Settings), CliError> {
        let scene = scenes::load_with_warnings(name, true)?;
        let settings = self.checked(&scene, bytes_per_pixel)?;
        Ok((scene, settings))
    }

    /// The settings of this scene's frames, checked as by [`FrameOptions::load`].
    pub fn checked(&self, scene: &Scene, bytes_per_pixel: usize) -> Result<Settings, CliError> {
        let settings = self.settings(scene);
        if self.as_scene {
            memory::check(settings.resolution, bytes_per_pixel)?;
        }
        warn_of_lost_hierarchy(&settings.methods, scene);
        Ok(settings)
    }
}
