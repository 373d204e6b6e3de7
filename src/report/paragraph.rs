//! Text in lines that a terminal of ordinary width shows whole.
//!
//! For: [`paragraph`], [`item`]. May import: `textwrap`. Must not know: what the text says.

use textwrap::Options;

/// Columns of a line, those that help texts have.
const WIDTH: usize = 100;

/// Sentences in lines of up to `WIDTH` columns, the last one ended too.
pub fn paragraph(text: &str) -> String {
    textwrap::fill(text, WIDTH) + "\n"
}

/// A name in a column of `name_width`, and what is said of it, in further lines below itself.
pub fn item(name: &str, name_width: usize, text: &str) -> String {
    let (first, further) = (format!("{name:<name_width$} "), " ".repeat(name_width + 1));
    let options = Options::new(WIDTH).initial_indent(&first).subsequent_indent(&further);
    // Words longer than a line, such as paths, stay whole: they are there to be copied.
    textwrap::fill(text, options.break_words(false)) + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn item_indents_further_lines_and_keeps_long_words() {
        let path = "x".repeat(120);
        assert_eq!(item("file", 6, &path), format!("file   {path}\n"));
        let two = item("why", 6, &"word ".repeat(25));
        assert_eq!(two.lines().count(), 2);
        assert!(
            two.lines().all(|line| line.chars().count() <= WIDTH && line[7..].starts_with("word")),
            "{two}"
        );
        assert!(two.lines().nth(1).unwrap().starts_with("       word"), "{two}");
    }
}
