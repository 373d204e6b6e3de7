//! The sources as text: every file of every package, with its place among the modules.

use proc_macro2::{Delimiter, Spacing, TokenStream, TokenTree};
use std::fs;
use std::path::{Path, PathBuf};

/// The packages, each of which may use those before it: Cargo keeps that order. The last one is the
/// program's.
pub const PACKAGES: [(&str, &str); 6] = [
    ("rays", "src/rays"),
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
    pub tokens: Vec<String>,
    /// The tokens, with spaces between names alone.
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
        let tokens = tokens_of(&text);
        Self { path: path.into(), package, module, text, code: joined(&tokens), tokens }
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

/// The tokens of a text, without comments, strings and characters; `::` is one.
fn tokens_of(text: &str) -> Vec<String> {
    fn flatten(stream: TokenStream, tokens: &mut Vec<String>) {
        let mut joined = false;
        for tree in stream {
            let was_joined = std::mem::take(&mut joined);
            match tree {
                TokenTree::Group(group) => {
                    let [open, close] = match group.delimiter() {
                        Delimiter::Brace => ["{", "}"],
                        Delimiter::Bracket => ["[", "]"],
                        _ => ["(", ")"],
                    };
                    tokens.push(open.into());
                    flatten(group.stream(), tokens);
                    tokens.push(close.into());
                }
                TokenTree::Ident(name) => tokens.push(name.to_string()),
                TokenTree::Punct(sign) if sign.as_char() == ':' && was_joined => {
                    *tokens.last_mut().unwrap() = "::".into();
                }
                TokenTree::Punct(sign) => {
                    joined = sign.as_char() == ':' && sign.spacing() == Spacing::Joint;
                    tokens.push(sign.as_char().into());
                }
                TokenTree::Literal(literal) => {
                    let text = literal.to_string();
                    tokens.extend(text.starts_with(|c: char| c.is_ascii_digit()).then_some(text));
                }
            }
        }
    }
    let mut tokens = Vec::new();
    flatten(text.parse().expect("a source of Rust"), &mut tokens);
    tokens
}

pub fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Tokens as a text, with spaces between names alone.
fn joined(tokens: &[String]) -> String {
    let mut text = String::new();
    for (at, token) in tokens.iter().enumerate() {
        let apart = at > 0 && is_name(&tokens[at - 1]) && is_name(token);
        text.extend(apart.then_some(' '));
        text += token;
    }
    text
}
