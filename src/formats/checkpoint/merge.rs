//! Joins the shards of a picture into a film with the bits of one run.

use super::error::CheckpointError;
use super::file::{Checkpoint, Header};
use super::identity::Identity;
use crate::wording::counted;
use octray_engine::film::Film;
use octray_engine::integrate::edge_aovs::DenoiserAovs;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::PathBuf;

const MEND: &str = "give every shard of one picture once, each complete: an unfinished one goes on with its own \
                    command and --checkpoint";

const MEND_GUIDES: &str =
    "render every shard with --denoise (a whole picture with --shard 1/1), or merge without it";

/// The shards of one picture, each once and complete. Their headers are read, and their tiles are not yet.
pub struct Parts<R>(Vec<Checkpoint<R>>);

impl Parts<BufReader<File>> {
    /// Opens the parts of a picture. An error names everything that is missing, doubled, mixed or incomplete.
    ///
    /// # Panics
    /// If there are none.
    pub fn open(paths: &[PathBuf]) -> Result<Self, CheckpointError> {
        let open = |path: &PathBuf| {
            Checkpoint::open(path)?.ok_or_else(|| CheckpointError::NoPart { path: path.clone() })
        };
        Self::new(paths.iter().map(open).collect::<Result<_, _>>()?)
    }
}

impl<R: Read> Parts<R> {
    /// Accepts opened parts as [`Parts::open`] does.
    ///
    /// # Panics
    /// If there are none.
    pub fn new(parts: Vec<Checkpoint<R>>) -> Result<Self, CheckpointError> {
        let mut faults: Vec<String> = parts[1..].iter().flat_map(|part| mixed(part, &parts[0])).collect();
        faults.extend(parts.iter().enumerate().flat_map(|(at, part)| doubled(part, &parts[..at])));
        faults.extend(missing(&parts));
        faults.extend(parts.iter().filter(|part| !part.header.complete).map(|part| {
            let wanted = counted(part.header.wanted, "sample", "samples");
            format!("`{}` is not complete: its run ended before it had {wanted}", part.path().display())
        }));
        if faults.is_empty() { Ok(Self(parts)) } else { Err(CheckpointError::Parts { faults, mend: MEND }) }
    }

    /// Returns the header of the first part. All have the same picture and settings.
    pub fn header(&self) -> &Header {
        &self.0[0].header
    }

    /// Reads the whole film, and the denoiser's AOVs if they are `wanted`, which each part must then have.
    pub fn film(self, wanted: bool) -> Result<(Film, Option<DenoiserAovs>), CheckpointError> {
        let lacks = |part: &&Checkpoint<R>| {
            let Identity { shard, settings, .. } = &part.header.identity;
            part.header.guides as usize != shard.rows(settings.resolution[1]).len()
        };
        let without = self.0.iter().filter(|part| wanted && lacks(part));
        let fault = |part: &Checkpoint<R>| {
            format!("`{}` has nothing for --denoise: render it with this option", part.path().display())
        };
        let faults: Vec<String> = without.map(fault).collect();
        if !faults.is_empty() {
            return Err(CheckpointError::Parts { faults, mend: MEND_GUIDES });
        }
        let settings = &self.header().identity.settings;
        let mut film = Film::new(settings.resolution, settings.tile_size);
        if settings.target.is_some() {
            film = film.with_noise();
        }
        let mut guides = wanted.then(DenoiserAovs::default);
        guides.iter_mut().for_each(|guides| guides.resize(film.resolution()));
        for part in self.0 {
            part.fill_with_guides(&mut film, guides.as_mut())?;
        }
        Ok((film, guides))
    }
}

/// Returns a sentence for each difference between the pictures of two parts.
fn mixed<R: Read>(part: &Checkpoint<R>, first: &Checkpoint<R>) -> Vec<String> {
    let (theirs, ours) = (&part.header, &first.header);
    let here = Identity { shard: ours.identity.shard, ..theirs.identity.clone() };
    let mut found = here.differences(&ours.identity);
    if theirs.identity.shard.count != ours.identity.shard.count {
        found.push(format!("{} shards, and here {}", theirs.identity.shard.count, ours.identity.shard.count));
    }
    if theirs.wanted != ours.wanted {
        found.push(format!("samples: {}, and here {}", theirs.wanted, ours.wanted));
    }
    if theirs.display != ours.display {
        found.push("exposure or tone: not the same".into());
    }
    let [part, first] = [part, first].map(|part| part.path().display());
    found.into_iter().map(|what| format!("`{part}` is not of the picture of `{first}`: {what}")).collect()
}

/// Returns a sentence if an earlier part is of the same shard.
fn doubled<R: Read>(part: &Checkpoint<R>, before: &[Checkpoint<R>]) -> Option<String> {
    let shard = part.header.identity.shard;
    let same = before.iter().find(|other| other.header.identity.shard == shard)?;
    let [path, other] = [part, same].map(|part| part.path().display());
    Some(format!("shard {} is there twice: `{other}` and `{path}`", shard.number))
}

/// Returns a sentence that names the shards without a part: the first ten of them.
fn missing<R>(parts: &[Checkpoint<R>]) -> Option<String> {
    let count = parts[0].header.identity.shard.count;
    let mut there: Vec<u32> = parts.iter().map(|part| part.header.identity.shard.number).collect();
    there.sort_unstable();
    let mut lacking = (1..=count).filter(|number| there.binary_search(number).is_err());
    let named: Vec<String> = lacking.by_ref().take(10).map(|number| number.to_string()).collect();
    let more = if lacking.next().is_some() { ", …" } else { "" };
    match named.len() {
        0 => None,
        1 => Some(format!("shard {} of {count} is missing", named[0])),
        _ => Some(format!("shards {}{more} of {count} are missing", named.join(", "))),
    }
}
