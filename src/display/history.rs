//! Temporal reprojection: accumulates the frames of a moving camera.
//!
//! A frame of a moving camera has one or a few samples a pixel; earlier frames have sampled most of the same
//! points. For every pixel:
//!
//! 1. Reprojection: the visible point (the depth AOV along the ray through the pixel's centre; of the sky,
//!    the direction) is projected into the previous frame's camera.
//! 2. Disocclusion test: the pixels around that position are taps. A tap is valid if it has the same object
//!    id, nearly the same normal, and lies in the plane of the point.
//! 3. Where all of 4×4 taps are valid, they are interpolated bicubically (Catmull, Rom, "A class of local
//!    interpolating splines", 1974), which avoids the blur of repeated bilinear interpolation; otherwise the
//!    valid ones of 2×2, bilinearly, with weights normalised to 1. Where none is valid, the pixel is
//!    disoccluded and has no history.
//! 4. History and new samples are blended by their sample counts. That of the history is capped, so that old
//!    samples fade.
//! 5. In the sky, history is clamped to the 3×3 neighbourhood of the new frame: the sky has no noise, but at
//!    the edge of a light its pixels hold some of the light's radiance, which would leave a trail.
//!
//! Sharp reflections do not move with the surface: there the cap is lower. It is lower everywhere if the
//! camera has a lens: the history moves as seen from the middle of the lens, and blurred light does not.
//! Clamping the history to the new neighbourhood (variance clipping) was tried on mirrors as well: with one
//! sample a pixel, noise determines the neighbourhood, and no scene had a smaller error.
//!
//! Sources: Nehab, Sander, Lawrence, Tatarchuk, Isidoro, "Accelerating Real-Time Shading with Reverse
//! Reprojection Caching", Graphics Hardware 2007; the disocclusion test and the sample counts are as in
//! Schied et al., "Spatiotemporal Variance-Guided Filtering", HPG 2017.

use super::rows;
use glam::{Vec3A, Vec4};
use octray_engine::camera::PreparedCamera;
use octray_engine::film::Picture;
use octray_engine::integrate::aovs::{Aovs, Plane};
use octray_engine::lane::{F32x8, Lane, Mask, lane_indices};
use octray_engine::math::{MISS, Vec3};

/// Lanes of the projection.
type L = F32x8;

/// Cap on the history's sample count on diffuse surfaces: with 64 the errors are the same within one per
/// cent.
const MAX_SAMPLES: f32 = 32.0;
/// The cap on mirrors; in between it rises by twice [`MAX_SAMPLES`] for each unit of the lobe's width.
const MAX_SAMPLES_ON_MIRRORS: f32 = 8.0;
/// Samples of a static camera from which on its film alone is shown.
const STATIC_SAMPLES: u32 = 64;
/// Disocclusion test: the least cosine between the normals of a point and a tap.
const MIN_NORMAL_COSINE: f32 = 0.9;
/// Disocclusion test: the largest distance of a tap from the plane of a point, in pixel widths there.
const MAX_PLANE_DISTANCE: f32 = 2.0;

/// The least sum of the bilinear weights of valid taps: with less there is no history.
const MIN_WEIGHT: f32 = 0.01;

/// A pixel of the history buffer.
#[derive(Clone, Copy, Debug, Default)]
struct HistoryPixel {
    /// Red, green, blue, and their sample count.
    value: Vec4,
    /// The visible point; of the sky, the direction.
    point: Vec3A,
    normal: Vec3A,
    object: u32,
}

/// The history buffer. Cost: a projection and sixteen taps a pixel; working memory: 144 bytes a pixel with
/// the picture.
///
/// Call [`History::reproject`] for the first frame and whenever the camera has moved,
/// [`History::blend_static`] while it stays where it was at the last of those.
#[derive(Clone, Debug, Default)]
pub struct History {
    /// Camera and resolution of the previous frame, if there is one.
    previous: Option<(PreparedCamera, [u32; 2])>,
    buffer: Vec<HistoryPixel>,
    /// Those of the current frame.
    next: Vec<HistoryPixel>,
    shown: Picture,
    counts: Vec<f32>,
    /// Samples of the static film that is in `shown` and not yet in `buffer`; 0 if there is none.
    static_samples: u32,
}

impl History {
    /// Discards the history: for another scene, or other lights.
    pub fn reset(&mut self) {
        (self.previous, self.static_samples) = (None, 0);
    }

    /// The last picture.
    pub fn shown(&self) -> &Picture {
        &self.shown
    }

    /// The sample count of each pixel of the last picture, row by row from the top.
    pub fn counts(&self) -> &[f32] {
        &self.counts
    }

