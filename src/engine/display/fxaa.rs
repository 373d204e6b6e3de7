//! Steps of edges smoothed by what one picture shows.
//!
//! For: [`Fxaa`]. May import: `rows`, `film`, `output` (what a screen shows). Must never know: guides, cameras.
//!
//! Source: Timothy Lottes, "FXAA", NVIDIA, 2009, and the algorithm of its version 3.11 (quality), in our own words and in another order:
//!
//! 1. A pixel whose neighbours differ little in brightness, as a screen shows it, stays as it is.
//! 2. The edge is horizontal or vertical, whichever second differences are larger; it lies between the pixel and the neighbour across it that
//!    differs more.
//! 3. Along the edge, both ways, its ends are where the mean of both sides changes. The nearer the end, the more the step there is spread: by as much of
//!    the neighbour as a straight line from end to end would cover of the pixel.
//! 4. A pixel that differs from all its neighbours (a thin line, a dot) takes some of the neighbour, too; the larger share wins.
//!
//! Departures: the search goes pixel by pixel and not in growing strides; an end that is not found smooths nothing; and step 4 takes off first what a straight
//! edge would make of it, so that edges along rows and columns stay sharp.

use super::rows;
use crate::film::Picture;
use crate::tone::Tone;

/// The least contrast that is an edge: of the brightest neighbour, and in itself (displayed brightness, 0 to 1).
const LEAST_CONTRAST: f32 = 0.125;
const LEAST_STEP: f32 = 0.0312;
/// Pixels to each side in which ends are looked for.
const REACH: usize = 16;
/// The part of the contrast that an edge's mean changes by at an end.
const END: f32 = 0.25;
/// The most that a single dot loses to its neighbour.
const MOST_OF_A_DOT: f32 = 0.75;
/// What step 4 finds at a straight edge: a third.
const RENORMALIZATION_INTERVAL: f32 = 0.334;
/// Red, green and blue in brightness, as in the original.
const LUMA: [f32; 3] = [0.299, 0.587, 0.114];

/// The filter. Cost: a root a pixel, and some forty operations and a short search at edges.
///
/// Law: every pixel is a mean of itself and one neighbour, in linear radiance; a flat picture and edges along rows and columns stay as they are, bit by
/// bit. It does not know noise from edges: it is for pictures of many samples.
#[derive(Clone, Debug, Default)]
pub struct Fxaa {
    luma: Vec<f32>,
    shown: Picture,
}

impl Fxaa {
    pub fn new() -> Self {
        Self::default()
    }

    /// The picture with smoother edges, judged by what `tone` will show of it.
    pub fn filter(&mut self, picture: &Picture, tone: &Tone) -> &Picture {
        let [width, height] = [picture.width, picture.height].map(|side| side as usize);
        let scale = tone.exposure.exp2();
        self.luma.resize(width * height, 0.0);
        self.shown.resize([picture.width, picture.height]);
        rows::each(&mut self.luma, width, |y, row| {
            for (luma, pixel) in row.iter_mut().zip(&picture.pixels[y * width..]) {
                let [r, g, b] = pixel.map(|channel| tone.operator.map(channel * scale));
                // The root is the curve of a screen, nearly, as the original has it, too.
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

/// Displayed brightness; beyond the border, the outermost pixels go on.
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

    /// The neighbour that a pixel takes a share of, if it does.
    fn neighbour(&self, x: i32, y: i32) -> Option<(usize, f32)> {
        let at = |right, down| self.at(x + right, y + down);
        let [own, up, down, left, right] = [at(0, 0), at(0, -1), at(0, 1), at(-1, 0), at(1, 0)];
        let most = own.max(up).max(down).max(left).max(right);
        let contrast = most - own.min(up).min(down).min(left).min(right);
        if contrast < LEAST_STEP.max(LEAST_CONTRAST * most) {
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
        let alone = (((around / 12.0 - own).abs() / contrast).min(1.0) - RENORMALIZATION_INTERVAL).max(0.0)
            / (1.0 - RENORMALIZATION_INTERVAL);
        let smooth = alone * alone * (3.0 - 2.0 * alone);
        let dot = smooth * smooth * MOST_OF_A_DOT;
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
        let change = END * (own - other).abs();
        let along = |steps: i32| if horizontal { (x + steps, y) } else { (x, y + steps) };
        // How far off the end is, and how far the mean is there from the edge's.
        let end = |direction: i32| {
            (1..=REACH as i32).find_map(|steps| {
                let (x, y) = along(steps * direction);
                let off = 0.5 * (self.at(x, y) + self.at(x + across[0], y + across[1])) - mean;
                (off.abs() >= change).then_some((steps, off))
            })
        };
        let (one, two) = (end(-1), end(1));
        let beyond = REACH as i32 + 1;
        let steps = |end: Option<(i32, f32)>| end.map_or(beyond, |(steps, _)| steps);
        let length = steps(one) + steps(two) - 1;
        let Some((near, off)) = (if steps(one) <= steps(two) { one } else { two }) else { return 0.0 };
        // The step goes away from this pixel's side only at one of the two ends.
        if (off < 0.0) == (own < mean) {
            return 0.0;
        }
        (0.5 - (near as f32 - 0.5) / length as f32).max(0.0)
    }
}
