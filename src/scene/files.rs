//! Where a scene's other files come from: a folder on disk, or the program itself.
//!
//! For: [`Files`], which also remembers what was read. May import: `builtin` (the embedded table). Must never know: what the files hold.

use super::{SceneError, builtin};
use std::borrow::Cow;
use std::cell::RefCell;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The folder that a scene's relative paths start from, and the files that were read on the way to the scene.
pub struct Files {
    /// `None`: the files inside the program, named as in the project's folder of scenes.
    folder: Option<PathBuf>,
    /// Those on disk, in the order of their first reading.
    opened: RefCell<Vec<PathBuf>>,
}

impl Files {
    /// The files beside `file`.
    pub fn beside(file: &Path) -> Self {
        let folder = file.parent().unwrap_or(Path::new("")).to_path_buf();
        Self { folder: Some(folder), opened: RefCell::default() }
    }
    /// The files inside the program.
    pub fn embedded() -> Self {
        Self { folder: None, opened: RefCell::default() }
    }
    /// Where relative paths start, if that is on disk.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }
    /// The file that `path` means; slashes may lean either way in the program's own files.
    pub fn resolve(&self, path: &str) -> PathBuf {
        match &self.folder {
            Some(folder) => folder.join(path),
            None => PathBuf::from(path.trim_start_matches("./")),
        }
    }
    /// The content of a resolved path, or the reason why there is none.
    pub fn read(&self, path: &Path) -> Result<Cow<'static, [u8]>, String> {
        if self.folder.is_none() {
            return builtin::embedded(path).map(Cow::Borrowed).ok_or_else(|| "no such file".to_string());
        }
        let content = read_from_disk(path)?;
        let mut opened = self.opened.borrow_mut();
        if !opened.iter().any(|known| known == path) {
            opened.push(path.to_path_buf());
        }
        Ok(Cow::Owned(content))
    }
    /// The content of a file that the user named on the command line.
    pub fn read_named(&self, path: &Path) -> Result<Cow<'static, [u8]>, SceneError> {
        self.read(path).map_err(|reason| {
            SceneError::new(format!("cannot read the scene: {reason}"))
                .in_file(path)
                .mend("give a .json or .obj file that exists and can be read, or `builtin:NAME`")
        })
    }
    pub fn exists(&self, path: &Path) -> bool {
        match self.folder {
            Some(_) => path.is_file(),
            None => builtin::embedded(path).is_some(),
        }
    }
    /// What was read from disk, as it was opened, each path once.
    pub fn into_opened(self) -> Vec<PathBuf> {
        self.opened.into_inner()
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
