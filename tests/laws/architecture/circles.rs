//! Which file imports which, and where that goes round in a circle.
//!
//! A file's paths are read from its text: `use` trees, and paths in code that begin with `crate`, `self`,
//! `super`, a child module or an imported name. A path is followed to the file that defines the item: through
//! child modules, and through every `use` on the way, so that what a `mod.rs` re-exports counts as an import
//! of the file it comes from. To declare modules and to re-export what is in them is no import; to use it is
//! one.

use super::sources::{Source, is_name};
use std::collections::{BTreeMap, BTreeSet, HashSet};

/// Names of a path that is followed, at most.
const LONGEST: usize = 20;

/// Absolute from a package's root on.
pub type Module = Vec<String>;

/// One `use`: a path, and the name it gets; `*` for all names.
#[derive(Clone, Debug)]
struct Use {
    path: Vec<String>,
    name: String,
    public: bool,
}

/// What is written in one module: a file, or a part of one in `mod name { … }`.
#[derive(Default)]
struct Scope {
    file: usize,
    uses: Vec<Use>,
    /// Paths in code, of two names and more.
    paths: Vec<Vec<String>>,
    /// Names in code that stand alone.
    names: HashSet<String>,
    /// Names that are defined here.
    items: HashSet<String>,
}

/// Every scope of one package.
struct Package {
    scopes: BTreeMap<Module, Scope>,
}

/// Files that import each other, by their numbers: from each to those that it imports.
pub type Imports = Vec<BTreeSet<usize>>;

/// The paths that a source names, each with the module that names it.
pub fn paths(source: &Source) -> Vec<(Module, Vec<String>)> {
    let mut scopes = BTreeMap::new();
    read_scopes(0, source, &mut scopes);
    let of_scope = |(module, scope): (Module, Scope)| {
        let uses = scope.uses.into_iter().map(|one| one.path);
        uses.chain(scope.paths).map(move |path| (module.clone(), path)).collect::<Vec<_>>()
    };
    scopes.into_iter().flat_map(of_scope).collect()
}

/// For every source the sources that it imports.
pub fn imports(sources: &[Source]) -> Imports {
    let mut imports = vec![BTreeSet::new(); sources.len()];
    let packages: BTreeSet<usize> = sources.iter().map(|source| source.package).collect();
    for package in packages {
        let mut scopes = BTreeMap::new();
        for (file, source) in sources.iter().enumerate().filter(|(_, source)| source.package == package) {
            // The program's `main.rs` is a package of its own to Rust, and imports only its library.
            if !source.path.ends_with("main.rs") {
                read_scopes(file, source, &mut scopes);
            }
        }
        Package { scopes }.add_imports(&mut imports);
    }
    imports
}

/// The circles: groups of two files and more each of which imports all others, by a longer way or a shorter
/// one.
pub fn circles(imports: &Imports) -> Vec<Vec<usize>> {
    let reached = |from: usize| {
        let (mut seen, mut left) = (BTreeSet::new(), vec![from]);
        while let Some(file) = left.pop() {
            left.extend(imports[file].iter().filter(|&&next| seen.insert(next)));
        }
        seen
    };
    let reached: Vec<_> = (0..imports.len()).map(reached).collect();
    let group = |file: usize| -> Vec<usize> {
        reached[file].iter().copied().filter(|&other| reached[other].contains(&file)).collect()
    };
    // Each circle once: at its first file.
    (0..imports.len())
        .map(|file| (file, group(file)))
        .filter(|(file, group)| group.first() == Some(file))
        .map(|(_, group)| group)
        .filter(|group| group.len() > 1)
        .collect()
}

