//! The films that one call of `render` makes: a picture, a part of one, or the pictures of frames.

use super::denoise::raw_file;
use super::error::{CliError, refuse};
use super::limits::LimitOptions;
use super::numbers::seconds;
use super::options::{PictureOptions, SCENE};
use super::outputs::{is_same, keep_inputs};
use crate::checkpoint::{CheckpointError, Shard, is_checkpoint};
use crate::output::{self, Existing, Format};
use std::ffi::OsString;
use std::ops::RangeInclusive;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// Render a picture into a file.
///
/// The file's ending decides its format: .png and .jpg for display, .exr and .hdr for linear radiance. It
/// replaces an existing one.
///
/// --target-error estimates the error of blocks of 16×16 pixels after 16, 32, 64, … samples: the root mean
/// square of the standard errors of their luminance, relative to it, or to the block's mean where a pixel is
/// brighter, or to a tenth of the picture's brightness where it is darker. It can miss light that hardly any
/// sample finds, such as caustics; blocks that stop too early are too dark, mostly by less than 0.02 %.
///
/// A view (.json, format octray-view-1) has defaults for options in its `render`; any limit given replaces
/// its samples. With --checkpoint the same command goes on after a crash, Ctrl-C or a time limit, also with
/// more --samples, to the bits of one run; time limits count from each start and frame. A checkpoint of
/// another scene, setting, version or rounding is refused. If it cannot be saved, a warning says so; if not
/// at the end either, the exit code is 2. With --shard, part I of N has every N-th tile of 16×16 pixels, and
/// `octray merge` joins the parts into the bits of one run; a part that --checkpoint names too goes on.
///
/// Ctrl-C, SIGTERM and SIGHUP write the picture so far (exit code 130); pixels without a sample are black. A
/// second one writes nothing.
#[derive(Debug, clap::Parser)]
#[command(after_long_help = "Examples:
  octray render builtin:three -o three.png
  octray render scene.json -o scene.png --samples 64 --size 1920x1080 --denoise
  octray render scene.json -o scene.png --target-error 0.05 --time-limit 600
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
    /// Denoise (softens sharp shadows); the raw film is FILE.raw.exr.
    #[arg(long)]
    pub denoise: bool,
    /// Also write albedo, normal, depth and more as layers (.exr).
    #[arg(long, value_name = "FILE", help_heading = LONG, hide_short_help = true)]
    pub aovs: Option<PathBuf>,
    /// Also write the samples of each pixel (.exr: numbers, .png: shades).
    #[arg(long, value_name = "FILE", help_heading = LONG, hide_short_help = true)]
    pub samples_map: Option<PathBuf>,
    /// Save every few seconds, and go on from there.
    #[arg(long, value_name = "FILE", help_heading = LONG)]
    pub checkpoint: Option<PathBuf>,
    /// Seconds between checkpoints [default: 5, or 50 × the time of saving].
    #[arg(long, value_name = "SECONDS", value_parser = seconds, allow_hyphen_values = true, requires = "checkpoint", help_heading = LONG, hide_short_help = true)]
    pub checkpoint_interval: Option<Duration>,
    /// Part I of N for octray merge; of frames every N-th.
    #[arg(long, value_name = "I/N", value_parser = shard, allow_hyphen_values = true, help_heading = LONG)]
    pub shard: Option<Shard>,
    /// Frames of a view's keyframes; # is their number.
    #[arg(long, value_name = "A..B", value_parser = frames, allow_hyphen_values = true, help_heading = LONG)]
    pub frames: Option<RangeInclusive<u32>>,
    #[command(flatten)]
    pub picture: PictureOptions,
    /// Print the report as JSON (schema octray-render-1).
    #[arg(long)]
    pub json: bool,
    /// Print time by stage, rays, SIMD use, tests per ray.
    #[arg(long)]
    pub stats: bool,
}

/// The heading of options for renderings of many hours, machines or frames.
const LONG: &str = "Long renderings";

/// A film to render, and the files that are made of it.
pub struct Job {
    pub frame: Option<u32>,
    pub output: PathBuf,
    /// The film has the tiles of this shard, and the output is a part: its checkpoint.
    pub shard: Option<Shard>,
    pub checkpoint: Option<PathBuf>,
    pub samples_map: Option<PathBuf>,
    /// The file of the raw film of a denoised picture.
    pub raw: Option<PathBuf>,
    pub aovs: Option<PathBuf>,
}

/// Returns the jobs of a call, with their files checked: they can be written. Frames are a job each; of a
/// shard, every N-th.
pub fn jobs(options: &RenderOptions) -> Result<Vec<Job>, CliError> {
    let jobs: Vec<Job> = match (&options.frames, options.shard) {
        (None, shard) => {
            shard.map_or(Ok(()), |shard| check_shard(shard, options))?;
            vec![job(options, None)?]
        }
        (Some(frames), shard) => {
            let (shard, count) = (shard.unwrap_or(Shard::WHOLE), frames.end() - frames.start() + 1);
            if shard.count > count {
                let instead = format!("there are {count} frames to share: give at most as many parts");
                return Err(refuse_shard(shard, instead));
            }
            let of_shard = frames.clone().enumerate().filter(|(index, _)| shard.contains(*index));
            of_shard.map(|(_, frame)| job(options, Some(frame))).collect::<Result<_, _>>()?
        }
    };
    jobs.iter().try_for_each(check)?;
    Ok(jobs)
}

