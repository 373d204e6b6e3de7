//! Pixels at edges of objects and textures: composed of what several of their points show.
//!
//! A filtered pixel has the albedo and the light at its centre, and so every edge would be a staircase. The
//! albedos of a few points in the pixel have no noise: the pixel becomes the mean, over the points, of albedo
//! times the filtered light of the nearest pixel of the same object. Points show what emits exactly. The
//! film's mean takes over as the samples grow, which cover the pixel better than the points do.

use super::planes::{ALBEDO, Guide, MIN_ALBEDO, NORMALS, PAD, Task};
use octray_engine::integrate::edge_aovs::{EDGE_POINTS, EdgeSample, POINTS};

/// The weight of pixels that show several objects, as taps, at a fraction of a sample: their light is that of
/// one object or another.
const TRUST: f32 = 0.3;
/// Samples at which they have (1 + `TRUST`) / 2 of a full weight.
const TRUSTED_SAMPLES: f32 = 16.0;
/// Samples, less one, at which a pixel is half the film's mean: at edges of textures, and of objects.
const TEXTURE_SAMPLES: f32 = 8.0;
const OBJECT_SAMPLES: f32 = 4.0;
/// The squared distance, in pixels, as which a squared difference of unit normals counts.
const NORMAL_DISTANCE: f32 = 8.0;

impl Task<'_> {
    /// Demodulates the pixels of a row that are at edges by the mean albedo of the centre and of the points
    /// that show the centre's object; reduces the weight of those that show several.
    pub fn prepare_edges(&self, y: usize, guides: &mut [f32], light: &mut [f32]) {
        let objects = self.aovs.centers().objects(y as u32);
        let albedo = ALBEDO.map(|plane| self.aovs.centers().row(plane, y as u32));
        for edge in self.aovs.edges(y as u32) {
            let x = edge.x as usize;
            let (mut sum, mut count) = (albedo.map(|albedo| albedo[x].max(MIN_ALBEDO)), 1.0);
            for sample in edge.samples.iter().filter(|sample| sample.object == objects[x]) {
                (0..3).for_each(|channel| sum[channel] += sample.albedo[channel].max(MIN_ALBEDO));
                count += 1.0;
            }
            let mean = sum.map(|sum| sum / count);
            let pixel = y * self.width + x;
            for channel in 0..3 {
                light[channel * self.stride + PAD + x] = self.picture.pixels[pixel][channel] / mean[channel];
            }
            let several = count < (EDGE_POINTS + 1) as f32;
            let samples = self.samples_of(pixel);
            let trust = (samples + TRUST * TRUSTED_SAMPLES) / (samples + TRUSTED_SAMPLES);
            let weight = (mean[0] + mean[1] + mean[2]) * (1.0 / 3.0);
            guides[Guide::Weight as usize * self.stride + PAD + x] =
                if several { weight * trust } else { weight };
        }
    }

    /// Composes the pixels of a row that are at edges; `light` is that of all rows, filtered.
    pub fn compose_edges(&self, y: usize, light: &[f32], row: &mut [[f32; 3]]) {
        let objects = self.aovs.centers().objects(y as u32);
        for edge in self.aovs.edges(y as u32) {
            let x = edge.x as usize;
            let mut sum = [0.0; 3];
            for (sample, point) in edge.samples.iter().zip(POINTS) {
                let color = self.color_of(sample, [x, y], point, light).unwrap_or(row[x]);
                (0..3).for_each(|channel| sum[channel] += color[channel] * (1.0 / EDGE_POINTS as f32));
            }
            let texture = edge.samples.iter().all(|sample| sample.object == objects[x]);
            let half = if texture { TEXTURE_SAMPLES } else { OBJECT_SAMPLES };
            let pixel = y * self.width + x;
            let more = (self.samples_of(pixel) - 1.0).max(0.0);
            let (film, kept) = (self.picture.pixels[pixel], more / (more + half));
            row[x] = std::array::from_fn(|channel| sum[channel] + (film[channel] - sum[channel]) * kept);
        }
    }

    /// The colour at a point: its albedo times the light of the nearest pixel of 3×3 with the same object,
    /// if there is one.
    fn color_of(
        &self,
        sample: &EdgeSample,
        [x, y]: [usize; 2],
        [right, down]: [f32; 2],
        light: &[f32],
    ) -> Option<[f32; 3]> {
        if sample.emits {
            return Some(sample.albedo);
        }
        let mut nearest = (f32::INFINITY, None);
        let around = |own: usize, side: usize| own.saturating_sub(1)..(own + 2).min(side);
        for line in around(y, self.height) {
            let objects = self.aovs.centers().objects(line as u32);
            for column in around(x, self.width) {
                if objects[column] != sample.object {
                    continue;
                }
                let away = |pixel: usize, own: usize, point: f32| pixel as f32 + 0.5 - own as f32 - point;
                let (across, along) = (away(column, x, right), away(line, y, down));
                let mut distance = across * across + along * along;
                for ((_, plane), normal) in NORMALS.into_iter().zip(sample.normal) {
                    let difference = self.aovs.centers().row(plane, line as u32)[column] - normal;
                    distance += NORMAL_DISTANCE * (difference * difference);
                }
                if distance < nearest.0 {
                    nearest = (distance, Some(line * 3 * self.stride + PAD + column));
                }
            }
        }
        let at = nearest.1?;
        let color =
            |channel: usize| sample.albedo[channel].max(MIN_ALBEDO) * light[at + channel * self.stride];
        Some(std::array::from_fn(color))
    }
}
