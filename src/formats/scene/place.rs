//! Where in a JSON text something stands: a path, and from the path the line and column.
//!
//! For: [`Place`], [`Source`]. May import: `error`. Must never know: what the keys mean.

use super::SceneError;
use std::fmt;
use std::path::Path;

/// A path into a JSON text, as a chain of borrowed steps: it costs nothing until an error prints it.
#[derive(Clone, Copy)]
pub enum Place<'a> {
    Root,
    Key(&'a Place<'a>, &'a str),
    Item(&'a Place<'a>, usize),
}

impl<'a> Place<'a> {
    pub fn key(&'a self, key: &'a str) -> Place<'a> {
        Place::Key(self, key)
    }
    pub fn item(&'a self, index: usize) -> Place<'a> {
        Place::Item(self, index)
    }
    /// The byte at which this place's value starts. Domain: `text` is valid JSON.
    fn offset(&self, text: &[u8]) -> Option<usize> {
        match *self {
            Place::Root => Some(skip_space(text, 0)),
            Place::Key(parent, key) => {
                let mut at = skip_space(text, parent.offset(text)? + 1);
                while text.get(at) == Some(&b'"') {
                    let key_end = skip_value(text, at);
                    let value = skip_space(text, skip_space(text, key_end) + 1);
                    if serde_json::from_slice::<String>(text.get(at..key_end)?)
                        .is_ok_and(|found| found == key)
                    {
                        return Some(value);
                    }
                    at = next_entry(text, value);
                }
                None
            }
            Place::Item(parent, index) => {
                let mut at = skip_space(text, parent.offset(text)? + 1);
                for _ in 0..index {
                    at = next_entry(text, at);
                }
                (at < text.len()).then_some(at)
            }
        }
    }
}

impl fmt::Display for Place<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Place::Root => Ok(()),
            Place::Key(Place::Root, key) => write!(f, "{key}"),
            Place::Key(parent, key) => write!(f, "{parent}.{key}"),
            Place::Item(parent, index) => write!(f, "{parent}[{index}]"),
        }
    }
}

fn skip_space(text: &[u8], mut at: usize) -> usize {
    while text.get(at).is_some_and(u8::is_ascii_whitespace) {
        at += 1;
    }
    at
}

/// The start of the entry after the one whose value starts at `value`: past the value and the comma.
fn next_entry(text: &[u8], value: usize) -> usize {
    skip_space(text, skip_space(text, skip_value(text, value)) + 1)
}

/// The first byte after the value that starts at `at`.
fn skip_value(text: &[u8], mut at: usize) -> usize {
    let mut depth = 0_usize;
    while let Some(&byte) = text.get(at) {
        match byte {
            b'"' => {
                at += 1;
                while text.get(at).is_some_and(|&byte| byte != b'"') {
                    at += if text[at] == b'\\' { 2 } else { 1 };
                }
            }
            b'{' | b'[' => depth += 1,
            b'}' | b']' => depth = depth.saturating_sub(1),
            _ => {
                // A number or a word ends where a separator stands.
                while text.get(at + 1).is_some_and(|next| !b",:]} \t\r\n".contains(next)) && depth == 0 {
                    at += 1;
                }
            }
        }
        at += 1;
        if depth == 0 {
            break;
        }
    }
    at
}

/// A JSON text and the file it came from, for messages.
pub struct Source<'a> {
    pub file: &'a Path,
    pub text: &'a str,
}

impl Source<'_> {
    /// An error about the value at `place`.
    pub fn error(&self, place: &Place, what: impl Into<String>, mend: impl Into<String>) -> SceneError {
        let error = SceneError::new(what).in_file(self.file).mend(mend);
        match (place, place.offset(self.text.as_bytes())) {
            (Place::Root, _) => error,
            (place, None) => error.at(place.to_string()),
            (place, Some(offset)) => {
                let (line, column) = line_and_column(self.text, offset);
                error.at(format!("{place}, line {line}, column {column}"))
            }
        }
    }
}

/// Both count from 1; a column is a character.
fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = String::from_utf8_lossy(&text.as_bytes()[..offset]);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn place_finds_line_and_column_past_strings_nested_values_and_escapes() {
        let text =
            "{ \"a,{\": [1, {\"x\": \"]\\\"\"}, 3],\n  \"b\\u0041\": [\n [0], [1, -2.5e3] ], \"c\": true }";
        let source = Source { file: Path::new("x.json"), text };
        let root = Place::Root;
        let at = |place: &Place| source.error(place, "", "").at.unwrap();
        assert_eq!(at(&root.key("a,{").item(2)), "a,{[2], line 1, column 28");
        assert_eq!(at(&root.key("bA").item(1).item(1)), "bA[1][1], line 3, column 11");
        assert_eq!(at(&root.key("c")), "c, line 3, column 27");
        assert_eq!(at(&root.key("missing")), "missing");
    }
}
