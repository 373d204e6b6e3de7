//! Reads a scene's other files: from a folder on disk, or from the program itself.
//!
//! For: [`Files`], which also records every path that was requested. May import: `embedded`, `error`. Must
//! not know: what the files hold.

use super::embedded;
use super::error::SceneError;
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::HashSet;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// What may be named as a scene.
pub const FILES: &str = "a scene (.json), a model (.obj, .gltf, .glb, .ply), or `builtin:NAME`";

/// The folder that a scene's relative paths start from, and the files that were requested while loading it.
pub struct Files {
    /// `None`: the files inside the program, named relative to `scenes/`.
    folder: Option<PathBuf>,
    /// Paths on disk, existing or not, in the order of the first request.
    requested: RefCell<Vec<PathBuf>>,
    /// The same paths, for lookup.
    seen: RefCell<HashSet<PathBuf>>,
}

impl Files {
    /// The files beside `file`.
    pub fn beside(file: &Path) -> Self {
        let folder = file.parent().unwrap_or(Path::new("")).to_path_buf();
        Self { folder: Some(folder), requested: RefCell::default(), seen: RefCell::default() }
    }
    /// The files inside the program.
    pub fn embedded() -> Self {
        Self { folder: None, requested: RefCell::default(), seen: RefCell::default() }
    }
    /// Where relative paths start, if on disk.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }
    /// The file that `path` names. A leading `./` is dropped for files inside the program.
    pub fn resolve(&self, path: &str) -> PathBuf {
        match &self.folder {
            Some(folder) => folder.join(path),
            None => PathBuf::from(path.trim_start_matches("./")),
        }
    }
    /// The content of a resolved path, or the reason why there is none.
    pub fn read(&self, path: &Path) -> Result<Cow<'static, [u8]>, String> {
        if self.folder.is_none() {
            return embedded::file(path).map(Cow::Borrowed).ok_or_else(|| "no such file".to_string());
        }
        self.record(path);
        read_from_disk(path).map(Cow::Owned)
    }
    /// The content of a file that the user named on the command line.
    pub fn read_named(&self, path: &Path) -> Result<Cow<'static, [u8]>, SceneError> {
        self.read(path).map_err(|reason| {
            SceneError::new(format!("cannot read the scene: {reason}"))
                .in_file(path)
                .mend(format!("give a file that exists and can be read: {FILES}"))
        })
    }
    pub fn exists(&self, path: &Path) -> bool {
        match self.folder {
            Some(_) => {
                self.record(path);
                path.is_file()
            }
            None => embedded::file(path).is_some(),
        }
    }
    /// The paths requested on disk, existing or not, in the order of the first request, each once.
    pub fn into_requested(self) -> Vec<PathBuf> {
        self.requested.into_inner()
    }
    fn record(&self, path: &Path) {
        if self.seen.borrow_mut().insert(path.to_path_buf()) {
            self.requested.borrow_mut().push(path.to_path_buf());
        }
    }
}

/// Anything but a regular file is refused: a pipe or a device may never end.
fn read_from_disk(path: &Path) -> Result<Vec<u8>, String> {
    let metadata = fs::metadata(path).map_err(reason)?;
    if metadata.is_dir() {
        return Err("it is a folder, not a file".to_string());
    }
    if !metadata.is_file() {
        return Err("it is not a regular file".to_string());
    }
    fs::read(path).map_err(reason)
}

fn reason(error: std::io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "no such file".to_string(),
        ErrorKind::PermissionDenied => "no permission to read it".to_string(),
        _ => error.to_string(),
    }
}
