//! What one call of `render` makes: a picture, a part of one, or the pictures of frames.
//!
//! For: [`RenderOptions`], and the [`jobs`] of a call.

use super::error::{CliError, refuse};
use super::frames::{frames, numbered, shard};
use super::groups::SCENE;
use super::limits::LimitOptions;
use super::numbers::seconds;
use super::picture::PictureOptions;
use crate::checkpoint::{CheckpointError, Shard, is_checkpoint};
use crate::output::{self, Existing, Format};
use std::ffi::OsString;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::time::Duration;

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
/// defaults for options of this command, by their names; options on the command line override them, and
/// --samples, --time-limit and --target-error its samples.
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
#[derive(Debug, clap::Parser)]
#[command(after_help = "Examples:
  octray render builtin:three -o three.png
  octray render scene.json -o scene.exr --samples 1024 --size 1920x1080
  octray render scene.json -o scene.png --target-error 0.05 --time-limit 600 --samples-map where.png
  octray render scene.json -o scene.exr --samples 4096 --checkpoint scene.part
  octray render scene.json -o 3.part --samples 4096 --shard 3/8
  octray render path.json -o shot-####.png --frames 1..48")]
pub struct RenderOptions {
    #[arg(value_name = "SCENE", help = SCENE)]
    pub scene: OsString,
    /// The picture file: .png, .jpg, .exr or .hdr.
    #[arg(short, long, value_name = "FILE")]
    pub output: PathBuf,
    #[command(flatten)]
    pub limits: LimitOptions,
    /// Also write the number of samples of each pixel: as numbers into .exr and .hdr, as shades (white for
    /// the most, half as bright to the eye for its square root) into .png and .jpg.
    #[arg(long, value_name = "FILE")]
    pub samples_map: Option<PathBuf>,
    /// Save what is done into FILE every few seconds and at the end; if FILE is there, go on from it.
    #[arg(long, value_name = "FILE")]
    pub checkpoint: Option<PathBuf>,
    /// Seconds between two checkpoints [default: 5, or 50 times as long as saving takes].
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true, requires = "checkpoint")]
    pub checkpoint_interval: Option<Duration>,
    /// Render part I of N of the picture into a part file for `octray merge`; with --frames, every N-th
    /// frame.
    #[arg(long, value_name = "I/N", value_parser = shard, allow_hyphen_values = true)]
    pub shard: Option<Shard>,
    /// Render the frames A to B of the keyframes of a view. The last # or row of # in the names of files
    /// becomes the frame's number.
    #[arg(long, value_name = "A..B", value_parser = frames, allow_hyphen_values = true)]
    pub frames: Option<RangeInclusive<u32>>,
    #[command(flatten)]
    pub picture: PictureOptions,
    /// Print the report as JSON (schema octray-render-1).
    #[arg(long)]
    pub json: bool,
    /// Print time by stage, rays by kind, lanes in use by bounce, and box and primitive tests per ray.
    /// Counting takes some time; it does not change the picture.
    #[arg(long)]
    pub stats: bool,
}

/// A film to render, and the files that are made of it.
pub struct Job {
    pub frame: Option<u32>,
    pub output: PathBuf,
    /// The film has the tiles of this shard, and the output is a part: its checkpoint.
    pub shard: Option<Shard>,
    pub checkpoint: Option<PathBuf>,
    pub samples_map: Option<PathBuf>,
}

/// The jobs of a call, with their files checked: they can be written. Frames are a job each; of a shard,
/// every N-th.
pub fn jobs(options: &RenderOptions) -> Result<Vec<Job>, CliError> {
    let jobs: Vec<Job> = match (&options.frames, options.shard) {
        (None, shard) => {
            shard.map_or(Ok(()), |shard| check_shard(shard, options))?;
            vec![job(options, None)?]
        }
        (Some(frames), shard) => {
            let (shard, count) = (shard.unwrap_or(Shard::WHOLE), frames.end() - frames.start() + 1);
            if shard.of > count {
                let instead = format!("there are {count} frames to share: give at most as many parts");
                return Err(refuse_shard(shard, instead));
            }
            let of_shard = frames.clone().enumerate().filter(|(index, _)| shard.has(*index));
            of_shard.map(|(_, frame)| job(options, Some(frame))).collect::<Result<_, _>>()?
        }
    };
    jobs.iter().try_for_each(check)?;
    Ok(jobs)
}

/// An error about `--shard`.
pub fn refuse_shard(Shard { number, of }: Shard, instead: impl AsRef<str>) -> CliError {
    refuse("--shard", format!("{number}/{of}"), instead.as_ref())
}

/// Refuses what a shard of tiles cannot do.
fn check_shard(shard: Shard, options: &RenderOptions) -> Result<(), CliError> {
    let limits = &options.limits;
    let instead = if limits.target_error.is_some() {
        "--target-error decides by the whole picture, of which a shard sees a part: give --samples instead"
    } else if limits.time_limit.is_some() && limits.samples.is_none() {
        "shards join where each has as many samples: with --time-limit give --samples too, and --checkpoint to \
         go on later"
    } else if options.samples_map.is_some() {
        "all pixels of a shard have as many samples: leave out --samples-map"
    } else {
        return Ok(());
    };
    Err(refuse_shard(shard, instead))
}

