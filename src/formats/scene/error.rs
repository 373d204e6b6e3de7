//! What can be wrong with a scene: what, where, and how to mend it.

use super::Scene;
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
    /// Every file that was looked for until then, there or not: once one of them is another, it may be otherwise.
    pub files: Vec<PathBuf>,
}

fn place(file: &Option<PathBuf>, at: &Option<String>) -> String {
    match (file, at) {
        (Some(file), Some(at)) => format!("\n  at {}: {at}", file.display()),
        (Some(file), None) => format!("\n  in {}", file.display()),
        (None, Some(at)) => format!("\n  at {at}"),
        (None, None) => String::new(),
    }
}

fn remedy(mend: &Option<String>) -> String {
    mend.as_ref().map(|mend| format!("\n  {mend}")).unwrap_or_default()
}

impl SceneError {
    /// An error that knows neither its file nor its remedy yet.
    pub(super) fn new(what: impl Into<String>) -> Self {
        Self { what: what.into(), file: None, at: None, mend: None, files: Vec::new() }
    }
    /// That a valid scene cannot be used, and why; other files may be of more use.
    pub fn of_use(why: String, scene: &Scene) -> Self {
        Self::new(format!("{}: {why}", scene.name)).after(scene.files.clone())
    }
    /// That [`Scene::overview`] has no camera.
    pub fn no_overview(scene: &Scene) -> Self {
        let what = "is so small, or so far from the origin, that no camera can stand beside it";
        Self::new(format!("`{}` {what}", scene.name)).mend("move it to the origin, or scale it up")
    }
    pub(super) fn in_file(self, file: impl Into<PathBuf>) -> Self {
        Self { file: Some(file.into()), ..self }
    }
    pub(super) fn at(self, at: impl Into<String>) -> Self {
        Self { at: Some(at.into()), ..self }
    }
    /// After those that are known already.
    pub(super) fn after(mut self, files: Vec<PathBuf>) -> Self {
        self.files.extend(files);
        self
    }
    pub(super) fn mend(self, mend: impl Into<String>) -> Self {
        Self { mend: Some(mend.into()), ..self }
    }
}
