//! Watches a scene's files, so that the scene is reloaded when one of them changes.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant, SystemTime};

/// Interval at which files are looked at, and for which they must be unchanged before they are read: editors
/// write in several steps.
const INTERVAL: Duration = Duration::from_millis(150);
/// A file system's clock is behind the system's by up to this.
const CLOCK_TICK: Duration = Duration::from_millis(10);

/// What tells that a file changed: its modification time and size; `None` if it does not exist.
type Stamp = Option<(SystemTime, u64)>;

/// A set of watched files, existing or not.
#[derive(Default)]
pub struct FileWatcher {
    files: BTreeMap<PathBuf, Stamp>,
    /// Whether one of them changed when they were last looked at, and when that was.
    changed: bool,
    looked: Option<Instant>,
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

    /// Whether a file changed and then stayed unchanged for a while. True once per change.
    pub fn have_changed(&mut self, now: Instant) -> bool {
        if self.looked.is_some_and(|looked| now - looked < INTERVAL) {
            return false;
        }
        self.looked = Some(now);
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

    /// How often a change is reported when files are looked at a few times.
    fn reports(files: &mut FileWatcher) -> usize {
        let start = files.looked.unwrap_or_else(Instant::now);
        (1..=4).filter(|&times| files.have_changed(start + times * INTERVAL)).count()
    }

    #[test]
    fn changes_of_watched_files_are_reported_once_and_of_others_never() {
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        let (scene, deep) = (path("scene.json"), path("pictures/of/it.png"));
        fs::write(&scene, "1").unwrap();
        let read = SystemTime::now() + 2 * CLOCK_TICK;
        let mut files = FileWatcher::default();
        files.watch([scene.as_path(), &deep, &scene], read);
        fs::write(path("other.json"), "2").unwrap();
        assert_eq!(reports(&mut files), 0, "another file");
        fs::write(&scene, "12").unwrap();
        assert_eq!(reports(&mut files), 1);
        // As many editors save.
        fs::write(path("scene.json~"), "123").unwrap();
        fs::rename(path("scene.json~"), &scene).unwrap();
        assert_eq!(reports(&mut files), 1);
        assert!(!fs::read_to_string(&scene).unwrap().is_empty());
        assert_eq!(reports(&mut files), 0, "reading is no change");
        fs::remove_file(&scene).unwrap();
        assert_eq!(reports(&mut files), 1, "removed");
        fs::write(&scene, "1234").unwrap();
        files.watch([scene.as_path(), &deep], read);
        assert_eq!(reports(&mut files), 1, "nothing is lost while others are watched");
        fs::create_dir_all(path("pictures/of")).unwrap();
        fs::write(&deep, "1").unwrap();
        assert_eq!(reports(&mut files), 1, "created, with its folder");
        let looked = files.looked.unwrap();
        for (step, text) in ["a", "ab", "abc"].into_iter().enumerate() {
            fs::write(&scene, text).unwrap();
            assert!(!files.have_changed(looked + (step as u32 + 1) * INTERVAL), "not quiet yet");
        }
        assert_eq!(reports(&mut files), 1);
        files.watch([], read);
        fs::write(&scene, "4").unwrap();
        assert_eq!(reports(&mut files), 0, "no longer watched");
        files.watch([scene.as_path()], SystemTime::UNIX_EPOCH);
        assert_eq!(reports(&mut files), 1, "changed after it was read and before it was watched");
    }
}