/// The whole call's, or that of a frame, whose number is in the names of the files.
fn job(options: &RenderOptions, frame: Option<u32>) -> Result<Job, CliError> {
    let name = |option, path: &PathBuf| match frame {
        None => Ok(path.clone()),
        Some(frame) => numbered(path, frame).ok_or_else(|| {
            let instead = "give a name with # in it, such as shot-####.png: there the frame's number will be";
            refuse(option, path.display(), instead)
        }),
    };
    Ok(Job {
        frame,
        output: name("--output", &options.output)?,
        shard: options.shard.filter(|_| frame.is_none()),
        checkpoint: options.checkpoint.as_ref().map(|path| name("--checkpoint", path)).transpose()?,
        samples_map: options.samples_map.as_ref().map(|path| name("--samples-map", path)).transpose()?,
    })
}

fn check(Job { output, shard, checkpoint, samples_map, .. }: &Job) -> Result<(), CliError> {
    if shard.is_some() {
        check_checkpoint("--output", output, "a shard is a part of a picture, for octray merge")?;
    } else {
        Format::of(output)?;
        output::check(output, Existing::Replace)?;
    }
    if let Some(file) = samples_map {
        Format::of(file)?;
        if is_same(file, output) {
            let instead = "it is also the output file: give another file";
            return Err(refuse("--samples-map", file.display(), instead));
        }
        output::check(file, Existing::Replace)?;
    }
    if let Some(file) = checkpoint {
        check_checkpoint("--checkpoint", file, "a checkpoint is no picture")?;
        output::remove_leftovers(file);
        output::remove_leftovers(output);
    }
    Ok(())
}

/// A file that a checkpoint may replace: there is none, or one that is a checkpoint.
fn check_checkpoint(option: &str, file: &Path, what: &str) -> Result<(), CliError> {
    if Format::of(file).is_ok() {
        let instead = format!("{what}: give a name with another ending, such as .part");
        return Err(refuse(option, file.display(), instead));
    }
    output::check(file, Existing::Replace)?;
    if file.exists() && !is_checkpoint(file) {
        return Err(CheckpointError::NotACheckpoint { path: file.to_owned() }.into());
    }
    Ok(())
}

/// Are both the same file, there or not?
pub fn is_same(one: &Path, other: &Path) -> bool {
    place(one) == place(other)
}

/// The canonical path of a file, there or not; the path itself where its folder does not exist.
fn place(path: &Path) -> PathBuf {
    let folder = path.parent().unwrap_or(Path::new("")).join(".").canonicalize();
    let of_new = |folder: PathBuf| path.file_name().map(|name| folder.join(name));
    path.canonicalize().ok().or_else(|| folder.ok().and_then(of_new)).unwrap_or_else(|| path.into())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::picture::of_view;
    use crate::scene::{Loaded, View, load};
    use clap::Parser;
    use serde_json::{Value, json};

    /// Settings, tone mapping and limits of a view with this `render` and of these options.
    fn chosen(render: &Value, options: &Value) -> impl PartialEq + std::fmt::Debug {
        let scene = load("builtin:cornell").unwrap();
        let render = serde_json::from_value(render.clone()).unwrap();
        let view = View { render, ..View::of(&scene, None, Path::new("")) };
        let scene = Loaded { view: Some(view), ..scene.into() };
        let text = |value: &Value| value.as_str().map_or(value.to_string(), str::to_owned);
        let options = options.as_object().unwrap().iter();
        let options = options.flat_map(|(option, value)| [format!("--{option}"), text(value)]);
        let words = ["render", "view.json", "-o", "a.png"].map(String::from).into_iter().chain(options);
        let RenderOptions { picture, limits, .. } = RenderOptions::parse_from(words);
        let limits = limits.limits(of_view(&scene).samples).unwrap();
        (picture.settings(&scene), picture.tone(&scene), limits)
    }

    #[test]
    fn views_mean_the_same_as_options_and_options_override_them() {
        let some = json!({ "samples": 37, "seed": u32::MAX, "exposure": -0.3, "tone": "reinhard", "clamp": 10.1,
            "sphere": "naive", "triangle": "moller-trumbore", "traversal": "linear",
            "lights": "on", "sampler": "random", "pipeline": "general" });
        let other = json!({ "samples": 1, "seed": 2, "exposure": 3, "tone": "aces", "clamp": 4,
            "sphere": "robust", "triangle": "woop", "traversal": "single",
            "lights": "off", "sampler": "sobol", "pipeline": "needed" });
        let none = json!({});
        let by_view = chosen(&some, &none);
        assert_eq!(by_view, chosen(&none, &some));
        assert_ne!(by_view, chosen(&none, &none));
        assert_eq!(chosen(&some, &other), chosen(&none, &other));
    }
}
