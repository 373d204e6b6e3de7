//! Reads JSON and locates errors: a JSON path, and from it the line and column.
//!
//! For: [`read`], [`JsonPath`], [`Source`].

use super::error::SceneError;
use super::spelling::nearest;
use serde::de::DeserializeOwned;
use std::fmt;
use std::path::Path;

/// A path into a JSON text, a chain of borrowed steps: nothing is allocated until an error prints it.
#[derive(Clone, Copy)]
pub enum JsonPath<'a> {
    Root,
    Key(&'a JsonPath<'a>, &'a str),
    Item(&'a JsonPath<'a>, usize),
}

impl<'a> JsonPath<'a> {
    pub fn key(&'a self, key: &'a str) -> JsonPath<'a> {
        JsonPath::Key(self, key)
    }
    pub fn item(&'a self, index: usize) -> JsonPath<'a> {
        JsonPath::Item(self, index)
    }
    /// The byte at which the path's value starts. Domain: `text` is valid JSON.
    fn offset(&self, text: &[u8]) -> Option<usize> {
        match *self {
            JsonPath::Root => Some(skip_space(text, 0)),
            JsonPath::Key(parent, key) => {
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
            JsonPath::Item(parent, index) => {
                let mut at = skip_space(text, parent.offset(text)? + 1);
                for _ in 0..index {
                    at = next_entry(text, at);
                }
                (at < text.len()).then_some(at)
            }
        }
    }
}

impl fmt::Display for JsonPath<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            JsonPath::Root => Ok(()),
            JsonPath::Key(JsonPath::Root, key) => write!(f, "{key}"),
            JsonPath::Key(parent, key) => write!(f, "{parent}.{key}"),
            JsonPath::Item(parent, index) => write!(f, "{parent}[{index}]"),
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
                // A number or a word ends at a separator.
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
    pub fn error(&self, place: &JsonPath, what: impl Into<String>, mend: impl Into<String>) -> SceneError {
        let error = SceneError::new(what).in_file(self.file).mend(mend);
        match (place, place.offset(self.text.as_bytes())) {
            (JsonPath::Root, _) => error,
            (place, None) => error.at(place.to_string()),
            (place, Some(offset)) => {
                let (line, column) = line_and_column(self.text, offset);
                error.at(format!("{place}, line {line}, column {column}"))
            }
        }
    }
}

/// Both count from 1; columns are characters.
fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = String::from_utf8_lossy(&text.as_bytes()[..offset]);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

/// Parses a JSON text as `T`.
pub fn read<T: DeserializeOwned>(source: &Source) -> Result<T, SceneError> {
    let mut deserializer = serde_json::Deserializer::from_str(source.text);
    let value: T = serde_path_to_error::deserialize(&mut deserializer)
        .map_err(|error| refusal(source, &error.path().to_string(), error.inner()))?;
    deserializer.end().map_err(|error| refusal(source, ".", &error))?;
    Ok(value)
}

fn refusal(source: &Source, path: &str, error: &serde_json::Error) -> SceneError {
    let (mut line, mut column) = (error.line(), error.column());
    let message = error.to_string();
    let message = message.strip_suffix(&format!(" at line {line} column {column}")).unwrap_or(&message);
    if error.is_eof() {
        (line, column) = line_and_column(source.text, source.text.trim_end().len());
    }
    let (what, mend) = if error.is_data() {
        data_fault(path, message)
    } else if message == "trailing characters" && path != "." {
        ("there are too many entries in this list".to_string(), "remove those from here on".to_string())
    } else {
        syntax_fault(message, source.text.lines().nth(line.saturating_sub(1)).unwrap_or_default(), column)
    };
    // `serde_path_to_error` writes a question mark for an unreadable key.
    let path = path.trim_end_matches('?').trim_end_matches('.');
    let place = match path {
        "" => format!("line {line}, column {column}"),
        path => format!("{path}, line {line}, column {column}"),
    };
    SceneError::new(what).in_file(source.file).at(place).mend(mend)
}

fn syntax_fault(message: &str, line: &str, column: usize) -> (String, String) {
    let rest = line.get(column.saturating_sub(1)..).unwrap_or_default();
    let word = rest.trim_start_matches('-');
    if ["NaN", "nan", "Inf", "inf"].iter().any(|start| word.starts_with(start))
        || message.contains("number out of range")
    {
        let what = "this is not a finite number".to_string();
        return (what, "write a number from -1e18 to 1e18; JSON has no NaN and no infinity".to_string());
    }
    let mend = match message {
        "EOF while parsing a value" => "the file is empty or ends too early: write a JSON object",
        "trailing comma" => "remove the comma before the closing bracket",
        "trailing characters" => "remove what follows the end of the JSON object",
        m if m.starts_with("EOF") => "the file ends too early: close the brackets and quotes that are open",
        m if m.starts_with("expected `,`") => "put a comma between two entries",
        "key must be a string" => "put the key in double quotes; comments are not allowed",
        _ => "mend the JSON here: keys and texts in double quotes, commas between entries, no comments",
    };
    (format!("broken JSON: {message}"), mend.to_string())
}

fn data_fault(path: &str, message: &str) -> (String, String) {
    let quoted = || message.split('`').skip(1).step_by(2);
    if message.starts_with("unknown field") {
        let unknown = quoted().next().unwrap_or_default();
        let known: Vec<&str> = quoted().skip(1).collect();
        let guess = nearest(unknown, known.iter().copied());
        let guess = guess.map(|known| format!("did you mean `{known}`? ")).unwrap_or_default();
        let mend = format!("{guess}the keys known here are {}", known.join(", "));
        return (format!("unknown key `{unknown}`"), mend);
    }
    if message.starts_with("missing field") {
        let missing = quoted().next().unwrap_or_default();
        return (format!("the key `{missing}` is missing"), format!("add `{missing}` to this object"));
    }
    if message.starts_with("duplicate field") || message.contains("occurs twice") {
        return (
            message.replace("duplicate field", "a second"),
            "remove or rename one of the two".to_string(),
        );
    }
    if message.starts_with("unknown variant") {
        let (key, word) = (path.rsplit('.').next().unwrap_or(path), quoted().next().unwrap_or_default());
        let known: Vec<&str> = quoted().skip(1).collect();
        return (format!("`{key}` cannot be `{word}`"), format!("write one of {}", known.join(", ")));
    }
    let message = message
        .replace("expected f64", "expected a number")
        .replace("expected u32", "expected a whole number of 0 or more")
        .replace("expected a sequence", "expected an array");
    let expected = message.rsplit_once("expected ").map(|(_, expected)| expected.to_string());
    let mend =
        expected.map_or("see the scene format".to_string(), |expected| format!("write {expected} here"));
    (message, mend)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_path_finds_line_and_column_past_strings_nested_values_and_escapes() {
        let text =
            "{ \"a,{\": [1, {\"x\": \"]\\\"\"}, 3],\n  \"b\\u0041\": [\n [0], [1, -2.5e3] ], \"c\": true }";
        let source = Source { file: Path::new("x.json"), text };
        let root = JsonPath::Root;
        let at = |place: &JsonPath| source.error(place, "", "").at.unwrap();
        assert_eq!(at(&root.key("a,{").item(2)), "a,{[2], line 1, column 28");
        assert_eq!(at(&root.key("bA").item(1).item(1)), "bA[1][1], line 3, column 11");
        assert_eq!(at(&root.key("c")), "c, line 3, column 27");
        assert_eq!(at(&root.key("missing")), "missing");
    }
}
