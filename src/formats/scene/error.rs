//! Reports why a scene was refused, where the fault is, and how to mend it.

use octray_engine::scene::Scene;
use std::path::PathBuf;

/// Most faults of a file in one error.
pub const MAX_FAULTS: usize = 10;

/// The reason why a scene was refused.
#[derive(Debug, Default, thiserror::Error)]
#[error("{what}{}{}{}", place(.file, .at), remedy(.mend), further(.others))]
pub struct SceneError {
    /// The fault, as a clause without a full stop.
    pub what: String,
    /// The file that contains the fault.
    pub file: Option<PathBuf>,
    /// The place in the file: a JSON path (`materials.clay.color[1]`) or `line 12, column 5`, or both.
    pub at: Option<Box<str>>,
    /// The remedy.
    pub mend: Option<Box<str>>,
    /// The other faults of the file in its order, at most [`MAX_FAULTS`] in all.
    pub others: Box<[SceneError]>,
    /// The files requested until then, existing or not. Loading may succeed once one of them changes.
    pub files: Vec<PathBuf>,
}

fn place(file: &Option<PathBuf>, at: &Option<Box<str>>) -> String {
    match (file, at) {
        (Some(file), Some(at)) => format!("\n  at {}: {at}", file.display()),
        (Some(file), None) => format!("\n  in {}", file.display()),
        (None, Some(at)) => format!("\n  at {at}"),
        (None, None) => String::new(),
    }
}

fn remedy(mend: &Option<Box<str>>) -> String {
    mend.as_ref().map(|mend| format!("\n  {mend}")).unwrap_or_default()
}

fn further(others: &[SceneError]) -> String {
    others.iter().map(|error| format!("\nalso: {error}")).collect()
}

impl SceneError {
    /// Makes an error without a file and a remedy.
    pub(super) fn new(what: impl Into<String>) -> Self {
        Self { what: what.into(), ..Self::default() }
    }
    /// Joins the faults of a file in one error; `None` without faults.
    pub(super) fn join(faults: Vec<Self>) -> Option<Self> {
        let mut all = Vec::new();
        for mut fault in faults {
            let others = std::mem::take(&mut fault.others);
            all.push(fault);
            all.extend(others);
        }
        all.sort_by_key(Self::line_and_column);
        all.truncate(MAX_FAULTS);
        let mut all = all.into_iter();
        all.next().map(|first| Self { others: all.collect(), ..first })
    }
    /// Makes an error about a valid scene that cannot be used.
    pub fn unusable(why: String, scene: &Scene) -> Self {
        Self::new(format!("{}: {why}", scene.name)).after(scene.files.clone())
    }
    /// Makes an error about a scene for which [`Scene::overview`] has no camera.
    pub fn no_overview(scene: &Scene) -> Self {
        let what = "is so small, or so far from the origin, that no camera can stand beside it";
        Self::new(format!("`{}` {what}", scene.name)).mend("move it to the origin, or scale it up")
    }
    pub(super) fn in_file(self, file: impl Into<PathBuf>) -> Self {
        Self { file: Some(file.into()), ..self }
    }
    pub(super) fn at_place(self, at: impl Into<Box<str>>) -> Self {
        Self { at: Some(at.into()), ..self }
    }
    /// Returns the JSON path of `at`.
    pub(super) fn place(&self) -> &str {
        self.at.as_deref().unwrap_or_default().split(", line ").next().unwrap_or_default()
    }
    /// Returns the line and the column at the end of `at`; 0 if there are none.
    fn line_and_column(&self) -> [usize; 2] {
        let numbers = self.at.as_deref().and_then(|at| at.rsplit_once("line ")?.1.split_once(", column "));
        let (line, column) = numbers.unwrap_or_default();
        [line, column].map(|number| number.parse().unwrap_or(0))
    }
    /// Adds requested files.
    pub(super) fn after(mut self, files: Vec<PathBuf>) -> Self {
        self.files.extend(files);
        self
    }
    pub(super) fn mend(self, mend: impl Into<String>) -> Self {
        Self { mend: Some(mend.into().into_boxed_str()), ..self }
    }
}
