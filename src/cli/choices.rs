//! What the user chooses between: methods, ways, pipelines, tones. The help of each choice stands beside it.
//!
//! For: [`MethodArgs`] and an enum for each choice. May import: `clap`. Must never know: what a choice does.

use clap::ValueEnum;

/// How rays meet surfaces.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::Args)]
pub struct MethodArgs {
    /// The equations that hold where others fail; the default, said aloud.
    #[arg(long, conflicts_with = "fast")]
    pub robust: bool,
    /// The fastest equations on the front that `octray chart` measures: in scenes that test every triangle, baldwin-weber, which leaks at edges;
    /// in others the defaults are the fastest.
    #[arg(long)]
    pub fast: bool,
    /// How rays meet spheres [default: robust].
    #[arg(long, value_enum, value_name = "METHOD")]
    pub sphere: Option<SphereMethod>,
    /// How rays meet triangles [default: woop].
    #[arg(long, value_enum, value_name = "METHOD")]
    pub triangle: Option<TriangleMethod>,
    /// How rays meet boxes, those of a hierarchy and a triangle's own [default: padded-fma].
    #[arg(long = "box", value_enum, value_name = "METHOD")]
    pub boxes: Option<BoxMethod>,
    /// How rays find what they meet: it does not change the picture. Of small scenes `needed` tests every primitive; in others it takes
    /// the fastest ways through a hierarchy [default: needed].
    #[arg(long, value_enum, value_name = "WAY")]
    pub traversal: Option<TraversalArg>,
    /// Which emitters paths look for, besides finding them by chance: `auto`, those for which it pays; `on`, all; `off`, none. It
    /// changes the noise, not the picture behind it [default: auto].
    #[arg(long, value_enum, value_name = "CHOICE")]
    pub lights: Option<LightArg>,
    /// Where random numbers come from: well spread points, or numbers independent of each other. It changes the noise, not the picture
    /// behind it [default: sobol].
    #[arg(long, value_enum, value_name = "SAMPLER")]
    pub sampler: Option<SamplerArg>,
}

/// Where random numbers come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SamplerArg {
    /// Owen-scrambled Sobol points.
    Sobol,
    Random,
}

/// Which emitters paths look for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum LightArg {
    Auto,
    On,
    Off,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum TraversalArg {
    /// What suits.
    #[default]
    Needed,
    /// Every primitive is tested.
    Linear,
    /// One ray on the binary tree, without SIMD: the baseline, and what --lanes 1 takes.
    Scalar,
    /// One ray against eight boxes, and against eight primitives.
    Single,
    /// Tiles of camera rays in a frustum, others in streams.
    Packet,
    /// Many rays together down the tree.
    Stream,
    /// What measured fastest for the rays at hand.
    Hybrid,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum SphereMethod {
    /// The discriminant from the perpendicular: holds for small, distant and huge spheres.
    Robust,
    /// The textbook's quadratic formula: loses digits where the other does not.
    Naive,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum TriangleMethod {
    /// Watertight: no ray slips through between neighbours.
    Woop,
    /// The classic: leaks at edges and vertices.
    MollerTrumbore,
    /// Stores an affine map for each triangle: fast, leaks.
    BaldwinWeber,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum BoxMethod {
    /// One multiply-add a plane, padded by what rounding can do: loses no hit.
    PaddedFma,
    /// The same without padding: no faster, and loses hits at corners and edges.
    Fma,
}

/// What the shading stages are compiled for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default, ValueEnum)]
pub enum PipelineArg {
    /// The smallest set of features that holds the scene's needs.
    #[default]
    Needed,
    /// Every feature.
    General,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ToneArg {
    /// Cut it off: true to the radiance up to there.
    Clamp,
    /// x / (1 + x): nothing burns out, everything is darker.
    Reinhard,
    /// The look of film: deep shadows, soft highlights.
    Aces,
}
