//! Draws frames as character cells. A cell shows two pixels: an upper half block in the colour of the upper
//! one, on a background in the colour of the lower one.

use super::canvas::Canvas;
use super::frame::Frame;
use super::keys;
use crossterm::style::{Color, Colors, Print, ResetColor, SetColors};
use crossterm::{cursor, queue, terminal as screen};
use std::borrow::Cow;
use std::io::{self, Write};

/// A character, and its foreground and background colours; `None` stands for the terminal's own.
type Cell = (char, Option<[u32; 2]>);

/// The terminal's present content, so that only changed cells are written.
#[derive(Default)]
pub struct CellBuffer {
    /// Row by row; empty if unknown.
    shown: Vec<Cell>,
    size: [u16; 2],
}

impl CellBuffer {
    /// Forces a full redraw.
    pub fn invalidate(&mut self) {
        self.shown.clear();
    }

    /// Draws a frame on a terminal of this size, in columns and rows.
    pub fn draw(&mut self, out: &mut impl Write, frame: &Frame, size: [u16; 2]) -> io::Result<()> {
        let [columns, rows] = size.map(usize::from);
        if columns == 0 || rows == 0 {
            return Ok(());
        }
        if self.size != size || self.shown.is_empty() {
            self.invalidate();
            queue!(out, ResetColor, screen::Clear(screen::ClearType::All))?;
        }
        let cells = cells_of(frame, columns, rows);
        // The cell of the cursor if it is known, and the colours that are set.
        let (mut cursor, mut set) = (None, None);
        for (place, &(character, colors)) in cells.iter().enumerate() {
            if self.shown.get(place) == Some(&cells[place]) {
                continue;
            }
            let [row, column] = [place / columns, place % columns];
            if cursor != Some(place) || column == 0 {
                queue!(out, cursor::MoveTo(column as u16, row as u16))?;
            }
            if set != Some(colors) {
                set = Some(colors);
                match colors.map(|colors| colors.map(color)) {
                    Some([upper, lower]) => queue!(out, SetColors(Colors::new(upper, lower)))?,
                    None => queue!(out, ResetColor)?,
                }
            }
            queue!(out, Print(character))?;
            // Characters beyond ASCII may be wider or narrower than a cell.
            cursor = (colors.is_some() || character.is_ascii()).then_some(place + 1);
        }
        queue!(out, ResetColor)?;
        (self.shown, self.size) = (cells, size);
        Ok(())
    }
}

/// Returns the cells of a terminal that shows a frame.
fn cells_of(frame: &Frame, columns: usize, rows: usize) -> Vec<Cell> {
    let mut pixels = vec![0; 2 * columns * rows];
    let mut canvas = Canvas { pixels: &mut pixels, width: columns, height: 2 * rows };
    canvas.draw_picture(frame);
    canvas.draw_minimap(frame, columns.min(2 * rows) / 3, 0);
    let pair = |place: usize| {
        let upper = place / columns * 2 * columns + place % columns;
        [pixels[upper], pixels[upper + columns]]
    };
    let mut cells: Vec<Cell> = (0..columns * rows).map(|place| ('▀', Some(pair(place)))).collect();
    for (row, line) in cells.chunks_mut(columns).zip(text_of(frame, columns, rows)) {
        row.iter_mut().zip(line.chars()).for_each(|(cell, character)| *cell = (character, None));
    }
    cells
}

fn color(pixel: u32) -> Color {
    let [_, r, g, b] = pixel.to_be_bytes();
    Color::Rgb { r, g, b }
}

/// Returns the lines of text over a frame that fit the terminal.
fn text_of(frame: &Frame, columns: usize, rows: usize) -> Vec<String> {
    let mut lines = Vec::new();
    for text in [&*frame.figures, &frame.message, if frame.help { "Ctrl-C  end" } else { "" }] {
        if !text.is_empty() {
            lines.extend(textwrap::wrap(text, columns).into_iter().map(Cow::into_owned));
        }
    }
    if frame.help {
        lines.extend(keys::help_in(columns, rows.saturating_sub(lines.len())));
    }
    lines.truncate(rows);
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_fits_the_terminal() {
        let text =
            Frame { figures: "one two three\nfour".into(), message: "five".into(), ..Frame::default() };
        assert_eq!(text_of(&text, 80, 24), ["one two three", "four", "five"]);
        assert_eq!(text_of(&text, 8, 24), ["one two", "three", "four", "five"]);
        assert_eq!(text_of(&text, 8, 2), ["one two", "three"]);
        let help = Frame { help: true, ..Frame::default() };
        assert_eq!(text_of(&help, 200, 60)[1..], keys::help().collect::<Vec<_>>());
        for (columns, rows) in [(80, 24), (200, 60), (200, 10), (40, 12), (5, 3), (1, 1)] {
            let lines = text_of(&help, columns, rows);
            assert!(lines.len() <= rows && lines.iter().all(|line| line.chars().count() <= columns));
            assert!(columns < 20 || lines[0] == "Ctrl-C  end");
        }
    }

    #[test]
    fn only_what_changes_is_written() {
        let mut cells = CellBuffer::default();
        let mut written = |frame: &Frame, size| {
            let mut out = Vec::new();
            cells.draw(&mut out, frame, size).unwrap();
            String::from_utf8(out).unwrap().chars().filter(|&letter| letter == '▀').count()
        };
        let mut frame = Frame { pixels: vec![1; 8], width: 4, height: 2, ..Frame::default() };
        assert_eq!(written(&frame, [4, 1]), 4);
        assert_eq!(written(&frame, [4, 1]), 0);
        frame.pixels[2] = 2;
        assert_eq!(written(&frame, [4, 1]), 1);
        frame.message = "two".to_string();
        assert_eq!(written(&frame, [4, 1]), 0, "text over the picture");
        frame.message.clear();
        assert_eq!(written(&frame, [4, 1]), 3, "the pixels below it");
        assert_eq!(written(&frame, [8, 2]), 16, "another size");
    }
}
