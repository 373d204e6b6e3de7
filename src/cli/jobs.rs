//! What one call of `render` makes: a picture, a part of one, or the pictures of frames.
//!
//! For: [`jobs`].

use super::error::CliError;
use super::frames::{Frames, numbered};
use super::numbers::refuse;
use super::options::RenderOptions;
use crate::checkpoint::{CheckpointError, Shard, is_checkpoint};
use crate::output::{self, Existing, Format};
use std::path::{Path, PathBuf};

/// A film to render, and the files that are made of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Job {
    pub frame: Option<u32>,
    pub output: PathBuf,
    /// The output is a part: the checkpoint of a shard.
    pub part: bool,
    /// The tiles of the film.
    pub shard: Shard,
    pub checkpoint: Option<PathBuf>,
    pub samples_map: Option<PathBuf>,
}

/// The jobs of a call, with their files checked: they can be written.
pub fn jobs(options: &RenderOptions) -> Result<Vec<Job>, CliError> {
    let jobs = match options.frames {
        Some(frames) => of_frames(options, frames)?,
        None => vec![Job {
            frame: None,
            output: options.output.clone(),
            part: options.shard.is_some(),
            shard: options.shard.unwrap_or(Shard::WHOLE),
            checkpoint: options.checkpoint.clone(),
            samples_map: options.samples_map.clone(),
        }],
    };
    jobs.iter().try_for_each(check)?;
    Ok(jobs)
}

/// A job a frame; of a shard, every N-th.
fn of_frames(options: &RenderOptions, frames: Frames) -> Result<Vec<Job>, CliError> {
    let shard = options.shard.unwrap_or(Shard::WHOLE);
    if shard.of > frames.count() {
        let why = format!("there are {} frames to share: give at most as many parts", frames.count());
        return Err(refuse("--shard", &format!("{}/{}", shard.number, shard.of), why));
    }
    let name = |option: &'static str, path: &Path, frame| {
        let why = "give a name with # in it, such as shot-####.png: there the frame's number will be";
        numbered(path, frame).ok_or_else(|| refuse(option, &path.display().to_string(), why))
    };
    let job = |frame| {
        let named =
            |option, path: &Option<PathBuf>| path.as_ref().map(|path| name(option, path, frame)).transpose();
        Ok(Job {
            frame: Some(frame),
            output: name("--output", &options.output, frame)?,
            part: false,
            shard: Shard::WHOLE,
            checkpoint: named("--checkpoint", &options.checkpoint)?,
            samples_map: named("--samples-map", &options.samples_map)?,
        })
    };
    frames.numbers().enumerate().filter(|(index, _)| shard.has(*index)).map(|(_, frame)| job(frame)).collect()
}

fn check(job: &Job) -> Result<(), CliError> {
    let Job { output, part, checkpoint, samples_map, .. } = job;
    if *part {
        check_checkpoint("--output", output, "a shard is a part of a picture, for octray merge")?;
    } else {
        Format::of(output)?;
        output::check(output, Existing::Replace)?;
    }
    if let Some(file) = samples_map {
        Format::of(file)?;
        if is_same(file, output) {
            let why = "it is also the output file: give another file";
            return Err(refuse("--samples-map", &file.display().to_string(), why));
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
fn check_checkpoint(option: &'static str, file: &Path, what: &str) -> Result<(), CliError> {
    if Format::of(file).is_ok() {
        let why = format!("{what}: give a name with another ending, such as .part");
        return Err(refuse(option, &file.display().to_string(), why));
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
