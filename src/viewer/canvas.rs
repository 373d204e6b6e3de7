//! Draws a frame's picture and minimap at the size of a window or a terminal.

use super::frame::Frame;
use std::ops::Range;

/// The pixels of a window or a terminal, 0x00RRGGBB, row by row from the top.
pub struct Canvas<'a> {
    pub pixels: &'a mut [u32],
    pub width: usize,
    pub height: usize,
}

/// Left, top, width, height.
type Rectangle = [usize; 4];

impl Canvas<'_> {
    /// Draws the picture as large as it fits, in its aspect ratio, on black.
    pub fn draw_picture(&mut self, frame: &Frame) {
        let size = [frame.width, frame.height].map(|side| side as usize);
        let area = fit(size, [self.width, self.height]);
        if area != [0, 0, self.width, self.height] {
            self.pixels.fill(0);
        }
        self.resample(&frame.pixels, size, area);
    }

    /// Draws the square minimap into the upper right corner, at most as large as `side`.
    pub fn draw_minimap(&mut self, frame: &Frame, side: usize, margin: usize) {
        let own = frame.inset.len().isqrt();
        let side = side.min(own).min(self.width.min(self.height).saturating_sub(margin));
        let left = self.width.saturating_sub(margin + side);
        self.resample(&frame.inset, [own; 2], [left, margin, side, side]);
    }

    /// Draws a picture of a size into an area. A smaller area shows the mean of several pixels in one.
    fn resample(&mut self, picture: &[u32], size: [usize; 2], [left, top, width, height]: Rectangle) {
        let columns: Vec<_> = (0..width).map(|x| span(x, width, size[0])).collect();
        let mut last = 0..0;
        for y in 0..height {
            let rows = span(y, height, size[1]);
            let start = (top + y) * self.width + left;
            if rows == last {
                // This row equals the one above.
                let above = start - self.width;
                self.pixels.copy_within(above..above + width, start);
                continue;
            }
            for (pixel, columns) in self.pixels[start..].iter_mut().zip(&columns) {
                *pixel = match (rows.len(), columns.len()) {
                    (1, 1) => picture[rows.start * size[0] + columns.start],
                    _ => mean(rows.clone().flat_map(|y| &picture[y * size[0]..][columns.clone()])),
                };
            }
            last = rows;
        }
    }
}

/// Returns the largest centred area of a picture's aspect ratio in a window.
fn fit([width, height]: [usize; 2], [across, down]: [usize; 2]) -> Rectangle {
    if width == 0 || height == 0 || across == 0 || down == 0 {
        return [0; 4];
    }
    let [shown, tall] = match width * down <= height * across {
        true => [(down * width / height).max(1), down],
        false => [across, (across * height / width).max(1)],
    };
    [(across - shown) / 2, (down - tall) / 2, shown, tall]
}

/// Returns the pixels, of `all` in a row, that lie under pixel `at` of `count`: at least one.
fn span(at: usize, count: usize, all: usize) -> Range<usize> {
    let from = at * all / count;
    from..((at + 1) * all / count).max(from + 1)
}

/// Returns the mean of pixels, rounded in each channel.
fn mean<'a>(pixels: impl Iterator<Item = &'a u32>) -> u32 {
    let (mut sums, mut count) = ([0u32; 3], 0);
    for pixel in pixels {
        let [_, r, g, b] = pixel.to_be_bytes();
        sums = [sums[0] + u32::from(r), sums[1] + u32::from(g), sums[2] + u32::from(b)];
        count += 1;
    }
    let [r, g, b] = sums.map(|sum| (sum + count / 2) / count);
    r << 16 | g << 8 | b
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Frame {
        Frame { pixels: vec![1, 2, 3, 4, 5, 6], width: 3, height: 2, ..Frame::default() }
    }
    fn shown(frame: &Frame, width: usize, height: usize) -> Vec<u32> {
        let mut pixels = vec![9; width * height];
        let mut canvas = Canvas { pixels: &mut pixels, width, height };
        canvas.draw_picture(frame);
        canvas.draw_minimap(frame, 2, 6);
        pixels
    }

    #[test]
    fn a_smaller_picture_has_the_mean_of_its_pixels() {
        let pixels = vec![0x102030, 0x302010, 0, 0x40, 7, 7, 7, 7];
        let frame = Frame { pixels, width: 4, height: 2, ..Frame::default() };
        assert_eq!(shown(&frame, 2, 1), [0x101014, 0x14]);
    }

    #[test]
    fn the_shape_is_kept_and_what_is_left_is_black() {
        assert_eq!(shown(&frame(), 5, 2), [0, 1, 2, 3, 0, 0, 4, 5, 6, 0]);
        assert_eq!(shown(&frame(), 3, 4), [0, 0, 0, 1, 2, 3, 4, 5, 6, 0, 0, 0]);
        assert_eq!(shown(&Frame::default(), 2, 2), [0; 4]);
        assert_eq!(fit([240, 135], [960, 540]), [0, 0, 960, 540]);
        assert_eq!(fit([1, 16_000], [10, 10]), [4, 0, 1, 10]);
    }
}
