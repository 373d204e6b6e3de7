//! Raw arguments: the commands, their options and their help texts.
//!
//! For: [`Args`], with one struct a command. Numbers stay text here and `options` reads them, so that every
//! refusal has the same form.

use super::groups::{LimitArgs, MethodArgs, PictureArgs, choice};
use crate::measure::stability::recipes;
use crate::render::{LaneChoice, PipelineChoice};
use crate::tone::Operator;
use crate::traverse::TraversalChoice;
#[cfg(feature = "viewer")]
use crate::viewer::keys;
use clap::builder::PossibleValuesParser;
use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};

const SCENE: &str = "A scene file (.json), a model (.obj, .gltf, .glb, .ply), or builtin:NAME";

/// A data-oriented path tracer for CPUs.
///
/// Traces 8 or 16 rays at a time with SIMD instructions, and one at a time to check that both give the same
/// picture, bit by bit.
///
/// A SCENE is one of: a scene file (.json, in octray's own format or in the thesis's); a view (.json, format
/// octray-view-1), which names another scene, a camera and options of render: all commands but rays use its
/// camera, and render and view its options; a model (.obj, .gltf, .glb or .ply, framed automatically under a
/// plain sky unless it has a camera); or a built-in scene (builtin:NAME). `octray inspect SCENE` shows what a
/// scene contains.
///
/// Exit codes: 0 success; 1 a check failed; 2 the input cannot be used; 130 Ctrl-C came before the end.
#[derive(Debug, Parser)]
#[command(name = "octray", version, max_term_width = 110, after_help = after_help())]
pub struct Args {
    #[command(subcommand)]
    pub command: Option<Command>,
}

/// The built-in scenes.
fn after_help() -> String {
    let names: Vec<String> = crate::scene::builtin_names().map(|name| format!("builtin:{name}")).collect();
    format!(
        "Built-in scenes: {}; meshes of about N triangles: builtin:knot:N, builtin:terrain:N.",
        names.join(", ")
    )
}

#[derive(Debug, Subcommand)]
pub enum Command {
    Bench(BenchArgs),
    Compare(CompareArgs),
    Render(RenderArgs),
    Merge(MergeArgs),
    Rays(RaysArgs),
    Chart(ChartArgs),
    #[cfg(feature = "viewer")]
    View(ViewArgs),
    Stability(StabilityArgs),
    Convert(ConvertArgs),
    Inspect(InspectArgs),
}

/// Measure frames per second, SIMD beside scalar.
///
/// A frame is one sample per pixel. Each scene is rendered frame after frame, first to warm up, then to
/// measure. Loading and building are not timed. One sample of each scene is also checked: SIMD against
/// scalar, and against a reference in double precision.
///
/// Columns: 16 lanes, 8 lanes, scalar: frames per second on one thread (or --threads), the median, and in
/// brackets the 1 % low (the rate that 99 % of the frames reach). Packets of 16 are measured where they are
/// one vector of the machine. all cores, and Mray/s, millions of rays per second on one thread (or
/// --threads): by the width of --lanes, or that of --lanes auto. 178k is 178,000; a dash stands for what was
/// not measured. pixels≠: pixels in which any width differs from scalar in any bit. hits≠: primary hits that
/// are wrong by the reference. Both should be 0; if not, the exit code is 1. rmse: root mean square error of
/// a frame without next event estimation (--lights off) against the reference on the same random numbers.
///
/// A second table, after the last scene, has ratios of that width: medians of alternating rounds, and in
/// brackets from 10 to 90 % of them. speed-up: over scalar. scaling: all cores over one thread. over general:
/// the pipeline compiled for the features of the scene over the one with every feature; a dash where these
/// are the same.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  octray bench builtin:three --threads 1 --json > bench.json")]
pub struct BenchArgs {
    /// Scene files, models, or builtin:NAME; the built-in bench scenes if none is given.
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Print the figures as JSON (schema octray-bench-1).
    #[arg(long)]
    pub json: bool,
    /// After the measured frames, render some more that are not timed, and print time by stage, rays by kind,
    /// lanes in use by bounce, and box and primitive tests per ray.
    #[arg(long)]
    pub stats: bool,
    /// Worker threads [default: one, and SIMD once more on all cores].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub threads: Option<String>,
    /// Measure one width only [default: scalar and every width that is one vector of the machine].
    #[arg(long, value_name = "LANES", value_parser = choice::<LaneChoice>())]
    pub lanes: Option<LaneChoice>,
    /// Pixels of a frame.
    #[arg(long, value_name = "WxH", default_value = "240x135", allow_hyphen_values = true)]
    pub size: String,
    /// Most scattering events on a path.
    #[arg(long, value_name = "N", default_value = "4", allow_hyphen_values = true)]
    pub bounces: String,
    /// Measured frames for each scene and column [default: at least 50, and as many as fit into two seconds a
    /// scene].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub frames: Option<String>,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value = "0", allow_hyphen_values = true)]
    pub seed: String,
    #[command(flatten)]
    pub methods: MethodArgs,
    /// Features that the pipeline is compiled for: the pictures are the same, the speed is not.
    #[arg(long, value_name = "PIPELINE", default_value = PipelineChoice::default().name(), value_parser = choice::<PipelineChoice>())]
    pub pipeline: PipelineChoice,
}

