//! Fast approximate anti-aliasing (FXAA) of one picture.
//!
//! Source: Timothy Lottes, "FXAA", NVIDIA, 2009, and the algorithm of its version 3.11 (quality), reworded
//! and reordered:
//!
//! 1. A pixel whose local contrast in displayed luma is low stays as it is.
//! 2. The edge is horizontal or vertical, whichever second differences are larger; it lies between the pixel
//!    and the neighbour across it that differs more.
//! 3. The ends of the edge, in both directions, are where the mean of both sides changes. The nearer the end,
//!    the larger the share of the neighbour: the area of the pixel that a straight line from end to end would
//!    cover.
//! 4. A pixel that differs from all its neighbours (a thin line, a dot) is blended with the neighbour, too;
//!    the larger share counts.
//!
//! Departures: the search proceeds pixel by pixel and not in growing strides; an end that is not found
//! smooths nothing; and step 4 first subtracts its response to a straight edge, so that edges along rows and
//! columns stay sharp.

use super::rows;
use octray_engine::film::Picture;
use octray_engine::tone::Tone;

/// The least contrast of an edge relative to the largest luma nearby.
const MIN_RELATIVE_CONTRAST: f32 = 0.125;
/// The least contrast of an edge in displayed luma, 0 to 1.
const MIN_CONTRAST: f32 = 0.0312;
/// Pixels to each side in which the ends of an edge are searched.
const SEARCH_DISTANCE: usize = 16;
/// The share of the contrast by which an edge's mean changes at its end.
const END_CONTRAST: f32 = 0.25;
/// The largest share of the neighbour in step 4.
const MAX_DOT_SHARE: f32 = 0.75;
/// The response of step 4 to a straight edge: a third.
const STRAIGHT_EDGE_RESPONSE: f32 = 0.334;
/// Weights of red, green and blue in luma, as in the original.
const LUMA: [f32; 3] = [0.299, 0.587, 0.114];

/// The filter. Cost: a square root a pixel, and some forty operations and a short search at edges.
///
/// Law: every pixel is a mean of itself and one neighbour, in linear radiance; a flat picture and edges along
/// rows and columns stay bit-identical. Noise counts as edges: the filter is for converged pictures.
#[derive(Clone, Debug, Default)]
pub struct Fxaa {
    luma: Vec<f32>,
    shown: Picture,
}

impl Fxaa {
    /// The anti-aliased picture; contrast is that of the picture displayed with `tone`.
    pub fn filter(&mut self, picture: &Picture, tone: &Tone) -> &Picture {
        let [width, height] = [picture.width, picture.height].map(|side| side as usize);
        let scale = tone.exposure.exp2();
        self.luma.resize(width * height, 0.0);
        self.shown.resize([picture.width, picture.height]);
        rows::each(&mut self.luma, width, |y, row| {
            for (luma, pixel) in row.iter_mut().zip(&picture.pixels[y * width..]) {
                let [r, g, b] = pixel.map(|channel| tone.operator.map(channel * scale));
                // The square root approximates the display's transfer curve, as in the original.
                *luma = (r * LUMA[0] + g * LUMA[1] + b * LUMA[2]).sqrt();
            }
        });
        let seen = Luma { luma: &self.luma, width, height };
        rows::each(&mut self.shown.pixels, width, |y, row| {
            for (x, pixel) in row.iter_mut().enumerate() {
                let own = picture.pixels[y * width + x];
                *pixel = match seen.neighbour(x as i32, y as i32) {
                    None => own,
                    Some((other, share)) => {
                        let other = picture.pixels[other];
                        std::array::from_fn(|c| own[c] + (other[c] - own[c]) * share)
                    }
                };
            }
        });
        &self.shown
    }
}

/// Displayed luma; coordinates are clamped to the border.
struct Luma<'a> {
    luma: &'a [f32],
    width: usize,
    height: usize,
}

