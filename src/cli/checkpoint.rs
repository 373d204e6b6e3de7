//! `--checkpoint`: saves the film every few seconds and resumes from it.

use super::error::{CliError, describe, refuse};
use super::{interrupt, terminal};
use crate::checkpoint::{self, Checkpoint, CheckpointError, GuideRows, Header};
use crate::film::Film;
use crate::output::OutputError;
use crate::wording::grouped;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Time between two checkpoints, unless one takes long to save.
const INTERVAL: Duration = Duration::from_secs(5);
/// Multiple of the time that the last save took: saving takes at most a fiftieth of the time.
const SAVINGS: u32 = 50;

/// Saves the film of a rendering while it grows, and at its end.
pub struct CheckpointWriter {
    file: PathBuf,
    header: Header,
    /// The samples that each tile is to have at the end of the round in which the film was saved, by tile
    /// number; empty for a new film.
    pub goals: Vec<u32>,
    /// The rows of the denoiser's AOVs that a shard keeps.
    pub guides: GuideRows,
    /// `None`: [`INTERVAL`], or longer where saving takes long.
    interval: Option<Duration>,
    /// The time at which the film is to be saved next.
    pub due: Instant,
    /// Pixel samples in the file.
    saved: u64,
    /// Whether the user was warned that saving fails.
    warned: bool,
}

impl CheckpointWriter {
    /// Fills the film from the file, if it is there. `header` is what this run will write.
    pub fn resume(
        file: &Path,
        header: Header,
        interval: Option<Duration>,
        film: &mut Film,
    ) -> Result<Self, CliError> {
        let mut goals = Vec::new();
        if let Some(checkpoint) = Checkpoint::open(file)? {
            let differences = checkpoint.header.identity.differences(&header.identity);
            if !differences.is_empty() {
                return Err(CheckpointError::Differs { path: file.to_owned(), differences }.into());
            }
            goals = checkpoint.fill(film)?;
        }
        let (most, wanted) = (film.most_samples(), header.wanted);
        if most > wanted {
            let has = format!("the checkpoint `{}` has {most} samples of some pixels", file.display());
            let instead = format!("{has}: give {most} or more, or another file");
            return Err(refuse("--samples", grouped(wanted), instead));
        }
        let (file, saved) = (file.to_owned(), film.pixel_samples());
        let due = Instant::now() + interval.unwrap_or(INTERVAL);
        Ok(Self { file, header, goals, guides: Vec::new(), interval, due, saved, warned: false })
    }

    /// Tests whether it is time to save, and the film has samples that the file does not have.
    pub fn is_due(&self, film: &Film) -> bool {
        self.due <= Instant::now() && film.pixel_samples() > self.saved
    }

    /// Saves the film of a rendering that continues. If that fails, one warning is printed, and the earlier
    /// checkpoint stays: hours of rendering must not end because a disk is full.
    pub fn save_or_warn(&mut self, film: &Film, goals: &[u32]) {
        let began = Instant::now();
        interrupt::hold();
        let saved = self.save(film, goals);
        interrupt::release();
        let next = self.interval.unwrap_or_else(|| INTERVAL.max(SAVINGS * began.elapsed()));
        self.due = Instant::now() + next;
        if let Err(error) = &saved
            && !self.warned
        {
            let why = describe(error);
            terminal::warn(&format!("no checkpoint was saved, and the rendering goes on without: {why}"));
        }
        self.warned = saved.is_err();
        if saved.is_ok() {
            self.saved = film.pixel_samples();
        }
    }

    /// Saves the film at the end of a rendering, `complete` or not.
    pub fn finish(&mut self, film: &Film, goals: &[u32], complete: bool) -> Result<(), OutputError> {
        self.header.complete = complete;
        self.save(film, goals)
    }

    fn save(&self, film: &Film, goals: &[u32]) -> Result<(), OutputError> {
        checkpoint::save(&self.file, &self.header, film, goals, &self.guides, &interrupt::insisted)
    }
}
