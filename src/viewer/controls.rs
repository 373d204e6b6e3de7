//! The settings that keys change while the viewer runs.
//!
//! For: [`Controls`], changed by [`Controls::apply`].

use super::display_mode::DisplayMode;
use super::keys::Command;
use octray_engine::render::LaneChoice;
use octray_engine::tone::{Operator, Tone};
use octray_engine::traverse::batch::Traversal;
use octray_engine::traverse::{Methods, SphereChoice, TraversalChoice, TriangleChoice};
use octray_formats::scene::{MAX_BOUNCES, MAX_SIDE, Scene};

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
    pub fn name(self) -> &'static str {
        match self {
            Self::None => "no filter",
            Self::Blur => "3×3 blur",
            Self::Fxaa => "FXAA",
        }
    }
}

/// Sets of intersection methods that a key cycles through.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MethodPreset {
    /// The methods requested on the command line.
    #[default]
    CommandLine,
    Robust,
    Fast,
    Naive,
}

impl MethodPreset {
    pub fn name(self) -> &'static str {
        match self {
            Self::CommandLine => "as requested",
            Self::Robust => "robust",
            Self::Fast => "fast",
            Self::Naive => "naive",
        }
    }
    /// The methods for a scene, given those requested on the command line.
    pub fn of(self, scene: &Scene, requested: Methods) -> Methods {
        let Methods { traversal, lights, sampler, .. } = requested;
        let methods = match self {
            Self::CommandLine => return requested,
            Self::Robust => Methods::default(),
            Self::Fast => Methods::fast(scene),
            Self::Naive => Methods {
                sphere: SphereChoice::Naive,
                triangle: TriangleChoice::MollerTrumbore,
                ..Methods::default()
            },
        };
        Methods { traversal, lights, sampler, ..methods }
    }
}

/// Target frame rates.
const TARGETS: [Option<u32>; 4] = [None, Some(15), Some(30), Some(60)];
/// Bounds of [`Controls::scale`].
const SCALES: [i32; 2] = [-8, 6];
/// Most pixels that upscaling leads to: 3840×2160, about 1.5 GB.
const MAX_PIXELS: f64 = 3840.0 * 2160.0;
/// Bounds of the exposure in stops, and the step of a key.
const MAX_STOPS: f32 = 20.0;
const STOP_STEP: f32 = 0.5;

