//! What a drawing of lines shows.
//!
//! For: [`Figure`], [`Panel`], [`Line`].

pub use super::axis::Axis;

/// Most lines of a panel: about as many as an eye follows.
pub const MOST_LINES: usize = 6;

/// A drawing.
#[derive(Clone, Debug, Default)]
pub struct Figure {
    pub title: String,
    /// Explanations, a paragraph each.
    pub notes: Vec<String>,
    pub x: Axis,
    pub y: Axis,
    pub panels: Vec<Panel>,
}

/// A plane with lines.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    pub title: String,
    pub lines: Vec<Line>,
}

/// What distinguishes a line from others.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Look {
    /// With a colour and a mark of its own.
    #[default]
    Plain,
    /// Thick, its name bold.
    Default,
    /// Grey: something else is better everywhere.
    Behind,
    /// A colour, and dashes: outside the comparison.
    Dashed,
    /// A broad pale line behind the others, without marks.
    Front,
}

/// A polyline.
#[derive(Clone, Debug, Default)]
pub struct Line {
    pub name: String,
    /// A figure after its name, such as a ratio; may be empty.
    pub figure: String,
    pub look: Look,
    pub points: Vec<[f64; 2]>,
    /// x, and the lower and upper end in y; none or one a point.
    pub band: Vec<[f64; 3]>,
}

impl Line {
    /// The words at its end.
    pub(super) fn label(&self) -> String {
        let space = if self.figure.is_empty() { "" } else { " " };
        format!("{}{space}{}", self.name, self.figure)
    }
}

impl Panel {
    /// Panels of all lines, as equally full as possible; each begins with the lines of `shared`.
    pub fn split(title: &str, shared: &[Line], lines: Vec<Line>) -> Vec<Self> {
        let count = lines.len().div_ceil(MOST_LINES - shared.len()).max(1);
        let each = lines.len().div_ceil(count).max(1);
        let panel = |(number, lines): (usize, &[Line])| Self {
            title: match count {
                1 => title.to_owned(),
                _ => format!("{title} ({} of {count})", number + 1).trim_start().to_owned(),
            },
            lines: shared.iter().chain(lines).cloned().collect(),
        };
        if lines.is_empty() {
            return vec![panel((0, &[]))];
        }
        lines.chunks(each).enumerate().map(panel).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn more_lines_than_an_eye_follows_go_to_further_panels() {
        let line = |name: &str| Line { name: name.into(), ..Line::default() };
        let lines = |count: usize| (0..count).map(|number| line(&number.to_string())).collect();
        let shared = [line("front"), line("default")];
        for (count, panels) in [(0, 1), (4, 1), (5, 2), (8, 2), (9, 3)] {
            let split = Panel::split("group", &shared, lines(count));
            assert_eq!(split.len(), panels, "{count}");
            let mut names = Vec::new();
            for panel in &split {
                assert!(panel.lines.len() <= MOST_LINES && panel.lines[1].name == "default");
                names.extend(panel.lines[2..].iter().map(|line| line.name.clone()));
            }
            assert_eq!(names, (0..count).map(|number| number.to_string()).collect::<Vec<_>>());
        }
        assert_eq!(Panel::split("group", &shared, lines(5))[1].title, "group (2 of 2)");
    }
}
