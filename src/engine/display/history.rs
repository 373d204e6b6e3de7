//! What earlier frames saw, brought to where the camera is now.
//!
//! For: [`History`]. May import: `rows`, `camera`, the guides of `integrate`, `film`. Must never know: scenes, renderers, clocks.
//!
//! A frame of a moving camera has one or a few samples a pixel; the frames before it have seen most of the same points. For every pixel:
//!
//! 1. The point that it sees (its guide's distance along the ray through its middle; of the sky, the direction) is projected into the
//!    camera of the frame before.
//! 2. The pixels around that place are taps. One counts if it saw the same object, with nearly the same normal, in the plane of the point.
//! 3. Where all of 4×4 count, they are interpolated by cubics (Catmull, Rom, "A class of local interpolating splines", 1974), which keep what
//!    frame after frame of bilinear interpolation would blur; else those of 2×2 that count, bilinearly, their weights made up to 1. Where none counts, there is
//!    no history.
//! 4. History and fresh samples are weighted by their numbers. That of the history is capped, so that it forgets.
//! 5. In the sky, history is kept within what the 3×3 fresh pixels around show: there is no noise in them, but at the edge of a lamp pixels of
//!    the sky hold some of its light, and would take it along.
//!
//! Where reflections are sharp, they move otherwise than the surface: there the cap is lower. To keep the history within what the fresh pixels
//! around show (variance clipping) was tried there as well: with one sample a pixel, noise decides what they show, and no scene had a smaller error.
//!
//! The idea is that of Nehab, Sander, Lawrence, Tatarchuk, Isidoro, "Accelerating Real-Time Shading with Reverse Reprojection Caching",
//! Graphics Hardware 2007; tests of taps and counts of samples are as in Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017.

use super::rows;
use crate::camera::Pinhole;
use crate::film::Picture;
use crate::integrate::aovs::{Aovs, Plane};
use crate::lane::{F32x8, Lane, Mask, lane_indices};
use crate::math::{MISS, Vec3};
use glam::{Vec3A, Vec4};

/// Lanes of the projection.
type L = F32x8;

/// Most samples that history stands for, on what is matt: with 64 the errors are the same within one per cent.
const MOST_SAMPLES: f32 = 32.0;
/// And on mirrors; in between it rises by twice [`MOST_SAMPLES`] for each unit of the width of the lobe.
const MOST_ON_MIRRORS: f32 = 8.0;
/// Samples of a camera that stands still after which its film alone is shown.
const SETTLED: u32 = 64;
/// The least cosine between the normals of a point and a tap.
const LEAST_COSINE: f32 = 0.9;
/// How far a tap may lie off the plane of a point, in widths of a pixel there.
const MOST_OFF_PLANE: f32 = 2.0;

/// Bilinear weights of taps that count; with less, history is next to nothing.
const LEAST_WEIGHT: f32 = 0.01;

/// What is remembered of a pixel.
#[derive(Clone, Copy, Debug, Default)]
struct Trace {
    /// Red, green, blue, and how many samples they stand for.
    value: Vec4,
    /// Where the surface is; of the sky, in which direction.
    point: Vec3A,
    normal: Vec3A,
    object: u32,
}

/// The frames so far, blended. Cost: a projection and sixteen taps a pixel; working memory: 144 bytes a pixel with the picture.
///
/// Call [`History::advance`] for the first frame and whenever the camera has moved, [`History::still`] while it stands where the last of those was.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// Of the frame before, and its resolution; none where there was none.
    seen_from: Option<(Pinhole, [u32; 2])>,
    traces: Vec<Trace>,
    /// Of the frame under way.
    next: Vec<Trace>,
    shown: Picture,
    counts: Vec<f32>,
    /// Samples of the film that stands in `shown` and not in `traces`; 0 where there is none.
    still: u32,
}

impl History {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// What was seen is no more: another scene, other light.
    pub fn forget(&mut self) {
        (self.seen_from, self.still) = (None, 0);
    }

    /// The last picture.
    pub fn shown(&self) -> &Picture {
        &self.shown
    }

    /// Samples that each pixel of the last picture stands for, row by row from the top.
    pub fn counts(&self) -> &[f32] {
        &self.counts
    }

    /// A frame from another place than the one before, blended with what is known: `fresh` is the mean of so many samples a pixel, independent of
    /// earlier frames' (0 where they are to stay out of what is known), `guides` and `camera` are its own. Another resolution than before starts anew.
    ///
    /// # Panics
    /// If picture and guides differ in size.
    pub fn advance(&mut self, fresh: &Picture, samples: u32, guides: &Aovs, camera: &Pinhole) -> &Picture {
        let size = [fresh.width, fresh.height];
        assert_eq!(size, guides.resolution(), "a picture and its guides");
        self.remember_still();
        let frame = Frame { fresh, samples: samples as f32, guides, camera };
        let before = self.seen_from.as_ref().filter(|(_, seen)| *seen == size);
        let before = before.map(|(camera, size)| Before { camera, size: *size, traces: &self.traces });
        self.next.resize(fresh.pixels.len(), Trace::default());
        rows::each(&mut self.next, fresh.width as usize, |y, row| frame.trace_row(y, row, before.as_ref()));
        std::mem::swap(&mut self.traces, &mut self.next);
        self.seen_from = Some((*camera, size));
        self.show(fresh, |trace, _| split(trace.value));
        &self.shown
    }

