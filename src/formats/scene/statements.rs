//! Splits Wavefront files into statements of a keyword, words and numbers.

use super::check::{WITHIN_BOUNDS, is_within_bounds};
use super::error::SceneError;
use std::borrow::Cow;
use std::path::Path;

/// A statement: a line that is not empty, and the lines that a backslash at its end joins to it. A `#` begins
/// a comment, which ends with its line. Names may hold a `#`: see [`without_comment`].
pub struct Statement<'a> {
    path: &'a Path,
    /// The number of its first line, from 1.
    pub line: usize,
    content: Cow<'a, [u8]>,
}

/// Returns the statements of a file.
pub fn statements<'a>(text: &'a [u8], path: &'a Path) -> impl Iterator<Item = Statement<'a>> {
    let text = text.strip_prefix(b"\xef\xbb\xbf").unwrap_or(text);
    let mut lines = text.split(|&byte| byte == b'\n').enumerate();
    let statements = std::iter::from_fn(move || {
        let (index, first) = lines.next()?;
        let (mut content, mut last) = (Cow::Borrowed(first), first);
        while !last.contains(&b'#')
            && let Some(head) = content.trim_ascii_end().strip_suffix(b"\\").map(<[u8]>::len)
        {
            let Some((_, next)) = lines.next() else { break };
            // Joined in place, because a copy for every line would take time by the square of their number.
            let joined = content.to_mut();
            joined.truncate(head);
            joined.push(b' ');
            joined.extend_from_slice(next);
            last = next;
        }
        Some(Statement { path, line: index + 1, content })
    });
    statements.filter(|statement| !statement.keyword().is_empty())
}

/// Returns a name as it is, and shortened to where a `#` may begin a comment. Some names hold a `#`.
pub fn without_comment(name: &str) -> impl Iterator<Item = &str> {
    let ends = [Some(name.len()), name.find(" #"), name.find('#')];
    ends.into_iter().flatten().map(|end| name[..end].trim_end()).filter(|name| !name.is_empty())
}

impl Statement<'_> {
    pub fn keyword(&self) -> &[u8] {
        self.all_words().next().unwrap_or_default()
    }
    /// Returns the keyword for messages.
    pub fn shown(&self) -> String {
        let keyword = self.keyword();
        format!("`{}`", String::from_utf8_lossy(&keyword[..keyword.len().min(40)]))
    }
    /// Tests whether it switches off what its kind of statements switches on.
    pub fn is_off(&self) -> bool {
        self.words().eq([b"off"]) || self.words().eq([b"0"])
    }
    /// Returns the rest after the keyword as a name, which may hold spaces.
    pub fn name(&self) -> String {
        let rest = &self.content.trim_ascii_start()[self.keyword().len()..];
        String::from_utf8_lossy(rest.trim_ascii()).into_owned()
    }
    fn all_words(&self) -> impl Iterator<Item = &[u8]> {
        let content = self.content.split(|&byte| byte == b'#').next().unwrap_or_default();
        content.split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
    }
    /// Returns the words after the keyword.
    pub fn words(&self) -> impl Iterator<Item = &[u8]> {
        self.all_words().skip(1)
    }
    /// Parses the next `N` of these words as numbers.
    pub fn numbers<'a, const N: usize>(
        &self,
        words: &mut impl Iterator<Item = &'a [u8]>,
        what: &str,
    ) -> Result<[f64; N], SceneError> {
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
            Ok(value) if is_within_bounds(value) => Ok(value),
            Ok(_) => {
                let what = format!("`{shown}` is not a number that a scene can hold");
                Err(self.fault(what, WITHIN_BOUNDS))
            }
            Err(_) => Err(self.fault(format!("`{shown}` is not a number"), "write a number")),
        }
    }
    /// Makes an error about the statement.
    pub fn fault(&self, what: impl Into<String>, mend: impl Into<String>) -> SceneError {
        SceneError::new(what).in_file(self.path).at_place(format!("line {}", self.line)).mend(mend)
    }
}
