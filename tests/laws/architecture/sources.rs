//! The sources as text: every file of every package, with its place among the modules.

use std::fs;
use std::path::{Path, PathBuf};

/// The packages, each of which may use those before it: Cargo keeps that order. The last one is the
/// program's.
pub const PACKAGES: [(&str, &str); 5] = [
    ("engine", "src/engine"),
    ("formats", "src/formats"),
    ("viewer", "src/viewer"),
    ("laboratory", "src/laboratory"),
    ("program", "src"),
];

pub struct Source {
    /// From the checkout's root.
    pub path: PathBuf,
    /// Its place in [`PACKAGES`].
    pub package: usize,
    /// The module that the file is, from the package's root on; empty for the root itself.
    pub module: Vec<String>,
    pub text: String,
    pub code: String,
}

impl Source {
    /// A file at this path of the checkout.
    pub fn new(path: &Path, text: String) -> Self {
        let folder = |(_, folder): &(&str, &str)| path.starts_with(folder);
        let package = PACKAGES.iter().position(folder).expect("every source is in a package");
        let inside = path.strip_prefix(PACKAGES[package].1).unwrap().with_extension("");
        let mut module: Vec<_> = inside.iter().map(|name| name.to_str().unwrap().to_owned()).collect();
        if ["mod", "lib", "main"].contains(&module.last().unwrap().as_str()) {
            module.pop();
        }
        Self { path: path.into(), package, module, code: code_of(&text), text }
    }
    pub fn is_root(&self) -> bool {
        self.module.is_empty()
    }
    /// The top-level module that it belongs to; empty for the root.
    pub fn room(&self) -> &str {
        self.module.first().map_or("", String::as_str)
    }
}

/// The checkout.
pub fn checkout() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap().into()
}

/// All Rust files below a folder of the checkout, by their paths from there.
pub fn files_below(folder: &str) -> Vec<PathBuf> {
    fn collect(folder: &Path, files: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(&path, files);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push(path);
            }
        }
    }
    let mut files = Vec::new();
    collect(&checkout().join(folder), &mut files);
    files.sort();
    files.iter().map(|path| path.strip_prefix(checkout()).unwrap().into()).collect()
}

pub fn read(path: &Path) -> String {
    fs::read_to_string(checkout().join(path)).unwrap()
}

/// All sources of all packages.
pub fn sources() -> Vec<Source> {
    let sources: Vec<_> = files_below("src").iter().map(|path| Source::new(path, read(path))).collect();
    assert!(sources.len() > 100, "the sources are found");
    sources
}

/// The text without comments and without what stands in strings and characters.
pub fn code_of(text: &str) -> String {
    let bytes: Vec<char> = text.chars().collect();
    let mut code = String::new();
    let mut at = 0;
    let starts = |at: usize, with: &str| with.chars().enumerate().all(|(i, c)| bytes.get(at + i) == Some(&c));
    while at < bytes.len() {
        if starts(at, "//") {
            while at < bytes.len() && bytes[at] != '\n' {
                at += 1;
            }
        } else if starts(at, "/*") {
            while at < bytes.len() && !starts(at, "*/") {
                at += 1;
            }
            at += 2;
        } else if bytes[at] == 'r' && (starts(at, "r\"") || starts(at, "r#\"")) {
            let end = if starts(at, "r\"") { "\"" } else { "\"#" };
            at += end.len() + 1;
            while at < bytes.len() && !starts(at, end) {
                at += 1;
            }
            at += end.len();
        } else if bytes[at] == '"' {
            at += 1;
            while at < bytes.len() && bytes[at] != '"' {
                at += if bytes[at] == '\\' { 2 } else { 1 };
            }
            at += 1;
        } else if bytes[at] == '\'' && (bytes.get(at + 1) == Some(&'\\') || bytes.get(at + 2) == Some(&'\''))
        {
            // A character, not a lifetime.
            at += if bytes[at + 1] == '\\' { 3 } else { 2 };
            while at < bytes.len() && bytes[at] != '\'' {
                at += 1;
            }
            at += 1;
        } else {
            code.push(bytes[at]);
            at += 1;
        }
    }
    code
}