/// Check that SIMD and scalar render the same picture.
///
/// Renders each scene at every width (1, 8 and, with AVX-512, 16) and counts the pixels that differ in any
/// bit: 0 is expected. Then they are compared with a reference in double precision that shares no code with
/// them. Exits with 1 if a pixel differs, a sample is not finite, or a primary hit is wrong; differing pixels
/// are allowed with --box fma, and wrong hits with any method that is not robust. All widths are always
/// compared, so there is no --lanes.
///
/// Columns: differing: pixels that differ. speed-up: SIMD over scalar, the median, and in brackets from 10 to
/// 90 % of the rounds. rmse/f64, max/f64: root mean square and largest difference from the reference. wrong
/// hits: primary hits that are wrong by the reference. Samples are timed on all cores at once, where other
/// programs disturb them: `octray bench` measures the speed-up on one.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  octray compare builtin:three --samples 64")]
pub struct CompareArgs {
    /// Scene files, models, or builtin:NAME; the built-in scenes if none is given.
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Print the figures as JSON (schema octray-compare-1; of hashes octray-hash-1).
    #[arg(long)]
    pub json: bool,
    /// Worker threads [default: all cores].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub threads: Option<String>,
    /// Only print a hash of each scene's film, equal on every machine: FNV-1a (64 bits) of width and height
    /// (u32) and of the linear RGB of all pixels by rows (f32), little-endian. "fused" or "plain" says
    /// whether this build has fused multiply-add; films of the two kinds differ.
    #[arg(long)]
    pub hash: bool,
    /// Pixels of the pictures.
    #[arg(long, value_name = "WxH", default_value = "240x135", allow_hyphen_values = true)]
    pub size: String,
    /// Most scattering events on a path.
    #[arg(long, value_name = "N", default_value = "4", allow_hyphen_values = true)]
    pub bounces: String,
    /// Samples per pixel.
    #[arg(long, value_name = "N", default_value = "16", allow_hyphen_values = true)]
    pub samples: String,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value = "0", allow_hyphen_values = true)]
    pub seed: String,
    #[command(flatten)]
    pub methods: MethodArgs,
    /// Features that the pipeline is compiled for: the pictures are the same, the speed is not.
    #[arg(long, value_name = "PIPELINE", default_value = PipelineChoice::default().name(), value_parser = choice::<PipelineChoice>())]
    pub pipeline: PipelineChoice,
}

/// Render a picture into a file.
///
/// The file's extension decides its format: .png and .jpg for display (exposure, tone mapping, sRGB), .exr
/// and .hdr for linear radiance. The file is written at the end, and replaces an existing one then.
///
/// Without limits, every pixel gets 64 samples. --samples, --time-limit and --target-error can be combined:
/// the first one reached ends the rendering, and the report says which.
///
/// --target-error estimates the error of blocks of 16×16 pixels after 16, 32, 64, … samples. A block's error
/// is the root mean square of the standard errors of its pixels' luminance, each relative to the pixel's
/// luminance, or to the block's mean where the pixel is brighter, or to a tenth of the picture's brightness
/// where it is darker. E bounds the root mean square over the picture, 2 E the error of every block. Blocks
/// stop when they reach the target, so that difficult ones get more samples, and may keep more error. The
/// estimate comes from the samples themselves: it can miss light that hardly any sample finds, such as
/// caustics. Stopping by it is biased: blocks with a low estimate by chance stop early, mostly those that
/// have missed such light, and are too dark: by less than a fiftieth of a per cent in most scenes, by some
/// per cent where much light comes from one path in ten thousand. Where all pixels have the same number of
/// samples, there is no bias.
///
/// A view (a .json file of the format octray-view-1) names another scene and a camera. Its `render` holds
/// defaults for options of this command, by their names; options on the command line override them. --fast
/// and --robust override all its intersection methods, and --samples, --time-limit and --target-error its
/// samples.
///
/// --checkpoint makes a rendering restartable: after a crash, Ctrl-C or a time limit, the same command goes
/// on, and its picture has the bits of a run that was never interrupted. More --samples go on from the same
/// file too. Time limits count from each start, and for each frame. A checkpoint of another scene, of other
/// settings, or by an octray of another version or rounding is refused. If it cannot be saved, a warning says
/// so, the earlier one stays and the rendering goes on; if that is still so at the end, the picture is
/// written and the exit code is 2.
///
/// --shard divides a picture among machines: part I of N has every N-th tile of 16×16 pixels. `octray merge`
/// joins the parts into the bits of one run. A part is a checkpoint: with the same name for --checkpoint and
/// --output it goes on where it was interrupted.
///
/// Ctrl-C ends the rendering early: the picture so far is written, the exit code is 130, and with --json
/// `interrupted` is true. If a sample of the whole picture takes long, some parts then have one sample more
/// than others; parts without a sample are black; if no part has a sample, nothing is written. A second
/// Ctrl-C ends the program at once and writes nothing; the last checkpoint stays.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  octray render builtin:three -o three.png
  octray render scene.json -o scene.exr --samples 1024 --size 1920x1080
  octray render scene.json -o scene.png --target-error 0.05 --time-limit 600 --samples-map where.png
  octray render scene.json -o scene.exr --samples 4096 --checkpoint scene.part
  octray render scene.json -o 3.part --samples 4096 --shard 3/8
  octray render path.json -o shot-####.png --frames 1..48")]
