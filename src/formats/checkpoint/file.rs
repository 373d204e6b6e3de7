//! Writes checkpoint files atomically, and reads them with their checksum.

use super::error::CheckpointError;
use super::identity::{Display, Identity};
use crate::output::{CancellableWriter, Existing, OutputError, write_atomically};
use octray_engine::camera::{MAX_PIXELS, Tile};
use octray_engine::film::Film;
use octray_engine::integrate::edge_aovs::DenoiserAovs;
use octray_engine::scene::MAX_SIDE;
use octray_engine::tone::Tone;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

const MAGIC: [u8; 8] = *b"\x89octray\n";
const VERSION: u32 = 3;
/// Longest header in bytes, some fifty times as long as a usual one.
const MAX_HEADER: u32 = 1 << 16;

/// The header of a checkpoint, before its tiles.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Header {
    /// The scene's name, for messages.
    pub name: String,
    /// The properties that must be the same to resume.
    pub identity: Identity,
    /// How the picture is shown.
    #[serde(with = "Display")]
    pub display: Tone,
    /// Samples per pixel that the run aims at; with adaptive sampling the maximum.
    pub wanted: u32,
    /// Whether the run reached its number of samples or its target error.
    pub complete: bool,
    /// Rays traced for the samples.
    pub rays: u64,
    /// Number of tiles in the file.
    pub tiles: u32,
    /// Number of rows of the denoiser's AOVs behind the tiles, in a part of a picture to be denoised.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub guides: u32,
}

fn is_zero(count: &u32) -> bool {
    *count == 0
}

/// Rows of the denoiser's AOVs: their numbers, and [`DenoiserAovs::row_words`].
pub type GuideRows = Vec<(u32, Vec<u32>)>;

/// Writes a checkpoint. Afterwards the file is complete, or as it was before. `goals` are the samples that
/// tiles are to have at the end of the round, by tile number. Fails once `cancelled` returns true.
pub fn save(
    path: &Path,
    header: &Header,
    film: &Film,
    goals: &[u32],
    guides: &GuideRows,
    cancelled: &dyn Fn() -> bool,
) -> Result<(), OutputError> {
    write_atomically(path, Existing::Replace, |inner| {
        write(CancellableWriter { inner, cancelled }, header, film, goals, guides)
    })
}

pub(super) fn write(
    out: impl Write,
    header: &Header,
    film: &Film,
    goals: &[u32],
    guides: &GuideRows,
) -> io::Result<()> {
    let (tiles, guide_rows) = (film.tiles().len() as u32, guides.len() as u32);
    let header = Header { rays: film.rays(), tiles, guides: guide_rows, ..header.clone() };
    let text = serde_json::to_vec(&header)?;
    let mut out = Writer { inner: out, sum: crc32fast::Hasher::new() };
    out.write(&MAGIC)?;
    out.write(&VERSION.to_le_bytes())?;
    out.write(&(text.len() as u32).to_le_bytes())?;
    out.write(&text)?;
    out.write_sum()?;
    let mut words = Vec::new();
    for sums in film.tiles() {
        let number = sums.tile.number;
        let goal = goals.get(number).copied().unwrap_or(sums.samples);
        words.clear();
        words.extend([number as u32, sums.samples, goal, u32::from(sums.has_discarded())]);
        sums.words_into(&mut words);
        words.iter_mut().for_each(|word| *word = word.to_le());
        out.write(bytemuck::cast_slice(&words))?;
    }
    out.write_sum()?;
    for (y, row) in guides {
        let words: Vec<u32> = [*y, row.len() as u32].iter().chain(row).map(|word| word.to_le()).collect();
        out.write(bytemuck::cast_slice(&words))?;
    }
    if guides.is_empty() { Ok(()) } else { out.write_sum() }
}

/// Tests whether the file begins as a checkpoint does. False if it cannot be read.
pub fn is_checkpoint(path: &Path) -> bool {
    let mut magic = [0; MAGIC.len()];
    let Ok(Some((mut file, _))) = open_regular(path) else { return false };
    file.read_exact(&mut magic).is_ok() && magic == MAGIC
}

/// Opens a file, and returns it with its length. Returns `None` for anything but a regular file: opening a
/// pipe would wait for a writer.
fn open_regular(path: &Path) -> io::Result<Option<(File, u64)>> {
    let metadata = path.metadata()?;
    if !metadata.is_file() {
        return Ok(None);
    }
    Ok(Some((File::open(path)?, metadata.len())))
}

