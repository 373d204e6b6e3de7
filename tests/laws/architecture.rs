//! The law of the layout: each module imports only what stands before it in the list of the design, so that the direction never turns.
//!
//! The sources are read as text, comments and strings removed, and searched for `crate::…` paths; a module that is not in the list fails
//! the test, so that every new one is given its place.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

/// Top-level modules in the order in which they may be imported: each from those before it.
const ORDER: &[&str] = &[
    "lane",
    "math",
    "wording",
    "sampling",
    "kernel",
    "scene",
    "buffers",
    "light_sampling",
    "bvh",
    "camera",
    "traverse",
    "integrate",
    "reference",
    "threads",
    "film",
    "adaptive",
    "render",
    "output",
    "display",
    "measure",
    "report",
    "viewer",
    "cli",
];

/// What a module must not import although it stands before it, and why.
const FORBIDDEN: &[(&str, &[&str], &str)] = &[
    (
        "reference",
        &["lane", "math", "kernel", "buffers", "bvh", "camera", "traverse", "integrate"],
        "the judge is independent",
    ),
    ("kernel", &["scene"], "equations know lanes and nothing else"),
    ("scene", &["lane", "kernel", "sampling"], "a scene is what the user wrote, checked"),
];

/// Longest source file in lines.
const MAX_LINES: usize = 700;

struct Source {
    path: PathBuf,
    /// The top-level module it belongs to; `lib` and `main` for the crate's own roots.
    module: String,
    /// How many `super::` lead from the file to the crate's root.
    depth: usize,
    text: String,
    code: String,
}

fn sources() -> Vec<Source> {
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
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    collect(&root, &mut files);
    files.sort();
    let read = |path: &PathBuf| {
        let inside = path.strip_prefix(&root).unwrap().with_extension("");
        let mut names: Vec<_> = inside.iter().map(|name| name.to_str().unwrap().to_owned()).collect();
        if names.last().is_some_and(|name| name == "mod") {
            names.pop();
        }
        let text = fs::read_to_string(path).unwrap();
        let path = Path::new("src").join(path.strip_prefix(&root).unwrap());
        Source { path, module: names[0].clone(), depth: names.len(), code: code_of(&text), text }
    };
    let sources: Vec<_> = files.iter().map(read).collect();
    assert!(sources.len() > 30, "the sources are found");
    sources
}

/// The text without comments and without what stands in strings and characters.
fn code_of(text: &str) -> String {
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

fn identifier(text: &str) -> &str {
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    &text[..end]
}

/// The first names of a path or of a group `{a::…, b}`.
fn first_names(path: &str) -> Vec<&str> {
    let Some(group) = path.strip_prefix('{') else { return vec![identifier(path)] };
    let (mut names, mut level, mut fresh) = (Vec::new(), 1, true);
    for (at, c) in group.char_indices() {
        match c {
            '{' => level += 1,
            '}' => level -= 1,
            ',' if level == 1 => fresh = true,
            _ if fresh && !c.is_whitespace() => {
                names.push(identifier(&group[at..]));
                fresh = false;
            }
            _ => {}
        }
        if level == 0 {
            break;
        }
    }
    names
}

/// The crate's top-level names that a source mentions.
fn imports(source: &Source) -> BTreeSet<&str> {
    let mut prefixes = vec!["crate::".to_owned()];
    if source.depth > 0 && source.module != "lib" && source.module != "main" {
        prefixes.push("super::".repeat(source.depth));
    }
    if source.module == "main" {
        prefixes = vec!["octray::".to_owned()];
    }
    let mut names = BTreeSet::new();
    for prefix in prefixes {
        for (at, _) in source.code.match_indices(&prefix) {
            let before = source.code[..at].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                continue;
            }
            let path = &source.code[at + prefix.len()..];
            // `super::super::…` and `super::*` of an inline module lead elsewhere.
            names.extend(first_names(path).into_iter().filter(|name| !name.is_empty() && *name != "super"));
        }
    }
    names
}

fn place(module: &str) -> Option<usize> {
    ORDER.iter().position(|name| *name == module)
}

#[test]
fn modules_import_only_what_stands_before_them() {
    let mut faults = Vec::new();
    for source in sources() {
        if source.module == "lib" || source.module == "main" {
            continue;
        }
        let Some(own) = place(&source.module) else {
            faults.push(format!(
                "{}: module `{}` has no place in ORDER",
                source.path.display(),
                source.module
            ));
            continue;
        };
        for name in imports(&source) {
            let path = source.path.display();
            match place(name) {
                Some(other) if other <= own => {}
                Some(_) => faults
                    .push(format!("{path}: `{}` imports `{name}`, which stands behind it", source.module)),
                // Inline modules reach their own file by `super::`; macros and items of the root have no module.
                None => faults.push(format!("{path}: `{name}` is no module of ORDER")),
            }
            for (module, forbidden, why) in FORBIDDEN {
                if source.module == *module && forbidden.contains(&name) {
                    faults.push(format!("{path}: `{module}` imports `{name}`, but {why}"));
                }
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn modules_of_the_root_have_a_place() {
    for source in sources().iter().filter(|source| source.module == "lib" || source.module == "main") {
        for line in source.code.lines() {
            let declared = line.trim().trim_start_matches("pub ").strip_prefix("mod ");
            if let Some(name) = declared.map(identifier) {
                assert!(
                    place(name).is_some(),
                    "{}: module `{name}` has no place in ORDER",
                    source.path.display()
                );
            }
        }
    }
}

#[test]
fn wide_is_imported_by_lane_alone() {
    for source in sources() {
        if source.module != "lane" {
            assert!(!source.code.contains("wide::"), "{} uses `wide`", source.path.display());
        }
    }
}

#[test]
fn no_source_is_unsafe() {
    for source in sources() {
        let code = source.code.replace("#![forbid(unsafe_code)]", "");
        assert!(!code.contains("unsafe"), "{}", source.path.display());
        assert!(source.module != "lib" || code.len() < source.code.len(), "the crate forbids unsafe code");
    }
}

#[test]
fn no_source_is_longer_than_a_reader_can_hold() {
    for source in sources() {
        let lines = source.text.lines().count();
        assert!(lines <= MAX_LINES, "{} has {lines} lines, more than {MAX_LINES}", source.path.display());
    }
}

#[test]
fn reader_of_sources_sees_every_form_of_import_and_no_comment() {
    let code = code_of(
        "//! crate::a\nuse crate::{b::{x, y}, c, d::*};\n/* crate::e */ let s = \"crate::f\\\"\"; let c = '\"';\n\
         let r = r#\"crate::h\"#; fn g<'a>(x: &'a str) { crate::i::j() } use super::super::k::L; mycrate::m;",
    );
    let source = |depth| Source {
        path: PathBuf::new(),
        module: "x".into(),
        depth,
        text: String::new(),
        code: code.clone(),
    };
    assert_eq!(imports(&source(2)), BTreeSet::from(["b", "c", "d", "i", "k"]));
    assert_eq!(imports(&source(3)), BTreeSet::from(["b", "c", "d", "i"]));
}
