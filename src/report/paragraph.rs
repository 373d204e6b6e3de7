//! Text in lines that a terminal of ordinary width shows whole.
//!
//! For: [`paragraph`], [`item`], [`row_name`] and its [`NAME`].

use textwrap::{Options, WordSplitter};

/// Columns of a line, as of help that is piped.
const WIDTH: usize = 100;

/// Lines end at blanks alone: paths, and names such as `moller-trumbore`, stay whole.
fn options<'a>() -> Options<'a> {
    Options::new(WIDTH).break_words(false).word_splitter(WordSplitter::NoHyphenation)
}

/// Sentences in lines of up to `WIDTH` columns, the last one ended too.
pub fn paragraph(text: &str) -> String {
    textwrap::fill(text, options()) + "\n"
}

/// A name in a column of `name_width`, and what is said of it, in further lines below itself.
pub fn item(name: &str, name_width: usize, text: &str) -> String {
    let (first, further) = (format!("{name:<name_width$} "), " ".repeat(name_width + 1));
    textwrap::fill(text, options().initial_indent(&first).subsequent_indent(&further)) + "\n"
}

/// Columns of the scene's name in tables that have a row for each scene.
pub const NAME: usize = 24;

/// A scene's name in its [`NAME`] columns; a longer one in a line above its row.
pub fn row_name(name: &str) -> String {
    if name.chars().count() < NAME { format!("{name:<NAME$}") } else { format!("{name}\n{:NAME$}", "") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn item_indents_further_lines_and_keeps_long_words() {
        let path = "long-name/".repeat(12);
        assert_eq!(item("file", 6, &path), format!("file   {path}\n"));
        let two = item("why", 6, &"word ".repeat(25));
        assert_eq!(two.lines().count(), 2);
        assert!(
            two.lines().all(|line| line.chars().count() <= WIDTH && line[7..].starts_with("word")),
            "{two}"
        );
        assert!(two.lines().nth(1).unwrap().starts_with("       word"), "{two}");
    }

    #[test]
    fn row_name_keeps_columns_in_place() {
        assert_eq!(row_name("abc"), "abc".to_owned() + &" ".repeat(NAME - 3));
        let long = "x".repeat(NAME);
        assert_eq!(row_name(&long), long + "\n" + &" ".repeat(NAME));
    }
}
