//! Writes files atomically: a complete file or none.
//!
//! The content is written to a temporary file in the final folder, synced to the disk, and renamed to its
//! final name in one step. A reader sees the old file or the new one. After a failure, the old one is left.

use super::error::OutputError;
use serde::Serialize;
use std::fs::{self, File};
use std::io::{self, BufWriter, ErrorKind, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use tempfile::NamedTempFile;

/// The treatment of a file that exists already.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Existing {
    /// The new file takes its place and its permissions.
    Replace,
    /// The new file is not written.
    Keep,
}

/// Checks that a file can be written at `path`, by an empty temporary file beside it. A long computation can
/// so fail at its start and not at its end.
pub fn check(path: &Path, existing: Existing) -> Result<(), OutputError> {
    Destination::new(path, existing)?.temporary().map(drop)
}

/// Writes a file through `fill`. Afterwards the file is complete, or everything is as it was before.
pub fn write_atomically(
    path: &Path,
    existing: Existing,
    fill: impl FnOnce(&mut BufWriter<&mut File>) -> io::Result<()>,
) -> Result<(), OutputError> {
    let destination = Destination::new(path, existing)?;
    let failed = |source| OutputError::Write { path: path.to_owned(), source };
    // Dropping the temporary file removes it: every early return cleans up.
    let mut temporary = destination.temporary()?;
    let mut buffer = BufWriter::with_capacity(1 << 16, temporary.as_file_mut());
    let filled = fill(&mut buffer).and_then(|()| buffer.flush());
    // `into_parts` discards what a failed write left in the buffer; dropping the buffer would write it.
    drop(buffer.into_parts());
    filled.map_err(failed)?;
    if let Some(permissions) = destination.permissions {
        temporary.as_file().set_permissions(permissions).map_err(failed)?;
    }
    temporary.as_file().sync_all().map_err(failed)?;
    let persisted = match existing {
        Existing::Replace => temporary.persist(&destination.file),
        Existing::Keep => temporary.persist_noclobber(&destination.file),
    };
    match persisted {
        Ok(_) => Ok(()),
        Err(error) if error.error.kind() == ErrorKind::AlreadyExists => {
            Err(OutputError::Exists { path: path.to_owned() })
        }
        Err(error) => Err(failed(error.error)),
    }
}

/// Writes a text file, replacing any earlier one.
pub fn save_text(path: &Path, text: &str) -> Result<(), OutputError> {
    write_atomically(path, Existing::Replace, |file| file.write_all(text.as_bytes()))
}

/// Writes indented JSON, replacing any earlier file.
pub fn save_json(path: &Path, what: &impl Serialize) -> Result<(), OutputError> {
    write_atomically(path, Existing::Replace, |file| {
        serde_json::to_writer_pretty(&mut *file, what)?;
        file.write_all(b"\n")
    })
}

/// Removes the temporary files of runs that were killed while they wrote `path`. Call it before the first
/// write: another run that writes the same file at this moment loses its temporary file, and reports it.
pub fn remove_leftovers(path: &Path) {
    let Ok(destination) = Destination::new(path, Existing::Replace) else { return };
    let prefix = temporary_prefix(&destination.file);
    for entry in fs::read_dir(&destination.folder).into_iter().flatten().flatten() {
        let name = entry.file_name();
        let name = name.to_string_lossy();
        if name.starts_with(&prefix) && name.ends_with(SUFFIX) {
            // A file that cannot be removed is left.
            let _ = fs::remove_file(entry.path());
        }
    }
}

/// Returns the beginning of the names of temporary files for `file`. All names give the same length.
fn temporary_prefix(file: &Path) -> String {
    let name = file.file_name().unwrap_or_default().as_encoded_bytes();
    format!(".octray-{:08x}-", crc32fast::hash(name))
}

/// The end of the names of temporary files.
const SUFFIX: &str = ".tmp";

/// Creates a folder and its parents unless they exist.
pub fn make_folder(folder: &Path) -> Result<(), OutputError> {
    fs::create_dir_all(folder)
        .map_err(|source| OutputError::FolderNotMade { folder: folder.to_owned(), source })
}

