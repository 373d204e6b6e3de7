//! Why a scene was refused: what, where, and how to mend it.
//!
//! For: [`SceneError`].

use octray_engine::scene::Scene;
use std::path::PathBuf;

/// Why a scene was refused.
#[derive(Debug, thiserror::Error)]
#[error("{what}{}{}", place(.file, .at), remedy(.mend))]
pub struct SceneError {
    /// What is wrong, as a clause without a full stop.
    pub what: String,
    /// The file that contains the fault.
    pub file: Option<PathBuf>,
    /// Where in the file: a JSON path (`materials.clay.color[1]`) or `line 12, column 5`, or both.
    pub at: Option<String>,
    /// How to mend it.
    pub mend: Option<String>,
    /// Every file requested until then, existing or not: once one of them changes, loading may succeed.
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
    /// An error without a file and a remedy.
    pub(super) fn new(what: impl Into<String>) -> Self {
        Self { what: what.into(), file: None, at: None, mend: None, files: Vec::new() }
    }
    /// A valid scene cannot be used, and why.
    pub fn of_use(why: String, scene: &Scene) -> Self {
        Self::new(format!("{}: {why}", scene.name)).after(scene.files.clone())
    }
    /// [`Scene::overview`] has no camera.
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
    /// Appends requested files.
    pub(super) fn after(mut self, files: Vec<PathBuf>) -> Self {
        self.files.extend(files);
        self
    }
    pub(super) fn mend(self, mend: impl Into<String>) -> Self {
        Self { mend: Some(mend.into()), ..self }
    }
}
