//! Refuses outputs that would replace what the same command reads, or each other.

use super::error::{CliError, refuse};
use std::collections::HashSet;
use std::path::{Path, PathBuf};

/// Refuses an output, given with its option, that is one of the inputs or an earlier output.
pub fn keep_inputs<'a>(
    inputs: &[PathBuf],
    outputs: impl IntoIterator<Item = (&'static str, &'a Path)>,
) -> Result<(), CliError> {
    let mut taken: HashSet<PathBuf> =
        inputs.iter().filter(|file| file.exists()).map(|file| place(file)).collect();
    let inputs = taken.clone();
    for (option, file) in outputs {
        let place = place(file);
        if inputs.contains(&place) {
            let instead = "this command reads this file, which would be replaced: give another name";
            return Err(refuse(option, file.display(), instead));
        }
        if !taken.insert(place) {
            return Err(refuse(option, file.display(), "it is also another output: give another file"));
        }
    }
    Ok(())
}

/// Returns whether both are the same file, there or not.
pub fn is_same(one: &Path, other: &Path) -> bool {
    place(one) == place(other)
}

/// Returns a key that identifies a file. A file that exists has its device and inode as key, which are the
/// same by every link and, where the system ignores case, spelling. A new file has its canonical path, or the
/// path itself where its folder does not exist.
fn place(path: &Path) -> PathBuf {
    #[cfg(unix)]
    if let Ok(found) = path.metadata() {
        use std::os::unix::fs::MetadataExt;
        return format!("{} {}", found.dev(), found.ino()).into();
    }
    let folder = path.parent().unwrap_or(Path::new("")).join(".").canonicalize();
    let of_new = |folder: PathBuf| path.file_name().map(|name| folder.join(name));
    path.canonicalize().ok().or_else(|| folder.ok().and_then(of_new)).unwrap_or_else(|| path.into())
}
