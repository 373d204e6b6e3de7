//! Reports why a checkpoint cannot be used, where the fault is, and how to mend it.

use std::io;
use std::path::PathBuf;

/// The reason why a checkpoint was refused. The file is unchanged. The messages explain the variants.
#[allow(missing_docs)]
#[derive(Debug, thiserror::Error)]
pub enum CheckpointError {
    #[error("cannot read the checkpoint `{path}`")]
    Read { path: PathBuf, source: io::Error },
    #[error("there is no part `{path}`\n  render it with --shard and -o, or check its name")]
    NoPart { path: PathBuf },
    #[error(
        "`{path}` is not a checkpoint of octray\n  \
         name a checkpoint or a part: a file of another kind is neither read nor replaced"
    )]
    NotACheckpoint { path: PathBuf },
    #[error(
        "the checkpoint `{path}` has version {found} of the format, and this octray reads version {reads}\n  \
         finish it with the octray that made it, or delete it to start anew"
    )]
    Version { path: PathBuf, found: u32, reads: u32 },
    #[error(
        "the checkpoint `{path}` is damaged: {what}\n  delete it and render again, or take an earlier copy"
    )]
    Damaged { path: PathBuf, what: String },
    #[error(
        "the checkpoint `{path}` is of another picture\n  {}\n  \
         give the scene and the options that it was begun with, or another file, or delete it to start anew",
        .differences.join("\n  ")
    )]
    Differs { path: PathBuf, differences: Vec<String> },
    #[error("the parts do not make one picture\n  {}\n  {mend}", .faults.join("\n  "))]
    Parts { faults: Vec<String>, mend: &'static str },
}