/// Reads a file's scopes: its own, and those of the modules inside it.
fn read_scopes(file: usize, source: &Source, scopes: &mut BTreeMap<Module, Scope>) {
    const DEFINES: [&str; 9] = ["struct", "enum", "fn", "trait", "const", "static", "type", "union", "mod"];
    let tokens: Vec<&str> = source.tokens.iter().map(String::as_str).collect();
    let token = |at: usize| tokens.get(at).copied().unwrap_or("");
    let mut module = source.module.clone();
    // How many braces are open where an inner module begins.
    let (mut depth, mut inner) = (0, Vec::new());
    let mut at = 0;
    while at < tokens.len() {
        let scope = scopes.entry(module.clone()).or_default();
        scope.file = file;
        match tokens[at] {
            "{" => depth += 1,
            "}" => {
                depth -= 1;
                if inner.last() == Some(&depth) {
                    inner.pop();
                    module.pop();
                }
            }
            "mod" if token(at + 2) == "{" => {
                module.push(tokens[at + 1].into());
                inner.push(depth);
                depth += 1;
                at += 2;
            }
            // A child, which is a scope of its own.
            "mod" if token(at + 2) == ";" => at += 2,
            // Not the `use<…>` of a type.
            "use" if token(at + 1) != "<" => {
                let public = at > 0 && (tokens[at - 1] == "pub" || tokens[at - 1] == ")");
                let end = at + tokens[at..].iter().position(|&token| token == ";").expect("a use ends");
                read_use(&tokens[at + 1..end], &mut Vec::new(), public, &mut scope.uses);
                at = end;
            }
            "macro_rules" => {
                scope.items.insert(token(at + 2).into());
                at += 2;
            }
            word if DEFINES.contains(&word) && is_name(token(at + 1)) => {
                // `const fn`: the name follows the next token.
                let is_definition = !DEFINES.contains(&token(at + 1));
                scope.items.extend(is_definition.then(|| token(at + 1).into()));
                at += usize::from(is_definition);
            }
            name if is_name(name) => {
                let follows = at > 0 && ["::", "."].contains(&tokens[at - 1]);
                let mut path = vec![name.to_owned()];
                while token(at + 1) == "::" && is_name(token(at + 2)) {
                    path.push(token(at + 2).into());
                    at += 2;
                }
                if follows {
                } else if path.len() > 1 {
                    scope.paths.push(path);
                } else if name.starts_with(char::is_uppercase) || token(at + 1) == "(" {
                    // Types and constants, and functions that are called: small names alone are fields and
                    // variables.
                    scope.names.insert(name.into());
                }
            }
            _ => {}
        }
        at += 1;
    }
}

/// Adds what a tree of a `use` names.
fn read_use(tree: &[&str], before: &mut Vec<String>, public: bool, uses: &mut Vec<Use>) {
    let length = before.len();
    let mut at = 0;
    // `::std` begins at the outer packages, like `std`.
    while at < tree.len() && tree[at] != "{" {
        match tree[at] {
            "::" => {}
            "as" => {
                uses.push(Use { path: before.clone(), name: tree[at + 1].into(), public });
                before.truncate(length);
                return;
            }
            // `a::{self}` is `a`.
            "self" if !before.is_empty() => {}
            name => before.push(name.into()),
        }
        at += 1;
    }
    if at < tree.len() {
        let (mut start, mut level) = (at + 1, 0);
        for (end, &token) in tree.iter().enumerate().skip(at) {
            match token {
                "{" => level += 1,
                "}" => level -= 1,
                _ => {}
            }
            if (level == 1 && token == ",") || level == 0 {
                if end > start {
                    read_use(&tree[start..end], before, public, uses);
                }
                start = end + 1;
            }
        }
    } else if let Some(name) = before.last().cloned() {
        uses.push(Use { path: before.clone(), name, public });
    }
    before.truncate(length);
}