/// The present settings.
#[derive(Clone, Copy, Debug, PartialEq)]
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
    pub lanes: LaneChoice,
    /// Scalar for now, whatever `lanes` says.
    pub scalar: bool,
    pub preset: MethodPreset,
    /// Overrides the command line's traversal.
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
    /// The settings at the start.
    pub fn new(bounces: u32, threads: usize, lanes: LaneChoice, tone: Tone) -> Self {
        let scalar = lanes == LaneChoice::One;
        Self {
            bounces,
            scale: 0,
            target: None,
            threads,
            max_threads: threads,
            lanes: if scalar { LaneChoice::Auto } else { lanes },
            scalar,
            preset: MethodPreset::default(),
            traversal: None,
            tone,
            mode: DisplayMode::default(),
            reprojection: true,
            filter: Filter::default(),
            denoiser: false,
            minimap: false,
            overlay: true,
            help: false,
        }
    }

    /// Applies a command; commands that concern no setting change nothing.
    pub fn apply(&mut self, command: Command) {
        match command {
            Command::FewerBounces => self.bounces = self.bounces.saturating_sub(1),
            Command::MoreBounces => self.bounces = (self.bounces + 1).min(MAX_BOUNCES),
            Command::Coarser => self.scale = (self.scale - 1).max(SCALES[0]),
            Command::Finer => self.scale = (self.scale + 1).min(SCALES[1]),
            Command::NextTarget => self.target = next(&TARGETS, self.target),
            Command::NextThreads => {
                self.threads = match self.threads {
                    all if all >= self.max_threads => 1,
                    some => (2 * some).min(self.max_threads),
                }
            }
            Command::SwitchLanes => self.scalar = !self.scalar,
            Command::NextMethods => {
                let all = [
                    MethodPreset::CommandLine,
                    MethodPreset::Robust,
                    MethodPreset::Fast,
                    MethodPreset::Naive,
                ];
                self.preset = next(&all, self.preset);
            }
            Command::NextTraversal => {
                let through = Traversal::ALL.map(|traversal| Some(TraversalChoice::Through(traversal)));
                let mut all = vec![None, Some(TraversalChoice::Linear)];
                all.extend(through);
                self.traversal = next(&all, self.traversal);
            }
            // The command line's exposure may lie beyond the bounds.
            Command::Brighter if self.tone.exposure < MAX_STOPS => {
                self.tone.exposure = (self.tone.exposure + STOP_STEP).min(MAX_STOPS);
            }
            Command::Darker if self.tone.exposure > -MAX_STOPS => {
                self.tone.exposure = (self.tone.exposure - STOP_STEP).max(-MAX_STOPS);
            }
            Command::NextTone => {
                self.tone.operator = next(&Operator::ALL, self.tone.operator);
            }
            Command::Show(mode) => self.mode = mode,
            Command::SwitchReprojection => self.reprojection = !self.reprojection,
            Command::NextFilter => {
                self.filter = next(&[Filter::None, Filter::Blur, Filter::Fxaa], self.filter)
            }
            Command::SwitchDenoiser => self.denoiser = !self.denoiser,
            Command::SwitchMinimap => self.minimap = !self.minimap,
            Command::SwitchOverlay => self.overlay = !self.overlay,
            Command::SwitchHelp => self.help = !self.help,
            Command::NextScene
            | Command::PreviousScene
            | Command::Reload
            | Command::Home
            | Command::Narrower
            | Command::Wider
            | Command::Screenshot
            | Command::Brighter
            | Command::Darker
            | Command::ReleaseMouse => {}
        }
    }

    /// The resolution for a scene: its own, scaled by [`Self::scale`] and by `factor`, within bounds.
    pub fn resolution(&self, scene_resolution: [u32; 2], factor: f64) -> [u32; 2] {
        let [width, height] = scene_resolution.map(f64::from);
        let factor = (f64::from(self.scale) / 2.0).exp2() * factor;
        let least = (8.0 / width).max(8.0 / height).min(1.0);
        let most = (f64::from(MAX_SIDE) / width.max(height)).min((MAX_PIXELS / (width * height)).sqrt());
        let factor = factor.clamp(least, most.max(1.0));
        [width, height].map(|side| (side * factor).round().max(1.0) as u32)
    }

    /// The methods for a scene, given those requested on the command line.
    pub fn methods(&self, scene: &Scene, requested: Methods) -> Methods {
        let methods = self.preset.of(scene, requested);
        Methods { traversal: self.traversal.unwrap_or(methods.traversal), ..methods }
    }
}

