//! What can be chosen while the viewer runs, and what is chosen now.
//!
//! For: [`Controls`], changed by [`Controls::apply`]. May import: `keys`, what there is to choose between. Must never know: threads that trace, windows.

use super::keys::Command;
use super::views::View;
use crate::scene::{MAX_BOUNCES, MAX_SIDE, Scene};
use crate::tone::{Operator, Tone};
use crate::traverse::batch::Traversal;
use crate::traverse::{Methods, SphereChoice, TraversalChoice, TriangleChoice};

/// What smooths edges in what is shown.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Filter {
    #[default]
    None,
    /// The thesis's.
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

/// Which equations.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Equations {
    /// What the command line asked for.
    #[default]
    Asked,
    Robust,
    Fast,
    Naive,
}

impl Equations {
    pub fn name(self) -> &'static str {
        match self {
            Self::Asked => "as asked",
            Self::Robust => "robust",
            Self::Fast => "fast",
            Self::Naive => "naive",
        }
    }
    /// The methods of a scene, given what the command line asked for.
    pub fn of(self, scene: &Scene, asked: Methods) -> Methods {
        let Methods { traversal, lights, sampler, .. } = asked;
        let equations = match self {
            Self::Asked => return asked,
            Self::Robust => Methods::default(),
            Self::Fast => Methods::fast(scene),
            Self::Naive => Methods {
                sphere: SphereChoice::Naive,
                triangle: TriangleChoice::MollerTrumbore,
                ..Methods::default()
            },
        };
        Methods { traversal, lights, sampler, ..equations }
    }
}

/// Frame rates to hold.
const TARGETS: [Option<u32>; 4] = [None, Some(15), Some(30), Some(60)];
/// Steps of [`Controls::scale`].
const SCALES: [i32; 2] = [-8, 6];
/// Most pixels that are shown where a scene asks for fewer: 3840×2160, about 1.5 GB.
const MOST_PIXELS: f64 = 3840.0 * 2160.0;
/// Most stops up and down, and how many a key changes.
const STOPS: f32 = 20.0;
const STOP: f32 = 0.5;

#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Controls {
    /// Scattering events allowed on a path.
    pub bounces: u32,
    /// Each step makes the picture √2 times as wide and high.
    pub scale: i32,
    /// Frames a second that coarser pixels are to hold.
    pub target: Option<u32>,
    pub threads: usize,
    /// All that the machine, or the command line, gives.
    pub most_threads: usize,
    /// 8 (SIMD) or 1 (scalar).
    pub lanes: usize,
    pub equations: Equations,
    /// Instead of what the command line asked for.
    pub traversal: Option<TraversalChoice>,
    pub tone: Tone,
    pub view: View,
    pub reprojection: bool,
    pub filter: Filter,
    pub denoiser: bool,
    pub map: bool,
    pub overlay: bool,
    pub help: bool,
}

impl Controls {
    /// Everything as it is when the viewer starts.
    pub fn new(bounces: u32, threads: usize, lanes: usize, tone: Tone) -> Self {
        Self {
            bounces,
            scale: 0,
            target: None,
            threads,
            most_threads: threads,
            lanes,
            equations: Equations::default(),
            traversal: None,
            tone,
            view: View::default(),
            reprojection: true,
            filter: Filter::default(),
            denoiser: false,
            map: false,
            overlay: true,
            help: false,
        }
    }

    /// Changes what a command changes here; other commands change nothing.
    pub fn apply(&mut self, command: Command) {
        match command {
            Command::FewerBounces => self.bounces = self.bounces.saturating_sub(1),
            Command::MoreBounces => self.bounces = (self.bounces + 1).min(MAX_BOUNCES),
            Command::Coarser => self.scale = (self.scale - 1).max(SCALES[0]),
            Command::Finer => self.scale = (self.scale + 1).min(SCALES[1]),
            Command::NextTarget => self.target = next(&TARGETS, self.target),
            Command::NextThreads => {
                self.threads = match self.threads {
                    all if all >= self.most_threads => 1,
                    some => (2 * some).min(self.most_threads),
                }
            }
            Command::SwitchLanes => self.lanes = if self.lanes == 1 { 8 } else { 1 },
            Command::NextMethods => {
                let all = [Equations::Asked, Equations::Robust, Equations::Fast, Equations::Naive];
                self.equations = next(&all, self.equations);
            }
            Command::NextTraversal => {
                let through = Traversal::ALL.map(|traversal| Some(TraversalChoice::Through(traversal)));
                let mut all = vec![None, Some(TraversalChoice::Linear)];
                all.extend(through);
                self.traversal = next(&all, self.traversal);
            }
            // What the command line asked for may lie beyond.
            Command::Brighter if self.tone.exposure < STOPS => {
                self.tone.exposure = (self.tone.exposure + STOP).min(STOPS);
            }
            Command::Darker if self.tone.exposure > -STOPS => {
                self.tone.exposure = (self.tone.exposure - STOP).max(-STOPS);
            }
            Command::NextTone => {
                self.tone.operator = next(&Operator::ALL, self.tone.operator);
            }
            Command::Show(view) => self.view = view,
            Command::SwitchReprojection => self.reprojection = !self.reprojection,
            Command::NextFilter => {
                self.filter = next(&[Filter::None, Filter::Blur, Filter::Fxaa], self.filter)
            }
            Command::SwitchDenoiser => self.denoiser = !self.denoiser,
            Command::SwitchMap => self.map = !self.map,
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
            | Command::Release => {}
        }
    }

