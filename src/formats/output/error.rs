//! Reports why an output file was not written, and how to mend it.

use std::io;
use std::path::PathBuf;

/// The reason why a file was not written. Any earlier file is unchanged. The messages explain the variants.
#[derive(Debug, thiserror::Error)]
#[allow(missing_docs)]
pub enum OutputError {
    #[error(
        "the name `{path}` does not say which picture format to write\n  \
         end it in .png or .jpg (for screens), or .exr or .hdr (linear radiance)"
    )]
    UnknownFormat { path: PathBuf },
    #[error("`{path}` is a folder, not a file\n  add the name of a file in it")]
    IsFolder { path: PathBuf },
    #[error(
        "`{path}` is neither a file nor a folder (a device or a pipe?)\n  \
         output is written to a temporary file beside it and then renamed: name an ordinary file"
    )]
    NotAFile { path: PathBuf },
    #[error("the folder `{folder}` for `{path}` does not exist\n  create it first: mkdir -p '{folder}'")]
    MissingFolder { folder: PathBuf, path: PathBuf },
    #[error("`{folder}` is not a folder, so `{path}` cannot be written in it\n  choose another place")]
    NotAFolder { folder: PathBuf, path: PathBuf },
    #[error(
        "cannot write in the folder `{folder}`\n  \
         choose a folder that you may write in and whose disk is not full"
    )]
    FolderNotWritable { folder: PathBuf, source: io::Error },
    #[error("cannot make the folder `{folder}`\n  choose a place that is no file and may be written")]
    FolderNotMade { folder: PathBuf, source: io::Error },
    #[error("`{path}` is protected against writing\n  choose another name, or: chmod u+w '{path}'")]
    ReadOnly { path: PathBuf },
    #[error("`{path}` exists already\n  choose another name, or give --force to replace it")]
    Exists { path: PathBuf },
    #[error("cannot access `{path}`\n  check that you may read the folders on the way to it")]
    Unreachable { path: PathBuf, source: io::Error },
    #[error("writing `{path}` failed, and nothing was changed\n  check that its disk has room")]
    Write { path: PathBuf, source: io::Error },
}
