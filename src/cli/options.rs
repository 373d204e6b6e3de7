//! What we accept: numbers in range, names known, defaults filled in.
//!
//! For: one struct a command, made from its raw arguments or refused. May import: `args`, `asked`, `choices`, `methods`, `numbers`, `output`, `render`'s choices.
//! Must never know: how a command does its work.

use super::args::{
    BenchArgs, ChartArgs, CompareArgs, ConvertArgs, InspectArgs, RaysArgs, RenderArgs, StabilityArgs,
};
use super::choices::{PipelineArg, ToneArg};
use super::error::CliError;
use super::limits::{Limits, seconds};
use super::methods::MethodOptions;
use super::numbers::{bounces, lanes, refuse, samples, seed, size, threads, whole};
use super::picture::PictureOptions;
use crate::measure::chart::pictures;
use crate::measure::chart::ground_truth::SHRINK;
use crate::measure::stability::{Recipe, recipes};
use crate::measure::trace::TraceMethod;
use crate::render::PipelineChoice;
use crate::tone::Operator;
use crate::wording::grouped;
use std::path::PathBuf;
use std::time::Duration;

/// Most frames measured.
pub const MAX_FRAMES: u32 = 1_000_000;
/// Most passes over rays measured.
pub const MAX_PASSES: u32 = 1_000_000;
/// Most seeds of a chart.
pub const MAX_SEEDS: u32 = 1_000;
/// Most pixels for rays in prepared arrays: 3840×2160, and about 1.5 GB.
pub const MAX_RAYS: u32 = 1 << 23;

#[derive(Clone, Debug, PartialEq)]
pub struct BenchOptions {
    /// Empty: the built-in bench scenes.
    pub scenes: Vec<String>,
    pub json: bool,
    pub stats: bool,
    /// One thread, and packets once more on all cores, if `None`.
    pub threads: Option<usize>,
    /// One width only; both if `None`.
    pub lanes: Option<usize>,
    pub size: [u32; 2],
    pub bounces: u32,
    /// So many per engine; by time if `None`.
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
    /// Where the numbers of samples go.
    pub samples_map: Option<PathBuf>,
    /// With limits.
    pub picture: PictureOptions,
    pub json: bool,
    pub stats: bool,
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
    /// All that suit the rays if `None`.
    pub traversal: Option<TraceMethod>,
    /// So many per way; by time if `None`.
    pub passes: Option<u32>,
    pub seed: u32,
}

#[derive(Clone, Debug)]
pub struct StabilityOptions {
    pub json: bool,
    pub output: Option<PathBuf>,
    /// At least one.
    pub recipes: Vec<&'static Recipe>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ChartOptions {
    /// Empty: the built-in scenes.
    pub scenes: Vec<String>,
    pub output: PathBuf,
    pub json: bool,
    /// So much a scene if `None`.
    pub budget: Option<Duration>,
    /// Of a frame: multiples of [`SHRINK`].
    pub size: [u32; 2],
    pub bounces: u32,
    pub seeds: u32,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ConvertOptions {
    pub model: PathBuf,
    pub scene: PathBuf,
    pub force: bool,
}

#[derive(Clone, Debug, PartialEq)]
pub struct InspectOptions {
    pub scene: String,
    pub json: bool,
}

impl TryFrom<BenchArgs> for BenchOptions {
    type Error = CliError;
    fn try_from(args: BenchArgs) -> Result<Self, CliError> {
        Ok(Self {
            scenes: args.scenes,
            json: args.json,
            stats: args.stats,
            threads: args.threads.map(|text| threads(Some(text))).transpose()?,
            lanes: args.lanes.as_deref().map(lanes).transpose()?,
            size: size(&args.size)?,
            bounces: bounces(&args.bounces)?,
            frames: args.frames.map(|text| whole("--frames", &text, 1, MAX_FRAMES)).transpose()?,
            seed: seed(&args.seed)?,
            methods: args.methods.into(),
            pipeline: args.pipeline.into(),
        })
    }
}

impl TryFrom<CompareArgs> for CompareOptions {
    type Error = CliError;
    fn try_from(args: CompareArgs) -> Result<Self, CliError> {
        Ok(Self {
            scenes: args.scenes,
            json: args.json,
            threads: threads(args.threads)?,
            size: size(&args.size)?,
            bounces: bounces(&args.bounces)?,
            samples: samples(&args.samples)?,
            seed: seed(&args.seed)?,
            methods: args.methods.into(),
            pipeline: args.pipeline.into(),
        })
    }
}

impl TryFrom<RenderArgs> for RenderOptions {
    type Error = CliError;
    fn try_from(args: RenderArgs) -> Result<Self, CliError> {
        let mut picture = PictureOptions::try_from(args.picture)?;
        picture.asked.limits = Limits::asked(args.limits)?;
        Ok(Self {
            scene: args.scene,
            output: args.output,
            samples_map: args.samples_map,
            picture,
            json: args.json,
            stats: args.stats,
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
            threads: args.threads.map(|text| threads(Some(text))).transpose()?,
            traversal: TraceMethod::of(args.traversal.into()),
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
        Self { json: args.json, output: args.output, recipes }
    }
}

impl From<ConvertArgs> for ConvertOptions {
    fn from(args: ConvertArgs) -> Self {
        Self { model: args.model, scene: args.scene, force: args.force }
    }
}

impl From<InspectArgs> for InspectOptions {
    fn from(args: InspectArgs) -> Self {
        Self { scene: args.scene, json: args.json }
    }
}

impl From<PipelineArg> for PipelineChoice {
    fn from(pipeline: PipelineArg) -> Self {
        match pipeline {
            PipelineArg::Needed => Self::Needed,
            PipelineArg::General => Self::General,
        }
    }
}

impl From<ToneArg> for Operator {
    fn from(tone: ToneArg) -> Self {
        match tone {
            ToneArg::Clamp => Self::Clamp,
            ToneArg::Reinhard => Self::Reinhard,
            ToneArg::Aces => Self::Aces,
        }
    }
}