/// A checkpoint whose header is read, and whose tiles are not yet.
pub struct Checkpoint<R> {
    /// Its header.
    pub header: Header,
    reader: Reader<R>,
}

impl Checkpoint<BufReader<File>> {
    /// Opens a file; `None` if there is none.
    pub fn open(path: &Path) -> Result<Option<Self>, CheckpointError> {
        match open_regular(path) {
            Ok(Some((file, length))) => {
                let checkpoint = Self::read(BufReader::with_capacity(1 << 16, file), path)?;
                // Checked before a film is allocated.
                if length < least_bytes(&checkpoint.header) {
                    return Err(checkpoint.reader.damaged("it ends too early"));
                }
                Ok(Some(checkpoint))
            }
            Ok(None) => Err(CheckpointError::NotACheckpoint { path: path.to_owned() }),
            Err(error) if error.kind() == ErrorKind::NotFound => Ok(None),
            Err(source) => Err(CheckpointError::Read { path: path.to_owned(), source }),
        }
    }
}

impl<R: Read> Checkpoint<R> {
    /// Reads the header.
    pub fn read(reader: R, path: &Path) -> Result<Self, CheckpointError> {
        let mut reader = Reader { path: path.to_owned(), inner: reader, sum: crc32fast::Hasher::new() };
        let mut magic = [0; MAGIC.len()];
        match reader.fill(&mut magic) {
            Ok(()) if magic == MAGIC => {}
            Err(error @ CheckpointError::Read { .. }) => return Err(error),
            _ => return Err(CheckpointError::NotACheckpoint { path: reader.path }),
        }
        let [found, length] = reader.words()?;
        if found != VERSION {
            return Err(CheckpointError::Version { path: reader.path, found, reads: VERSION });
        }
        if length > MAX_HEADER {
            return Err(reader.damaged("its header is too long"));
        }
        let mut text = vec![0; length as usize];
        reader.fill(&mut text)?;
        reader.check_sum()?;
        let header: Header = serde_json::from_slice(&text)
            .map_err(|error| reader.damaged(format!("its header cannot be read ({error})")))?;
        check(&header).map_err(|what| reader.damaged(what))?;
        Ok(Self { header, reader })
    }

    /// Returns the path of its file, for messages.
    pub fn path(&self) -> &Path {
        &self.reader.path
    }

    /// Reads the tiles into a film that has all tiles, and the header's resolution, tile size and target.
    /// Returns the samples that tiles are to have at the end of the round, by tile number.
    ///
    /// After an error, the film's content is unspecified.
    ///
    /// # Panics
    /// If the film has another resolution.
    pub fn fill(self, film: &mut Film) -> Result<Vec<u32>, CheckpointError> {
        self.fill_with_guides(film, None)
    }

    /// Does what [`Checkpoint::fill`] does, and reads the rows of the denoiser's AOVs.
    pub(super) fn fill_with_guides(
        self,
        film: &mut Film,
        mut guides: Option<&mut DenoiserAovs>,
    ) -> Result<Vec<u32>, CheckpointError> {
        let Self { header, mut reader } = self;
        let (Identity { settings, shard, .. }, count) = (header.identity, header.tiles);
        assert_eq!(film.resolution(), settings.resolution);
        let expected = film.tiles().iter().filter(|sums| shard.contains(sums.tile.number)).count();
        if expected != count as usize {
            return Err(reader.damaged(format!("it has {count} tiles instead of {expected}")));
        }
        let mut goals = Vec::new();
        let mut tiles = film.tiles_mut().iter_mut();
        for _ in 0..count {
            let [number, samples, goal, discarded] = reader.words()?;
            let sums = tiles.find(|sums| sums.tile.number == number as usize);
            let Some(sums) = sums.filter(|sums| shard.contains(sums.tile.number)) else {
                return Err(reader.damaged(format!("tile {number} is not where it should be")));
            };
            // Rendering goes on until goals are reached, so a goal beyond the target's limit must not pass.
            let most = settings.target.map_or(u32::MAX, |(.., most)| most);
            if discarded > 1 || goal > most.max(samples) {
                return Err(reader.damaged(format!("tile {number} cannot be read")));
            }
            let words = reader.vector(sums.words(discarded == 1))?;
            sums.restore(samples, discarded == 1, &words);
            goals.resize(sums.tile.number, 0);
            goals.push(goal);
        }
        reader.check_sum()?;
        let most = DenoiserAovs::MAX_WORDS * settings.resolution[0] as usize;
        for expected in shard.rows(settings.resolution[1]).take(header.guides as usize) {
            let [y, length] = reader.words()?;
            if y != expected || length as usize > most {
                return Err(reader.damaged(format!("row {y} of its guides is not where it should be")));
            }
            let words = reader.vector(length as usize)?;
            if guides.as_mut().is_some_and(|guides| !guides.set_row(y, &words)) {
                return Err(reader.damaged(format!("row {y} of its guides cannot be read")));
            }
        }
        if header.guides > 0 {
            reader.check_sum()?;
        }
        if reader.fill(&mut [0]).is_ok() {
            return Err(reader.damaged("something follows its end"));
        }
        film.add_rays(header.rays);
        Ok(goals)
    }
}

