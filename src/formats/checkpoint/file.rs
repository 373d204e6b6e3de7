//! Checkpoints as files: written atomically, read with their checksum.
//!
//! For: [`save`], [`Checkpoint`], [`is_checkpoint`].

use super::error::CheckpointError;
use super::identity::{Display, Identity};
use crate::output::{CancellableWriter, Existing, OutputError, write_atomically};
use octray_engine::camera::{MAX_PIXELS, Tile};
use octray_engine::film::Film;
use octray_engine::scene::MAX_SIDE;
use octray_engine::tone::Tone;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

const MAGIC: [u8; 8] = *b"\x89octray\n";
const VERSION: u32 = 2;
/// Longest header in bytes: some fifty times what one takes.
const MAX_HEADER: u32 = 1 << 16;

/// What a checkpoint says of its tiles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// The scene's name, for people.
    pub name: String,
    /// What must be the same to go on.
    pub identity: Identity,
    /// How the picture is shown.
    #[serde(with = "Display")]
    pub display: Tone,
    /// Samples per pixel that the run was to take; with adaptive sampling the most.
    pub wanted: u32,
    /// Was the run's limit of samples or its target error reached?
    pub complete: bool,
    /// Rays traced for the samples.
    pub rays: u64,
    /// Number of tiles in the file.
    pub tiles: u32,
}

/// Writes a checkpoint: afterwards the file is complete, or as it was before. `goals` are the samples that
/// tiles shall have at the end of the round, by tile number. Fails once `cancelled` returns true.
pub fn save(
    path: &Path,
    header: &Header,
    film: &Film,
    goals: &[u32],
    cancelled: &dyn Fn() -> bool,
) -> Result<(), OutputError> {
    write_atomically(path, Existing::Replace, |inner| {
        write(CancellableWriter { inner, cancelled }, header, film, goals)
    })
}

pub(super) fn write(out: impl Write, header: &Header, film: &Film, goals: &[u32]) -> io::Result<()> {
    let header = Header { rays: film.rays(), tiles: film.tiles().len() as u32, ..header.clone() };
    let text = serde_json::to_vec(&header)?;
    let mut out = Summed { inner: out, sum: crc32fast::Hasher::new() };
    out.write_all(&MAGIC)?;
    out.write_all(&VERSION.to_le_bytes())?;
    out.write_all(&(text.len() as u32).to_le_bytes())?;
    out.write_all(&text)?;
    out.write_sum()?;
    let mut words = Vec::new();
    for sums in film.tiles() {
        let number = sums.tile.number;
        let goal = goals.get(number).copied().unwrap_or(sums.samples);
        words.clear();
        words.extend([number as u32, sums.samples, goal, u32::from(sums.has_discarded())]);
        sums.words_into(&mut words);
        words.iter_mut().for_each(|word| *word = word.to_le());
        out.write_all(bytemuck::cast_slice(&words))?;
    }
    out.write_sum()
}

/// Does the file begin as a checkpoint does? False where it cannot be read.
pub fn is_checkpoint(path: &Path) -> bool {
    let mut magic = [0; MAGIC.len()];
    let Ok(Some((mut file, _))) = open_regular(path) else { return false };
    file.read_exact(&mut magic).is_ok() && magic == MAGIC
}

/// A file and its length; `None` if it is no regular file: to open a pipe would wait for somebody who writes.
fn open_regular(path: &Path) -> io::Result<Option<(File, u64)>> {
    let metadata = path.metadata()?;
    if !metadata.is_file() {
        return Ok(None);
    }
    Ok(Some((File::open(path)?, metadata.len())))
}

/// A checkpoint whose header was read, and whose tiles were not yet.
pub struct Checkpoint<R> {
    /// Where it was read from, for messages.
    pub path: PathBuf,
    /// What stands before the sums.
    pub header: Header,
    reader: Summed<R>,
}

impl Checkpoint<BufReader<File>> {
    /// Opens a file; `None` if there is none.
    pub fn open(path: &Path) -> Result<Option<Self>, CheckpointError> {
        let failed = |source| CheckpointError::Read { path: path.to_owned(), source };
        match open_regular(path) {
            Ok(Some((file, length))) => {
                let checkpoint = Self::read(BufReader::with_capacity(1 << 16, file), path)?;
                // Before a film is allocated.
                if length < least_bytes(&checkpoint.header) {
                    return Err(damaged(path, "it ends too early"));
                }
                Ok(Some(checkpoint))
            }
            Ok(None) => Err(CheckpointError::NotACheckpoint { path: path.to_owned() }),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(error) => Err(failed(error)),
        }
    }
}

impl<R: Read> Checkpoint<R> {
    /// Reads the header.
    pub fn read(reader: R, path: &Path) -> Result<Self, CheckpointError> {
        let path = path.to_owned();
        let mut reader = Summed { inner: reader, sum: crc32fast::Hasher::new() };
        let mut magic = [0; MAGIC.len()];
        match reader.read_exact(&mut magic) {
            Ok(()) if magic == MAGIC => {}
            Err(error) if error.kind() != ErrorKind::UnexpectedEof => {
                return Err(CheckpointError::Read { path, source: error });
            }
            _ => return Err(CheckpointError::NotACheckpoint { path }),
        }
        let [found, length] = read_words(&mut reader).map_err(|error| ended(&path, error))?;
        if found != VERSION {
            return Err(CheckpointError::Version { path, found, reads: VERSION });
        }
        if length > MAX_HEADER {
            return Err(damaged(&path, "its header is too long"));
        }
        let mut text = vec![0; length as usize];
        reader.read_exact(&mut text).map_err(|error| ended(&path, error))?;
        check_sum(&mut reader, &path)?;
        let header: Header = serde_json::from_slice(&text)
            .map_err(|error| damaged(&path, format!("its header cannot be read ({error})")))?;
        check(&header).map_err(|what| damaged(&path, what))?;
        Ok(Self { path, header, reader })
    }

