//! Where the parts of a figure stand: its panels with shared axes, its text, its direct labels.
//!
//! For: `Layout`.
//!
//! From top to bottom: title, notes, the name of the y axis, panels in one or two columns, the name of the x
//! axis. An odd number of panels leaves a place free, where the notes stand then. Names of lines stand in a
//! column to the right of each panel, beside the ends of their lines.

use super::axis::Range;
use super::canvas::{Align, Ink, Mark, Text};
use super::figure::{Figure, Line, Look, Panel};
use super::labels::{bold_width, spread, width, wrap};

/// Width of every drawing. It is shown at half of it, about the width of a page of text.
pub(super) const WIDTH: i32 = 1_600;
pub(super) const MARGIN: i32 = 24;
const TITLE: i32 = 34;
pub(super) const TEXT: i32 = 25;
/// From one line of text to the next.
pub(super) const LINE: i32 = 32;
/// Height of the plane of a panel alone, and of one of several.
const HEIGHTS: [i32; 2] = [560, 400];
/// Most letters of a line of a label, likewise.
const LETTERS: [usize; 2] = [26, 16];
/// Between the plane and its labels: the leader, and the sample of the line.
const LEADER: i32 = 26;
const SAMPLE: i32 = 26;

/// All parts of a figure in their places.
pub(super) struct Layout {
    pub size: [i32; 2],
    pub texts: Vec<Text>,
    pub panels: Vec<Placed>,
}

/// A panel in its place.
pub(super) struct Placed {
    pub x: Range,
    pub y: Range,
    /// Left, top, right and bottom edge of the plane.
    pub edges: [i32; 4],
    pub lines: Vec<PlacedLine>,
}

/// A line of a panel, by its index, and its label.
pub(super) struct PlacedLine {
    pub line: usize,
    pub ink: Ink,
    pub mark: Mark,
    /// The middle of the label's height, to which the leader goes.
    pub label: i32,
}

impl Layout {
    pub fn of(figure: &Figure) -> Self {
        let several = figure.panels.len() > 1;
        let columns = if several { 2 } else { 1 };
        let mut layout = Self { size: [WIDTH, 0], texts: Vec::new(), panels: Vec::new() };
        let notes_aside = several && figure.panels.len() % 2 == 1;
        let mut y = header(&mut layout.texts, &figure.title, if notes_aside { &[] } else { &figure.notes });
        y += LINE / 2;
        layout.texts.push(Text { bold: true, ..line_at([MARGIN, y], figure.y.name()) });
        y += LINE;

        let numbers = |axis: usize| -> Vec<f64> {
            let lines = || figure.panels.iter().flat_map(|panel| &panel.lines);
            let points = lines().flat_map(|line| line.points.iter().map(|point| point[axis]));
            let bands = lines().flat_map(|line| line.band.iter().flat_map(|band| [band[1], band[2]]));
            points.chain(bands.filter(|_| axis == 1)).collect()
        };
        let (of_x, of_y) = (numbers(0), numbers(1));
        let ticks = Range::of(&figure.y, &of_y, [0, 1]);
        let wide = |text: String| width(&text, TEXT);
        let left = MARGIN + 14 + ticks.ticks.iter().map(|&tick| wide(ticks.label(tick))).max().unwrap_or(0);
        let letters = LETTERS[usize::from(several)];
        let labels = figure.panels.iter().flat_map(|panel| &panel.lines);
        let widest = labels.filter_map(|line| line.label_width(letters)).max();
        let labels = LEADER + SAMPLE + widest.unwrap_or(0);
        let column = (WIDTH - MARGIN - left) / columns as i32;
        let plane = [column - labels - if several { LINE } else { 0 }, HEIGHTS[usize::from(several)]];
        let titled = figure.panels.iter().any(|panel| !panel.title.is_empty());
        let row = plane[1] + LINE + if titled { 2 * LINE } else { 0 };

        let rows = figure.panels.len().div_ceil(columns);
        for (number, panel) in figure.panels.iter().enumerate() {
            let corner = [left + column * (number % columns) as i32, y + row * (number / columns) as i32];
            let corner = [corner[0], corner[1] + if titled { LINE } else { 0 }];
            if titled {
                let at = [corner[0], corner[1] - LINE * 3 / 4];
                layout.texts.push(Text { bold: true, ..line_at(at, panel.title.clone()) });
            }
            let [right, bottom] = [corner[0] + plane[0], corner[1] + plane[1]];
            let placed = Placed {
                x: Range::of(&figure.x, &of_x, [corner[0], right]),
                y: Range::of(&figure.y, &of_y, [bottom, corner[1]]),
                edges: [corner[0], corner[1], right, bottom],
                lines: Vec::new(),
            };
            let (first, last) = (number % columns == 0, number + columns >= figure.panels.len());
            placed.ticks(first, last, &mut layout.texts);
            layout.panels.push(placed.labelled(panel, letters, &mut layout.texts));
        }
        if notes_aside {
            let from = [left + column, y + row * (rows as i32 - 1) + 4 * LINE];
            let letters = letters_in(column - LINE);
            remarks(&mut layout.texts, from, &figure.notes, letters);
        }
        let bottom = layout.panels.last().map_or(y, |last| last.edges[3]);
        layout.texts.push(Text { bold: true, ..line_at([left, bottom + 2 * LINE + 8], figure.x.name()) });
        layout.size[1] = bottom + 3 * LINE + 8;
        layout
    }
}