pub struct RenderArgs {
    #[arg(value_name = "SCENE", help = SCENE)]
    pub scene: String,
    /// The picture file: .png, .jpg, .exr or .hdr.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub limits: LimitArgs,
    /// Also write the number of samples of each pixel: as numbers into .exr and .hdr, as shades (white for
    /// the most, half as bright to the eye for its square root) into .png and .jpg.
    #[arg(long, value_name = "FILE")]
    pub samples_map: Option<PathBuf>,
    /// Save what is done into FILE every few seconds and at the end; if FILE is there, go on from it.
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Seconds between two checkpoints [default: 5, or 50 times as long as saving takes].
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true, requires = "checkpoint")]
    pub checkpoint_interval: Option<String>,
    /// Render part I of N of the picture into a part file for `octray merge`; with --frames, every N-th
    /// frame.
    #[arg(long, value_name = "I/N", allow_hyphen_values = true)]
    pub shard: Option<String>,
    /// Render the frames A to B of the keyframes of a view. The last # or row of # in the names of files
    /// becomes the frame's number.
    #[arg(long, value_name = "A..B", allow_hyphen_values = true)]
    pub frames: Option<String>,
    #[command(flatten)]
    pub picture: PictureArgs,
    /// Print the report as JSON (schema octray-render-1).
    #[arg(long)]
    pub json: bool,
    /// Print time by stage, rays by kind, lanes in use by bounce, and box and primitive tests per ray.
    /// Counting takes some time; it does not change the picture.
    #[arg(long)]
    pub stats: bool,
}

/// Join the parts of a picture that was rendered in shards.
///
/// The parts come from `octray render --shard I/N -o PART`. The picture has the bits of one run. Parts that
/// are missing, doubled, incomplete or of other pictures are named, and nothing is written. A checkpoint of a
/// whole picture is a part too, the only one.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:
  octray merge *.part -o scene.exr")]
pub struct MergeArgs {
    #[arg(value_name = "PART", required = true, help = "The parts, in any order")]
    pub parts: Vec<PathBuf>,
    /// The picture file: .png, .jpg, .exr or .hdr.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    /// Brighten (above 0) or darken (below 0) the displayed picture by so many stops of a factor of two
    /// [default: the parts'].
    #[arg(long, value_name = "STOPS", allow_hyphen_values = true)]
    pub exposure: Option<String>,
    /// Tone mapping of the displayed picture [default: the parts'].
    #[arg(long, value_name = "OPERATOR", value_parser = choice::<Operator>())]
    pub tone: Option<Operator>,
    /// Print the report as JSON (schema octray-merge-1).
    #[arg(long)]
    pub json: bool,
}

