//! A drawing of a chart: lines or dots, with a name for its file.
//!
//! For: [`Drawing`], [`file_name`].

use super::dots::DotTable;
use super::figure::Figure;

/// A drawing, and its file name without an extension.
#[derive(Clone, Debug)]
pub struct Drawing {
    /// Without folder and extension.
    pub name: String,
    pub kind: Kind,
}

/// The form of a drawing.
#[derive(Clone, Debug)]
pub enum Kind {
    /// Curves in planes with common axes.
    Lines(Figure),
    /// A row a thing, a column a measure.
    Dots(DotTable),
}

impl Drawing {
    /// The text of an SVG file.
    pub fn svg(&self) -> String {
        match &self.kind {
            Kind::Lines(figure) => figure.svg(),
            Kind::Dots(table) => table.svg(),
        }
    }
}

/// A scene's name as part of a file name: letters and digits, and hyphens for all else.
pub fn file_name(scene: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() { c.to_ascii_lowercase() } else { '-' };
    let name: String = scene.strip_prefix("builtin:").unwrap_or(scene).chars().map(plain).collect();
    let words: Vec<&str> = name.split('-').filter(|word| !word.is_empty()).collect();
    words.join("-")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_hold_only_letters_digits_and_hyphens() {
        assert_eq!(file_name("builtin:cornell-spheres"), "cornell-spheres");
        assert_eq!(file_name("../My scenes/Kitchen 2.json"), "my-scenes-kitchen-2-json");
        assert_eq!(file_name("builtin:terrain:2000"), "terrain-2000");
    }
}