/// Returns the least number of bytes that the tiles take.
fn least_bytes(header: &Header) -> u64 {
    let Identity { settings, shard, .. } = &header.identity;
    let tiles =
        Tile::cover(settings.resolution, settings.tile_size).filter(|tile| shard.contains(tile.number));
    tiles.map(|tile| 16 + 24 * tile.pixels() as u64).sum()
}

/// Checks that resolution, tile size and shard are possible, which bounds the memory that they ask for.
fn check(header: &Header) -> Result<(), String> {
    let Identity { settings, shard, .. } = &header.identity;
    let possible = |sides: [u32; 2]| sides.iter().all(|side| (1..=MAX_SIDE).contains(side));
    let [width, height] = settings.tile_size;
    if !possible(settings.resolution) || !possible([width, height]) || (width * height) as usize > MAX_PIXELS
    {
        return Err("its resolution is impossible".into());
    }
    if !(1..=shard.count).contains(&shard.number) {
        return Err("its shard is impossible".into());
    }
    if header.guides as usize > shard.rows(settings.resolution[1]).len() {
        return Err("it has more rows of guides than its shard".into());
    }
    Ok(())
}

/// A reader of a file with the checksum of all bytes read.
struct Reader<R> {
    path: PathBuf,
    inner: R,
    sum: crc32fast::Hasher,
}

impl<R> Reader<R> {
    fn damaged(&self, what: impl Into<String>) -> CheckpointError {
        CheckpointError::Damaged { path: self.path.clone(), what: what.into() }
    }
}

impl<R: Read> Reader<R> {
    fn fill(&mut self, bytes: &mut [u8]) -> Result<(), CheckpointError> {
        self.inner.read_exact(bytes).map_err(|source| match source.kind() {
            ErrorKind::UnexpectedEof => self.damaged("it ends too early"),
            _ => CheckpointError::Read { path: self.path.clone(), source },
        })?;
        self.sum.update(bytes);
        Ok(())
    }
    fn words<const N: usize>(&mut self) -> Result<[u32; N], CheckpointError> {
        let mut words = [0; N];
        self.fill(bytemuck::cast_slice_mut(&mut words))?;
        Ok(words.map(u32::from_le))
    }
    fn vector(&mut self, length: usize) -> Result<Vec<u32>, CheckpointError> {
        let mut words = vec![0; length];
        self.fill(bytemuck::cast_slice_mut(&mut words))?;
        words.iter_mut().for_each(|word| *word = u32::from_le(*word));
        Ok(words)
    }
    /// Reads a checksum and compares it with that of everything before.
    fn check_sum(&mut self) -> Result<(), CheckpointError> {
        let sum = self.sum.clone().finalize();
        match self.words()? {
            [found] if found == sum => Ok(()),
            _ => Err(self.damaged("its checksum is wrong")),
        }
    }
}

/// A writer of a file with the checksum of all bytes written.
struct Writer<W> {
    inner: W,
    sum: crc32fast::Hasher,
}

impl<W: Write> Writer<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sum.update(bytes);
        self.inner.write_all(bytes)
    }
    /// Writes the checksum of everything before.
    fn write_sum(&mut self) -> io::Result<()> {
        let sum = self.sum.clone().finalize();
        self.write(&sum.to_le_bytes())
    }
}