/// Measure rays per second, by kind of ray and traversal.
///
/// Three kinds: primary rays from a camera that sees the whole scene (blocks of 4×4 pixels), one shadow ray
/// from each of their hits (cosine-weighted, a quarter of the scene's diagonal long, any hit), and one
/// diffuse ray from each (cosine-weighted, nearest hit). They are traced from prepared arrays, whose
/// preparation is not timed. All traversals are measured in alternation.
///
/// Columns: rays, hits: their numbers. lanes: rays traced at a time. Mray/s: millions of rays per second, the
/// median; beside it from 10 to 90 % of the passes. differ: rays whose hit is not that of one scalar ray at a
/// time. It should be 0; if not, the exit code is 1. A warning tells where other programs took the processor:
/// a tenth of the passes, of a millisecond or more, much slower than the median.
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
    /// Trace all rays once more without timing, and print box, triangle and sphere tests per ray.
    #[arg(long)]
    pub stats: bool,
    /// Write rays, nearest hits and triangles into this folder, for other programs to trace; perf/README.md
    /// describes the format.
    #[arg(long, value_name = "DIR")]
    pub dump: Option<PathBuf>,
    /// Pixels, one primary ray each.
    #[arg(long, value_name = "WxH", default_value = "960x540", allow_hyphen_values = true)]
    pub size: String,
    /// Worker threads [default: one, and once more all cores].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub threads: Option<String>,
    /// Measure this traversal only; `needed` measures all that suit the kind of rays.
    #[arg(long, value_name = "TRAVERSAL", default_value = TraversalChoice::default().name(), value_parser = choice::<TraversalChoice>())]
    pub traversal: TraversalChoice,
    /// Measured passes for each traversal [default: at least 10, and as many as fit into a second for each
    /// kind of ray].
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub passes: Option<String>,
    /// Seed of the random numbers.
    #[arg(long, value_name = "N", default_value = "0", allow_hyphen_values = true)]
    pub seed: String,
}

/// Chart speed against accuracy.
///
/// Five charts: intersection methods (cost of a test beside failures and errors, at the widest vector of the
/// machine and scalar), pictures (error against time for every configuration, from one sample per pixel on,
/// with the Pareto front as one line), frames (the error of a window's accumulated picture after a short
/// time), display (one picture unfiltered, blurred, with FXAA, and denoised), and motion (frames of a moving
/// camera with one sample per pixel, unfiltered, reprojected, and also denoised). Errors are measured against
/// a ground truth that is rendered first, with other random numbers, and cached in the folder for the next
/// run; those in motion against ground truths of their own.
///
/// Times in drawings are multiples of the default's, so that charts of different machines can be compared;
/// seconds are in the tables. A plane has at most six lines; more are spread over several.
///
/// Writes report.html (one page that needs no other file), an .svg for each figure, .csv tables and
/// chart.json. Exits with 1 if a configuration that must give the default's picture, bit by bit, gives
/// another.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  octray chart builtin:three builtin:cornell -o charts --budget 60")]
pub struct ChartArgs {
    /// Scene files, models, or builtin:NAME; the built-in scenes if none is given.
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// The folder for all files; created if it does not exist.
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Also print the figures as JSON (schema octray-chart-1).
    #[arg(long)]
    pub json: bool,
    /// Time for the whole run: a longer one has more samples, narrower bands and a better ground truth
    /// [default: 20 for each scene].
    #[arg(long, value_name = "SECONDS", allow_hyphen_values = true)]
    pub budget: Option<String>,
    /// Pixels of a frame; multiples of 3, because the pictures of the pictures chart have a third of its
    /// width and height.
    #[arg(long, value_name = "WxH", default_value = "240x135", allow_hyphen_values = true)]
    pub size: String,
    /// Most scattering events on a path.
    #[arg(long, value_name = "N", default_value = "4", allow_hyphen_values = true)]
    pub bounces: String,
    /// Random seeds behind every median: 8 or more.
    #[arg(long, value_name = "N", default_value = "8", allow_hyphen_values = true)]
    pub seeds: String,
}

/// Walk through scenes in a terminal or, in builds with it, a window.
///
/// The picture accumulates samples while the camera stands still, up to 65,536 per pixel: after N of them it
/// has the bits of `octray render --samples N`. While the camera moves, earlier frames are reprojected. Where
/// the window has room, it shows each pixel larger. Scenes can be dropped on the window. A scene whose files
/// change is loaded again; if it cannot be read, the old one stays and the reason is shown.
///
/// Two rates are shown: frames per second of the screen, at most the display's, and samples per second of the
/// renderer alone, which are the fps of `octray bench` with the same scene, size, bounces, lanes and threads.
///
/// A build with --features window opens a window. Others, and --terminal, draw with half-block characters in
/// true colour, which needs no display and takes the same keys except Shift, Ctrl and mouse movement. Ctrl-C
/// ends the viewer, with exit code 0.
#[cfg(feature = "viewer")]
#[derive(Debug, clap::Args)]
#[command(after_help = view_after_help())]
pub struct ViewArgs {
    /// Scene files, models, folders of them, or builtin:NAME; the built-in scenes if none is given.
    #[arg(value_name = "SCENE")]
    pub scenes: Vec<String>,
    /// Draw in this terminal instead of a window.
    #[arg(long)]
    pub terminal: bool,
    /// Keep at least so many frames per second, with coarser pixels where necessary.
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub target_fps: Option<String>,
    /// The folder for screenshots.
    #[arg(long, value_name = "FOLDER", default_value = ".")]
    pub screenshots: PathBuf,
    /// End after so many frames.
    #[arg(long, value_name = "N", allow_hyphen_values = true)]
    pub frames: Option<String>,
    /// At the end, print frame rates and times as JSON (schema octray-window-1).
    #[arg(long)]
    pub json: bool,
    #[command(flatten)]
    pub picture: PictureArgs,
}

