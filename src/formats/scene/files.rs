//! Reads a scene's other files: from a folder on disk, from the program itself, or from a caller's function.
//!
//! For: [`Files`], which also records every path that was requested, and [`has_extension`].

use super::embedded;
use super::error::SceneError;
use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// What may be named as a scene.
pub const FILES: &str = "a scene (.json), a model (.obj, .gltf, .glb, .ply), or `builtin:NAME`";

/// Whether a file's name ends in this extension, in letters of either case.
pub fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

/// Largest file that is read, in bytes.
const MAX_FILE: u64 = 1 << 34;

/// The content of the file at a path.
pub type Reading = dyn Fn(&Path) -> io::Result<Vec<u8>>;

/// Where the content of files comes from.
#[derive(Clone, Default)]
enum Store {
    Disk,
    /// The files inside the program, named relative to `scenes/`.
    #[default]
    Program,
    Given(Rc<Reading>),
}

/// The folder that a scene's relative paths start from, and the files that were requested while loading it.
/// Copies record in the same list. By default the files inside the program.
#[derive(Clone, Default)]
pub struct Files {
    folder: PathBuf,
    store: Store,
    requested: Rc<RefCell<Requested>>,
}

/// Paths outside the program that were requested, existing or not.
#[derive(Default)]
struct Requested {
    /// In the order of the first request.
    list: Vec<PathBuf>,
    /// The same paths, for lookup.
    seen: HashSet<PathBuf>,
}

impl Files {
    /// The files beside `file` on disk.
    pub fn beside(file: &Path) -> Self {
        Self { folder: folder_of(file), store: Store::Disk, ..Self::default() }
    }
    /// The files beside `file`, from a function.
    pub fn given(file: &Path, reading: Rc<Reading>) -> Self {
        Self { folder: folder_of(file), store: Store::Given(reading), ..Self::default() }
    }
    /// The files beside another file, from where these come from.
    pub fn beside_other(&self, file: &Path) -> Self {
        Self { folder: folder_of(file), ..self.clone() }
    }
    /// Where relative paths start, if outside the program.
    pub fn folder(&self) -> Option<&Path> {
        match self.store {
            Store::Program => None,
            Store::Disk | Store::Given(_) => Some(&self.folder),
        }
    }
    /// The file that `path` names. A leading `./` is dropped for files inside the program.
    pub fn resolve(&self, path: &str) -> PathBuf {
        match self.folder() {
            Some(folder) => folder.join(path),
            None => PathBuf::from(path.trim_start_matches("./")),
        }
    }
    /// The content of a resolved path, or the reason why there is none.
    pub fn read(&self, path: &Path) -> Result<Cow<'static, [u8]>, String> {
        match &self.store {
            Store::Program => {
                embedded::file(path).map(Cow::Borrowed).ok_or_else(|| "no such file".to_string())
            }
            Store::Disk => {
                self.record(path);
                read_from_disk(path).map(Cow::Owned)
            }
            Store::Given(reading) => {
                self.record(path);
                reading(path).map(Cow::Owned).map_err(reason)
            }
        }
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
        match &self.store {
            Store::Disk => {
                self.record(path);
                path.is_file()
            }
            Store::Program | Store::Given(_) => self.read(path).is_ok(),
        }
    }
    /// The paths requested outside the program, existing or not, each once, in the order of requests.
    pub fn into_requested(self) -> Vec<PathBuf> {
        std::mem::take(&mut self.requested.borrow_mut().list)
    }
    fn record(&self, path: &Path) {
        let mut requested = self.requested.borrow_mut();
        if requested.seen.insert(path.to_path_buf()) {
            requested.list.push(path.to_path_buf());
        }
    }
}

fn folder_of(file: &Path) -> PathBuf {
    file.parent().unwrap_or(Path::new("")).to_path_buf()
}

/// Anything but a regular file is refused: a pipe or a device may never end. Reads as much as the file has at
/// the beginning, and allocates it at once or not at all.
fn read_from_disk(path: &Path) -> Result<Vec<u8>, String> {
    let metadata = fs::metadata(path).map_err(reason)?;
    if metadata.is_dir() {
        return Err("it is a folder, not a file".to_string());
    }
    if !metadata.is_file() {
        return Err("it is not a regular file".to_string());
    }
    let length = metadata.len();
    if length > MAX_FILE {
        return Err(format!("it has {length} bytes, and at most {MAX_FILE} are read"));
    }
    let file = File::open(path).map_err(reason)?;
    let mut content = Vec::new();
    content.try_reserve_exact(length as usize).map_err(|error| error.to_string())?;
    file.take(length).read_to_end(&mut content).map_err(reason)?;
    Ok(content)
}

fn reason(error: io::Error) -> String {
    match error.kind() {
        ErrorKind::NotFound => "no such file".to_string(),
        ErrorKind::PermissionDenied => "no permission to read it".to_string(),
        _ => error.to_string(),
    }
}
