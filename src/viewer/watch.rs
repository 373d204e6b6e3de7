//! Files that are watched: a scene is read again when one of its own changes.
//!
//! For: [`Files`]. May import: `notify`. Must never know: what is in a file.

use notify::{EventKind, RecommendedWatcher, RecursiveMode, Watcher};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant, SystemTime};

/// How long files must be left alone before they are read: editors write in several steps.
const QUIET: Duration = Duration::from_millis(150);

/// A set of files and what is heard of them. Where nothing can be watched, nothing is heard.
pub struct Files {
    watcher: Option<RecommendedWatcher>,
    changes: Receiver<notify::Result<notify::Event>>,
    files: BTreeSet<PathBuf>,
    folders: BTreeSet<PathBuf>,
    /// When one of them changed last.
    changed: Option<Instant>,
}

impl Files {
    /// `tell` is called when anything is heard of a folder with such files.
    pub fn none(tell: impl Fn() + Send + 'static) -> Self {
        let (sender, changes) = channel();
        let watcher = notify::recommended_watcher(move |change| {
            // Who no longer listens need not.
            let _ = sender.send(change);
            tell();
        })
        .ok();
        Self { watcher, changes, files: BTreeSet::new(), folders: BTreeSet::new(), changed: None }
    }

    /// Watches these from now on, and no others. Names of no files are passed over.
    pub fn watch<'a>(&mut self, files: impl IntoIterator<Item = &'a Path>) {
        let Some(watcher) = &mut self.watcher else { return };
        self.files = files.into_iter().filter_map(place_of).collect();
        // Folders: many editors put a new file in the place of the old one, and nobody hears of the new one otherwise.
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

    /// Has one changed, and been left alone since? Says so once.
    pub fn have_changed(&mut self, now: Instant) -> bool {
        while let Ok(change) = self.changes.try_recv() {
            let Ok(change) = change else { continue };
            let matters = !matches!(change.kind, EventKind::Access(_));
            if matters && change.paths.iter().any(|path| self.files.contains(path)) {
                self.changed = Some(now);
            }
        }
        let over = self.changed.is_some_and(|changed| now - changed >= QUIET);
        if over {
            self.changed = None;
        }
        over
    }
}

/// Where a file is, or will be once it is there again; where its folder is missing, where that will be.
fn place_of(file: &Path) -> Option<PathBuf> {
    file.canonicalize().ok().or_else(|| {
        let folder = match file.parent()? {
            here if here.as_os_str().is_empty() => Path::new("."),
            folder => folder,
        };
        match folder.canonicalize() {
            Ok(folder) => Some(folder.join(file.file_name()?)),
            Err(_) => place_of(folder),
        }
    })
}

/// Has any of these been written since? What claims to be of the future says nothing.
pub fn is_newer<'a>(files: impl IntoIterator<Item = &'a Path>, than: SystemTime) -> bool {
    let written = |file: &Path| std::fs::metadata(file).and_then(|file| file.modified()).ok();
    let now = SystemTime::now();
    files.into_iter().filter_map(written).any(|written| written > than && written <= now)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;
    use std::thread::sleep;

    /// Does it hear of a change within a while?
    fn hears(files: &mut Files, patience: Duration) -> bool {
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
    fn changes_of_watched_files_are_heard_once_and_of_others_never() {
        let (long, short) = (Duration::from_secs(20), Duration::from_millis(600));
        let folder = tempfile::tempdir().unwrap();
        let path = |name: &str| folder.path().join(name);
        for name in ["scene.json", "other.json"] {
            fs::write(path(name), "1").unwrap();
        }
        let mut files = Files::none(|| {});
        if files.watcher.is_none() {
            eprintln!("skipped: this system watches no files");
            return;
        }
        let scene = path("scene.json");
        files.watch([scene.as_path(), Path::new("no such folder/file")]);
        fs::write(path("other.json"), "2").unwrap();
        assert!(!hears(&mut files, short), "another file");
        fs::write(&scene, "2").unwrap();
        assert!(hears(&mut files, long));
        assert!(!hears(&mut files, short), "once");
        // As many editors save.
        fs::write(path("scene.json~"), "3").unwrap();
        fs::rename(path("scene.json~"), &scene).unwrap();
        assert!(hears(&mut files, long));
        assert!(!fs::read_to_string(&scene).unwrap().is_empty());
        assert!(!hears(&mut files, short), "reading is no change");
        fs::remove_file(&scene).unwrap();
        assert!(hears(&mut files, long), "it is gone");
        files.watch([scene.as_path()]);
        fs::write(&scene, "5").unwrap();
        assert!(hears(&mut files, long), "it is there again");
        fs::write(&scene, "6").unwrap();
        sleep(Duration::from_millis(20));
        assert!(!files.have_changed(Instant::now()), "not left alone yet");
        files.watch([scene.as_path()]);
        assert!(hears(&mut files, long), "nothing is lost while others are watched");
        files.watch([]);
        fs::write(&scene, "4").unwrap();
        assert!(!hears(&mut files, short), "no longer watched");
        let deep = path("pictures/of/it.png");
        files.watch([deep.as_path()]);
        fs::create_dir(path("pictures")).unwrap();
        assert!(hears(&mut files, long), "a folder on the way");
        files.watch([deep.as_path()]);
        fs::create_dir(path("pictures/of")).unwrap();
        assert!(hears(&mut files, long), "the next one");
        files.watch([deep.as_path()]);
        fs::write(&deep, "1").unwrap();
        assert!(hears(&mut files, long), "the file");
    }
}