/// Keys and examples.
#[cfg(feature = "viewer")]
fn view_after_help() -> String {
    let keys: Vec<String> = keys::help().map(|line| format!("  {line}")).collect();
    let examples = "Examples:
  octray view
  octray view scene.json model.obj scenes/
  octray view builtin:thesis --terminal
  octray view builtin:three --frames 600 --json > view.json";
    format!("Keys:\n{}\n\n{examples}", keys.join("\n"))
}

/// Measure where methods fail.
///
/// Runs every method on cases that are numerically difficult: intersection of spheres, triangles and boxes,
/// offsets of rays that leave surfaces, texture lookup, scattering, light sampling, sums of samples, cameras
/// and whole scenes; far away, huge, tiny, at edges, in the planes of faces, close to each other. All methods
/// get the same cases and are compared with double precision. The verdict comes first, then a table a recipe:
/// failure rates and errors by distance, scale or shape. The seeds are fixed: the figures are the same in
/// every run and on any number of threads, and differ slightly between builds with and without FMA. Exits
/// with 1 if a default method exceeds its bounds. All recipes together take about half a minute on two cores.
#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  octray stability
  octray stability --only spheres-far mesh-edges -o charts
  octray stability --json > stability.json")]
pub struct StabilityArgs {
    /// Print the figures as JSON (schema octray-stability-1).
    #[arg(long)]
    pub json: bool,
    /// Also write the JSON and a chart of each recipe (SVG) into this folder; created if it does not exist.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Try ten times as many cases, millions, for failures that are rarer; some five minutes on two cores.
    #[arg(long)]
    pub thorough: bool,
    /// Run these recipes only.
    #[arg(long, value_name = "NAME", num_args = 1.., value_parser = PossibleValuesParser::new(recipes().map(|recipe| recipe.name)))]
    pub only: Vec<String>,
}

/// Convert a mesh to a scene file.
///
/// Writes a scene in octray's own format: the model, its materials, its camera or one that frames it, and a
/// plain sky. The scene file holds every triangle and does not need the model file. Textures stay where they
/// are, and the scene file names them relative to its own folder; those inside the model are written beside
/// it. An existing scene file is kept unless --force is given.
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example:\n  octray convert bunny.obj bunny.json && octray render bunny.json -o bunny.png"
)]
pub struct ConvertArgs {
    /// A model: Wavefront OBJ, glTF 2.0 (.gltf, .glb) or PLY.
    #[arg(value_name = "MODEL")]
    pub model: PathBuf,
    /// The scene file to write.
    #[arg(value_name = "SCENE.json", required_unless_present = "output")]
    scene: Option<PathBuf>,
    /// The scene file to write, instead of the second argument.
    #[arg(short, long, value_name = "SCENE.json", conflicts_with = "scene")]
    output: Option<PathBuf>,
    /// Replace SCENE.json if it exists.
    #[arg(long)]
    pub force: bool,
}

impl ConvertArgs {
    /// The scene file to write; the parser makes sure that there is just one.
    pub fn scene(&self) -> &Path {
        self.scene.as_deref().or(self.output.as_deref()).expect("clap requires one of the two")
    }
}

/// Show what a scene contains.
///
/// Prints the numbers of objects, materials and textures, their memory, the camera, and warnings about the
/// file; the features that the scene needs; the traversal and why, either testing every primitive or a
/// hierarchy of boxes, which is built, timed and checked; and the default methods and why. Exits with 1 if
/// the hierarchy is invalid.
#[derive(Debug, clap::Args)]
#[command(after_help = "Example:\n  octray inspect builtin:three --json")]
pub struct InspectArgs {
    #[arg(value_name = "SCENE", help = SCENE)]
    pub scene: String,
    /// Print the report as JSON (schema octray-inspect-1).
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
