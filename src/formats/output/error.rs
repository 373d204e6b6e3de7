//! Reports why an output file was not written, and how to mend it.

use std::io;
use std::path::PathBuf;

/// The reason why a file was not written. Any earlier file is unchanged. The messages explain the variants.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)]
pub enum OutputError {
    #[error(
        "the name `{}` does not say which picture format to write\n  \
         end it in .png or .jpg (for screens), or .exr or .hdr (linear radiance)", .path.display()
    )]
    UnknownFormat { path: PathBuf },
    #[error(
        "`{}` is a folder, not a file\n  add the name of a file in it", .path.display()
    )]
    IsFolder { path: PathBuf },
    #[error(
        "`{}` is neither a file nor a folder (a device or a pipe?)\n  \
         output is written to a temporary file beside it and then renamed: name an ordinary file", .path.display()
    )]
    NotAFile { path: PathBuf },
    #[error(
        "the folder `{}` for `{}` does not exist\n  create it first: mkdir -p '{}'",
        .folder.display(), .path.display(), .folder.display()
    )]
    MissingFolder { folder: PathBuf, path: PathBuf },
    #[error("`{}` is not a folder, so `{}` cannot be written in it\n  choose another place", .folder.display(), .path.display())]
    NotAFolder { folder: PathBuf, path: PathBuf },
    #[error(
        "cannot write in the folder `{}`\n  choose a folder that you may write in and whose disk is not full",
        .folder.display()
    )]
    FolderNotWritable { folder: PathBuf, source: io::Error },
    #[error("cannot make the folder `{}`\n  choose a place that is no file and may be written", .folder.display())]
    FolderNotMade { folder: PathBuf, source: io::Error },
    #[error("`{}` is protected against writing\n  choose another name, or: chmod u+w '{}'", .path.display(), .path.display())]
    ReadOnly { path: PathBuf },
    #[error("`{}` exists already\n  choose another name, or give --force to replace it", .path.display())]
    Exists { path: PathBuf },
    #[error("cannot access `{}`\n  check that you may read the folders on the way to it", .path.display())]
    Unreachable { path: PathBuf, source: io::Error },
    #[error("writing `{}` failed, and nothing was changed\n  check that its disk has room", .path.display())]
    Write { path: PathBuf, source: io::Error },
}
