//! What can be wrong with a scene: what, where, and how to mend it.

use std::path::PathBuf;

/// Why a scene was refused.
#[derive(Debug, thiserror::Error)]
#[error("{what}{}{}", place(.file, .at), remedy(.mend))]
pub struct SceneError {
    /// What is wrong, as a clause without a full stop.
    pub what: String,
    /// The file it stands in.
    pub file: Option<PathBuf>,
    /// Where in the file: a JSON path (`materials.clay.color[1]`) or `line 12, column 5`, or both.
    pub at: Option<String>,
    /// What to do about it.
    pub mend: Option<String>,
}
