//! Reads JSON and locates errors: a JSON path, and from it the line and column.

use super::error::SceneError;
use super::spelling::did_you_mean;
use serde::de::DeserializeOwned;
use serde_json::value::RawValue;
use std::collections::HashMap;
use std::fmt;
use std::path::Path;

/// A JSON text, and the file it came from.
pub struct Source<'a> {
    pub file: &'a Path,
    pub text: &'a str,
}

impl Source<'_> {
    /// Returns the place of the whole text.
    pub fn root(&self) -> JsonPath<'_> {
        JsonPath::Root(self)
    }
}

/// A place in a JSON text: a chain of borrowed steps, so that nothing is allocated until an error prints it.
#[derive(Clone, Copy)]
pub enum JsonPath<'a> {
    Root(&'a Source<'a>),
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
    fn source(&self) -> &'a Source<'a> {
        match *self {
            JsonPath::Root(source) => source,
            JsonPath::Key(parent, _) | JsonPath::Item(parent, _) => parent.source(),
        }
    }
    /// Makes an error about the value here.
    pub fn error(&self, what: impl Into<String>, mend: impl Into<String>) -> SceneError {
        let source = self.source();
        let error = SceneError::new(what).in_file(source.file).mend(mend);
        match (self, self.value()) {
            (JsonPath::Root(_), _) => error,
            (_, None) => error.at_place(self.to_string()),
            (_, Some(value)) => {
                let offset = value.as_ptr().addr() - source.text.as_ptr().addr();
                let (line, column) = line_and_column(source.text, offset);
                error.at_place(format!("{self}, line {line}, column {column}"))
            }
        }
    }
    /// Returns the text of the value here, if there is one. Domain: the text is valid JSON.
    pub fn value(&self) -> Option<&'a str> {
        let value: &RawValue = match *self {
            JsonPath::Root(source) => return Some(source.text),
            JsonPath::Key(parent, key) => {
                serde_json::from_str::<HashMap<String, &RawValue>>(parent.value()?).ok()?.remove(key)?
            }
            JsonPath::Item(parent, index) => {
                serde_json::from_str::<Vec<&RawValue>>(parent.value()?).ok()?.get(index)?
            }
        };
        Some(value.get())
    }
}

impl fmt::Display for JsonPath<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            JsonPath::Root(_) => Ok(()),
            JsonPath::Key(JsonPath::Root(_), key) => write!(f, "{key}"),
            JsonPath::Key(parent, key) => write!(f, "{parent}.{key}"),
            JsonPath::Item(parent, index) => write!(f, "{parent}[{index}]"),
        }
    }
}

/// Returns the line and the column in characters of an offset in bytes, both from 1.
fn line_and_column(text: &str, offset: usize) -> (usize, usize) {
    let before = String::from_utf8_lossy(&text.as_bytes()[..offset]);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

/// The remedy for a key or a name that occurs twice.
pub const REMOVE_ONE: &str = "remove or rename one of the two";

/// Parses a JSON text as `T`. The error is its first fault.
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
    let (what, mend) = if error.is_data() || message == LONG_LIST && path != "." {
        data_fault(path, message)
    } else {
        syntax_fault(message, source.text.lines().nth(line.saturating_sub(1)).unwrap_or_default(), column)
    };
    // `serde_path_to_error` writes a question mark for an unreadable key.
    let path = path.trim_end_matches('?').trim_end_matches('.');
    let place = match path {
        "" => format!("line {line}, column {column}"),
        path => format!("{path}, line {line}, column {column}"),
    };
    SceneError::new(what).in_file(source.file).at_place(place).mend(mend)
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

/// Returns the word that a message of serde is about, and the words that are known instead.
pub fn quoted(message: &str) -> (&str, Vec<&str>) {
    let mut quoted = message.split('`').skip(1).step_by(2);
    (quoted.next().unwrap_or_default(), quoted.collect())
}

/// The message of serde about a list with more entries than it may have.
const LONG_LIST: &str = "trailing characters";

/// Returns the fault and the remedy of a message of serde.
pub fn data_fault(path: &str, message: &str) -> (String, String) {
    let (word, known) = quoted(message);
    if message.starts_with("unknown field") {
        let mend = format!("{}the keys known here are {}", did_you_mean(word, &known), known.join(", "));
        return (format!("unknown key `{word}`"), mend);
    }
    if message.starts_with("missing field") {
        return (format!("the key `{word}` is missing"), format!("add `{word}` to this object"));
    }
    if message.starts_with("duplicate field") || message.contains("occurs twice") {
        let what = message.replace("duplicate field", "a second");
        return (what, REMOVE_ONE.to_string());
    }
    if message.starts_with("unknown variant") {
        let key = path.rsplit('.').next().unwrap_or(path);
        return (format!("`{key}` cannot be `{word}`"), format!("write one of {}", known.join(", ")));
    }
    if message == LONG_LIST {
        let what = "there are too many entries in this list";
        return (what.to_string(), "remove the entries from here on".to_string());
    }
    let message = message
        .replace("expected f64", "expected a number")
        .replace("expected u32", "expected a whole number of 0 or more")
        .replace("expected a JSON number", "expected a whole number of 0 or more")
        .replace("expected a sequence", "expected an array")
        .replace("expected a map", "expected an object")
        .replace("invalid type: sequence", "invalid type: array")
        .replace("invalid type: map", "invalid type: object")
        .replace("floating point", "number");
    let mend = match message.rsplit_once("expected ") {
        Some((_, expected)) => format!("write {expected} here"),
        None => "see the scene format".to_string(),
    };
    (message, mend)
}
