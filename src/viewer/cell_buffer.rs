//! Draws frames as character cells: the upper half block in the colour of the upper pixel, on the colour of
//! the lower one.
//!
//! For: [`CellBuffer`].

use super::frame::Frame;
use super::keys;
use super::layout::{fit, wrap};
use crossterm::style::{Color, Colors, Print, ResetColor, SetColors};
use crossterm::{cursor, queue, terminal as screen};
use std::io::{self, Write};

/// The terminal's present content: only changed cells are written.
#[derive(Default)]
pub struct CellBuffer {
    /// Upper and lower pixel of each cell, row by row.
    shown: Vec<[u32; 2]>,
    size: [u16; 2],
    /// Lines of text over the picture.
    lines: Vec<String>,
    /// The frame at the terminal's size.
    pixels: Vec<u32>,
}

/// Marks cells whose content must be written again.
const STALE: [u32; 2] = [u32::MAX; 2];

impl CellBuffer {
    /// Forces a full redraw.
    pub fn invalidate(&mut self) {
        self.shown.clear();
    }

    pub fn draw(&mut self, out: &mut impl Write, frame: &Frame, size: [u16; 2]) -> io::Result<()> {
        let [columns, rows] = size.map(usize::from);
        if columns == 0 || rows == 0 {
            return Ok(());
        }
        if self.size != size || self.shown.len() != columns * rows {
            self.size = size;
            self.shown.clear();
            self.shown.resize(columns * rows, STALE);
            self.lines.clear();
            queue!(out, ResetColor, screen::Clear(screen::ClearType::All))?;
        }
        self.downsample(frame, [columns as u32, 2 * rows as u32]);
        let lines = text_of(frame, columns, rows);
        // Cells that text no longer covers are written again.
        for (row, line) in self.lines.iter().enumerate().take(rows) {
            let kept = lines.get(row).map_or(0, |line| line.chars().count());
            let gone = line.chars().count().min(columns);
            self.shown[row * columns..][kept.min(gone)..gone].fill(STALE);
        }
        let mut colors = None;
        for row in 0..rows {
            let covered = lines.get(row).map_or(0, |line| line.chars().count().min(columns));
            let mut at = None;
            for column in covered..columns {
                let cell = [2 * row, 2 * row + 1].map(|y| self.pixels[y * columns + column]);
                let place = row * columns + column;
                if self.shown[place] == cell {
                    continue;
                }
                self.shown[place] = cell;
                if at != Some(column) {
                    queue!(out, cursor::MoveTo(column as u16, row as u16))?;
                }
                if colors != Some(cell) {
                    colors = Some(cell);
                    let [upper, lower] = cell.map(color);
                    queue!(out, SetColors(Colors::new(upper, lower)))?;
                }
                queue!(out, Print('▀'))?;
                at = Some(column + 1);
            }
        }
        for (row, line) in lines.iter().enumerate() {
            if self.lines.get(row) != Some(line) || self.shown[row * columns] != STALE {
                queue!(out, ResetColor, cursor::MoveTo(0, row as u16), Print(line))?;
                let covered = line.chars().count().min(columns);
                self.shown[row * columns..][..covered].fill(STALE);
            }
        }
        queue!(out, ResetColor)?;
        self.lines = lines;
        Ok(())
    }

    /// Resamples the frame to the terminal's size by box averages, with the minimap in its corner and black
    /// around.
    fn downsample(&mut self, frame: &Frame, [width, height]: [u32; 2]) {
        self.pixels.clear();
        self.pixels.resize((width * height) as usize, 0);
        let [left, top, across, down] = fit([frame.width, frame.height], [width, height]);
        let inset = if frame.inset.is_empty() { 0 } else { (width.min(height) / 3).min(frame.inset_side) };
        for y in 0..down {
            for x in 0..across {
                let mean = mean(&frame.pixels, [frame.width, frame.height], [x, y], [across, down]);
                self.pixels[((top + y) * width + left + x) as usize] = mean;
            }
        }
        for y in 0..inset {
            for x in 0..inset {
                let side = frame.inset_side;
                let mean = mean(&frame.inset, [side, side], [x, y], [inset, inset]);
                self.pixels[(y * width + width - inset + x) as usize] = mean;
            }
        }
    }
}

/// The average of the source pixels under target pixel (x, y), at least of one.
fn mean(pixels: &[u32], [width, height]: [u32; 2], [x, y]: [u32; 2], [across, down]: [u32; 2]) -> u32 {
    let span = |at: u32, of: u32, all: u32| {
        let from = (u64::from(at) * u64::from(all) / u64::from(of)) as u32;
        let to = (u64::from(at + 1) * u64::from(all) / u64::from(of)) as u32;
        from..to.max(from + 1)
    };
    let (mut sums, mut count) = ([0u32; 3], 0);
    for y in span(y, down, height) {
        for x in span(x, across, width) {
            let [_, r, g, b] = pixels[(y * width + x) as usize].to_be_bytes();
            sums = [sums[0] + u32::from(r), sums[1] + u32::from(g), sums[2] + u32::from(b)];
            count += 1;
        }
    }
    let [r, g, b] = sums.map(|sum| (sum + count / 2) / count);
    r << 16 | g << 8 | b
}

fn color(pixel: u32) -> Color {
    let [_, r, g, b] = pixel.to_be_bytes();
    Color::Rgb { r, g, b }
}

/// The lines of text over a frame that fit the terminal.
fn text_of(frame: &Frame, columns: usize, rows: usize) -> Vec<String> {
    let text = frame.figures.lines().chain(frame.message.lines());
    let mut lines: Vec<String> = text.flat_map(|line| wrap(line, columns)).map(String::from).collect();
    if frame.help {
        lines.push("Ctrl-C  end".to_string());
        lines.extend(keys::help_in(columns, rows.saturating_sub(lines.len())));
    }
    lines.truncate(rows);
    lines.iter().map(|line| line.chars().take(columns).collect()).collect()
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
        let last = keys::BINDINGS.last().expect("there are some");
        assert!(text_of(&help, 80, 24).iter().any(|line| line.contains(last.meaning)), "all of it");
    }
}