impl Placed {
    fn ticks(&self, left_labels: bool, lower_labels: bool, texts: &mut Vec<Text>) {
        let [left, _, _, bottom] = self.edges;
        let ticks = |range: &Range| {
            range.ticks.iter().map(|&tick| (range.unit(tick), range.label(tick))).collect::<Vec<_>>()
        };
        for (x, label) in ticks(&self.x).into_iter().filter(|_| lower_labels) {
            texts.push(Text { align: Align::Middle, ..line_at([x, bottom + 22], label) });
        }
        for (y, label) in ticks(&self.y).into_iter().filter(|_| left_labels) {
            texts.push(Text { align: Align::Right, ..line_at([left - 12, y], label) });
        }
    }

    /// With the lines that have points, in the order in which they are drawn, and their labels.
    fn labelled(mut self, panel: &Panel, letters: usize, texts: &mut Vec<Text>) -> Self {
        let [_, top, right, bottom] = self.edges;
        let with_points = |line: &&(usize, &Line)| !line.1.points.is_empty();
        let lines: Vec<(usize, &Line)> =
            panel.lines.iter().enumerate().filter(|line| with_points(&line)).collect();
        let words: Vec<Vec<String>> = lines.iter().map(|(_, line)| wrap(&line.label(), letters)).collect();
        let heights: Vec<f64> = words.iter().map(|words| f64::from(LINE * words.len() as i32)).collect();
        let end = |line: &Line| line.points.last().map_or((0, 0), |&[x, y]| (self.x.at(x), self.y.at(y)));
        // Of lines that end at the same height, the label of the one that ends further right stands higher: a
        // slower line lies further up.
        let wanted: Vec<f64> = lines
            .iter()
            .map(|(_, line)| end(line))
            .map(|(x, y)| f64::from(y) - 1e-3 * f64::from(x))
            .collect();
        let middles = spread(&wanted, &heights, f64::from(top) - 20.0, f64::from(bottom) + 20.0);
        let mut others = 0;
        for ((&(number, line), words), middle) in lines.iter().zip(words).zip(middles) {
            let label = middle.round() as i32;
            let (ink, mark) = match line.look {
                Look::Default => (Ink::Default, Mark::Dot),
                Look::Front => (Ink::Front, Mark::Dot),
                Look::Plain | Look::Behind | Look::Dashed => {
                    others += 1;
                    let color = if line.look == Look::Behind { Ink::Behind } else { Ink::Line(others - 1) };
                    (color, Mark::ALL[(others - 1) % Mark::ALL.len()])
                }
            };
            let first = label - LINE * (words.len() as i32 - 1) / 2;
            for (index, words) in words.into_iter().enumerate() {
                let at = [right + LEADER + SAMPLE, first + LINE * index as i32];
                let ink =
                    if matches!(line.look, Look::Front | Look::Behind) { Ink::Remark } else { Ink::Text };
                texts.push(Text { ink, bold: line.look == Look::Default, ..line_at(at, words) });
            }
            self.lines.push(PlacedLine { line: number, ink, mark, label });
        }
        // The thick ones first, so that thinner ones of equal values lie on them.
        self.lines.sort_by_key(|placed| match panel.lines[placed.line].look {
            Look::Front => 0,
            Look::Default => 1,
            Look::Behind => 2,
            Look::Plain | Look::Dashed => 3,
        });
        self
    }
}

impl Line {
    fn label_width(&self, letters: usize) -> Option<i32> {
        let wide = if self.look == Look::Default { bold_width } else { width };
        wrap(&self.label(), letters).iter().map(|words| wide(words, TEXT)).max()
    }
}

fn line_at(at: [i32; 2], words: String) -> Text {
    Text { at, words, size: TEXT, ..Text::default() }
}

/// Letters of text that fit.
fn letters_in(wide: i32) -> usize {
    (wide / width("m", TEXT).max(1)) as usize
}

/// Adds title and notes, and returns the end of their height.
pub(super) fn header(texts: &mut Vec<Text>, title: &str, notes: &[String]) -> i32 {
    let mut y = MARGIN + TITLE / 2;
    let letters = (WIDTH - 2 * MARGIN) / bold_width("m", TITLE);
    for words in wrap(title, letters as usize) {
        texts.push(Text { size: TITLE, bold: true, ..line_at([MARGIN, y], words) });
        y += TITLE * 5 / 4;
    }
    remarks(texts, [MARGIN, y], notes, letters_in(WIDTH - 2 * MARGIN))
}

/// Adds paragraphs from a place on, and returns the end of their height.
fn remarks(texts: &mut Vec<Text>, [x, mut y]: [i32; 2], notes: &[String], letters: usize) -> i32 {
    for words in notes.iter().flat_map(|note| wrap(note, letters)) {
        texts.push(Text { ink: Ink::Remark, ..line_at([x, y], words) });
        y += LINE;
    }
    y
}

/// Pairs of texts that overlap, and texts outside the drawing: for tests.
#[cfg(test)]
pub(super) fn collisions(size: [i32; 2], texts: &[Text]) -> Vec<String> {
    let mut found = Vec::new();
    for (number, text) in texts.iter().enumerate() {
        let [left, top, right, bottom] = text.edges();
        if left < 0 || top < 0 || right > size[0] || bottom > size[1] {
            found.push(format!("outside: {text:?}"));
        }
        for other in &texts[..number] {
            let edges = other.edges();
            if left < edges[2] && edges[0] < right && top < edges[3] && edges[1] < bottom {
                found.push(format!("{:?} over {:?}", text.words, other.words));
            }
        }
    }
    found
}
