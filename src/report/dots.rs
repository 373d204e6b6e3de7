//! A table of dots: a row for each thing, a column with an axis of its own for each measure (W. Cleveland's
//! dot plot), drawn as SVG.

use super::drawing::{LETTER, LINE, MARGIN, WIDTH, marks, stroke, svg, text};
use super::scale::Scale;

/// A drawing.
#[derive(Clone, Debug, Default)]
pub struct DotTable {
    pub title: String,
    /// Explanations, a paragraph each.
    pub notes: Vec<String>,
    /// Names, and which is the default.
    pub rows: Vec<(String, bool)>,
    pub columns: Vec<Column>,
}

/// A measure: its name, its unit below it, and a value for each row, with its text.
#[derive(Clone, Debug, Default)]
pub struct Column {
    pub name: String,
    pub unit: String,
    /// Otherwise its axis begins at 0.
    pub log: bool,
    pub values: Vec<Option<(f64, String)>>,
}

const ROW: i32 = 52;
/// Between columns.
const GAP: i32 = 40;
/// Distance from a dot's middle to its text, and from an axis to the dot at its lower end.
const ASIDE: i32 = 20;
const TICKS: usize = 3;

impl DotTable {
    /// Returns the drawing as the text of an SVG file.
    pub fn svg(&self) -> String {
        svg(&self.title, &self.notes, |top, parts| {
            let class = |default: bool| if default { "strong words" } else { "words" };
            let first = top + 3 * LINE;
            let bottom = first + ROW * self.rows.len() as i32;
            let middle = |row: usize| first + ROW * row as i32 + ROW / 2;
            let names =
                self.rows.iter().map(|(name, _)| LETTER * name.chars().count() as i32).max().unwrap_or(0);
            let begin = MARGIN + names + GAP;
            let wide = (WIDTH - MARGIN - begin + GAP) / self.columns.len().max(1) as i32 - GAP;
            for (row, (name, default)) in self.rows.iter().enumerate() {
                parts.push(text([MARGIN, middle(row)], "start", class(*default), name));
            }
            for (number, column) in self.columns.iter().enumerate() {
                let left = begin + (wide + GAP) * number as i32;
                parts.push(text([left, top + LINE], "start", "strong words", &column.name));
                parts.push(text([left, top + 2 * LINE], "start", "remark", &column.unit));
                let values = column.values.iter().enumerate();
                let values: Vec<_> = values
                    .filter_map(|(row, value)| value.as_ref().map(|(value, text)| (row, *value, text)))
                    .collect();
                let numbers: Vec<f64> = values.iter().map(|(_, value, _)| *value).collect();
                let ends = [left + ASIDE, left + wide - ASIDE];
                let scale = if column.log { Scale::log } else { Scale::from_zero }(&numbers, TICKS, ends);
                for (at, label) in scale.ticks() {
                    parts.push(stroke("grid", 2, &[[at, first], [at, bottom]]));
                    parts.push(text([at, bottom + LINE * 3 / 4], "middle", "words", &label));
                }
                parts.push(stroke("remark", 2, &[[left, bottom], [left + wide, bottom]]));
                for (row, value, words) in values {
                    let (at, default) = ([scale.at(value), middle(row)], self.rows[row].1);
                    parts.push(marks(if default { "main" } else { "remark" }, 0, &[at]));
                    // The text goes to the side with more room.
                    let (aside, anchor) =
                        if at[0] < left + wide / 2 { (ASIDE, "start") } else { (-ASIDE, "end") };
                    parts.push(text([at[0] + aside, at[1]], anchor, class(default), words));
                }
            }
            bottom + 2 * LINE
        })
    }
}
