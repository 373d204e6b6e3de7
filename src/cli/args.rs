//! What the user typed: the arguments' names, shapes and help.
//!
//! For: [`Args`] and one struct a command. May import: `clap`, and the names of recipes. Must never know: which values make sense; numbers stay text
//! here, and `options` reads them, so that every refusal has the same form.

use super::choices::{MethodArgs, PipelineArg, TraversalArg};
use super::picture::PictureArgs;
use crate::measure::stability::recipes;
use clap::builder::PossibleValuesParser;
use clap::{Parser, Subcommand};
use std::path::PathBuf;

const SCENE: &str = "A scene file (.json), a model (.obj), or builtin:NAME";

/// A data-oriented path tracer for CPUs.
///
/// Traces eight rays at a time with SIMD instructions, and one at a time to check that the two agree. A scene is a file
/// (.json), a model (.obj; framed automatically under a plain sky) or a built-in scene (builtin:NAME). The file may be a view of another
/// scene: every command takes the camera from it, and render and view its options.
///
/// Exit codes: 0 success; 1 a check failed; 2 the input cannot be used; 130 Ctrl-C came before the end.
#[derive(Debug, Parser)]
#[command(name = "octray", version, max_term_width = 110)]
pub struct Args {
    #[command(subcommand)]
    pub command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub enum Command {
    Bench(BenchArgs),
    Compare(CompareArgs),
    Render(RenderArgs),
    Rays(RaysArgs),
    Chart(ChartArgs),
    #[cfg(feature = "viewer")]
    View(super::view::ViewArgs),
    Stability(StabilityArgs),
    Convert(ConvertArgs),
    Inspect(InspectArgs),
}

/// Measure frames per second, SIMD beside scalar.
///
/// A frame is one sample per pixel. Each scene is rendered frame after frame, first to warm up and then to measure; the
/// median is reported with its spread, and beside it the rays per second. Loading, building and writing files are not
/// counted.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  octray bench builtin:three --threads 1 --json > bench.json")]
pub struct BenchArgs {
    /// Scene files, models, or builtin:NAME; the built-in bench scenes if none is given.
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Print the figures as JSON (schema octray-bench-1).
    #[arg(long)]
    pub json: bool,
    /// After the measured frames, render some more that are not, and say where their time goes (by stage), how many rays there are of
    /// each kind, how full their packets are, and how many boxes and primitives a ray is tested against.
    #[arg(long)]
    pub stats: bool,
    /// Worker threads [default: one, and SIMD once more on all cores].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub threads: Option<String>,
    /// Measure one width only: 1 (scalar) or 8 (SIMD) [default: both].
    #[arg(long, value_name = "1|8", allow_hyphen_values = true)]
    pub lanes: Option<String>,
    /// Pixels of a frame.
    #[arg(long, value_name = "WxH", default_value = "240x135", allow_hyphen_values = true)]
    pub size: String,
    /// Scattering events allowed on a path.
    #[arg(long, value_name = "N", default_value = "4", allow_hyphen_values = true)]
    pub bounces: String,
    /// Frames measured for each scene and engine [default: at least 50, and as many as two seconds a scene hold].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub frames: Option<String>,
    /// Which random numbers to use.
    #[arg(long, value_name = "N", default_value = "0", allow_hyphen_values = true)]
    pub seed: String,
    #[command(flatten)]
    pub methods: MethodArgs,
    /// Compiled for what the scene needs, or with every feature: the pictures are the same, the speed is not.
    #[arg(long, value_enum, value_name = "PIPELINE", default_value_t)]
    pub pipeline: PipelineArg,
}

/// Check that SIMD and scalar render the same picture.
///
/// Renders each scene at both widths and counts the pixels that differ in any bit: 0 is expected. Then both are held
/// against a reference in double precision that shares no equation with them. Exits with 1 if a pixel differs, a sample was not
/// finite, or, unless a naive method was asked for, a primary hit is wrong.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  octray compare builtin:three --samples 64")]
pub struct CompareArgs {
    /// Scene files, models, or builtin:NAME; the built-in scenes if none is given.
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Print the figures as JSON (schema octray-compare-1).
    #[arg(long)]
    pub json: bool,
    /// Worker threads [default: all cores].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub threads: Option<String>,
    /// Pixels of the pictures.
    #[arg(long, value_name = "WxH", default_value = "240x135", allow_hyphen_values = true)]
    pub size: String,
    /// Scattering events allowed on a path.
    #[arg(long, value_name = "N", default_value = "4", allow_hyphen_values = true)]
    pub bounces: String,
    /// Samples per pixel.
    #[arg(long, value_name = "N", default_value = "16", allow_hyphen_values = true)]
    pub samples: String,
    /// Which random numbers to use.
    #[arg(long, value_name = "N", default_value = "0", allow_hyphen_values = true)]
    pub seed: String,
    #[command(flatten)]
    pub methods: MethodArgs,
    /// Compiled for what the scene needs, or with every feature: the pictures are the same, the speed is not.
    #[arg(long, value_enum, value_name = "PIPELINE", default_value_t)]
    pub pipeline: PipelineArg,
}

/// Render a picture into a file.
///
/// The file's extension names its format: .png and .jpg for screens (exposure, tone mapping, sRGB), .exr and .hdr for the
/// linear radiance. The file appears whole, at the end; one that was there before is replaced then.
///
/// Without limits of your own, every pixel gets 64 samples. --samples, --time-limit and --target-error may be combined: the first that is
/// reached ends the rendering, and the report says which.
///
/// --target-error looks at blocks of 16×16 pixels after 16, 32, 64, … samples. A block's error is the standard error of its pixels' luminance
/// (root mean square), as a share of the pixel's luminance, of the block's mean where the pixel is brighter than that, and of a tenth of the
/// picture's brightness where it is darker. E bounds the root mean square over the picture, 2 E every block; blocks that are easy stop early, and
/// those that are harder than others get more samples, and may keep more error. It is an estimate from the samples themselves: light that
/// hardly any sample finds, such as caustics, may be missed by it. And it is biased in principle: blocks that look calm by chance stop, mostly
/// those that have missed such light, and are a little too dark: by less than a fiftieth of a per cent in most scenes, by some per cent where
/// much light comes by one path in ten thousand. Where all pixels have the same number of samples, nothing is biased.
///
/// A view (a .json file of the format octray-view-1) names another scene and says how it is looked at. Its `render` holds defaults for options of
/// this command, by their names; an option given here wins. --fast and --robust win over all its equations, and --samples, --time-limit and
/// --target-error over its samples.
///
/// Ctrl-C ends the rendering early: the samples so far are written as a picture, the exit code is 130, and with --json `interrupted` is
/// true. In scenes where a sample takes long, some parts of the picture then have one sample more than others; those that have had none
/// are black; where no part has had one yet, nothing is written. A second Ctrl-C ends the program at once and writes nothing.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  octray render builtin:three -o three.png
  octray render scene.json -o scene.exr --samples 1024 --size 1920x1080
  octray render scene.json -o scene.png --target-error 0.05 --time-limit 600 --samples-map where.png")]
pub struct RenderArgs {
    #[arg(value_name = "SCENE", help = SCENE)]
    pub scene: String,
    /// Where the picture goes: .png, .jpg, .exr or .hdr.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub limits: LimitArgs,
    /// Also write how many samples each pixel has had: as they are into .exr and .hdr, as shades (white for the most, half as bright to the eye for
    /// the square root of it) into .png and .jpg.
    #[arg(long, value_name = "FILE")]
    pub samples_map: Option<PathBuf>,
    #[command(flatten)]
    pub picture: PictureArgs,
    /// Print what was done as JSON (schema octray-render-1).
    #[arg(long)]
    pub json: bool,
    /// Say where the time goes (by stage), how many rays there are of each kind, how full their packets are, and how many boxes and
    /// primitives a ray is tested against. Counting takes some time, and does not change the picture.
    #[arg(long)]
    pub stats: bool,
}

/// When a rendering ends.
#[derive(Debug, clap::Args)]
pub struct LimitArgs {
    /// Samples per pixel: four times as many halve the noise [default: 64; with --target-error at most 16384; with --time-limit as many as
    /// it holds].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub samples: Option<String>,
    /// Stop where the picture is good enough: at a relative standard error of E over the picture, such as 0.05 for five per cent, and 2 E in
    /// every block of 16×16 pixels. Parts that are easy stop early.
    #[arg(long, value_name = "E", allow_hyphen_values = true)]
    pub target_error: Option<String>,
    /// With --target-error: samples that every pixel gets before anything is judged [default: 16].
    #[arg(long, value_name = "N", allow_hyphen_values = true, requires = "target_error")]
    pub min_samples: Option<String>,
    /// Stop after so many seconds of tracing, between samples of the whole picture where one fits; loading and writing come on top.
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub time_limit: Option<String>,
}

/// Measure rays per second, by kind of ray and way of tracing.
///
/// Three kinds: primary rays from a camera that sees the whole scene (4×2 pixels a packet), one shadow ray from each of their hits
/// (cosine-weighted, a quarter of the scene's diagonal long, any hit), and one diffuse ray from each (cosine-weighted, nearest
/// hit). They are traced from prepared arrays, and making them is not counted. All ways of tracing take turns; the
/// median is reported with its spread. Exits with 1 if any way finds another hit than one scalar ray at a time does.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  octray rays bunny.obj
  octray rays builtin:knot:1000000 --size 240x135 --threads 1 --json > rays.json
  octray rays bunny.obj --dump bunny-rays")]
pub struct RaysArgs {
    #[arg(value_name = "SCENE", help = SCENE)]
    pub scene: String,
    /// Print the figures as JSON (schema octray-rays-1).
    #[arg(long)]
    pub json: bool,
    /// Trace all rays once more, outside of what is measured, and say how many boxes, triangles and spheres a ray is tested against.
    #[arg(long)]
    pub stats: bool,
    /// Write rays, nearest hits and triangles into this folder, for other programs to trace; perf/README.md has the format.
    #[arg(long, value_name = "DIR")]
    pub dump: Option<PathBuf>,
    /// Pixels that primary rays go through.
    #[arg(long, value_name = "WxH", default_value = "960x540", allow_hyphen_values = true)]
    pub size: String,
    /// Worker threads [default: one, and once more all cores].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub threads: Option<String>,
    /// Measure one way of tracing only; `needed` are all that suit the kind of rays.
    #[arg(long, value_enum, value_name = "WAY", default_value_t)]
    pub traversal: TraversalArg,
    /// Passes measured for each way [default: at least 7, and as many as a second for each kind of ray holds].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub passes: Option<String>,
    /// Which random numbers to use.
    #[arg(long, value_name = "N", default_value = "0", allow_hyphen_values = true)]
    pub seed: String,
}

/// Chart speed against accuracy.
///
/// Five charts: the equations alone (nanoseconds a test against failures and errors), pictures (error against time for every way to render,
/// from one sample a pixel on, with the Pareto front marked), frames (what has accumulated in a window after a moment), display (one picture
/// as it is, blurred, with FXAA, and denoised), and motion (a moving camera's frames of one sample, as they are, reprojected, and denoised
/// besides). Errors are held against a truth that is rendered first, with other random numbers, and kept in the folder for the next run; those
/// in motion against truths of their own.
///
/// Writes report.html (one page that needs no other file), an .svg a figure, .csv tables and chart.json. Exits with 1 if a way that promises
/// the default's very picture gave another.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  octray chart builtin:three builtin:cornell -o charts --budget 60")]
pub struct ChartArgs {
    /// Scene files, models, or builtin:NAME; the built-in scenes if none is given.
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// The folder for all files; made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Print the figures as JSON too (schema octray-chart-1).
    #[arg(long)]
    pub json: bool,
    /// Time for everything together: more of it means more samples, smaller bands, and a better truth [default: 20 for each scene].
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub budget: Option<String>,
    /// Pixels of a frame; multiples of 3, as pictures for the first chart have a third of them in width and height.
    #[arg(long, value_name = "WxH", default_value = "240x135", allow_hyphen_values = true)]
    pub size: String,
    /// Scattering events allowed on a path.
    #[arg(long, value_name = "N", default_value = "4", allow_hyphen_values = true)]
    pub bounces: String,
    /// Pictures behind every median: as many random seeds, 8 or more.
    #[arg(long, value_name = "N", default_value = "8", allow_hyphen_values = true)]
    pub seeds: String,
}

/// Show where methods fail.
///
/// Makes every method fail on purpose: of intersecting spheres, triangles and boxes, of leaving surfaces, of reading pictures, of scattering and aiming
/// at lamps, of summing samples, of cameras and whole scenes; far away, huge, tiny, at edges, in planes of faces, close to each other. Every method gets the same cases, judged in double precision; how often it fails and how far it is off
/// stands in a table, by distance, scale or shape. The seeds are fixed: the figures are the same on every run and any number of threads, and
/// differ a little between builds with and without FMA. Exits with 1 if a default method does not keep its bounds.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  octray stability
  octray stability --only spheres-far mesh-edges -o charts
  octray stability --json > stability.json")]
pub struct StabilityArgs {
    /// Print the figures as JSON (schema octray-stability-1).
    #[arg(long)]
    pub json: bool,
    /// Also write the JSON and a chart of each recipe (SVG) into this folder, which is made if it is not there.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Run these recipes only.
    #[arg(long, value_name = "NAME", num_args = 1.., value_parser = PossibleValuesParser::new(recipes().map(|recipe| recipe.name)))]
    pub only: Vec<String>,
}

/// Turn a mesh into a scene file.
///
/// Writes a scene in octray's own format that shows the model: a camera that frames it, a plain sky, its materials. The
/// scene file holds every triangle and no longer needs the model file. Textures stay where they are, and the scene file
/// names them relative to its own folder. An existing file is kept unless --force is given.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  octray convert bunny.obj bunny.json && octray render bunny.json -o bunny.png"
)]
pub struct ConvertArgs {
    /// A Wavefront OBJ file.
    #[arg(value_name = "MODEL.obj")]
    pub model: PathBuf,
    /// The scene file to write.
    #[arg(value_name = "SCENE.json")]
    pub scene: PathBuf,
    /// Replace SCENE.json if it exists.
    #[arg(long)]
    pub force: bool,
}

/// Show what a scene holds.
///
/// Counts its objects, materials and textures, says how much memory they take and where the camera stands, and repeats what
/// was odd about the file. Says which way its rays go and why: whether every primitive is tested or a hierarchy of boxes leads to the
/// few that matter; such a hierarchy is built, timed and checked. Says which methods it gets unless others are asked for, and why. Exits with 1 if it is not valid.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  octray inspect builtin:three --json")]
pub struct InspectArgs {
    #[arg(value_name = "SCENE", help = SCENE)]
    pub scene: String,
    /// Print it as JSON (schema octray-inspect-1).
    #[arg(long)]
    pub json: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn args_are_consistent_in_claps_own_judgement() {
        Args::command().debug_assert();
    }
}
