//! `--checkpoint`: saves the film every few seconds and resumes from it.

use super::error::{CliError, describe, refuse};
use super::interrupt;
use super::terminal;
use crate::checkpoint::{self, Checkpoint, CheckpointError, Header};
use crate::film::Film;
use crate::output::OutputError;
use crate::wording::grouped;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Time between two checkpoints, unless one takes long to save.
const INTERVAL: Duration = Duration::from_secs(5);
/// So many times as long as it took to save the last one: saving takes at most a fiftieth of the time.
const SAVINGS: u32 = 50;

/// Saves the film of a rendering while it grows, and at its end.
pub struct CheckpointWriter {
    file: PathBuf,
    header: Header,
    /// The samples that each tile is to have at the end of the round in which the film was saved, by tile
    /// number; empty for a new film.
    pub goals: Vec<u32>,
    /// By the time that saving takes if `None`.
    interval: Option<Duration>,
    due: Instant,
    /// Pixel samples in the file.
    saved: u64,
    /// Was the user warned that saving fails?
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
        Ok(Self { file, header, goals, interval, due, saved, warned: false })
    }

    /// When the film is to be saved next.
    pub fn due(&self) -> Instant {
        self.due
    }

    /// Is it time to save, and has the film samples that the file has not?
    pub fn is_due(&self, film: &Film) -> bool {
        self.due <= Instant::now() && film.pixel_samples() > self.saved
    }

    /// Saves the film of a rendering that goes on. If that fails, a warning says so once, and the earlier
    /// checkpoint stays: hours of rendering shall not end because a disk is full.
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
        checkpoint::save(&self.file, &self.header, film, goals, &interrupt::insisted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::checkpoint::{Identity, Shard};
    use crate::render::{Renderer, Settings};
    use crate::tone::Tone;

    #[test]
    fn saving_is_due_only_where_there_is_something_new() {
        let scene = crate::scene::load("builtin:three").unwrap();
        let settings = Settings { resolution: [40, 24], max_bounces: 1, ..Settings::of(&scene) };
        let renderer = Renderer::new(&scene, settings);
        let mut film = renderer.film();
        let header = Header {
            name: scene.name.clone(),
            identity: Identity::new(&scene, &settings, None, Shard { number: 1, of: 1 }),
            display: Tone::default(),
            wanted: 8,
            complete: false,
            rays: 0,
            tiles: 0,
        };
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("c.part");
        let resumed = CheckpointWriter::resume(&file, header, Some(Duration::ZERO), &mut film);
        let mut writer = resumed.unwrap();
        assert!(!writer.is_due(&film), "nothing is done");
        for _ in 0..2 {
            renderer.add_samples(&mut film, 1);
            assert!(writer.is_due(&film));
            writer.save_or_warn(&film, &[]);
            assert!(file.exists() && !writer.is_due(&film), "all is saved");
        }
    }
}
