//! The law of the layout: each module imports only what stands before it in the list of the design, so that
//! the direction never turns.
//!
//! The order of the packages is kept by Cargo; that of the modules inside each is [`ORDER`]. The sources are
//! read as text, comments and strings removed; a module that is not in the list fails the test, so that every
//! new one is given its place.

mod paths;
mod platform;
mod sources;

use sources::{PACKAGES, Source, checkout, files_below, read, sources};
use std::collections::BTreeSet;

/// By package: top-level modules in the order in which they may be imported, each from those before it.
const ORDER: [&[&str]; PACKAGES.len()] = [
    &["lane", "math", "coordinates", "kernel", "geometry", "bvh", "traverse"],
    &[
        "choice",
        "sampling",
        "kernel",
        "scene",
        "path_vertex",
        "buffers",
        "light_sampling",
        "camera",
        "integrate",
        "threads",
        "film",
        "adaptive",
        "render",
        "tone",
        "diagnosis",
        "display",
    ],
    &["wording", "openexr", "scene", "output", "checkpoint"],
    &[
        "display_mode",
        "dynamic_resolution",
        "file_watcher",
        "frame",
        "loader",
        "playlist",
        "timing",
        "options",
        "camera_controller",
        "controls",
        "keys",
        "accumulation",
        "canvas",
        "window_text",
        "cell_buffer",
        "minimap",
        "painter",
        "screenshot",
        "state",
        "overlay",
        "render_loop",
        "session",
        "terminal",
        "window",
    ],
    &["methods", "reference", "measure"],
    &["machine", "report", "cli"],
];

/// What a module, by its package's place, must not import although it stands before it, and why.
const FORBIDDEN: &[(usize, &str, &[&str], &str)] = &[
    (
        4,
        "reference",
        &["lane", "math", "kernel", "buffers", "bvh", "camera", "traverse", "integrate"],
        "the judge is independent",
    ),
    (1, "kernel", &["scene"], "equations know lanes and nothing else"),
    (1, "scene", &["lane", "kernel", "sampling"], "a scene is what the user wrote, checked"),
    // A view's file names the sampler of its rendering.
    (2, "scene", &["lane", "kernel"], "a scene is what the user wrote, checked"),
];

/// Folders whose comments are narrow.
const NARROW: [&str; 3] = ["src", "tests", "benches"];

/// Longest source file in lines.
const MAX_LINES: usize = 700;
/// Longest line in characters, comments included: `max_width` of `rustfmt.toml`, which does not see to
/// comments.
const MAX_WIDTH: usize = 110;

/// The top-level modules that a source mentions: of its own package, and of packages before it.
fn imports(source: &Source) -> BTreeSet<String> {
    let is_program = source.path.ends_with("main.rs");
    let before = |name: &str| {
        PACKAGES[..source.package].iter().any(|(package, _)| name == format!("octray_{package}"))
    };
    let top_level = |(mut module, path): (Vec<String>, Vec<String>)| {
        let mut rest = &path[..];
        match path[0].as_str() {
            "octray" => return path.get(1).filter(|_| is_program).cloned(),
            "crate" => (module, rest) = (Vec::new(), &path[1..]),
            "super" => {
                while rest.first().is_some_and(|name| name == "super") {
                    module.pop();
                    rest = &rest[1..];
                }
            }
            name if before(name) => return path.get(1).cloned(),
            _ => return None,
        }
        module.first().or(rest.first()).filter(|name| *name != "*").cloned()
    };
    paths::paths(source).into_iter().filter_map(top_level).collect()
}

/// Where a module stands that a source of this package names: in its own package or in one before it. A
/// package that is re-exported whole, as a module of its name, stands behind its last module.
fn place(package: usize, module: &str) -> Option<(usize, usize)> {
    let within = |package: usize| Some((package, ORDER[package].iter().position(|name| *name == module)?));
    let whole = |package: usize| (PACKAGES[package].0 == module).then(|| (package, ORDER[package].len()));
    (0..=package).rev().find_map(|package| within(package).or_else(|| whole(package)))
}

