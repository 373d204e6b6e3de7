//! Text for terminals of ordinary width: paragraphs, rows of tables, the warning of a busy machine.

use super::numbers::percent;
use crate::measure::cores::Reliability;
use std::cmp::Ordering;
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

/// A row of a table: cells in columns of these widths, negative where they stand on the left. A first cell
/// that is too long has a line of its own above.
pub fn row(widths: &[isize], cells: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    let mut row = String::new();
    for (cell, &width) in cells.into_iter().zip(widths) {
        let (cell, columns) = (cell.as_ref(), width.unsigned_abs());
        row += &if width > 0 { format!("{cell:>columns$}") } else { format!("{cell:<columns$}") };
        if row.chars().count() > columns && row.len() == cell.len() {
            row += &format!("\n{:columns$}", "");
        }
    }
    row + "\n"
}

/// The warning that other programs took the processor while something was timed; it names the figure from
/// which they took most.
pub fn busy(figures: impl Iterator<Item = (Reliability, String)>) -> Option<String> {
    let busy = figures.filter(|(figure, _)| figure.is_busy());
    let (Reliability { taken, .. }, name) =
        busy.max_by(|a, b| a.0.taken.partial_cmp(&b.0.taken).unwrap_or(Ordering::Equal))?;
    let taken = percent(taken.unwrap_or_default());
    Some(format!(
        "the machine is busy: other programs took {taken} of the time of {name}; end them and measure again."
    ))
}

/// What follows a sentence about `speeds`.
pub fn if_doubtful(reliable: bool, speeds: &str) -> String {
    if reliable { String::new() } else { format!(" The {speeds} are not reliable: see the warnings.") }
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
    fn row_keeps_columns_in_place() {
        assert_eq!(row(&[-5, 4, 0], ["abc", "d", " and"]), "abc     d and\n");
        assert_eq!(row(&[-5, 4], ["abcdé", "f"]), "abcdé   f\n");
        assert_eq!(row(&[-5, 4], ["abcdef", "g"]), "abcdef\n        g\n");
    }
}
