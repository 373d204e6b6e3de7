//! Draws a frame into a window's pixels: enlarged, with the minimap and text over it.
//!
//! For: [`Canvas`].

use super::frame::Frame;
use super::keys;
use super::layout::{fit, wrap};
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::iso_8859_1::{FONT_7X13, FONT_10X20};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::{Rgb888, RgbColor};
use embedded_graphics::prelude::{Drawable, Pixel};
use embedded_graphics::text::{Baseline, Text};
use std::convert::Infallible;

/// Pixels around blocks of text.
const PADDING: u32 = 6;

/// The pixels of a window, 0x00RRGGBB, row by row from the top.
pub struct Canvas<'a> {
    pub pixels: &'a mut [u32],
    pub width: u32,
    pub height: u32,
}

impl Canvas<'_> {
    /// Draws a frame. `columns` is working memory.
    pub fn draw_frame(&mut self, frame: &Frame, columns: &mut Vec<u32>) {
        self.enlarge(frame, columns);
        self.draw_inset(&frame.inset, frame.inset_side);
        let large = self.width >= 1_500;
        let below = self.draw_text(&frame.figures, 0, large, Rgb888::WHITE);
        let below = self.draw_text(&frame.message, below, large, Rgb888::YELLOW);
        if frame.help {
            let [columns, lines] = self.text_capacity(below, large);
            self.draw_text(&keys::help_in(columns, lines).join("\n"), below, large, Rgb888::WHITE);
        }
    }

    /// Scales the frame to the window by nearest neighbour; black around it.
    fn enlarge(&mut self, frame: &Frame, columns: &mut Vec<u32>) {
        let [left, top, width, height] = fit([frame.width, frame.height], [self.width, self.height]);
        if width == 0 {
            return self.pixels.fill(0);
        }
        columns.clear();
        columns.extend((0..width).map(|x| (u64::from(x) * u64::from(frame.width) / u64::from(width)) as u32));
        let row = self.width as usize;
        self.pixels[..top as usize * row].fill(0);
        self.pixels[(top + height) as usize * row..].fill(0);
        let mut last = None;
        for y in 0..height {
            let source = (u64::from(y) * u64::from(frame.height) / u64::from(height)) as usize;
            let start = (top + y) as usize * row;
            if last == Some(source) {
                // Same source row as the row above.
                self.pixels.copy_within(start - row..start, start);
                continue;
            }
            last = Some(source);
            let source = &frame.pixels[source * frame.width as usize..][..frame.width as usize];
            let target = &mut self.pixels[start..start + row];
            target[..left as usize].fill(0);
            target[(left + width) as usize..].fill(0);
            let shown = target[left as usize..].iter_mut().zip(columns.iter());
            shown.for_each(|(pixel, &column)| *pixel = source[column as usize]);
        }
    }

    /// Draws the square inset in the upper right corner.
    fn draw_inset(&mut self, inset: &[u32], side: u32) {
        if inset.is_empty() || side == 0 {
            return;
        }
        let left = self.width.saturating_sub(side + PADDING);
        for (y, row) in inset.chunks(side as usize).enumerate().take(self.height as usize) {
            for (x, &pixel) in row.iter().enumerate() {
                let [x, y] = [left + x as u32, PADDING + y as u32];
                if x < self.width && y < self.height {
                    self.pixels[(y * self.width + x) as usize] = pixel;
                }
            }
        }
    }

    /// Characters per line, and lines below `top` pixels, that fit the window.
    fn text_capacity(&self, top: u32, large: bool) -> [usize; 2] {
        let (_, [across, line]) = font(large);
        let columns = self.width.saturating_sub(2 * PADDING) / across;
        let lines = self.height.saturating_sub(top + PADDING) / line;
        [columns.max(1) as usize, lines as usize]
    }

    /// Draws lines of text on a darkened background from `top` on; returns where the next text may start.
    fn draw_text(&mut self, text: &str, top: u32, large: bool, color: Rgb888) -> u32 {
        if text.is_empty() {
            return top;
        }
        let (font, [across, line]) = font(large);
        let [room, _] = self.text_capacity(top, large);
        let lines = || text.lines().flat_map(|line| wrap(line, room));
        let widest = lines().map(|line| line.chars().count() as u32).max().unwrap_or(0);
        let width = (widest * across + 2 * PADDING).min(self.width);
        let height = (lines().count() as u32 * line + PADDING).min(self.height.saturating_sub(top));
        for y in top..top + height {
            let start = (y * self.width) as usize;
            // Darkens to a quarter.
            let row = &mut self.pixels[start..start + width as usize];
            row.iter_mut().for_each(|pixel| *pixel = (*pixel >> 2) & 0x3f3f3f);
        }
        let style = MonoTextStyle::new(font, color);
        let mut y = top + PADDING / 2;
        for words in lines() {
            let at = Point::new(PADDING as i32, y as i32);
            let Ok(_) = Text::with_baseline(words, at, style, Baseline::Top).draw(self);
            y += line;
        }
        top + height
    }
}