/// The value after `now`; cyclic.
fn next<T: Copy + PartialEq>(all: &[T], now: T) -> T {
    let place = all.iter().position(|one| *one == now).map_or(0, |place| place + 1);
    all[place % all.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use octray_engine::buffers::LightChoice;
    use octray_engine::sampling::Sampler;

    fn controls() -> Controls {
        Controls::new(4, 6, LaneChoice::Eight, Tone::default())
    }
    fn after(commands: &[Command]) -> Controls {
        let mut controls = controls();
        commands.iter().for_each(|&command| controls.apply(command));
        controls
    }

    #[test]
    fn opposites_bring_everything_back() {
        for (there, back) in [
            (Command::MoreBounces, Command::FewerBounces),
            (Command::Coarser, Command::Finer),
            (Command::Brighter, Command::Darker),
            (Command::SwitchLanes, Command::SwitchLanes),
            (Command::SwitchReprojection, Command::SwitchReprojection),
            (Command::SwitchDenoiser, Command::SwitchDenoiser),
            (Command::SwitchMinimap, Command::SwitchMinimap),
            (Command::SwitchOverlay, Command::SwitchOverlay),
            (Command::SwitchHelp, Command::SwitchHelp),
            (Command::Show(DisplayMode::Cost), Command::Show(DisplayMode::Picture)),
        ] {
            assert_ne!(after(&[there]), controls(), "{there:?} does something");
            assert_eq!(after(&[there, back]), controls(), "{back:?} undoes {there:?}");
        }
    }

    #[test]
    fn circles_close_after_all_of_their_choices() {
        for (command, choices) in [
            (Command::NextTarget, 4),
            (Command::NextThreads, 4),
            (Command::NextMethods, 4),
            (Command::NextTraversal, 7),
            (Command::NextTone, 3),
            (Command::NextFilter, 3),
        ] {
            for times in 1..choices {
                assert_ne!(after(&vec![command; times]), controls(), "{command:?} {times}");
            }
            assert_eq!(after(&vec![command; choices]), controls(), "{command:?}");
        }
        let threads = |times| after(&vec![Command::NextThreads; times]).threads;
        assert_eq!([1, 2, 3, 4].map(threads), [1, 2, 4, 6]);
    }

    #[test]
    fn bounds_hold() {
        assert_eq!(after(&[Command::FewerBounces; 9]).bounces, 0);
        assert_eq!(after(&[Command::Brighter; 99]).tone.exposure, MAX_STOPS);
        assert_eq!(after(&[Command::Darker; 99]).tone.exposure, -MAX_STOPS);
        let coarsest = after(&[Command::Coarser; 99]);
        assert_eq!(coarsest.resolution([240, 135], 1.0), [15, 8]);
        assert_eq!(coarsest.resolution([240, 135], 1e-9), [14, 8], "a few pixels are left");
        assert_eq!(coarsest.resolution([3, 2], 1.0), [3, 2], "nothing is made larger by being coarse");
        let finest = after(&[Command::Finer; 99]);
        assert_eq!(finest.resolution([240, 135], 1.0), [1920, 1080]);
        assert_eq!(finest.resolution([1920, 1080], 1.0), [3840, 2160]);
        assert_eq!(finest.resolution([5000, 4000], 1.0), [5000, 4000], "a scene's own resolution is kept");
        assert_eq!(finest.resolution([MAX_SIDE, 100], 1.0), [MAX_SIDE, 100]);
        let bright = Controls::new(4, 6, LaneChoice::Eight, Tone { exposure: 30.0, ..Tone::default() });
        let pressed = |command| {
            let mut controls = bright;
            controls.apply(command);
            controls.tone.exposure
        };
        assert_eq!([Command::Brighter, Command::Darker].map(pressed), [30.0, 29.5]);
    }

    #[test]
    fn presets_keep_traversal_lights_and_sampler() {
        let scene = octray_formats::scene::load("builtin:cornell").unwrap();
        let (traversal, lights, sampler) = (TraversalChoice::Linear, LightChoice::Off, Sampler::Random);
        let requested = Methods { traversal, lights, sampler, ..Methods::default() };
        for preset in
            [MethodPreset::CommandLine, MethodPreset::Robust, MethodPreset::Fast, MethodPreset::Naive]
        {
            let of = preset.of(&scene, requested);
            assert_eq!((of.traversal, of.lights, of.sampler), (traversal, lights, sampler), "{preset:?}");
        }
        assert_eq!(MethodPreset::Naive.of(&scene, requested).sphere, SphereChoice::Naive);
        let mut controls = controls();
        controls.apply(Command::NextTraversal);
        controls.apply(Command::NextTraversal);
        let through = TraversalChoice::Through(Traversal::ALL[0]);
        assert_eq!(controls.methods(&scene, requested).traversal, through);
    }
}