    /// A frame of a camera that stands where it stood for the last [`History::advance`]: the film's mean after so many samples, blended with what
    /// was known before; the more samples, the less of that. From 64 samples on it is the film's mean, bit by bit.
    pub fn still(&mut self, film: &Picture, samples: u32) -> &Picture {
        let size = [film.width, film.height];
        let known = self.seen_from.is_some_and(|(_, seen)| seen == size);
        let left = 1.0 - samples.min(SETTLED) as f32 / SETTLED as f32;
        if known && left > 0.0 {
            self.show(film, |trace, film| {
                let (color, of_color) = split(trace.value);
                let kept = of_color * left;
                (blend(color, kept, film, samples as f32), kept + samples as f32)
            });
        } else {
            self.shown.resize(size);
            self.shown.pixels.copy_from_slice(&film.pixels);
            self.counts.clear();
            self.counts.resize(film.pixels.len(), samples as f32);
        }
        self.still = if known { samples } else { 0 };
        &self.shown
    }

    /// What was shown while the camera stood is what is known when it moves on.
    fn remember_still(&mut self) {
        if std::mem::take(&mut self.still) == 0 {
            return;
        }
        let width = self.shown.width as usize;
        let (shown, counts) = (&self.shown.pixels, &self.counts);
        rows::each(&mut self.traces, width, |y, row| {
            for ((trace, color), count) in row.iter_mut().zip(&shown[y * width..]).zip(&counts[y * width..]) {
                trace.value = Vec3A::from_array(*color).extend(*count);
            }
        });
    }

    /// Fills picture and counts from what is remembered and the pixels of a picture.
    fn show(&mut self, from: &Picture, of: impl Fn(&Trace, [f32; 3]) -> ([f32; 3], f32) + Sync) {
        let width = from.width as usize;
        self.shown.resize([from.width, from.height]);
        self.counts.resize(from.pixels.len(), 0.0);
        let traces = &self.traces;
        let (colors, counts) = (&mut self.shown.pixels[..], &mut self.counts[..]);
        rows::each_two((colors, width), (counts, width), |y, colors, counts| {
            let known = traces[y * width..].iter().zip(&from.pixels[y * width..]);
            for ((color, count), (trace, &pixel)) in colors.iter_mut().zip(counts).zip(known) {
                (*color, *count) = of(trace, pixel);
            }
        });
    }
}

fn split(value: Vec4) -> ([f32; 3], f32) {
    let [r, g, b, samples] = value.to_array();
    ([r, g, b], samples)
}

/// Two means of so many samples each as one.
fn blend(a: [f32; 3], of_a: f32, b: [f32; 3], of_b: f32) -> [f32; 3] {
    let share = of_a / (of_a + of_b);
    std::array::from_fn(|c| b[c] + (a[c] - b[c]) * share)
}

/// A frame under way.
struct Frame<'a> {
    fresh: &'a Picture,
    samples: f32,
    guides: &'a Aovs,
    camera: &'a Pinhole,
}

/// The frame before it.
struct Before<'a> {
    camera: &'a Pinhole,
    size: [u32; 2],
    traces: &'a [Trace],
}

