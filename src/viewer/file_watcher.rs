//! Watches a scene's files for changes.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// Interval at which files are checked. A changed file must be unchanged for one interval before it is read,
/// because editors write in several steps.
const INTERVAL: Duration = Duration::from_millis(150);
/// A file system's clock is behind the system's by up to this.
const CLOCK_TICK: Duration = Duration::from_millis(10);

/// Modification time and size of a file; `None` if it does not exist.
type Stamp = Option<(SystemTime, u64)>;

/// A set of watched files, existing or not.
#[derive(Default)]
pub struct FileWatcher {
    files: BTreeMap<PathBuf, Stamp>,
    /// Whether one of them had changed at the last check.
    changed: bool,
    checked: Option<Instant>,
}

impl FileWatcher {
    /// Watches these files from now on, and no others. A file that was not watched counts as changed if it
    /// may have been modified after `read`. Modification times in the future are ignored.
    pub fn watch<'a>(&mut self, files: impl IntoIterator<Item = &'a Path>, read: SystemTime) {
        let mut before = std::mem::take(&mut self.files);
        for file in files.into_iter().collect::<BTreeSet<_>>() {
            let stamp = before.remove(file).unwrap_or_else(|| {
                let stamp = stamp_of(file);
                self.changed |= stamp.is_some_and(|(modified, _)| {
                    modified + CLOCK_TICK > read && modified <= SystemTime::now()
                });
                stamp
            });
            self.files.insert(file.to_path_buf(), stamp);
        }
    }

    /// Tests whether a file changed and then stayed unchanged for a while. True once per change.
    pub fn has_changed(&mut self, now: Instant) -> bool {
        if self.checked.is_some_and(|checked| now - checked < INTERVAL) {
            return false;
        }
        self.checked = Some(now);
        let mut differs = false;
        for (file, seen) in &mut self.files {
            let stamp = stamp_of(file);
            differs |= stamp != std::mem::replace(seen, stamp);
        }
        std::mem::replace(&mut self.changed, differs) && !differs
    }
}

fn stamp_of(file: &Path) -> Stamp {
    let file = fs::metadata(file).ok()?;
    Some((file.modified().ok()?, file.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns how often four checks report a change.
    fn reports(files: &mut FileWatcher) -> usize {
        let start = files.checked.unwrap_or_else(Instant::now);
        (1..=4).filter(|&times| files.has_changed(start + times * INTERVAL)).count()
    }

    #[test]
    fn changes_of_watched_files_are_reported_once_when_they_end() {
        let folder = tempfile::tempdir().unwrap();
        let [scene, missing] = ["scene.json", "pictures/of/it.png"].map(|name| folder.path().join(name));
        fs::write(&scene, "1").unwrap();
        let read = SystemTime::now() + 2 * CLOCK_TICK;
        let mut files = FileWatcher::default();
        files.watch([scene.as_path(), &missing], read);
        assert_eq!(reports(&mut files), 0);
        let checked = files.checked.unwrap();
        for (step, text) in ["a", "ab", "abc"].into_iter().enumerate() {
            fs::write(&scene, text).unwrap();
            assert!(!files.has_changed(checked + (step as u32 + 1) * INTERVAL), "it still changes");
        }
        assert_eq!(reports(&mut files), 1);
        fs::write(&scene, "1234").unwrap();
        files.watch([scene.as_path(), &missing], read);
        assert_eq!(reports(&mut files), 1, "watching anew loses no change");
        files.watch([], read);
        files.watch([scene.as_path()], SystemTime::UNIX_EPOCH);
        assert_eq!(reports(&mut files), 1, "changed after it was read and before it was watched");
    }
}