/// Returns an error about `--shard`.
pub fn refuse_shard(Shard { number, count }: Shard, instead: impl AsRef<str>) -> CliError {
    refuse("--shard", format!("{number}/{count}"), instead.as_ref())
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
    } else if options.aovs.is_some() {
        "AOVs are the same after any number of samples: write them whole, by a run with --samples 1"
    } else {
        return Ok(());
    };
    Err(refuse_shard(shard, instead))
}

/// Returns the job of the whole call, or that of a frame, whose number is in the names of the files.
fn job(options: &RenderOptions, frame: Option<u32>) -> Result<Job, CliError> {
    let name = |option, path: &PathBuf| match frame {
        None => Ok(path.clone()),
        Some(frame) => numbered(path, frame).ok_or_else(|| {
            let instead = "give a name with # in it, such as shot-####.png: there the frame's number will be";
            refuse(option, path.display(), instead)
        }),
    };
    let (output, shard) = (name("--output", &options.output)?, options.shard.filter(|_| frame.is_none()));
    Ok(Job {
        frame,
        // A shard is denoised when it is merged.
        raw: (options.denoise && shard.is_none()).then(|| raw_file(&output)),
        aovs: options.aovs.as_ref().map(|path| name("--aovs", path)).transpose()?,
        output,
        shard,
        checkpoint: options.checkpoint.as_ref().map(|path| name("--checkpoint", path)).transpose()?,
        samples_map: options.samples_map.as_ref().map(|path| name("--samples-map", path)).transpose()?,
    })
}

fn check(Job { output, shard, checkpoint, samples_map, raw, aovs, .. }: &Job) -> Result<(), CliError> {
    if shard.is_some() {
        check_checkpoint("--output", output, "a shard is a part of a picture, for octray merge")?;
    } else {
        Format::from_path(output)?;
        output::check(output, Existing::Replace)?;
    }
    if let Some(file) = samples_map {
        Format::from_path(file)?;
        output::check(file, Existing::Replace)?;
    }
    if let Some(file) = aovs {
        if Format::from_path(file).ok() != Some(Format::Exr) {
            return Err(refuse("--aovs", file.display(), "layers are written as EXR: give a name with .exr"));
        }
        output::check(file, Existing::Replace)?;
    }
    raw.iter().try_for_each(|file| output::check(file, Existing::Replace))?;
    if let Some(file) = checkpoint {
        check_checkpoint("--checkpoint", file, "a checkpoint is no picture")?;
        output::remove_leftovers(file);
        output::remove_leftovers(output);
        raw.iter().chain(aovs).for_each(|file| output::remove_leftovers(file));
    }
    Ok(())
}

/// Refuses a file that a checkpoint may not replace: it exists and is no checkpoint.
fn check_checkpoint(option: &str, file: &Path, what: &str) -> Result<(), CliError> {
    if Format::from_path(file).is_ok() {
        let instead = format!("{what}: give a name with another ending, such as .part");
        return Err(refuse(option, file.display(), instead));
    }
    output::check(file, Existing::Replace)?;
    if file.exists() && !is_checkpoint(file) {
        return Err(CheckpointError::NotACheckpoint { path: file.to_owned() }.into());
    }
    Ok(())
}

/// Refuses to replace a file that the scene was read from, or another output.
pub fn keep_files(jobs: &[Job], of_scene: &[PathBuf]) -> Result<(), CliError> {
    let outputs = jobs.iter().flat_map(|job| {
        // A shard that is also its checkpoint continues where it was interrupted.
        let checkpoint = job.checkpoint.as_ref().filter(|file| !is_same(file, &job.output));
        let files = [
            ("--output", Some(&job.output)),
            ("--samples-map", job.samples_map.as_ref()),
            ("--denoise", job.raw.as_ref()),
            ("--aovs", job.aovs.as_ref()),
            ("--checkpoint", checkpoint),
        ];
        files.into_iter().filter_map(|(option, file)| Some((option, file?.as_path())))
    });
    keep_inputs(of_scene, outputs)
}

const MAX_FRAME: u32 = 9_999_999;
/// Most shards: more than there are machines, and fewer than tiles in most pictures.
const MAX_SHARDS: u32 = 65_536;

/// Reads the first and the last frame, `A..B`, or `A` for a single one.
fn frames(text: &str) -> Result<RangeInclusive<u32>, &'static str> {
    let (first, last) = text.split_once("..").unwrap_or((text, text));
    match (first.parse(), last.parse()) {
        (Ok(first), Ok(last)) if first <= last && last <= MAX_FRAME => Ok(first..=last),
        (Ok(first), Ok(last)) if first > last => {
            Err("the first frame is after the last: give A..B, such as 1..48")
        }
        _ => Err("give the first and the last frame as A..B, such as 1..48"),
    }
}

/// Reads `I/N`.
fn shard(text: &str) -> Result<Shard, &'static str> {
    match text.split_once('/').map(|(number, count)| (number.parse(), count.parse())) {
        Some((Ok(number), Ok(count))) if (1..=count).contains(&number) && count <= MAX_SHARDS => {
            Ok(Shard { number, count })
        }
        _ => Err("give I/N, such as 3/8 for the third of eight parts; I is from 1 to N"),
    }
}

/// Returns the file of a frame: the last `#`, or row of them, of the file's name becomes the frame's number,
/// with zeros to as many digits as there are `#`. `None` without a `#`.
pub fn numbered(path: &Path, frame: u32) -> Option<PathBuf> {
    let name = path.file_name()?.to_str()?;
    let end = name.rfind('#')? + 1;
    let start = name[..end].trim_end_matches('#').len();
    let digits = end - start;
    Some(path.with_file_name(format!("{}{frame:0digits$}{}", &name[..start], &name[end..])))
}