    /// A frame of a camera that has moved, blended with the reprojected history: `fresh` is the mean of
    /// `samples` samples a pixel, independent of those of earlier frames (0 keeps them out of the history);
    /// `aovs` and `camera` are its own. Another resolution than before discards the history.
    ///
    /// # Panics
    /// If picture and AOVs differ in size.
    pub fn reproject(
        &mut self,
        fresh: &Picture,
        samples: u32,
        aovs: &Aovs,
        camera: &PreparedCamera,
    ) -> &Picture {
        let size = [fresh.width, fresh.height];
        assert_eq!(size, aovs.resolution(), "picture and AOVs differ in size");
        self.store_static();
        let frame = Frame { fresh, samples: samples as f32, aovs, camera };
        let before = self.previous.as_ref().filter(|(_, seen)| *seen == size);
        let before = before.map(|(camera, size)| PreviousFrame { camera, size: *size, buffer: &self.buffer });
        self.next.resize(fresh.pixels.len(), HistoryPixel::default());
        rows::each(&mut self.next, fresh.width as usize, |y, row| {
            frame.reproject_row(y, row, before.as_ref())
        });
        std::mem::swap(&mut self.buffer, &mut self.next);
        self.previous = Some((*camera, size));
        self.show(fresh, |entry, _| split(entry.value));
        &self.shown
    }

    /// A frame of a camera that has not moved since the last [`History::reproject`]: the film's mean after
    /// `samples` samples, blended with the history, whose weight falls with the samples. From 64 samples on
    /// it is the film's mean, bit for bit.
    pub fn blend_static(&mut self, film: &Picture, samples: u32) -> &Picture {
        let size = [film.width, film.height];
        let known = self.previous.is_some_and(|(_, seen)| seen == size);
        let left = 1.0 - samples.min(STATIC_SAMPLES) as f32 / STATIC_SAMPLES as f32;
        if known && left > 0.0 {
            self.show(film, |entry, film| {
                let (color, of_color) = split(entry.value);
                let kept = of_color * left;
                (blend(color, kept, film, samples as f32), kept + samples as f32)
            });
        } else {
            self.shown.resize(size);
            self.shown.pixels.copy_from_slice(&film.pixels);
            self.counts.clear();
            self.counts.resize(film.pixels.len(), samples as f32);
        }
        self.static_samples = if known { samples } else { 0 };
        &self.shown
    }

    /// Stores the last static picture in the history, for when the camera moves on.
    fn store_static(&mut self) {
        if std::mem::take(&mut self.static_samples) == 0 {
            return;
        }
        let width = self.shown.width as usize;
        let (shown, counts) = (&self.shown.pixels, &self.counts);
        rows::each(&mut self.buffer, width, |y, row| {
            for ((entry, color), count) in row.iter_mut().zip(&shown[y * width..]).zip(&counts[y * width..]) {
                entry.value = Vec3A::from_array(*color).extend(*count);
            }
        });
    }

    /// Fills picture and counts from the history and the pixels of a picture.
    fn show(&mut self, from: &Picture, of: impl Fn(&HistoryPixel, [f32; 3]) -> ([f32; 3], f32) + Sync) {
        let width = from.width as usize;
        self.shown.resize([from.width, from.height]);
        self.counts.resize(from.pixels.len(), 0.0);
        let buffer = &self.buffer;
        let (colors, counts) = (&mut self.shown.pixels[..], &mut self.counts[..]);
        rows::each_two((colors, width), (counts, width), |y, colors, counts| {
            let known = buffer[y * width..].iter().zip(&from.pixels[y * width..]);
            for ((color, count), (entry, &pixel)) in colors.iter_mut().zip(counts).zip(known) {
                (*color, *count) = of(entry, pixel);
            }
        });
    }
}

fn split(value: Vec4) -> ([f32; 3], f32) {
    let [r, g, b, samples] = value.to_array();
    ([r, g, b], samples)
}

/// The mean of two means, weighted by their sample counts.
fn blend(a: [f32; 3], of_a: f32, b: [f32; 3], of_b: f32) -> [f32; 3] {
    let share = of_a / (of_a + of_b);
    std::array::from_fn(|c| b[c] + (a[c] - b[c]) * share)
}

/// The current frame.
struct Frame<'a> {
    fresh: &'a Picture,
    samples: f32,
    aovs: &'a Aovs,
    camera: &'a PreparedCamera,
}

/// The previous frame.
struct PreviousFrame<'a> {
    camera: &'a PreparedCamera,
    size: [u32; 2],
    buffer: &'a [HistoryPixel],
}