impl Frame<'_> {
    /// What a row of pixels shows and remembers.
    fn trace_row(&self, y: usize, row: &mut [Trace], before: Option<&Before>) {
        let plane = |plane| self.guides.row(plane, y as u32);
        let distances = plane(Plane::Distance);
        let normals = [Plane::NormalX, Plane::NormalY, Plane::NormalZ].map(plane);
        let (objects, lobes) = (self.guides.objects(y as u32), plane(Plane::Lobe));
        for (packet, traces) in row.chunks_mut(L::WIDTH).enumerate() {
            let at = packet * L::WIDTH;
            let x = L::from_int(lane_indices::<L>()) + L::splat(at as f32 + 0.5);
            let ray = self.camera.rays(x, L::splat(y as f32 + 0.5));
            let distance = rows::packet(distances, at);
            let surface = distance.is_finite();
            let point = Vec3::select(surface, ray.at(distance), ray.direction);
            let place = before.map(|before| {
                let from = point - before.camera.origin();
                before.camera.project(Vec3::select(surface, from, ray.direction))
            });
            for (lane, trace) in traces.iter_mut().enumerate() {
                let x = at + lane;
                let fresh = self.fresh.pixels[y * self.fresh.width as usize + x];
                *trace = Trace {
                    value: Vec3A::from_array(fresh).extend(self.samples),
                    point: point.get(lane).into(),
                    normal: Vec3A::from_array(normals.map(|normals| normals[x])),
                    object: objects[x],
                };
                let (Some(before), Some((u, v, ahead))) = (before, place) else { continue };
                if ahead.bitmask() >> lane & 1 == 0 {
                    continue;
                }
                let off = MOST_OFF_PLANE * self.camera.pixel_size() * distances[x];
                if let Some(known) = before.look([u.get(lane), v.get(lane)], trace, off) {
                    let (mut color, samples) = split(known);
                    if objects[x] == MISS {
                        color = self.within_neighbours(color, [x, y]);
                    }
                    let kept = samples.min(most_samples(lobes[x]));
                    let color = blend(color, kept, fresh, self.samples);
                    trace.value = Vec3A::from_array(color).extend(kept + self.samples);
                }
            }
        }
    }

    /// The nearest colour that is between the least and the most of the pixel and those around it.
    fn within_neighbours(&self, color: [f32; 3], [x, y]: [usize; 2]) -> [f32; 3] {
        let [width, height] = [self.fresh.width, self.fresh.height].map(|side| side as usize);
        let around = |at: usize, side: usize| at.saturating_sub(1)..(at + 2).min(side);
        let (mut least, mut most) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        for y in around(y, height) {
            for pixel in &self.fresh.pixels[y * width..][around(x, width)] {
                for channel in 0..3 {
                    least[channel] = least[channel].min(pixel[channel]);
                    most[channel] = most[channel].max(pixel[channel]);
                }
            }
        }
        std::array::from_fn(|channel| color[channel].max(least[channel]).min(most[channel]))
    }
}

/// What history may stand for on a surface.
fn most_samples(lobe: f32) -> f32 {
    MOST_SAMPLES.min(MOST_ON_MIRRORS + 2.0 * MOST_SAMPLES * lobe)
}

impl Before<'_> {
    /// Does this tap show what the point is on?
    #[inline(always)]
    fn fits(tap: &Trace, point: &Trace, off_plane: f32) -> bool {
        tap.object == point.object
            && (point.object == MISS
                || tap.normal.dot(point.normal) >= LEAST_COSINE
                    && (tap.point - point.point).dot(point.normal).abs() <= off_plane)
    }

    /// What was known at a place of the picture: red, green, blue, and for how many samples they stand.
    fn look(&self, [x, y]: [f32; 2], point: &Trace, off_plane: f32) -> Option<Vec4> {
        let [width, height] = self.size.map(|side| side as i32);
        let (x, y) = (x - 0.5, y - 0.5);
        if !((-1.0..width as f32).contains(&x) && (-1.0..height as f32).contains(&y)) {
            return None;
        }
        let (left, top) = (x.floor(), y.floor());
        let (right, low) = (x - left, y - top);
        let (left, top) = (left as i32, top as i32);
        if left >= 1 && top >= 1 && left + 2 < width && top + 2 < height {
            let lines: [&[Trace]; 4] = std::array::from_fn(|line| {
                &self.traces[((top - 1 + line as i32) * width + left - 1) as usize..][..4]
            });
            if lines.iter().all(|line| line.iter().all(|tap| Self::fits(tap, point, off_plane))) {
                let [of_x, of_y] = [right, low].map(catmull_rom);
                let mut sum = Vec4::ZERO;
                for (line, of_y) in lines.iter().zip(of_y) {
                    let of_line = |at: usize| line[at].value * of_x[at];
                    sum += ((of_line(0) + of_line(1)) + (of_line(2) + of_line(3))) * of_y;
                }
                return Some(sum.max(Vec4::ZERO));
            }
        }
        let (mut sum, mut weights) = (Vec4::ZERO, 0.0);
        for (column, line, weight) in [
            (left, top, (1.0 - right) * (1.0 - low)),
            (left + 1, top, right * (1.0 - low)),
            (left, top + 1, (1.0 - right) * low),
            (left + 1, top + 1, right * low),
        ] {
            if (0..width).contains(&column) && (0..height).contains(&line) {
                let tap = &self.traces[(line * width + column) as usize];
                if Self::fits(tap, point, off_plane) {
                    sum += tap.value * weight;
                    weights += weight;
                }
            }
        }
        // Fewer taps are worse evidence, and lie to one side of the place: they stand for less.
        (weights > LEAST_WEIGHT).then(|| (sum / weights).with_w(sum.w))
    }
}
/// The weights of four neighbours for a place between the middle two.
fn catmull_rom(t: f32) -> [f32; 4] {
    let cubic = |a: f32, b: f32, c: f32, d: f32| 0.5 * (((a * t + b) * t + c) * t + d);
    [
        cubic(-1.0, 2.0, -1.0, 0.0),
        cubic(3.0, -5.0, 0.0, 2.0),
        cubic(-3.0, 4.0, 1.0, 0.0),
        cubic(1.0, -1.0, 0.0, 0.0),
    ]
}
