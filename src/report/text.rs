//! Text for terminals of ordinary width: paragraphs, rows of tables, the warning of a busy machine.

use super::numbers::percent;
use crate::measure::cores::Reliability;
use std::cmp::Ordering;
use textwrap::{Options, WordSplitter};

/// Columns of a line, as of help that is piped.
const WIDTH: usize = 100;

/// Breaks lines at blanks alone: paths, and names such as `moller-trumbore`, stay whole.
fn options<'a>() -> Options<'a> {
    Options::new(WIDTH).break_words(false).word_splitter(WordSplitter::NoHyphenation)
}

/// Wraps sentences in lines of up to `WIDTH` columns.
pub fn paragraph(text: &str) -> String {
    textwrap::fill(text, options()) + "\n"
}

/// Formats a name in a column of `name_width`, and its text beside it in as many lines as it needs.
pub fn item(name: &str, name_width: usize, text: &str) -> String {
    let (first, further) = (format!("{name:<name_width$} "), " ".repeat(name_width + 1));
    textwrap::fill(text, options().initial_indent(&first).subsequent_indent(&further)) + "\n"
}

/// Formats a row of a table: cells in columns of these widths, negative where cells are on the left. A first
/// cell that is too long has a line of its own above.
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

/// Returns the warning that other programs took the processor while something was timed; it names the figure
/// from which they took most.
pub fn busy(figures: impl Iterator<Item = (Reliability, String)>) -> Option<String> {
    let busy = figures.filter(|(figure, _)| figure.is_busy());
    let (Reliability { taken, .. }, name) =
        busy.max_by(|a, b| a.0.taken.partial_cmp(&b.0.taken).unwrap_or(Ordering::Equal))?;
    let taken = percent(taken.unwrap_or_default());
    Some(format!(
        "the machine is busy: other programs took {taken} of the time of {name}; end them and measure again."
    ))
}
