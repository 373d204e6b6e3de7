//! Reads the other files of a scene: from a folder on disk, the program itself, or a caller's function.

use super::embedded;
use super::error::SceneError;
use super::statements::without_comment;
use std::cell::RefCell;
use std::collections::HashSet;
use std::ffi::OsString;
use std::fs::{self, File};
use std::io::{self, ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// The names that stand for a scene, for messages.
pub const FILES: &str = "a scene (.json), a model (.obj, .gltf, .glb, .ply), or `builtin:NAME`";

/// Tests whether a file's name ends in this extension, in upper or lower case.
pub fn has_extension(path: &Path, wanted: &str) -> bool {
    path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(wanted))
}

const NO_FILE: &str = "no such file";

/// Largest file that is read, in bytes.
const MAX_FILE: u64 = 1 << 34;

/// A function that returns the content of the file at a path.
pub type Reading = dyn Fn(&Path) -> io::Result<Vec<u8>>;

/// The files that a scene may name, and the list of those that are requested while it is loaded, which copies
/// share. The default has the files inside the program, named relative to `scenes/`.
#[derive(Clone)]
pub struct Files {
    /// The folder of relative paths; `None` inside the program.
    folder: Option<PathBuf>,
    reading: Rc<Reading>,
    /// Whether the scene also keeps its unrounded points, for the reference.
    pub unrounded: bool,
    /// Returns the names in a folder.
    listing: fn(&Path) -> Vec<OsString>,
    requested: Rc<RefCell<Requested>>,
}

/// The paths outside the program that were requested, existing or not.
#[derive(Default)]
struct Requested {
    /// The paths in the order of the first request.
    list: Vec<PathBuf>,
    /// The same paths, for lookup.
    seen: HashSet<PathBuf>,
}

impl Default for Files {
    fn default() -> Self {
        let reading = |path: &Path| Ok(embedded::file(path).ok_or(ErrorKind::NotFound)?.to_vec());
        let (reading, requested) = (Rc::new(reading), Rc::default());
        Self { folder: None, reading, unrounded: false, listing: |_| Vec::new(), requested }
    }
}

impl Files {
    /// Returns the files beside `file` on disk.
    pub fn beside(file: &Path) -> Self {
        Self { listing: list_on_disk, ..Self::given(file, Rc::new(read_from_disk)) }
    }
    /// Returns the files beside `file` that a function reads.
    pub fn given(file: &Path, reading: Rc<Reading>) -> Self {
        Self { reading, ..Self::default() }.beside_other(file)
    }
    /// Returns these files for a scene that keeps its unrounded points, or does not.
    pub fn with_unrounded(self, unrounded: bool) -> Self {
        Self { unrounded, ..self }
    }
    /// Returns the files beside another file, read as these are.
    pub fn beside_other(&self, file: &Path) -> Self {
        let folder = file.parent().unwrap_or(Path::new(""));
        Self { folder: Some(folder.to_path_buf()), ..self.clone() }
    }
    /// Returns the folder of relative paths, if it is outside the program.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }
    /// Resolves a path relative to the folder. Files inside the program lose a leading `./`.
    pub fn resolve(&self, path: &str) -> PathBuf {
        match &self.folder {
            Some(folder) => folder.join(path),
            None => PathBuf::from(path.trim_start_matches("./")),
        }
    }
    /// Reads the content of a resolved path. The error is the reason why there is none.
    pub fn read(&self, path: &Path) -> Result<Vec<u8>, String> {
        let mut requested = self.requested.borrow_mut();
        if self.folder.is_some() && requested.seen.insert(path.to_path_buf()) {
            requested.list.push(path.to_path_buf());
        }
        (self.reading)(path).map_err(|error| match error.kind() {
            ErrorKind::NotFound => NO_FILE.to_string(),
            ErrorKind::PermissionDenied => "no permission to read it".to_string(),
            _ => error.to_string(),
        })
    }
    /// Returns the result of `attempt` for the file that a model names, or the reason why it fails. The model
    /// may come from another machine: `\` separates folders too, upper and lower case are the same, and a
    /// path that leads nowhere is tried by its last name, in the folders of the two files `beside`.
    pub fn find<T>(
        &self,
        name: &str,
        beside: [&Path; 2],
        mut attempt: impl FnMut(&Path) -> Result<T, String>,
    ) -> Result<T, String> {
        let [first, second] = beside.map(|file| file.parent().unwrap_or(Path::new("")));
        let mut reason = NO_FILE.to_string();
        for name in without_comment(name) {
            let path = name.replace('\\', "/");
            let last = path.rsplit('/').next().unwrap_or_default();
            for (folder, path) in [(first, name), (first, &path), (first, last), (second, last)] {
                let alike = std::iter::once_with(|| self.alike(folder, path)).flatten();
                for path in std::iter::once(folder.join(path)).chain(alike) {
                    match attempt(&path) {
                        Ok(found) => return Ok(found),
                        Err(why) if why != NO_FILE => reason = why,
                        Err(_) => {}
                    }
                }
            }
        }
        Err(reason)
    }
    /// Returns an existing path in `folder` that differs from this one at most in the case of letters.
    fn alike(&self, folder: &Path, path: &str) -> Option<PathBuf> {
        let mut parts = path.split('/').filter(|part| !["", "."].contains(part));
        parts.try_fold(folder.to_path_buf(), |folder, part| {
            let lower = part.to_lowercase();
            let is_alike = |name: &OsString| name.to_string_lossy().to_lowercase() == lower;
            let found = (self.listing)(&folder).into_iter().filter(is_alike).min();
            found.or_else(|| (part == "..").then(|| part.into())).map(|name| folder.join(name))
        })
    }
    /// Reads the content of a file that the user named on the command line.
    pub fn read_named(&self, path: &Path) -> Result<Vec<u8>, SceneError> {
        self.read(path).map_err(|reason| {
            SceneError::new(format!("cannot read the scene: {reason}"))
                .in_file(path)
                .mend(format!("give a file that exists and can be read: {FILES}"))
        })
    }
    /// Returns the paths requested outside the program, existing or not, in the order of the first request.
    pub fn into_requested(self) -> Vec<PathBuf> {
        std::mem::take(&mut self.requested.borrow_mut().list)
    }
}

fn list_on_disk(folder: &Path) -> Vec<OsString> {
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.map(|entry| entry.file_name()).collect()
}

/// Reads a regular file; others are refused, because a pipe or a device may never end. Memory for the length
/// at the beginning is allocated at once or not at all, and no more is read.
fn read_from_disk(path: &Path) -> io::Result<Vec<u8>> {
    let metadata = fs::metadata(path)?;
    if metadata.is_dir() {
        return Err(io::Error::other("it is a folder, not a file"));
    }
    if !metadata.is_file() {
        return Err(io::Error::other("it is not a regular file"));
    }
    let length = metadata.len();
    if length > MAX_FILE {
        return Err(io::Error::other(format!("it has {length} bytes, and at most {MAX_FILE} are read")));
    }
    let file = File::open(path)?;
    let mut content = Vec::new();
    content.try_reserve_exact(length as usize)?;
    file.take(length).read_to_end(&mut content)?;
    Ok(content)
}
