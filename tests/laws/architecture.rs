//! The laws of the sources that Cargo does not hold: which modules a module may import, where unsafe code and
//! the platform's functions may be, and what makes a file readable.

use std::fs;
use std::path::{Path, PathBuf};

/// A folder, modules that its sources must not import, and the reason.
const FORBIDDEN: [(&str, &[&str], &str); 3] = [
    (
        "src/laboratory/reference",
        &["lane", "math", "kernel", "buffers", "light_sampling", "bvh", "camera", "traverse", "integrate"],
        "the reference shares no code with what it judges",
    ),
    ("src/engine/scene", &["lane", "kernel", "sampling"], "a scene is what the user wrote, checked"),
    ("src/formats/scene", &["lane", "kernel"], "a scene is what the user wrote, checked"),
];

/// Functions of the standard library whose last bits depend on the machine and the compiler. `powi` has no
/// fixed order of products, except for squares.
const PLATFORM: &str = "sin cos tan asin acos atan atan2 sin_cos sinh cosh tanh exp exp2 exp_m1 ln ln_1p \
                        log log2 log10 powf powi cbrt hypot";
/// Sources whose results are not part of a film, so that their bits may depend on the platform.
const OUTSIDE_FILMS: [&str; 4] =
    ["src/engine/tone.rs", "src/engine/diagnosis.rs", "src/engine/film/noise.rs", "src/formats/output"];

/// Folders, and the longest source in each, in lines.
const MAX_LINES: [(&str, usize); 3] = [("src", 400), ("tests", 620), ("benches", 480)];
/// The longest line of a comment, in characters: `max_width` of `rustfmt.toml`, which does not apply to
/// comments.
const MAX_WIDTH: usize = 110;

fn checkout() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// The Rust sources below a folder of the checkout: their paths in it, and their texts.
fn sources(folder: &str) -> Vec<(PathBuf, String)> {
    let (mut unread, mut sources) = (vec![checkout().join(folder)], Vec::new());
    while let Some(path) = unread.pop() {
        if path.is_dir() {
            unread.extend(fs::read_dir(path).unwrap().map(|entry| entry.unwrap().path()));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = fs::read_to_string(&path).unwrap();
            sources.push((path.strip_prefix(checkout()).unwrap().to_owned(), text));
        }
    }
    assert!(!sources.is_empty(), "{folder} has sources");
    sources
}

/// The code of a source, without its comments and the unit tests at its end.
fn code(text: &str) -> String {
    let text = text.split("#[cfg(test)]\nmod tests").next().unwrap();
    text.lines().flat_map(|line| [line.split("//").next().unwrap(), "\n"]).collect()
}

