//! Where a scene's other files come from: a folder on disk, or the program itself.
//!
//! For: [`Files`]. May import: `builtin` (the embedded table). Must never know: what the files hold.

use super::{SceneError, builtin};
use std::borrow::Cow;
use std::fs;
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// The folder that a scene's relative paths start from.
pub enum Files {
    Disk(PathBuf),
    /// The files inside the program, named as in the project's folder of scenes.
    Embedded,
}

impl Files {
    /// The files beside `file`.
    pub fn beside(file: &Path) -> Self {
        Files::Disk(file.parent().unwrap_or(Path::new("")).to_path_buf())
    }
    /// The file that `path` means; slashes may lean either way in the program's own files.
    pub fn resolve(&self, path: &str) -> PathBuf {
        match self {
            Files::Disk(folder) => folder.join(path),
            Files::Embedded => PathBuf::from(path.trim_start_matches("./")),
        }
    }
    /// The content of a resolved path, or the reason why there is none.
    pub fn read(&self, path: &Path) -> Result<Cow<'static, [u8]>, String> {
        match self {
            Files::Disk(_) => read_from_disk(path).map(Cow::Owned),
            Files::Embedded => {
                builtin::embedded(path).map(Cow::Borrowed).ok_or_else(|| "no such file".to_string())
            }
        }
    }
    pub fn exists(&self, path: &Path) -> bool {
        match self {
            Files::Disk(_) => path.is_file(),
            Files::Embedded => builtin::embedded(path).is_some(),
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

/// The content of a file that the user named on the command line.
pub fn read_named(path: &Path) -> Result<Vec<u8>, SceneError> {
    read_from_disk(path).map_err(|reason| {
        SceneError::new(format!("cannot read the scene: {reason}"))
            .in_file(path)
            .mend("give a .json or .obj file that exists and can be read, or `builtin:NAME`")
    })
}