    /// The picture's size for a scene's own, multiplied by `more` besides; at least a few pixels, at most what a picture may have.
    pub fn resolution(&self, own: [u32; 2], more: f64) -> [u32; 2] {
        let [width, height] = own.map(f64::from);
        let factor = (f64::from(self.scale) / 2.0).exp2() * more;
        let least = (8.0 / width).max(8.0 / height).min(1.0);
        let most = (f64::from(MAX_SIDE) / width.max(height)).min((MOST_PIXELS / (width * height)).sqrt());
        let factor = factor.clamp(least, most.max(1.0));
        [width, height].map(|side| (side * factor).round().max(1.0) as u32)
    }

    /// The methods of a scene, given what the command line asked for.
    pub fn methods(&self, scene: &Scene, asked: Methods) -> Methods {
        let methods = self.equations.of(scene, asked);
        Methods { traversal: self.traversal.unwrap_or(methods.traversal), ..methods }
    }
}

/// The one behind `now`, or the first behind the last.
fn next<T: Copy + PartialEq>(all: &[T], now: T) -> T {
    let place = all.iter().position(|one| *one == now).map_or(0, |place| place + 1);
    all[place % all.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::buffers::LightChoice;
    use crate::sampling::Sampler;

    fn controls() -> Controls {
        Controls::new(4, 6, 8, Tone::default())
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
            (Command::SwitchMap, Command::SwitchMap),
            (Command::SwitchOverlay, Command::SwitchOverlay),
            (Command::SwitchHelp, Command::SwitchHelp),
            (Command::Show(View::Cost), Command::Show(View::Picture)),
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
        assert_eq!(after(&[Command::Brighter; 99]).tone.exposure, STOPS);
        assert_eq!(after(&[Command::Darker; 99]).tone.exposure, -STOPS);
        let coarsest = after(&[Command::Coarser; 99]);
        assert_eq!(coarsest.resolution([240, 135], 1.0), [15, 8]);
        assert_eq!(coarsest.resolution([240, 135], 1e-9), [14, 8], "a few pixels are left");
        assert_eq!(coarsest.resolution([3, 2], 1.0), [3, 2], "nothing is made larger by being coarse");
        let finest = after(&[Command::Finer; 99]);
        assert_eq!(finest.resolution([240, 135], 1.0), [1920, 1080]);
        assert_eq!(finest.resolution([1920, 1080], 1.0), [3840, 2160]);
        assert_eq!(finest.resolution([5000, 4000], 1.0), [5000, 4000], "what a scene asks for it gets");
        assert_eq!(finest.resolution([MAX_SIDE, 100], 1.0), [MAX_SIDE, 100]);
        let bright = Controls::new(4, 6, 8, Tone { exposure: 30.0, ..Tone::default() });
        let pressed = |command| {
            let mut controls = bright;
            controls.apply(command);
            controls.tone.exposure
        };
        assert_eq!([Command::Brighter, Command::Darker].map(pressed), [30.0, 29.5]);
    }

    #[test]
    fn equations_leave_alone_what_is_not_theirs() {
        let scene = crate::scene::load("builtin:cornell").unwrap();
        let (traversal, lights, sampler) = (TraversalChoice::Linear, LightChoice::Off, Sampler::Random);
        let asked = Methods { traversal, lights, sampler, ..Methods::default() };
        for equations in [Equations::Asked, Equations::Robust, Equations::Fast, Equations::Naive] {
            let of = equations.of(&scene, asked);
            assert_eq!((of.traversal, of.lights, of.sampler), (traversal, lights, sampler), "{equations:?}");
        }
        assert_eq!(Equations::Naive.of(&scene, asked).sphere, SphereChoice::Naive);
        let mut controls = controls();
        controls.apply(Command::NextTraversal);
        controls.apply(Command::NextTraversal);
        let through = TraversalChoice::Through(Traversal::ALL[0]);
        assert_eq!(controls.methods(&scene, asked).traversal, through);
    }
}
