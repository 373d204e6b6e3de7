//! Watches a scene's files, so that the scene is reloaded when one of them changes.
//!
//! For: [`FileWatcher`].

use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant, SystemTime};

/// How long files must be unchanged before they are read: editors write in several steps.
const QUIET_TIME: Duration = Duration::from_millis(150);

/// A set of watched files. On systems without file watching it reports nothing.
pub struct FileWatcher {
    watcher: Option<RecommendedWatcher>,
    changes: Receiver<notify::Result<notify::Event>>,
    files: BTreeSet<PathBuf>,
    folders: BTreeSet<PathBuf>,
    /// When one of them last changed.
    changed: Option<Instant>,
}

impl FileWatcher {
    /// `notify` is called after every event in a watched folder.
    pub fn new(notify: impl Fn() + Send + 'static) -> Self {
        let (sender, changes) = channel();
        let watcher = notify::recommended_watcher(move |change| {
            // Fails only after the receiver was dropped.
            let _ = sender.send(change);
            notify();
        })
        .ok();
        Self { watcher, changes, files: BTreeSet::new(), folders: BTreeSet::new(), changed: None }
    }

    /// Watches these files from now on, and no others. Paths without a file name are ignored.
    pub fn watch<'a>(&mut self, files: impl IntoIterator<Item = &'a Path>) {
        let Some(watcher) = &mut self.watcher else { return };
        self.files = files.into_iter().filter_map(canonical_path).collect();
        // Folders are watched: many editors replace a file by a new one, which a watch of the old one does
        // not report.
        let folders: BTreeSet<PathBuf> =
            self.files.iter().filter_map(|file| Some(file.parent()?.to_path_buf())).collect();
        for gone in self.folders.difference(&folders) {
            let _ = watcher.unwatch(gone);
        }
        let new: Vec<&PathBuf> = folders.difference(&self.folders).collect();
        for folder in new {
            let _ = watcher.watch(folder, RecursiveMode::NonRecursive);
        }
        self.folders = folders;
    }

    /// Whether a file changed and then stayed unchanged for `QUIET_TIME`. True once per change.
    pub fn have_changed(&mut self, now: Instant) -> bool {
        while let Ok(change) = self.changes.try_recv() {
            let Ok(change) = change else { continue };
            let matters = !matches!(change.kind, EventKind::Access(_));
            if matters && change.paths.iter().any(|path| self.files.contains(path)) {
                self.changed = Some(now);
            }
        }
        let over = self.changed.is_some_and(|changed| now - changed >= QUIET_TIME);
        if over {
            self.changed = None;
        }
        over
    }
}

/// Canonical path of a file that exists or not; if its folder is missing, that of the nearest missing folder.
fn canonical_path(file: &Path) -> Option<PathBuf> {
    file.canonicalize().ok().or_else(|| {
        let folder = match file.parent()? {
            here if here.as_os_str().is_empty() => Path::new("."),
            folder => folder,
        };
        match folder.canonicalize() {
            Ok(folder) => Some(folder.join(file.file_name()?)),
            Err(_) => canonical_path(folder),
        }
    })
}

/// A file system's clock is behind the system's by up to this.
const CLOCK_TICK: Duration = Duration::from_millis(10);

/// Whether a file may have been modified after `than`. Modification times in the future are ignored.
pub fn is_newer<'a>(files: impl IntoIterator<Item = &'a Path>, than: SystemTime) -> bool {
    let written = |file: &Path| std::fs::metadata(file).and_then(|file| file.modified()).ok();
    let now = SystemTime::now();
    files.into_iter().filter_map(written).any(|written| written + CLOCK_TICK > than && written <= now)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::thread::sleep;

    /// Whether a change is reported within `patience`.
    fn detects_change(files: &mut FileWatcher, patience: Duration) -> bool {
        let start = Instant::now();
        while start.elapsed() < patience {
            if files.have_changed(Instant::now()) {
                return true;
            }
            sleep(Duration::from_millis(5));
        }
        false
    }

    #[test]
    fn changes_of_watched_files_are_reported_once_and_of_others_never() {
        let (long, short) = (Duration::from_secs(20), Duration::from_millis(600));
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["scene.json", "other.json"] {
            fs::write(path(name), "1").unwrap();
        }
        let mut files = FileWatcher::new(|| {});
        if files.watcher.is_none() {
            eprintln!("skipped: this system watches no files");
            return;
        }
        let scene = path("scene.json");
        files.watch([scene.as_path(), Path::new("no such folder/file")]);
        fs::write(path("other.json"), "2").unwrap();
        assert!(!detects_change(&mut files, short), "another file");
        fs::write(&scene, "2").unwrap();
        assert!(detects_change(&mut files, long));
        assert!(!detects_change(&mut files, short), "once");
        // As many editors save.
        fs::write(path("scene.json~"), "3").unwrap();
        fs::rename(path("scene.json~"), &scene).unwrap();
        assert!(detects_change(&mut files, long));
        assert!(!fs::read_to_string(&scene).unwrap().is_empty());
        assert!(!detects_change(&mut files, short), "reading is no change");
        fs::remove_file(&scene).unwrap();
        assert!(detects_change(&mut files, long), "removed");
        files.watch([scene.as_path()]);
        fs::write(&scene, "5").unwrap();
        assert!(detects_change(&mut files, long), "created again");
        fs::write(&scene, "6").unwrap();
        sleep(Duration::from_millis(20));
        assert!(!files.have_changed(Instant::now()), "not quiet yet");
        files.watch([scene.as_path()]);
        assert!(detects_change(&mut files, long), "nothing is lost while others are watched");
        files.watch([]);
        fs::write(&scene, "4").unwrap();
        assert!(!detects_change(&mut files, short), "no longer watched");
        let deep = path("pictures/of/it.png");
        files.watch([deep.as_path()]);
        fs::create_dir(path("pictures")).unwrap();
        assert!(detects_change(&mut files, long), "a folder on the way");
        files.watch([deep.as_path()]);
        fs::create_dir(path("pictures/of")).unwrap();
        assert!(detects_change(&mut files, long), "the next one");
        files.watch([deep.as_path()]);
        fs::write(&deep, "1").unwrap();
        assert!(detects_change(&mut files, long), "the file");
    }
}