/// A writer that fails once `cancelled` returns true, because a large file takes seconds.
pub(crate) struct CancellableWriter<'a, W> {
    pub inner: W,
    pub cancelled: &'a dyn Fn() -> bool,
}

impl<W: Write> Write for CancellableWriter<'_, W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        // Not `ErrorKind::Interrupted`, which makes callers retry.
        if (self.cancelled)() { Err(io::Error::other("cancelled")) } else { self.inner.write(bytes) }
    }
    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<W: Seek> Seek for CancellableWriter<'_, W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}

/// A writer that inserts bytes at a place of what passes through it.
pub(super) struct InsertingWriter<W> {
    inner: W,
    /// The number of bytes before the place.
    before: usize,
    inserted: Vec<u8>,
}

impl<W> InsertingWriter<W> {
    pub fn new(inner: W, (before, inserted): (usize, Vec<u8>)) -> Self {
        Self { inner, before, inserted }
    }
}

impl<W: Write> Write for InsertingWriter<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.before == 0 {
            self.inner.write_all(&std::mem::take(&mut self.inserted))?;
        }
        if self.inserted.is_empty() {
            return self.inner.write(bytes);
        }
        let count = self.inner.write(&bytes[..bytes.len().min(self.before)])?;
        self.before -= count;
        Ok(count)
    }
    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}

impl<W: Seek> Seek for InsertingWriter<W> {
    fn seek(&mut self, to: SeekFrom) -> io::Result<u64> {
        self.inner.seek(to)
    }
}

/// A checked destination.
struct Destination {
    /// The final path, with symbolic links followed.
    file: PathBuf,
    folder: PathBuf,
    /// Permissions of the file that is replaced, if there is one.
    permissions: Option<fs::Permissions>,
}

impl Destination {
    fn new(path: &Path, existing: Existing) -> Result<Self, OutputError> {
        let path = path.to_owned();
        if path.file_name().is_none() || path.as_os_str().as_encoded_bytes().ends_with(b"/") {
            return Err(OutputError::IsFolder { path });
        }
        let file = if path.is_symlink() { follow(&path) } else { path.clone() };
        let folder = match file.parent() {
            Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
            _ => PathBuf::from("."),
        };
        match fs::metadata(&folder).map_err(|error| (error.kind(), error)) {
            Ok(found) if found.is_dir() => {}
            Ok(_) | Err((ErrorKind::NotADirectory, _)) => {
                return Err(OutputError::NotAFolder { folder, path });
            }
            Err((ErrorKind::NotFound, _)) => return Err(OutputError::MissingFolder { folder, path }),
            Err((_, source)) => return Err(OutputError::Unreachable { path, source }),
        }
        let permissions = match fs::metadata(&file) {
            Ok(found) if found.is_dir() => return Err(OutputError::IsFolder { path }),
            Ok(found) if !found.is_file() => return Err(OutputError::NotAFile { path }),
            Ok(_) if existing == Existing::Keep => return Err(OutputError::Exists { path }),
            Ok(found) if found.permissions().readonly() => return Err(OutputError::ReadOnly { path }),
            Ok(found) => Some(found.permissions()),
            Err(error) if error.kind() == ErrorKind::NotFound => None,
            Err(source) => return Err(OutputError::Unreachable { path, source }),
        };
        Ok(Self { file, folder, permissions })
    }

    /// Creates an empty file in the folder, which is removed on drop unless it is persisted.
    fn temporary(&self) -> Result<NamedTempFile, OutputError> {
        let mut builder = tempfile::Builder::new();
        let prefix = temporary_prefix(&self.file);
        builder.prefix(&prefix).suffix(SUFFIX);
        // The permissions of an ordinary new file. The default of `tempfile` is readable by the owner alone.
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
        // The error leaves out the temporary file's name, which means nothing to the user.
        builder.tempfile_in(&self.folder).map_err(|error| OutputError::FolderNotWritable {
            folder: self.folder.clone(),
            source: error.kind().into(),
        })
    }
}

/// Follows a symbolic link to its end, or by one step if its target does not exist yet.
fn follow(link: &Path) -> PathBuf {
    fs::canonicalize(link).unwrap_or_else(|_| match fs::read_link(link) {
        Ok(target) => link.with_file_name(target),
        Err(_) => link.to_owned(),
    })
}
