//! What we accept: numbers in range, names known, defaults filled in.
//!
//! For: one struct a command, made from its raw arguments or refused. May import: `args`, `output`, `render`'s and
//! `traverse`'s choices, `scene`'s limits.
//! Must never know: how a command does its work.

use super::args::{
    BenchArgs, CompareArgs, ConvertArgs, InspectArgs, MethodArgs, PipelineArg, RaysArgs, RenderArgs,
    SphereMethod, ToneArg, TraversalArg, TriangleMethod,
};
use super::error::CliError;
use super::limits::Limits;
use crate::measure::machine;
use crate::measure::ways::Way;
use crate::output::{Operator, Tone};
use crate::render::PipelineChoice;
use crate::scene::{MAX_BOUNCES, MAX_SIDE};
use crate::traverse::batch::Traversal;
use crate::traverse::{Methods, SphereChoice, TraversalChoice, TriangleChoice};
use std::path::PathBuf;

/// Most samples a pixel: up to here a sum in f32 still takes each one in.
pub const MAX_SAMPLES: u32 = 1 << 24;
/// Most worker threads: beyond any machine, below what exhausts one.
pub const MAX_THREADS: u32 = 1_024;
/// Most frames measured.
pub const MAX_FRAMES: u32 = 1_000_000;
/// Most passes over rays measured.
pub const MAX_PASSES: u32 = 1_000_000;
/// Most pixels for rays in prepared arrays: 3840×2160, and about 1.5 GB.
pub const MAX_RAYS: u32 = 1 << 23;
/// Most stops up or down: past f32's own range in visible light.
pub const MAX_EXPOSURE: f32 = 64.0;

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
            let why = format!("all rays are held in memory: give at most {MAX_RAYS} pixels");
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
        Self { sphere, triangle, traversal: args.traversal.into() }
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

fn threads(text: Option<String>) -> Result<usize, CliError> {
    match text {
        Some(text) => Ok(whole("--threads", &text, 1, MAX_THREADS)? as usize),
        None => Ok(machine::cores()),
    }
}

fn lanes(text: &str) -> Result<usize, CliError> {
    match text {
        "1" => Ok(1),
        "8" => Ok(8),
        _ => Err(refuse("--lanes", text, "give 1 (scalar) or 8 (SIMD)")),
    }
}

pub(super) fn samples(text: &str) -> Result<u32, CliError> {
    whole("--samples", text, 1, MAX_SAMPLES)
}

fn bounces(text: &str) -> Result<u32, CliError> {
    whole("--bounces", text, 0, MAX_BOUNCES)
}

fn seed(text: &str) -> Result<u32, CliError> {
    whole("--seed", text, 0, u32::MAX)
}

fn exposure(text: &str) -> Result<f32, CliError> {
    match text.parse::<f32>() {
        Ok(stops) if stops.abs() <= MAX_EXPOSURE => Ok(stops),
        _ => Err(refuse("--exposure", text, format!("give a number from -{MAX_EXPOSURE} to {MAX_EXPOSURE}"))),
    }
}

/// Reads `WxH` or `W×H`.
fn size(text: &str) -> Result<[u32; 2], CliError> {
    let shape = "give width and height as WIDTHxHEIGHT, such as 240x135";
    let (width, height) = text.split_once(['x', 'X', '×']).ok_or_else(|| refuse("--size", text, shape))?;
    let side = |digits: &str| match read(digits) {
        Reading::Number(side) if (1..=u64::from(MAX_SIDE)).contains(&side) => Ok(side as u32),
        Reading::Number(_) | Reading::TooLarge => {
            Err(refuse("--size", text, format!("width and height may be from 1 to {MAX_SIDE} pixels")))
        }
        Reading::Other => Err(refuse("--size", text, shape)),
    };
    Ok([side(width)?, side(height)?])
}

pub(super) fn whole(option: &'static str, text: &str, least: u32, most: u32) -> Result<u32, CliError> {
    match read(text) {
        Reading::Number(number) if (u64::from(least)..=u64::from(most)).contains(&number) => {
            Ok(number as u32)
        }
        _ => Err(refuse(option, text, format!("give a whole number from {least} to {most}"))),
    }
}

enum Reading {
    Number(u64),
    TooLarge,
    Other,
}

/// Reads decimal digits and nothing else: no sign, no spaces.
fn read(text: &str) -> Reading {
    if text.is_empty() || !text.bytes().all(|byte| byte.is_ascii_digit()) {
        return Reading::Other;
    }
    text.parse().map_or(Reading::TooLarge, Reading::Number)
}

pub(super) fn refuse(option: &'static str, value: &str, why: impl Into<String>) -> CliError {
    CliError::Value { option, value: value.to_string(), why: why.into() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size_accepts_every_cross() {
        for text in ["240x135", "240X135", "240×135"] {
            assert_eq!(size(text).unwrap(), [240, 135], "{text}");
        }
        assert_eq!(size("1x16384").unwrap(), [1, 16_384]);
    }

    #[test]
    fn size_refuses_the_rest_with_a_remedy() {
        for text in [
            "",
            "x",
            "240",
            "240x",
            "x135",
            "240x135x1",
            "-1x1",
            "+1x1",
            " 1x1",
            "1 x 1",
            "1.5x2",
            "axb",
            "١x١",
        ] {
            let message = size(text).unwrap_err().to_string();
            assert!(message.starts_with("--size ") && message.contains("240x135"), "{text}: {message}");
        }
        for text in ["0x0", "0x1", "1x0", "16385x1", "1x16385", "1000000000x1", "99999999999999999999999x1"] {
            let message = size(text).unwrap_err().to_string();
            assert!(message.contains("from 1 to 16384"), "{text}: {message}");
        }
    }

    #[test]
    fn whole_keeps_to_its_range() {
        assert_eq!(whole("--n", "1", 1, 9).unwrap(), 1);
        assert_eq!(whole("--n", "9", 1, 9).unwrap(), 9);
        assert_eq!(seed("4294967295").unwrap(), u32::MAX);
        for text in ["0", "10", "-1", "1.0", "1e0", "", "nan", "4294967297", "18446744073709551617"] {
            assert!(whole("--n", text, 1, 9).unwrap_err().to_string().contains("from 1 to 9"), "{text}");
        }
    }

    #[test]
    fn exposure_is_finite_and_bounded() {
        assert_eq!(exposure("-1.5").unwrap(), -1.5);
        for text in ["nan", "inf", "-inf", "65", "-65", "1e99", "bright", ""] {
            assert!(exposure(text).is_err(), "{text}");
        }
    }
}