impl Package {
    fn add_imports(&self, imports: &mut Imports) {
        for (module, scope) in &self.scopes {
            let own = &mut imports[scope.file];
            for one in &scope.uses {
                let Some((target, file)) = self.find(module, &one.path) else { continue };
                let of_child = target.len() > module.len() && target.starts_with(module);
                // To re-export is no import; where the name is used here as well, it is found below.
                if !(one.public && of_child) {
                    own.insert(file);
                }
            }
            let names = scope.names.iter().map(|name| vec![name.clone()]);
            for path in scope.paths.iter().cloned().chain(names) {
                own.extend(self.find(module, &path).map(|(_, file)| file));
            }
            own.remove(&scope.file);
        }
    }

    /// Where the item of a path is defined: module and file. Nothing, where that is outside of the package or
    /// the path names a module.
    fn find(&self, from: &Module, path: &[String]) -> Option<(Module, usize)> {
        self.find_within(from, path, &mut HashSet::new())
    }

    fn find_within(
        &self,
        from: &Module,
        path: &[String],
        seen: &mut HashSet<(Module, Vec<String>)>,
    ) -> Option<(Module, usize)> {
        // Names that lead round to themselves, `use image::image` say, end here.
        if path.len() > LONGEST || !seen.insert((from.clone(), path.to_vec())) {
            return None;
        }
        let mut module = from.clone();
        let mut rest = path;
        while let Some((first, after)) = rest.split_first() {
            match first.as_str() {
                "crate" => module.clear(),
                "self" => {}
                "super" => {
                    module.pop()?;
                }
                _ => break,
            }
            rest = after;
        }
        // A bare name may be anything outside of the package.
        let sure = rest.len() < path.len();
        self.find_in(module, rest, sure, seen)
    }

    fn find_in(
        &self,
        module: Module,
        path: &[String],
        sure: bool,
        seen: &mut HashSet<(Module, Vec<String>)>,
    ) -> Option<(Module, usize)> {
        let scope = self.scopes.get(&module)?;
        let (name, after) = path.split_first()?;
        let here = Some((module.clone(), scope.file));
        if name == "*" {
            return here;
        }
        let child: Module = module.iter().chain([name]).cloned().collect();
        if self.scopes.contains_key(&child) && !after.is_empty() {
            return self.find_in(child, after, true, seen);
        }
        if scope.items.contains(name) {
            return here;
        }
        for one in scope.uses.iter().filter(|one| one.name == *name) {
            let longer: Vec<String> = one.path.iter().chain(after).cloned().collect();
            if let Some(found) = self.find_within(&module, &longer, seen) {
                return Some(found);
            }
        }
        for one in scope.uses.iter().filter(|one| one.name == "*") {
            let longer: Vec<String> = one.path[..one.path.len() - 1].iter().chain(path).cloned().collect();
            // What a glob brings is known to be there only where it is found.
            if let Some(found) =
                self.find_within(&module, &longer, seen).filter(|(module, _)| self.defines(module, path))
            {
                return Some(found);
            }
        }
        let known = self.scopes.contains_key(&child)
            || scope.uses.iter().any(|one| one.name == *name || one.name == "*");
        if sure && !known { here } else { None }
    }

    /// Is one of a path's names defined in this module?
    fn defines(&self, module: &Module, path: &[String]) -> bool {
        let scope = &self.scopes[module];
        path.iter().any(|name| scope.items.contains(name))
    }
}

/// The circles as lines of text: their files, and who imports whom among them.
pub fn describe(sources: &[Source], imports: &Imports, circle: &[usize]) -> String {
    let path = |file: &usize| sources[*file].path.display().to_string();
    let line = |file: &usize| {
        let to: Vec<_> = imports[*file].iter().filter(|other| circle.contains(other)).map(path).collect();
        format!("    {} imports {}", path(file), to.join(", "))
    };
    let lines: Vec<_> = circle.iter().map(line).collect();
    format!("circle of {} files:\n{}", circle.len(), lines.join("\n"))
}

