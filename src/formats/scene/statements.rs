//! The lines of Wavefront files: statements, words and numbers.
//!
//! For: [`logical_lines`], [`words`], [`numbers`], [`name`].

use super::check::{WITHIN_BOUNDS, fits};
use std::borrow::Cow;

/// What is wrong with a line, and how to mend it.
pub type Fault = (String, String);

/// Lines with their numbers, from 1. A backslash at a line's end joins the next line to it.
pub fn logical_lines(text: &[u8]) -> impl Iterator<Item = (usize, Cow<'_, [u8]>)> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let mut lines = text.split(|&byte| byte == b'\n').enumerate();
    std::iter::from_fn(move || {
        let (index, first) = lines.next()?;
        let mut content = Cow::Borrowed(first);
        while let Some(head) = content.trim_ascii_end().strip_suffix(b"\\").map(<[u8]>::len) {
            let Some((_, next)) = lines.next() else { break };
            // In place: a copy for every line would take time by the square of their number.
            let joined = content.to_mut();
            joined.truncate(head);
            joined.push(b' ');
            joined.extend_from_slice(next);
        }
        Some((index + 1, content))
    })
}

/// The rest of a line as a name: it may hold spaces.
pub fn name(rest: &[u8]) -> String {
    String::from_utf8_lossy(rest.trim_ascii()).into_owned()
}

pub fn words(rest: &[u8]) -> impl Iterator<Item = &[u8]> {
    rest.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// The first `N` words as numbers; what follows them (weights, vertex colours) is ignored.
pub fn numbers<const N: usize>(rest: &[u8], what: &str) -> Result<[f64; N], Fault> {
    let mut words = words(rest);
    let mut values = [0.0; N];
    for value in &mut values {
        let Some(word) = words.next() else {
            return Err((format!("{what} needs {N} numbers"), format!("write {N} numbers on this line")));
        };
        *value = number(word)?;
    }
    Ok(values)
}

pub fn number(word: &[u8]) -> Result<f64, Fault> {
    let shown = String::from_utf8_lossy(word);
    let value: f64 =
        shown.parse().map_err(|_| (format!("`{shown}` is not a number"), "write a number".to_string()))?;
    if fits(value) {
        Ok(value)
    } else {
        Err((format!("`{shown}` is not a number that a scene can hold"), WITHIN_BOUNDS.to_string()))
    }
}
