//! Draws a frame into a window's pixels, with text over it.

use super::canvas::Canvas;
use super::frame::Frame;
use super::keys;
use embedded_graphics::draw_target::DrawTarget;
use embedded_graphics::geometry::{OriginDimensions, Point, Size};
use embedded_graphics::mono_font::iso_8859_1::{FONT_7X13, FONT_10X20};
use embedded_graphics::mono_font::{MonoFont, MonoTextStyle};
use embedded_graphics::pixelcolor::{IntoStorage, Rgb888, RgbColor};
use embedded_graphics::prelude::{Drawable, Pixel};
use embedded_graphics::text::{Baseline, Text};
use std::borrow::Cow;
use std::convert::Infallible;

const PADDING: usize = 6;

/// Draws a frame with its minimap and text.
pub fn draw(frame: &Frame, mut canvas: Canvas) {
    canvas.draw_picture(frame);
    canvas.draw_minimap(frame, usize::MAX, PADDING);
    let font = if canvas.width >= 1_500 { &FONT_10X20 } else { &FONT_7X13 };
    let [across, line] = cell(font);
    let columns = (canvas.width.saturating_sub(2 * PADDING) / across).max(1);
    let mut top = 0;
    for (text, color) in [(&frame.figures, Rgb888::WHITE), (&frame.message, Rgb888::YELLOW)] {
        if !text.is_empty() {
            top = draw_block(&mut canvas, &textwrap::wrap(text, columns), top, font, color);
        }
    }
    if frame.help {
        let lines = canvas.height.saturating_sub(top + PADDING) / line;
        let help: Vec<Cow<str>> = keys::help_in(columns, lines).into_iter().map(Cow::from).collect();
        draw_block(&mut canvas, &help, top, font, Rgb888::WHITE);
    }
}

/// Returns the width of a character and the height of a line in pixels.
fn cell(font: &MonoFont) -> [usize; 2] {
    [font.character_size.width as usize, font.character_size.height as usize + 1]
}

/// Draws lines on a darkened background from `top` on; returns where the next block may start.
fn draw_block(canvas: &mut Canvas, lines: &[Cow<str>], top: usize, font: &MonoFont, color: Rgb888) -> usize {
    let [across, line] = cell(font);
    let widest = lines.iter().map(|line| line.chars().count()).max().unwrap_or(0);
    let width = (widest * across + 2 * PADDING).min(canvas.width);
    let height = (lines.len() * line + PADDING).min(canvas.height.saturating_sub(top));
    for row in canvas.pixels.chunks_mut(canvas.width).skip(top).take(height) {
        // Darkens to a quarter.
        row[..width].iter_mut().for_each(|pixel| *pixel = (*pixel >> 2) & 0x3f3f3f);
    }
    let style = MonoTextStyle::new(font, color);
    for (number, text) in lines.iter().enumerate() {
        let at = Point::new(PADDING as i32, (top + PADDING / 2 + number * line) as i32);
        let Ok(_) = Text::with_baseline(text, at, style, Baseline::Top).draw(canvas);
    }
    top + height
}

impl OriginDimensions for Canvas<'_> {
    fn size(&self) -> Size {
        Size::new(self.width as u32, self.height as u32)
    }
}

impl DrawTarget for Canvas<'_> {
    type Color = Rgb888;
    type Error = Infallible;

    fn draw_iter<I: IntoIterator<Item = Pixel<Rgb888>>>(&mut self, pixels: I) -> Result<(), Infallible> {
        for Pixel(Point { x, y }, color) in pixels {
            if (0..self.width as i32).contains(&x) && (0..self.height as i32).contains(&y) {
                self.pixels[y as usize * self.width + x as usize] = color.into_storage();
            }
        }
        Ok(())
    }
}