#[test]
fn circles_are_seen_in_made_up_sources() {
    let of = |files: &[(&str, &str)]| -> Vec<String> {
        let source = |(path, text): &(&str, &str)| Source::new(path.as_ref(), (*text).into());
        let mut sources: Vec<_> = files.iter().map(source).collect();
        sources.push(Source::new("src/engine/lib.rs".as_ref(), "mod a; mod d; mod e;".into()));
        let names =
            |circle: Vec<usize>| -> Vec<&str> { circle.into_iter().map(|file| files[file].0).collect() };
        circles(&imports(&sources)).into_iter().map(|circle| names(circle).join(" ")).collect()
    };
    let room = "src/engine/a/mod.rs";
    let (b, c, d) = ("src/engine/a/b.rs", "src/engine/a/c.rs", "src/engine/d.rs");
    let none: [&str; 0] = [];
    // Two files directly, and three with one in another room.
    assert_eq!(
        of(&[(room, "mod b; mod c;"), (b, "use super::c::Y; struct X;"), (c, "use super::b::X; struct Y;")]),
        ["src/engine/a/b.rs src/engine/a/c.rs"]
    );
    let long = [
        (room, "mod b; mod c;"),
        (b, "fn x() { crate::a::c::y() }"),
        (c, "use crate::{d::{self, Z as W}, e}; fn y() {}"),
        (d, "use crate::a::b; struct Z; fn z() { b::x::<u8>() }"),
    ];
    assert_eq!(of(&long), ["src/engine/a/b.rs src/engine/a/c.rs src/engine/d.rs"]);
    // Declared and re-exported children are no imports; what comes through a re-export comes from its file.
    let reexport = [
        (room, "mod b; mod c; pub use b::X; pub use c::{Y, y};"),
        (b, "use super::{Y, y}; pub struct X;"),
        (c, "pub struct Y; pub fn y() {}"),
    ];
    assert_eq!(of(&reexport), none);
    let back = [reexport[0], reexport[1], (c, "use crate::a::X; pub struct Y; pub fn y() {}")];
    assert_eq!(of(&back), ["src/engine/a/b.rs src/engine/a/c.rs"]);
    // A module that uses what its child defines, while the child uses what it defines.
    for text in [
        "mod b; use b::X; pub struct M;",
        "mod b; pub use b::X; pub struct M(X);",
        "mod b; pub struct M(b::X);",
    ] {
        assert_eq!(
            of(&[(room, text), (b, "use super::M; pub struct X;")]),
            ["src/engine/a/mod.rs src/engine/a/b.rs"]
        );
    }
    // By a glob, by way of a module inside of a file, and by the name of a module that was imported.
    let glob = [
        (room, "mod b; mod c; pub use c::*;"),
        (b, "use super::*; pub struct X; fn x(y: Y) {}"),
        (c, "pub struct Y;"),
    ];
    assert_eq!(of(&glob), none);
    let inner = [
        (room, "mod b; mod c;"),
        (b, "struct X; mod tests { use super::*; use super::super::c::Y; }"),
        (c, "use super::b::X; struct Y;"),
    ];
    assert_eq!(of(&inner), ["src/engine/a/b.rs src/engine/a/c.rs"]);
    let named = [
        (room, "mod b; mod c;"),
        (b, "use crate::a::c; pub struct X(c::Y);"),
        (c, "pub struct Y(super::b::X);"),
    ];
    assert_eq!(of(&named), ["src/engine/a/b.rs src/engine/a/c.rs"]);
    // Comments and texts import nothing, nor do packages of the same names.
    let quiet = [
        (room, "mod b; mod c;"),
        (b, "// super::c::Y\nconst S: &str = \"super::c::Y\"; struct X;"),
        (c, "use super::b::X; struct Y;"),
    ];
    assert_eq!(of(&quiet), none);
    let packages = [(d, "use crate::e::Y; struct X;"), ("src/formats/e.rs", "use crate::d::X; struct Y;")];
    assert_eq!(of(&packages), none);
}