impl Frame<'_> {
    /// Reprojects a row of pixels.
    fn reproject_row(&self, y: usize, row: &mut [HistoryPixel], before: Option<&PreviousFrame>) {
        let plane = |plane| self.aovs.row(plane, y as u32);
        let distances = plane(Plane::Distance);
        let normals = [Plane::NormalX, Plane::NormalY, Plane::NormalZ].map(plane);
        let (objects, lobes) = (self.aovs.objects(y as u32), plane(Plane::Lobe));
        for (packet, buffer) in row.chunks_mut(L::WIDTH).enumerate() {
            let at = packet * L::WIDTH;
            let x = L::from_int(lane_indices::<L>()) + L::splat(at as f32 + 0.5);
            let ray = self.camera.rays(x, L::splat(y as f32 + 0.5));
            let distance = rows::packet(distances, at);
            let surface = distance.is_finite();
            let point = Vec3::select(surface, ray.at(distance), ray.direction);
            let place = before.map(|before| {
                let from = point - Vec3::splat(before.camera.position());
                before.camera.project(Vec3::select(surface, from, ray.direction))
            });
            for (lane, entry) in buffer.iter_mut().enumerate() {
                let x = at + lane;
                let fresh = self.fresh.pixels[y * self.fresh.width as usize + x];
                *entry = HistoryPixel {
                    value: Vec3A::from_array(fresh).extend(self.samples),
                    point: point.get(lane).into(),
                    normal: Vec3A::from_array(normals.map(|normals| normals[x])),
                    object: objects[x],
                };
                let (Some(before), Some((u, v, ahead))) = (before, place) else { continue };
                if ahead.bitmask() >> lane & 1 == 0 {
                    continue;
                }
                let max_distance = MAX_PLANE_DISTANCE * self.camera.pixel_size_at(distances[x]);
                if let Some(known) = before.sample([u.get(lane), v.get(lane)], entry, max_distance) {
                    let (mut color, samples) = split(known);
                    if objects[x] == MISS {
                        color = self.clamp_to_neighbourhood(color, [x, y]);
                    }
                    let lobe = if self.camera.has_lens() { 0.0 } else { lobes[x] };
                    let most = MAX_SAMPLES.min(MAX_SAMPLES_ON_MIRRORS + 2.0 * MAX_SAMPLES * lobe);
                    let kept = samples.min(most);
                    let color = blend(color, kept, fresh, self.samples);
                    entry.value = Vec3A::from_array(color).extend(kept + self.samples);
                }
            }
        }
    }

    /// The colour, clamped to the minimum and maximum of the 3×3 neighbourhood.
    fn clamp_to_neighbourhood(&self, color: [f32; 3], [x, y]: [usize; 2]) -> [f32; 3] {
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

impl PreviousFrame<'_> {
    /// The disocclusion test: is the tap on the surface of the point?
    #[inline(always)]
    fn is_valid(tap: &HistoryPixel, point: &HistoryPixel, max_distance: f32) -> bool {
        tap.object == point.object
            && (point.object == MISS
                || tap.normal.dot(point.normal) >= MIN_NORMAL_COSINE
                    && (tap.point - point.point).dot(point.normal).abs() <= max_distance)
    }

    /// The history at a position of the picture: red, green, blue, and their sample count.
    fn sample(&self, [x, y]: [f32; 2], point: &HistoryPixel, max_distance: f32) -> Option<Vec4> {
        let [width, height] = self.size.map(|side| side as i32);
        let (x, y) = (x - 0.5, y - 0.5);
        if !((-1.0..width as f32).contains(&x) && (-1.0..height as f32).contains(&y)) {
            return None;
        }
        let (left, top) = (x.floor(), y.floor());
        let (right, low) = (x - left, y - top);
        let (left, top) = (left as i32, top as i32);
        if left >= 1 && top >= 1 && left + 2 < width && top + 2 < height {
            let lines: [&[HistoryPixel]; 4] = std::array::from_fn(|line| {
                &self.buffer[((top - 1 + line as i32) * width + left - 1) as usize..][..4]
            });
            if lines.iter().all(|line| line.iter().all(|tap| Self::is_valid(tap, point, max_distance))) {
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
                let tap = &self.buffer[(line * width + column) as usize];
                if Self::is_valid(tap, point, max_distance) {
                    sum += tap.value * weight;
                    weights += weight;
                }
            }
        }
        // Fewer valid taps lie to one side of the position: their sample count is reduced.
        (weights > MIN_WEIGHT).then(|| (sum / weights).with_w(sum.w))
    }
}

/// Catmull-Rom weights of four samples for a position between the middle two.
fn catmull_rom(t: f32) -> [f32; 4] {
    let cubic = |a: f32, b: f32, c: f32, d: f32| 0.5 * (((a * t + b) * t + c) * t + d);
    [
        cubic(-1.0, 2.0, -1.0, 0.0),
        cubic(3.0, -5.0, 0.0, 2.0),
        cubic(-3.0, 4.0, 1.0, 0.0),
        cubic(1.0, -1.0, 0.0, 0.0),
    ]
}
