//! A table of dots: a row for each thing, a column with an axis of its own for each measure (W. Cleveland's
//! dot plot), drawn as SVG.
//!
//! For: [`DotTable`].

use super::axis::{Axis, Range};
use super::canvas::{Align, Canvas, DrawResult, Ink, Mark, Text, svg};
use super::labels::bold_width;
use super::layout::{LINE, MARGIN, TEXT, WIDTH, header};

/// A drawing.
#[derive(Clone, Debug, Default)]
pub struct DotTable {
    pub title: String,
    /// Explanations, a paragraph each.
    pub notes: Vec<String>,
    pub rows: Vec<Row>,
    pub columns: Vec<Column>,
}

/// A row's name.
#[derive(Clone, Debug, Default)]
pub struct Row {
    pub name: String,
    pub default: bool,
}

/// A measure: its name, its unit below it, and a value for each row, with its text.
#[derive(Clone, Debug, Default)]
pub struct Column {
    pub name: String,
    pub unit: String,
    pub log: bool,
    pub values: Vec<Option<(f64, String)>>,
}

const ROW: i32 = 52;
/// Between columns.
const GAP: i32 = 40;
const RADIUS: i32 = 10;

/// The dots and texts in their places.
struct Layout {
    size: [i32; 2],
    texts: Vec<Text>,
    /// Left and right end of each column.
    columns: Vec<[i32; 2]>,
    /// Top and bottom edge of the rows.
    rows: [i32; 2],
    /// Each dot's place, and whether it is the default's.
    dots: Vec<([i32; 2], bool)>,
}

impl DotTable {
    /// The drawing as the text of an SVG file, without a fixed size on the page.
    pub fn svg(&self) -> String {
        let layout = self.layout();
        svg(&self.title, layout.size, |canvas| layout.draw(canvas))
    }

    fn layout(&self) -> Layout {
        let mut texts = Vec::new();
        let top = header(&mut texts, &self.title, &self.notes) + LINE / 2;
        let name =
            |row: &Row| Text { words: row.name.clone(), size: TEXT, bold: row.default, ..Text::default() };
        let names = self.rows.iter().map(|row| bold_width(&row.name, TEXT)).max().unwrap_or(0);
        let left = MARGIN + names + GAP;
        let wide = (WIDTH - MARGIN - left + GAP) / self.columns.len().max(1) as i32 - GAP;
        let rows = [top + 2 * LINE + 8, top + 2 * LINE + 8 + ROW * self.rows.len() as i32];
        let middle = |row: usize| rows[0] + ROW * row as i32 + ROW / 2;
        for (number, row) in self.rows.iter().enumerate() {
            texts.push(Text { at: [MARGIN, middle(number)], ..name(row) });
        }
        let mut layout =
            Layout { size: [WIDTH, rows[1] + MARGIN], texts, columns: Vec::new(), rows, dots: Vec::new() };
        for (number, column) in self.columns.iter().enumerate() {
            let ends = [0, wide].map(|x| left + (wide + GAP) * number as i32 + x);
            layout.columns.push(ends);
            let heading = |y, words: &String, ink, bold| {
                let (at, words) = ([ends[0], y], words.clone());
                Text { at, words, size: TEXT, ink, bold, ..Text::default() }
            };
            layout.texts.push(heading(top + LINE / 2, &column.name, Ink::Text, true));
            layout.texts.push(heading(top + LINE * 3 / 2, &column.unit, Ink::Remark, false));
            let values: Vec<f64> = column.values.iter().flatten().map(|(value, _)| *value).collect();
            let axis = Axis { label: String::new(), log: column.log };
            // The texts stand to the right of the dots.
            let text =
                column.values.iter().flatten().map(|(_, text)| bold_width(text, TEXT)).max().unwrap_or(0);
            let range = Range::of(
                &axis,
                &values,
                [ends[0] + RADIUS, (ends[1] - text - 2 * RADIUS).max(ends[0] + RADIUS)],
            );
            for (row, (value, text)) in
                column.values.iter().enumerate().filter_map(|(row, one)| Some((row, one.as_ref()?)))
            {
                let at = [range.at(*value), middle(row)];
                let default = self.rows.get(row).is_some_and(|row| row.default);
                layout.dots.push((at, default));
                let place = [at[0] + 2 * RADIUS, at[1]];
                let text =
                    Text { at: place, words: text.clone(), size: TEXT, bold: default, ..Text::default() };
                layout.texts.push(Text { align: Align::Left, ..text });
            }
        }
        layout
    }
}

impl Layout {
    fn draw(&self, canvas: &Canvas) -> DrawResult {
        for &[left, right] in &self.columns {
            for y in (self.rows[0]..=self.rows[1]).step_by(ROW as usize) {
                canvas.path(&[[left, y], [right, y]], Ink::Grid, 2, false)?;
            }
            canvas.path(&[[left, self.rows[0]], [left, self.rows[1]]], Ink::Behind, 2, false)?;
        }
        for &(at, default) in &self.dots {
            canvas.mark(at, Mark::Dot, if default { Ink::Default } else { Ink::Behind }, RADIUS)?;
        }
        self.texts.iter().try_for_each(|text| canvas.text(text))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::layout::collisions;

    fn table() -> DotTable {
        let column = |log, values: [f64; 4]| Column {
            name: "failures".into(),
            unit: "share of cases".into(),
            log,
            values: values.iter().map(|&value| Some((value, format!("{value:.3} %")))).collect(),
        };
        DotTable {
            title: "methods".into(),
            notes: vec!["a note".into()],
            rows: ["moller-trumbore-epsilon", "b", "c", "d"]
                .map(|name| Row { name: name.into(), default: name == "b" })
                .to_vec(),
            columns: vec![
                column(false, [0.5, 1.0, 1.1, 9.0]),
                column(true, [0.0, 1e-6, 1.0, 100.0]),
                column(true, [3.0; 4]),
                column(false, [0.0; 4]),
            ],
        }
    }

    #[test]
    fn no_text_covers_another_or_a_dot_or_leaves_the_drawing() {
        let layout = table().layout();
        assert_eq!(collisions(layout.size, &layout.texts), Vec::<String>::new());
        assert_eq!(layout.dots.len(), 16);
        for ([x, y], _) in &layout.dots {
            for text in &layout.texts {
                let [left, top, right, bottom] = text.edges();
                let near = |at: i32, low, high| at + RADIUS > low && at - RADIUS < high;
                assert!(!(near(*x, left, right) && near(*y, top, bottom)), "{:?} over a dot", text.words);
            }
        }
    }

    #[test]
    fn larger_values_stand_further_right_and_absent_ones_nowhere() {
        let mut table = table();
        let places = |table: &DotTable| table.layout().dots.iter().map(|([x, _], _)| *x).collect::<Vec<_>>();
        let all = places(&table);
        assert!(all[..4].is_sorted_by(|a, b| a < b) && all[4..8].is_sorted_by(|a, b| a < b), "{all:?}");
        table.columns[0].values[1] = None;
        assert_eq!(places(&table).len(), 15);
        assert!(DotTable::default().svg().ends_with("</svg>\n"));
    }
}
