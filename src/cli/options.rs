//! Validated options: numbers in range, names known, defaults filled in.
//!
//! For: one struct a command, made from its raw arguments or refused; `convert` and `inspect` have nothing to
//! validate.

use super::args::{BenchArgs, ChartArgs, CompareArgs, MergeArgs, RaysArgs, RenderArgs, StabilityArgs};
use super::error::CliError;
use super::frames::{Frames, shard};
use super::groups::LimitArgs;
use super::limits::Limits;
use super::methods::MethodOptions;
use super::numbers::{bounces, exposure, lanes, refuse, samples, seconds, seed, size, threads, whole};
use super::picture::PictureOptions;
use crate::checkpoint::Shard;
use crate::machine;
use crate::measure::chart::ground_truth::SHRINK;
use crate::measure::chart::pictures;
use crate::measure::stability::{Effort, Recipe, recipes};
use crate::measure::trace::TraceMethod;
use crate::render::{LaneChoice, PipelineChoice};
use crate::tone::Operator;
use crate::wording::grouped;
use std::path::PathBuf;
use std::time::Duration;

/// Most measured frames.
pub const MAX_FRAMES: u32 = 1_000_000;
/// Most measured passes over the rays.
pub const MAX_PASSES: u32 = 1_000_000;
/// Most seeds of a chart.
pub const MAX_SEEDS: u32 = 1_000;
/// Most pixels, because all rays are held in memory: 3840×2160, about 1.5 GB.
pub const MAX_RAYS: u32 = 1 << 23;

#[derive(Clone, Debug, PartialEq)]
pub struct BenchOptions {
    /// Empty: the built-in bench scenes.
    pub scenes: Vec<String>,
    pub json: bool,
    pub stats: bool,
    /// One thread, and SIMD once more on all cores, if `None`.
    pub threads: Option<usize>,
    /// One width only; all that the machine has if `None`.
    pub lanes: Option<LaneChoice>,
    pub size: [u32; 2],
    pub bounces: u32,
    /// Frames per engine; by time if `None`.
    pub frames: Option<u32>,
    pub seed: u32,
    pub methods: MethodOptions,
    pub pipeline: PipelineChoice,
}