#[test]
fn modules_import_only_what_stands_before_them() {
    let mut faults = Vec::new();
    for source in sources().iter().filter(|source| !source.is_root()) {
        let (path, room) = (source.path.display(), source.room());
        let own = place(source.package, room);
        if own.is_none_or(|(package, _)| package != source.package) {
            faults.push(format!("{path}: module `{room}` has no place in ORDER"));
        }
        for name in imports(source) {
            match place(source.package, &name) {
                Some(other) if Some(other) <= own => {}
                Some(_) => faults.push(format!("{path}: `{room}` imports `{name}`, which stands behind it")),
                // Inline modules reach their own file by `super::`; macros and items of the root have no
                // module.
                None => faults.push(format!("{path}: `{name}` is no module of ORDER")),
            }
            for (package, module, forbidden, why) in FORBIDDEN {
                if source.package == *package && room == *module && forbidden.contains(&name.as_str()) {
                    faults.push(format!("{path}: `{module}` imports `{name}`, but {why}"));
                }
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn modules_of_the_roots_have_a_place() {
    for source in sources().iter().filter(|source| source.is_root()) {
        for declared in source.tokens.windows(3).filter(|tokens| tokens[0] == "mod" && tokens[2] == ";") {
            let listed = ORDER[source.package].contains(&declared[1].as_str());
            assert!(listed, "{}: module `{}` has no place in ORDER", source.path.display(), declared[1]);
        }
    }
}

#[test]
fn wide_is_imported_by_lane_alone() {
    for source in sources() {
        if source.room() != "lane" {
            assert!(!source.code.contains("wide::"), "{} uses `wide`", source.path.display());
        }
    }
}

#[test]
fn one_source_is_unsafe() {
    for source in sources() {
        let path = source.path.display();
        let allowed = source.path.ends_with("rays/lane/instructions.rs");
        let fence = if source.path.ends_with("rays/lib.rs") {
            "#![deny(unsafe_code)]"
        } else if allowed {
            "#![allow(unsafe_code)]"
        } else {
            "#![forbid(unsafe_code)]"
        };
        let code = source.code.replace(fence, "");
        // One block a function.
        let blocks = if allowed { 4 } else { 0 };
        assert_eq!(code.matches("unsafe").count(), blocks, "{path}");
        let fenced = code.len() < source.code.len();
        assert!(fenced || !(allowed || source.path.ends_with("lib.rs")), "{path} has no {fence}");
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
fn no_comment_is_wider_than_the_code() {
    let mut faults = Vec::new();
    for path in NARROW.into_iter().flat_map(files_below) {
        for (line, text) in read(&path).lines().enumerate() {
            let content = text.trim_start().trim_start_matches(['/', '!', ' ']);
            // Rows of tables cannot be wrapped.
            let comment = text.trim_start().starts_with("//") && !content.starts_with('|');
            if comment && text.chars().count() > MAX_WIDTH {
                faults.push(format!("{}:{}", path.display(), line + 1));
            }
        }
    }
    assert!(faults.is_empty(), "wider than {MAX_WIDTH}:\n{}", faults.join("\n"));
}

/// Comments say where something is tested or explained: what they name is there.
#[test]
fn files_that_are_named_in_sources_exist() {
    let mut faults = Vec::new();
    for path in ["src", "tests", "benches"].into_iter().flat_map(files_below) {
        let text = read(&path);
        for folder in ["src/", "tests/", "benches/"] {
            for (at, _) in text.match_indices(folder) {
                let alone = text[..at].ends_with(['`', ' ', '(']);
                let end = text[at..].find(|c: char| !(c.is_alphanumeric() || "_-/.".contains(c)));
                let name = &text[at..at + end.unwrap_or(text.len() - at)];
                // Made-up sources are of the engine.
                let made_up = path.ends_with("architecture/mod.rs");
                if alone && name.ends_with(".rs") && !made_up && !checkout().join(name).exists() {
                    faults.push(format!("{} names {name}", path.display()));
                }
            }
        }
    }
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn reader_of_sources_sees_every_form_of_import_and_no_comment() {
    let text = "//! crate::a\nuse crate::{b::{x, y}, c, d::*};\n/* crate::e */ const S: &str = \"crate::f\\\"\"; const C: char = '\"';\n\
         const R: &str = r#\"crate::h\"#; fn g<'a>(x: &'a str) { crate::i::j() } use super::super::k::L; use mycrate::m;\n\
         use octray_engine::n;";
    let names = |path: &str| {
        let source = Source::new(path.as_ref(), text.into());
        imports(&source).into_iter().collect::<Vec<_>>().join(" ")
    };
    assert_eq!(names("src/engine/x/y.rs"), "b c d i k");
    assert_eq!(names("src/engine/x/y/z.rs"), "b c d i x");
    assert_eq!(names("src/formats/x/y.rs"), "b c d i k n");
    assert_eq!(Source::new("src/formats/x/mod.rs".as_ref(), String::new()).module, ["x"]);
}
