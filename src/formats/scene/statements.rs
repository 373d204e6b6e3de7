//! The lines of Wavefront files: statements of a keyword, words and numbers.
//!
//! For: [`statements`], [`Statement`].

use super::check::{WITHIN_BOUNDS, fits};
use super::error::SceneError;
use std::borrow::Cow;
use std::path::Path;

/// A line that is not empty, and those that a backslash at its end joins to it.
pub struct Statement<'a> {
    path: &'a Path,
    /// The number of its first line, from 1.
    pub line: usize,
    content: Cow<'a, [u8]>,
}

/// The statements of a file. Comments are statements whose keyword begins with `#`.
pub fn statements<'a>(text: &'a [u8], path: &'a Path) -> impl Iterator<Item = Statement<'a>> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let mut lines = text.split(|&byte| byte == b'\n').enumerate();
    let statements = std::iter::from_fn(move || {
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
        Some(Statement { path, line: index + 1, content })
    });
    statements.filter(|statement| !statement.keyword().is_empty())
}

impl Statement<'_> {
    pub fn keyword(&self) -> &[u8] {
        let content = self.content.trim_ascii_start();
        content.split(u8::is_ascii_whitespace).next().unwrap_or_default()
    }
    /// What follows the keyword, as a name: it may hold spaces.
    pub fn name(&self) -> String {
        let rest = &self.content.trim_ascii_start()[self.keyword().len()..];
        String::from_utf8_lossy(rest.trim_ascii()).into_owned()
    }
    /// The words that follow the keyword.
    pub fn words(&self) -> impl Iterator<Item = &[u8]> {
        self.content.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty()).skip(1)
    }
    /// The first `N` words as numbers; what follows them (weights, vertex colours) is ignored.
    pub fn numbers<const N: usize>(&self, what: &str) -> Result<[f64; N], SceneError> {
        let mut words = self.words();
        let mut values = [0.0; N];
        for value in &mut values {
            let missing =
                || self.fault(format!("{what} needs {N} numbers"), format!("write {N} numbers on this line"));
            *value = self.number(words.next().ok_or_else(missing)?)?;
        }
        Ok(values)
    }
    pub fn number(&self, word: &[u8]) -> Result<f64, SceneError> {
        let shown = String::from_utf8_lossy(word);
        match shown.parse() {
            Ok(value) if fits(value) => Ok(value),
            Ok(_) => {
                let what = format!("`{shown}` is not a number that a scene can hold");
                Err(self.fault(what, WITHIN_BOUNDS))
            }
            Err(_) => Err(self.fault(format!("`{shown}` is not a number"), "write a number")),
        }
    }
    /// An error about the statement.
    pub fn fault(&self, what: impl Into<String>, mend: impl Into<String>) -> SceneError {
        SceneError::new(what).in_file(self.path).at(format!("line {}", self.line)).mend(mend)
    }
}
