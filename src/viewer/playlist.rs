//! Lists the scenes to switch between.

use octray_formats::scene::may_be_scene;
use std::ffi::{OsStr, OsString};

/// Names of scenes as on the command line, and the index of the current one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Playlist {
    names: Vec<OsString>,
    at: usize,
}

impl Playlist {
    /// Lists these scenes; a folder stands for the scenes and models in it, sorted. `None` if there are none.
    pub fn new(names: &[impl AsRef<OsStr>]) -> Option<Self> {
        let names: Vec<OsString> = names.iter().flat_map(|name| expand(name.as_ref())).collect();
        (!names.is_empty()).then_some(Self { names, at: 0 })
    }
    /// Returns the name of the current scene.
    pub fn current(&self) -> &OsStr {
        &self.names[self.at]
    }
    /// Returns the number of scenes, and that of the current one, from 1.
    pub(crate) fn count_and_number(&self) -> [usize; 2] {
        [self.names.len(), self.at + 1]
    }
    pub(crate) fn next(&mut self) {
        self.at = (self.at + 1) % self.names.len();
    }
    pub(crate) fn previous(&mut self) {
        self.at = (self.at + self.names.len() - 1) % self.names.len();
    }
    /// Makes this scene, or the first one of this folder, the current one. Scenes that are not in the list
    /// are inserted after the current one. Returns false if the folder holds none.
    pub(crate) fn drop_in(&mut self, name: impl AsRef<OsStr>) -> bool {
        let new = expand(name.as_ref());
        let Some(first) = new.first().cloned() else { return false };
        let unknown: Vec<OsString> = new.into_iter().filter(|name| !self.names.contains(name)).collect();
        self.names.splice(self.at + 1..self.at + 1, unknown);
        self.at = self.names.iter().position(|known| *known == first).unwrap_or(self.at);
        true
    }
}

/// Returns the name itself, or the scenes and models of a folder.
fn expand(name: &OsStr) -> Vec<OsString> {
    let Ok(folder) = std::fs::read_dir(name) else { return vec![name.to_os_string()] };
    let paths = folder.filter_map(|entry| Some(entry.ok()?.path()));
    let mut names: Vec<OsString> =
        paths.filter(|path| may_be_scene(path)).map(|path| path.into_os_string()).collect();
    names.sort();
    names
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn list(names: &[&str]) -> Playlist {
        Playlist::new(names).unwrap()
    }

    #[test]
    fn folders_stand_for_the_scenes_in_them() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["z.json", "b.OBJ", "readme.md", "a.json", "b.mtl", "c.glb", "d.gltf", "d.bin", "e.Ply"] {
            std::fs::write(folder.path().join(name), "").unwrap();
        }
        let path = folder.path().to_string_lossy().into_owned();
        let mut list = Playlist::new(&["first".to_string(), path.clone()]).unwrap();
        let names: Vec<_> = list.names.iter().map(|name| Path::new(name).file_name().unwrap()).collect();
        assert_eq!(names, ["first", "a.json", "b.OBJ", "c.glb", "d.gltf", "e.Ply", "z.json"]);
        let empty = tempfile::tempdir().unwrap();
        assert_eq!(Playlist::new(&[empty.path()]), None);
        assert!(!list.drop_in(empty.path()));
    }

    #[test]
    fn what_is_dropped_is_shown_and_never_twice_in_the_list() {
        let mut list = list(&["a", "b"]);
        assert!(list.drop_in("new"));
        assert_eq!((list.current(), list.count_and_number()), ("new".as_ref(), [3, 2]));
        assert!(list.drop_in("b"));
        assert_eq!((list.current(), list.count_and_number()), ("b".as_ref(), [3, 3]));
    }
}