/// The font, and the pixels of a character's width and a line's height.
fn font(large: bool) -> (&'static MonoFont<'static>, [u32; 2]) {
    let font = if large { &FONT_10X20 } else { &FONT_7X13 };
    (font, [font.character_size.width, font.character_size.height + 1])
}

impl OriginDimensions for Canvas<'_> {
    fn size(&self) -> Size {
        Size::new(self.width, self.height)
    }
}

impl DrawTarget for Canvas<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        let (width, height) = (self.width as i32, self.height as i32);
        for Pixel(Point { x, y }, color) in pixels {
            if (0..width).contains(&x) && (0..height).contains(&y) {
                let word = u32::from(color.r()) << 16 | u32::from(color.g()) << 8 | u32::from(color.b());
                self.pixels[(y * width + x) as usize] = word;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Frame {
        Frame { pixels: vec![1, 2, 3, 4, 5, 6], width: 3, height: 2, ..Frame::default() }
    }
    fn shown(frame: &Frame, width: u32, height: u32) -> Vec<u32> {
        let mut pixels = vec![9; (width * height) as usize];
        Canvas { pixels: &mut pixels, width, height }.draw_frame(frame, &mut Vec::new());
        pixels
    }

    #[test]
    fn pixels_are_enlarged_whole() {
        #[rustfmt::skip]
        assert_eq!(shown(&frame(), 6, 4), [
            1, 1, 2, 2, 3, 3,
            1, 1, 2, 2, 3, 3,
            4, 4, 5, 5, 6, 6,
            4, 4, 5, 5, 6, 6,
        ]);
    }

    #[test]
    fn the_shape_is_kept_and_what_is_left_is_black() {
        assert_eq!(shown(&frame(), 5, 2), [0, 1, 2, 3, 0, 0, 4, 5, 6, 0]);
        assert_eq!(shown(&frame(), 3, 4), [0, 0, 0, 1, 2, 3, 4, 5, 6, 0, 0, 0]);
        assert_eq!(shown(&Frame::default(), 2, 2), [0; 4]);
    }

    #[test]
    fn text_is_written_over_a_darkened_picture_and_cut_at_the_edge() {
        let white = Frame { pixels: vec![0xffffff; 1], width: 1, height: 1, ..Frame::default() };
        let with = Frame { figures: "60 fps · 3×3".to_string(), ..white.clone() };
        let pixels = shown(&with, 100, 40);
        let count = |color| pixels.iter().filter(|&&pixel| pixel == color).count();
        assert!(count(0x3f3f3f) > 500, "darkened");
        assert_eq!(pixels[39 * 100 + 30..][..40], [0xffffff; 40], "below the text all is as it was");
        assert!(shown(&with, 100, 3).len() == 300, "no room for a line");
        let help = Frame { help: true, ..white };
        assert!(shown(&help, 700, 500).iter().filter(|&&pixel| pixel == 0x3f3f3f).count() > 50_000);
    }

    #[test]
    fn an_inset_lies_in_the_upper_right_corner() {
        let with = Frame { inset: vec![7; 4], inset_side: 2, ..frame() };
        let pixels = shown(&with, 30, 20);
        let at = |x: usize, y: usize| pixels[y * 30 + x];
        assert_eq!((at(22, 6), at(23, 7)), (7, 7));
        assert_ne!(at(24, 6), 7);
        assert_eq!(shown(&Frame { inset: vec![7; 4], inset_side: 2, ..frame() }, 3, 2).len(), 6);
    }
}