impl Luma<'_> {
    fn index(&self, x: i32, y: i32) -> usize {
        let inside = |at: i32, size: usize| at.clamp(0, size as i32 - 1) as usize;
        inside(y, self.height) * self.width + inside(x, self.width)
    }
    fn at(&self, x: i32, y: i32) -> f32 {
        self.luma[self.index(x, y)]
    }

    /// The neighbour that a pixel is blended with, and its share; none where the pixel stays as it is.
    fn neighbour(&self, x: i32, y: i32) -> Option<(usize, f32)> {
        let at = |right, down| self.at(x + right, y + down);
        let [own, up, down, left, right] = [at(0, 0), at(0, -1), at(0, 1), at(-1, 0), at(1, 0)];
        let most = own.max(up).max(down).max(left).max(right);
        let contrast = most - own.min(up).min(down).min(left).min(right);
        if contrast < MIN_CONTRAST.max(MIN_RELATIVE_CONTRAST * most) {
            return None;
        }
        let [up_left, up_right, down_left, down_right] = [at(-1, -1), at(1, -1), at(-1, 1), at(1, 1)];
        let curved = |a: f32, middle: f32, b: f32| (a + b - 2.0 * middle).abs();
        let across_rows = curved(up_left, left, down_left)
            + 2.0 * curved(up, own, down)
            + curved(up_right, right, down_right);
        let across_columns = curved(up_left, up, up_right)
            + 2.0 * curved(left, own, right)
            + curved(down_left, down, down_right);
        let horizontal = across_rows >= across_columns;
        let (before, behind) = if horizontal { (up, down) } else { (left, right) };
        let side = if (before - own).abs() >= (behind - own).abs() { -1 } else { 1 };
        let across = if horizontal { [0, side] } else { [side, 0] };
        let other = if side < 0 { before } else { behind };

        let around = 2.0 * (up + down + left + right) + up_left + up_right + down_left + down_right;
        let alone = (((around / 12.0 - own).abs() / contrast).min(1.0) - STRAIGHT_EDGE_RESPONSE).max(0.0)
            / (1.0 - STRAIGHT_EDGE_RESPONSE);
        let smooth = alone * alone * (3.0 - 2.0 * alone);
        let dot = smooth * smooth * MAX_DOT_SHARE;
        let share = self.edge_share([x, y], horizontal, across, [own, other]).max(dot);
        (share > 0.0).then(|| (self.index(x + across[0], y + across[1]), share))
    }

    /// The share of the neighbour that a straight line between the ends of the edge would give the pixel.
    fn edge_share(
        &self,
        [x, y]: [i32; 2],
        horizontal: bool,
        across: [i32; 2],
        [own, other]: [f32; 2],
    ) -> f32 {
        let mean = 0.5 * (own + other);
        let change = END_CONTRAST * (own - other).abs();
        let along = |steps: i32| if horizontal { (x + steps, y) } else { (x, y + steps) };
        // Steps to the end, and the difference of the mean there from the edge's.
        let end = |direction: i32| {
            (1..=SEARCH_DISTANCE as i32).find_map(|steps| {
                let (x, y) = along(steps * direction);
                let off = 0.5 * (self.at(x, y) + self.at(x + across[0], y + across[1])) - mean;
                (off.abs() >= change).then_some((steps, off))
            })
        };
        let (one, two) = (end(-1), end(1));
        let beyond = SEARCH_DISTANCE as i32 + 1;
        let steps = |end: Option<(i32, f32)>| end.map_or(beyond, |(steps, _)| steps);
        let length = steps(one) + steps(two) - 1;
        let Some((near, off)) = (if steps(one) <= steps(two) { one } else { two }) else { return 0.0 };
        // The line covers this pixel's side only at one of the two ends.
        if (off < 0.0) == (own < mean) {
            return 0.0;
        }
        (0.5 - (near as f32 - 0.5) / length as f32).max(0.0)
    }
}