fn is_of_name(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

/// The names that follow `prefix`, such as `crate::`, in code.
fn names_after<'a>(code: &'a str, prefix: &'a str) -> impl Iterator<Item = &'a str> {
    let whole = |at: &usize| !code[..*at].ends_with(|c| is_of_name(c) || c == ':');
    let places = code.match_indices(prefix).map(|(at, _)| at).filter(whole);
    places.map(|at| code[at + prefix.len()..].split(|c| !is_of_name(c)).next().unwrap())
}

/// The names in the first column of the tables on a front page.
fn listed(page: &str) -> Vec<&str> {
    let cells = page.lines().filter_map(|line| line.strip_prefix("//! |")?.split('|').next());
    let names = cells.flat_map(|cell| cell.split('`').skip(1).step_by(2));
    names.map(|name| name.trim_start_matches("mod@")).collect()
}

fn assert_none(faults: &[String]) {
    assert!(faults.is_empty(), "\n{}", faults.join("\n"));
}

#[test]
fn modules_import_only_those_above_them_on_their_front_page() {
    let (sources, mut faults) = (sources("src"), Vec::new());
    for (front, page) in sources.iter().filter(|(path, _)| path.ends_with("lib.rs")) {
        let (folder, listed) = (front.parent().unwrap(), listed(page));
        let row = |module: &str| listed.iter().position(|name| *name == module);
        let lines = page.lines().map(|line| line.trim_start_matches("pub "));
        let declared = lines.filter_map(|line| line.strip_prefix("mod ")?.strip_suffix(';'));
        let modules: Vec<&str> = declared.collect();
        let missing = modules.iter().filter(|module| row(module).is_none());
        faults.extend(missing.map(|module| format!("{} has no row for `{module}`", front.display())));
        for (path, text) in sources.iter().filter(|(path, _)| path.starts_with(folder)) {
            let inside = path.strip_prefix(folder).unwrap().with_extension("");
            let parts: Vec<&str> = inside.iter().map(|part| part.to_str().unwrap()).collect();
            let to_root = "super::".repeat(parts.len() - usize::from(parts.ends_with(&["mod"])));
            let code = code(text);
            let imports = names_after(&code, "crate::").chain(names_after(&code, &to_root));
            // Other packages' sources, and names that are no modules, have no row.
            let below = imports.filter(|name| modules.contains(name) && row(name) > row(parts[0]));
            if modules.contains(&parts[0]) {
                faults.extend(below.map(|name| format!("{} imports `{name}` below it", path.display())));
            }
        }
    }
    assert_none(&faults);
}

#[test]
fn forbidden_modules_are_not_imported() {
    let mut faults = Vec::new();
    for (folder, modules, reason) in FORBIDDEN {
        for (path, text) in sources(folder) {
            let code = code(&text);
            let imports =
                ["crate::", "octray_engine::", "octray_rays::"].map(|root| names_after(&code, root));
            for name in imports.into_iter().flatten().filter(|name| modules.contains(name)) {
                faults.push(format!("{} imports `{name}`, but {reason}", path.display()));
            }
        }
    }
    assert_none(&faults);
}

#[test]
fn modules_of_the_tracing_core_that_are_hidden_have_no_users() {
    let page = fs::read_to_string(checkout().join("src/rays/lib.rs")).unwrap();
    let hidden = page.split("#[doc(hidden)]\npub mod ").skip(1).map(|rest| rest.split(';').next().unwrap());
    let hidden: Vec<&str> = hidden.collect();
    assert!(hidden.contains(&"bvh") && hidden.contains(&"traverse"), "{hidden:?}");
    let mut faults = Vec::new();
    for (path, text) in sources("src").iter().filter(|(path, _)| !path.starts_with("src/rays")) {
        let code = code(text);
        let names = ["crate::rays::", "octray_rays::"].map(|root| names_after(&code, root));
        let used = names.into_iter().flatten().filter(|name| hidden.contains(name));
        faults.extend(used.map(|name| format!("{} imports `{name}`", path.display())));
    }
    assert_none(&faults);
}

#[test]
fn unsafe_code_and_wide_are_used_by_lane_alone() {
    for (path, text) in sources("src") {
        let (code, shown) = (code(&text), path.display());
        let is_exception = path.ends_with("lane/instructions.rs");
        assert_eq!(code.matches("unsafe {").count(), if is_exception { 4 } else { 0 }, "{shown}");
        assert!(is_exception || !code.contains("allow(unsafe_code)"), "{shown}");
        assert!(
            !path.ends_with("lib.rs") || code.contains("(unsafe_code)]"),
            "{shown} forbids no unsafe code"
        );
        let is_lane = path.parent().unwrap().ends_with("lane");
        assert!(is_lane || names_after(&code, "wide::").next().is_none(), "{shown} uses `wide`");
    }
}

#[test]
fn scenes_and_films_use_no_function_of_the_platform() {
    let rendered = ["src/engine", "src/formats", "src/rays"].into_iter();
    let mut faults = Vec::new();
    for (path, text) in rendered.filter(|folder| checkout().join(folder).is_dir()).flat_map(sources) {
        let code = code(&text).replace(".powi(2)", "");
        let calls = PLATFORM.split_whitespace().filter(|name| code.contains(&format!(".{name}(")));
        if !OUTSIDE_FILMS.iter().any(|outside| path.starts_with(outside)) {
            faults.extend(calls.map(|name| format!("{}: {name}: use math::portable", path.display())));
        }
    }
    assert_none(&faults);
}

#[test]
fn sources_are_short_narrow_and_name_only_what_exists() {
    let mut faults = Vec::new();
    let all =
        MAX_LINES.into_iter().flat_map(|(folder, most)| sources(folder).into_iter().map(move |s| (s, most)));
    for ((path, text), most) in all {
        let mut fault = |line: usize, what: &str| faults.push(format!("{}:{line}: {what}", path.display()));
        if text.lines().count() > most {
            fault(most, "is too long");
        }
        for (number, line) in (1..).zip(text.lines()) {
            let Some((_, comment)) = line.split_once("//") else { continue };
            // Rows of tables cannot be wrapped.
            let is_row = comment.trim_start_matches(['/', '!', ' ']).starts_with('|');
            if line.chars().count() > MAX_WIDTH && line.trim_start().starts_with("//") && !is_row {
                fault(number, "the comment is too wide");
            }
            for word in comment.split(|c: char| !is_of_name(c) && !"/.-".contains(c)) {
                let is_of_checkout = ["src/", "tests/", "benches/"].iter().any(|dir| word.starts_with(dir));
                if is_of_checkout && word.ends_with(".rs") && !checkout().join(word).exists() {
                    fault(number, &format!("there is no {word}"));
                }
                // Every Linux has these.
                let path = word.strip_prefix('/').filter(|path| path.starts_with(char::is_alphabetic));
                let root = path.and_then(|path| path.split_once('/')).map(|(root, _)| root);
                if root.is_some_and(|root| !["proc", "sys", "dev", "tmp"].contains(&root)) {
                    fault(number, &format!("{word} is on one machine only"));
                }
            }
        }
    }
    assert_none(&faults);
}