#[derive(Clone, Debug, PartialEq)]
pub struct CompareOptions {
    /// Empty: the built-in scenes.
    pub scenes: Vec<String>,
    pub json: bool,
    /// Hashes of films instead of a comparison.
    pub hash: bool,
    pub threads: usize,
    pub size: [u32; 2],
    pub bounces: u32,
    pub samples: u32,
    pub seed: u32,
    pub methods: MethodOptions,
    pub pipeline: PipelineChoice,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    pub scene: String,
    pub output: PathBuf,
    /// The file for the numbers of samples.
    pub samples_map: Option<PathBuf>,
    pub checkpoint: Option<PathBuf>,
    /// Time between two checkpoints; by the time that saving takes if `None`.
    pub checkpoint_interval: Option<Duration>,
    /// Of tiles, or with `frames` of frames.
    pub shard: Option<Shard>,
    pub frames: Option<Frames>,
    /// With limits.
    pub picture: PictureOptions,
    pub json: bool,
    pub stats: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct MergeOptions {
    /// At least one.
    pub parts: Vec<PathBuf>,
    pub output: PathBuf,
    /// The parts' own if `None`.
    pub exposure: Option<f32>,
    pub tone: Option<Operator>,
    pub json: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RaysOptions {
    pub scene: String,
    pub json: bool,
    pub stats: bool,
    pub dump: Option<PathBuf>,
    /// At most [`MAX_RAYS`] pixels.
    pub size: [u32; 2],
    /// One thread, and once more all cores, if `None`.
    pub threads: Option<usize>,
    /// All traversals if `None`.
    pub traversal: Option<TraceMethod>,
    /// Passes per traversal; by time if `None`.
    pub passes: Option<u32>,
    pub seed: u32,
}

#[derive(Clone, Debug)]
pub struct StabilityOptions {
    pub json: bool,
    pub output: Option<PathBuf>,
    pub effort: Effort,
    /// At least one.
    pub recipes: Vec<&'static Recipe>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ChartOptions {
    /// Empty: the built-in scenes.
    pub scenes: Vec<String>,
    pub output: PathBuf,
    pub json: bool,
    /// By the number of scenes if `None`.
    pub budget: Option<Duration>,
    /// Pixels of a frame: multiples of [`SHRINK`].
    pub size: [u32; 2],
    pub bounces: u32,
    pub seeds: u32,
}

impl TryFrom<BenchArgs> for BenchOptions {
    type Error = CliError;
    fn try_from(args: BenchArgs) -> Result<Self, CliError> {
        Ok(Self {
            scenes: args.scenes,
            json: args.json,
            stats: args.stats,
            threads: threads(args.threads.as_deref())?,
            lanes: args.lanes.map(lanes).transpose()?,
            size: size(&args.size)?,
            bounces: bounces(&args.bounces)?,
            frames: args.frames.map(|text| whole("--frames", &text, 1, MAX_FRAMES)).transpose()?,
            seed: seed(&args.seed)?,
            methods: args.methods.into(),
            pipeline: args.pipeline,
        })
    }
}

impl TryFrom<CompareArgs> for CompareOptions {
    type Error = CliError;
    fn try_from(args: CompareArgs) -> Result<Self, CliError> {
        Ok(Self {
            scenes: args.scenes,
            json: args.json,
            hash: args.hash,
            threads: threads(args.threads.as_deref())?.unwrap_or_else(machine::cores),
            size: size(&args.size)?,
            bounces: bounces(&args.bounces)?,
            samples: samples(&args.samples)?,
            seed: seed(&args.seed)?,
            methods: args.methods.into(),
            pipeline: args.pipeline,
        })
    }
}

impl TryFrom<RenderArgs> for RenderOptions {
    type Error = CliError;
    fn try_from(args: RenderArgs) -> Result<Self, CliError> {
        let mut picture = PictureOptions::try_from(args.picture)?;
        let shard = args.shard.as_deref().map(shard).transpose()?;
        let frames = args.frames.as_deref().map(Frames::read).transpose()?;
        if let (Some(text), None) = (&args.shard, frames) {
            check_shard(text, &args.limits, args.samples_map.is_some())?;
        }
        let interval = args.checkpoint_interval.as_deref();
        picture.overrides.limits = Limits::of_args(args.limits)?;
        Ok(Self {
            scene: args.scene,
            output: args.output,
            samples_map: args.samples_map,
            checkpoint: args.checkpoint,
            checkpoint_interval: interval.map(|text| seconds("--checkpoint-interval", text)).transpose()?,
            shard,
            frames,
            picture,
            json: args.json,
            stats: args.stats,
        })
    }
}

/// Refuses what a shard of tiles cannot do.
fn check_shard(text: &str, limits: &LimitArgs, map: bool) -> Result<(), CliError> {
    let why = if limits.target_error.is_some() {
        "--target-error decides by the whole picture, of which a shard sees a part: give --samples instead"
    } else if limits.time_limit.is_some() && limits.samples.is_none() {
        "shards join where each has as many samples: with --time-limit give --samples too, and --checkpoint to \
         go on later"
    } else if map {
        "all pixels of a shard have as many samples: leave out --samples-map"
    } else {
        return Ok(());
    };
    Err(refuse("--shard", text, why))
}

impl TryFrom<MergeArgs> for MergeOptions {
    type Error = CliError;
    fn try_from(args: MergeArgs) -> Result<Self, CliError> {
        Ok(Self {
            parts: args.parts,
            output: args.output,
            exposure: args.exposure.as_deref().map(exposure).transpose()?,
            tone: args.tone,
            json: args.json,
        })
    }
}

impl TryFrom<RaysArgs> for RaysOptions {
    type Error = CliError;
    fn try_from(args: RaysArgs) -> Result<Self, CliError> {
        let size = size(&args.size)?;
        if size[0] * size[1] > MAX_RAYS {
            let why = format!("all rays are held in memory: give at most {} pixels", grouped(MAX_RAYS));
            return Err(refuse("--size", &args.size, why));
        }
        Ok(Self {
            scene: args.scene,
            json: args.json,
            stats: args.stats,
            dump: args.dump,
            size,
            threads: threads(args.threads.as_deref())?,
            traversal: TraceMethod::of(args.traversal),
            passes: args.passes.map(|text| whole("--passes", &text, 1, MAX_PASSES)).transpose()?,
            seed: seed(&args.seed)?,
        })
    }
}

impl TryFrom<ChartArgs> for ChartOptions {
    type Error = CliError;
    fn try_from(args: ChartArgs) -> Result<Self, CliError> {
        let size = size(&args.size)?;
        if size.iter().any(|side| side % SHRINK != 0) {
            let [width, height] = size.map(|side| side.next_multiple_of(SHRINK));
            let why = format!(
                "pictures have a third of its width and height: give multiples of 3, such as {width}x{height}"
            );
            return Err(refuse("--size", &args.size, why));
        }
        Ok(Self {
            scenes: args.scenes,
            output: args.output,
            json: args.json,
            budget: args.budget.as_deref().map(|text| seconds("--budget", text)).transpose()?,
            size,
            bounces: bounces(&args.bounces)?,
            seeds: whole("--seeds", &args.seeds, pictures::SEEDS, MAX_SEEDS)?,
        })
    }
}

impl From<StabilityArgs> for StabilityOptions {
    fn from(args: StabilityArgs) -> Self {
        let wanted =
            |recipe: &&Recipe| args.only.is_empty() || args.only.iter().any(|name| name == recipe.name);
        let recipes = recipes().filter(wanted).collect();
        let effort = if args.thorough { Effort::THOROUGH } else { Effort::STANDARD };
        Self { json: args.json, output: args.output, effort, recipes }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::buffers::LightChoice;
    use crate::cli::args::{Args, Command};
    use crate::cli::overrides::Overrides;
    use crate::sampling::Sampler;
    use crate::scene::{Loaded, Rendering, Scene, View, load};
    use crate::traverse::batch::Traversal;
    use crate::traverse::{BoxChoice, Methods, SphereChoice, TraversalChoice, TriangleChoice};
    use clap::Parser;

    /// The overrides of a view with this `render` and of these options.
    fn overrides(render: Rendering, options: &[&str]) -> Overrides {
        let words = ["octray", "render", "view.json", "-o", "a.png"].iter().chain(options);
        let Some(Command::Render(args)) = Args::parse_from(words).command else {
            unreachable!("the command is render")
        };
        let view = View { render, ..View::of(&cornell(), None, std::path::Path::new("")) };
        let scene = Loaded { view: Some(view), ..cornell().into() };
        let of_view = Overrides::of_view(&scene).unwrap();
        RenderOptions::try_from(args).unwrap().picture.overrides.or(of_view)
    }

    fn cornell() -> Scene {
        load("builtin:cornell").unwrap()
    }

    #[test]
    fn views_mean_the_same_as_options_and_options_override_them() {
        let render = Rendering {
            samples: Some(37),
            seed: Some(u32::MAX),
            exposure: Some(-0.3),
            tone: Some(Operator::Reinhard),
            clamp: Some(10.1),
            sphere: Some(SphereChoice::Naive),
            triangle: Some(TriangleChoice::MollerTrumbore),
            boxes: Some(BoxChoice::Fma),
            traversal: Some(TraversalChoice::Through(Traversal::Single)),
            lights: Some(LightChoice::On),
            sampler: Some(Sampler::Random),
            pipeline: Some(PipelineChoice::General),
        };
        let same = "--samples 37 --seed 4294967295 --exposure -0.3 --tone reinhard --clamp 10.1 --sphere naive \
                    --triangle moller-trumbore --box fma --traversal single --lights on --sampler random --pipeline general";
        let same: Vec<&str> = same.split_whitespace().collect();
        let by_view = overrides(render, &[]);
        assert_eq!(by_view, overrides(Rendering::default(), &same));
        assert_ne!(by_view, overrides(Rendering::default(), &[]));
        let other = "--samples 1 --seed 2 --exposure 3 --tone aces --clamp 4 --sphere robust --triangle woop --box padded-fma \
                     --traversal linear --lights off --sampler sobol --pipeline needed";
        let other: Vec<&str> = other.split_whitespace().collect();
        assert_eq!(overrides(render, &other), overrides(Rendering::default(), &other));
    }

    #[test]
    fn fast_and_robust_override_the_views_methods_and_any_limit_its_samples() {
        let render = Rendering {
            samples: Some(37),
            triangle: Some(TriangleChoice::MollerTrumbore),
            lights: Some(LightChoice::Off),
            ..Rendering::default()
        };
        let methods = |options: &[&str]| overrides(render, options).methods.of(&cornell());
        let plain = methods(&[]);
        assert_eq!(plain.triangle, TriangleChoice::MollerTrumbore);
        assert_eq!(methods(&["--robust"]), Methods { triangle: TriangleChoice::Woop, ..plain });
        assert_eq!(methods(&["--fast"]), Methods { triangle: TriangleChoice::BaldwinWeber, ..plain });
        let limits = |options: &[&str]| overrides(render, options).limits.unwrap();
        assert_eq!(limits(&[]).samples, 37);
        assert_eq!(limits(&["--samples", "5"]).samples, 5);
        assert!(limits(&["--target-error", "0.1"]).samples > 37);
        assert!(limits(&["--time-limit", "1"]).samples > 37);
    }
}