    /// Reads the tiles into a film that has all of them, of the header's resolution, tile size and target.
    /// Returns the samples that tiles shall have at the end of the round, by tile number.
    ///
    /// On an error, the film's content is unspecified.
    ///
    /// # Panics
    /// If the film is of another resolution.
    pub fn fill(mut self, film: &mut Film) -> Result<Vec<u32>, CheckpointError> {
        assert_eq!(film.resolution(), self.header.identity.settings.resolution);
        let Header { tiles: count, identity: Identity { shard, .. }, .. } = self.header;
        let expected = film.tiles().iter().filter(|sums| shard.has(sums.tile.number)).count();
        if expected != count as usize {
            return Err(damaged(&self.path, format!("it has {count} tiles instead of {expected}")));
        }
        let mut goals = Vec::new();
        let mut tiles = film.tiles_mut().iter_mut();
        for _ in 0..count {
            let [number, samples, goal, discarded] = self.words()?;
            let sums = tiles.find(|sums| sums.tile.number == number as usize);
            let Some(sums) = sums.filter(|sums| shard.has(sums.tile.number)) else {
                return Err(damaged(&self.path, format!("tile {number} is not where it should be")));
            };
            // Goals of a round are within the target's limit, and rendering goes on until they are reached.
            let most = self.header.identity.settings.target.map_or(u32::MAX, |(.., most)| most);
            if discarded > 1 || goal > most.max(samples) {
                return Err(damaged(&self.path, format!("tile {number} cannot be read")));
            }
            let mut words = vec![0; sums.words(discarded == 1)];
            let bytes = bytemuck::cast_slice_mut(&mut words);
            self.reader.read_exact(bytes).map_err(|error| ended(&self.path, error))?;
            words.iter_mut().for_each(|word| *word = u32::from_le(*word));
            sums.restore(samples, discarded == 1, &words);
            goals.resize(sums.tile.number, 0);
            goals.push(goal);
        }
        check_sum(&mut self.reader, &self.path)?;
        if self.reader.read(&mut [0]).map_err(|error| ended(&self.path, error))? > 0 {
            return Err(damaged(&self.path, "something follows its end"));
        }
        film.add_rays(self.header.rays);
        Ok(goals)
    }

    fn words<const N: usize>(&mut self) -> Result<[u32; N], CheckpointError> {
        read_words(&mut self.reader).map_err(|error| ended(&self.path, error))
    }
}

/// The fewest bytes that the tiles take.
fn least_bytes(header: &Header) -> u64 {
    let Identity { settings, shard, .. } = &header.identity;
    let tiles = Tile::cover(settings.resolution, settings.tile_size).filter(|tile| shard.has(tile.number));
    tiles.map(|tile| 16 + 24 * tile.pixels() as u64).sum()
}

/// Is what the header says possible? What is allocated by it is bounded by this.
fn check(header: &Header) -> Result<(), String> {
    let Identity { settings, shard, .. } = &header.identity;
    let possible = |sides: [u32; 2]| sides.iter().all(|side| (1..=MAX_SIDE).contains(side));
    let [width, height] = settings.tile_size;
    if !possible(settings.resolution) || !possible([width, height]) || (width * height) as usize > MAX_PIXELS
    {
        return Err("its resolution is impossible".into());
    }
    if !(1..=shard.of).contains(&shard.number) {
        return Err("its shard is impossible".into());
    }
    Ok(())
}

fn read_words<const N: usize>(reader: &mut impl Read) -> io::Result<[u32; N]> {
    let mut words = [0; N];
    reader.read_exact(bytemuck::cast_slice_mut(&mut words))?;
    Ok(words.map(u32::from_le))
}

/// Reads the checksum of everything before.
fn check_sum(reader: &mut Summed<impl Read>, path: &Path) -> Result<(), CheckpointError> {
    let sum = reader.sum.clone().finalize();
    match read_words(reader).map_err(|error| ended(path, error))? {
        [found] if found == sum => Ok(()),
        _ => Err(damaged(path, "its checksum is wrong")),
    }
}

fn damaged(path: &Path, what: impl Into<String>) -> CheckpointError {
    CheckpointError::Damaged { path: path.to_owned(), what: what.into() }
}

fn ended(path: &Path, source: io::Error) -> CheckpointError {
    match source.kind() {
        ErrorKind::UnexpectedEof => damaged(path, "it ends too early"),
        _ => CheckpointError::Read { path: path.to_owned(), source },
    }
}

/// Sums up all bytes that pass.
struct Summed<T> {
    inner: T,
    sum: crc32fast::Hasher,
}

impl<W: Write> Summed<W> {
    /// Writes the checksum of everything before.
    fn write_sum(&mut self) -> io::Result<()> {
        let sum = self.sum.clone().finalize();
        self.write_all(&sum.to_le_bytes())
    }
}

impl<W: Write> Write for Summed<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.sum.update(&bytes[..written]);
        Ok(written)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<R: Read> Read for Summed<R> {
    fn read(&mut self, bytes: &mut [u8]) -> io::Result<usize> {
        let read = self.inner.read(bytes)?;
        self.sum.update(&bytes[..read]);
        Ok(read)
    }
}
