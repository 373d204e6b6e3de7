//! What we accept: numbers in range, names known, defaults filled in.
//!
//! For: one struct a command, made from its raw arguments or refused. May import: `args`, `choices`, `numbers`, `output`, `measure`'s, `render`'s and
//! `traverse`'s choices.
//! Must never know: how a command does its work.

use super::args::{BenchArgs, CompareArgs, ConvertArgs, InspectArgs, RaysArgs, RenderArgs, StabilityArgs};
use super::choices::{
    LightArg, MethodArgs, PipelineArg, SamplerArg, SphereMethod, ToneArg, TraversalArg, TriangleMethod,
};
use super::error::CliError;
use super::limits::Limits;
use super::numbers::{bounces, clamp, exposure, lanes, refuse, samples, seed, size, threads, whole};
use crate::buffers::LightChoice;
use crate::measure::stability::{Recipe, recipes};
use crate::measure::ways::Way;
use crate::output::{Operator, Tone};
use crate::render::PipelineChoice;
use crate::sampling::Sampler;
use crate::traverse::batch::Traversal;
use crate::traverse::{Methods, SphereChoice, TraversalChoice, TriangleChoice};
use crate::wording::grouped;
use std::path::PathBuf;

/// Most frames measured.
pub const MAX_FRAMES: u32 = 1_000_000;
/// Most passes over rays measured.
pub const MAX_PASSES: u32 = 1_000_000;
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
    pub methods: Methods,
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
    pub methods: Methods,
    pub pipeline: PipelineChoice,
}

#[derive(Clone, Debug, PartialEq)]
pub struct RenderOptions {
    pub scene: String,
    pub output: PathBuf,
    /// Where the numbers of samples go.
    pub samples_map: Option<PathBuf>,
    pub limits: Limits,
    /// The scene's if `None`.
    pub size: Option<[u32; 2]>,
    /// The scene's if `None`.
    pub bounces: Option<u32>,
    pub seed: u32,
    pub threads: usize,
    pub lanes: usize,
    pub tone: Tone,
    /// The most that a sample may bring to a channel; infinite without a limit.
    pub clamp: f32,
    /// Was exposure or tone mapping asked for?
    pub tone_asked: bool,
    pub methods: Methods,
    pub pipeline: PipelineChoice,
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
    pub traversal: Option<Way>,
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
        Ok(Self {
            scene: args.scene,
            output: args.output,
            samples_map: args.samples_map,
            limits: args.limits.try_into()?,
            size: args.size.as_deref().map(size).transpose()?,
            bounces: args.bounces.as_deref().map(bounces).transpose()?,
            seed: seed(&args.seed)?,
            threads: threads(args.threads)?,
            lanes: lanes(&args.lanes)?,
            clamp: args.clamp.as_deref().map_or(Ok(f32::INFINITY), clamp)?,
            tone_asked: args.exposure.is_some() || args.tone.is_some(),
            tone: Tone {
                exposure: args.exposure.as_deref().map_or(Ok(0.0), exposure)?,
                operator: args.tone.unwrap_or_default().into(),
            },
            methods: args.methods.into(),
            pipeline: args.pipeline.into(),
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
            traversal: Way::of(args.traversal.into()),
            passes: args.passes.map(|text| whole("--passes", &text, 1, MAX_PASSES)).transpose()?,
            seed: seed(&args.seed)?,
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

impl From<MethodArgs> for Methods {
    fn from(args: MethodArgs) -> Self {
        let sphere = match args.sphere {
            SphereMethod::Robust => SphereChoice::Robust,
            SphereMethod::RobustAnyLength => SphereChoice::RobustAnyLength,
            SphereMethod::Naive => SphereChoice::Naive,
        };
        let triangle = match args.triangle {
            TriangleMethod::Woop => TriangleChoice::Woop,
            TriangleMethod::WoopContracted => TriangleChoice::WoopContracted,
            TriangleMethod::MollerTrumbore => TriangleChoice::MollerTrumbore,
            TriangleMethod::BaldwinWeber => TriangleChoice::BaldwinWeber,
            TriangleMethod::Plucker => TriangleChoice::Plucker,
        };
        let sampler = match args.sampler {
            SamplerArg::Sobol => Sampler::Sobol,
            SamplerArg::Random => Sampler::Random,
        };
        let lights = match args.lights {
            LightArg::Auto => LightChoice::Auto,
            LightArg::On => LightChoice::On,
            LightArg::Off => LightChoice::Off,
        };
        Self { sphere, triangle, traversal: args.traversal.into(), lights, sampler }
    }
}

impl From<TraversalArg> for TraversalChoice {
    fn from(traversal: TraversalArg) -> Self {
        match traversal {
            TraversalArg::Needed => Self::Needed,
            TraversalArg::Linear => Self::Linear,
            TraversalArg::Scalar => Self::Through(Traversal::Scalar),
            TraversalArg::Single => Self::Through(Traversal::Single),
            TraversalArg::Packet => Self::Through(Traversal::Packet),
            TraversalArg::Stream => Self::Through(Traversal::Stream),
            TraversalArg::Hybrid => Self::Through(Traversal::Hybrid),
        }
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
