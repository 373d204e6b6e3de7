//! A denoiser: the edge-avoiding à-trous wavelet filter.
//!
//! Source: Dammertz, Sewtz, Hanika, Lensch, "Edge-Avoiding À-Trous Wavelet Transform for fast Global
//! Illumination Filtering", HPG 2010. Each level is a small blur with twice the tap distance of the level
//! before. Edge-stopping functions of guide buffers reduce the weight of a tap:
//!
//! - Object, normal and depth: a tap on another object has the weight 0; the weight falls with the difference
//!   of the normals, and with the difference of 1/depth from the pixel's slope (1/depth is linear on a plane:
//!   a slanted floor is no edge).
//! - Colour: the weight falls where colours differ by more than the noise. The noise is estimated from the
//!   number of samples and from the neighbourhood; it halves with every level, as the remaining noise does. A
//!   converged picture changes little. With few samples the first levels hardly look at colours: few pixels
//!   hold most of the light, and stopping there would leave their neighbours dark and them as fireflies.
//! - Lobe width: on glossy surfaces the weight falls with the distance of the tap, because no guide buffer
//!   holds the edges of what they reflect. The guide buffers of mirrors and glass are those of what they show
//!   ([`DenoiserAovs`]). What emits, seen directly or in mirrors, has no noise and is not filtered.
//!
//! Colours are filtered demodulated (radiance over albedo), so that textures stay sharp; a tap's weight is
//! proportional to its albedo, because the error of the quotient is inversely proportional to it. Pixels at
//! edges of objects and textures are composed of what several of their points show ([`mod@edges`]).
//!
//! Three departures from the paper: a level has 3×3 taps with weights 1 2 1 (the paper's 5×5 are 2.8 times as
//! many, for 0.8 to 1.1 times the error); e^(−x) is (1 − x/4)⁴ up to 4 and 0 beyond, so that strong edges
//! stop the filter completely; and the colour range is the one described above.

mod edges;
mod planes;

use super::rows;
use octray_engine::film::Picture;
use octray_engine::integrate::edge_aovs::DenoiserAovs;
use octray_engine::lane::{Bits, F32x8, Lane, Mask};
use planes::{ALBEDO, GUIDES, Guide, MIN_ALBEDO, PAD, Task, UNFILTERED};

pub use planes::Samples;

type L = F32x8;

/// Levels, each twice as wide as the one before: 31 pixels in all. A fifth blurs more than it smooths.
const LEVELS: u32 = 4;
/// Upper bound of the colour range at one sample a pixel, as a multiple of the brightness, whatever the
/// neighbourhood's variance.
const NOISE_PER_SAMPLE: f32 = 8.0;
/// The factor, less 1, by which one sample a pixel widens the colour range of the first level: few pixels
/// hold most of the light, and the variance of the others is underestimated. It falls with the samples, and
/// with the levels as the tap distance to the power of −1.5.
const FEW_SAMPLES: f32 = 26.0;
/// Edge stopping by normals: weight 1/e at 24°, 0 from 49° on.
const NORMAL_FACTOR: f32 = 6.0;
/// Edge stopping by depth: tolerances relative to 1/depth, and to its change by the slope over the step.
const DEPTH_TOLERANCE: f32 = 0.02;
const SLOPE_TOLERANCE: f32 = 0.5;

/// The filter. Cost: 36 taps a pixel and 25 reads for the variance of its neighbourhood, eight pixels at
/// once, and 9 reads for each point of a pixel at an edge; working memory: 80 bytes a pixel with the picture.
///
/// Law: a filtered pixel is a mean of pixels of one object, times the pixel's albedo, or at an edge a mean of
/// such; a picture without noise changes little.
#[derive(Clone, Debug, Default)]
pub struct Denoiser {
    guides: Vec<f32>,
    light: Vec<f32>,
    next: Vec<f32>,
    shown: Picture,
}

impl Denoiser {
    /// The denoised picture; `aovs` are those of its camera.
    ///
    /// # Panics
    /// If picture, samples and AOVs differ in size.
    pub fn filter(&mut self, picture: &Picture, samples: Samples, aovs: &DenoiserAovs) -> &Picture {
        let task = Task::new(picture, samples, aovs);
        let (stride, width) = (task.stride, task.width);
        self.guides.resize(stride * GUIDES * task.height, 0.0);
        self.light.resize(stride * 3 * task.height, 0.0);
        self.next.resize(stride * 3 * task.height, 0.0);
        let [of_guides, of_light] = [stride * GUIDES, stride * 3];
        rows::each_two((&mut self.guides, of_guides), (&mut self.light, of_light), |y, guides, light| {
            task.prepare(y, guides, light);
        });
        let light = &self.light;
        rows::each(&mut self.guides, of_guides, |y, row| task.estimate_variance(y, row, light));
        for step in (0..LEVELS).map(|level| 1 << level) {
            let (light, guides) = (&self.light, &self.guides);
            rows::each(&mut self.next, of_light, |y, row| level(&task, step, y, row, light, guides));
            std::mem::swap(&mut self.light, &mut self.next);
        }
        self.shown.resize([picture.width, picture.height]);
        let light = &self.light;
        rows::each(&mut self.shown.pixels, width, |y, row| {
            let of_row = &light[y * of_light..][..of_light];
            let [red, green, blue] = [0, 1, 2].map(|channel| &of_row[channel * stride + PAD..]);
            let albedo = ALBEDO.map(|plane| aovs.centers().row(plane, y as u32));
            let narrow = &self.guides[y * of_guides + Guide::Narrowness as usize * stride + PAD..];
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = if narrow[x] == UNFILTERED {
                    picture.pixels[y * width + x]
                } else {
                    let [r, g, b] = albedo.map(|albedo| albedo[x].max(MIN_ALBEDO));
                    [red[x] * r, green[x] * g, blue[x] * b]
                };
            }
            task.compose_edges(y, light, row);
        });
        &self.shown
    }
}

/// The pixel that taps are compared with.
struct Center {
    object: <L as Lane>::Bits,
    normal: [L; 3],
    inverse_depth: L,
    slope: [L; 2],
    narrowness: L,
    light: [L; 3],
    /// Factors of a squared colour difference: relative to the squared brightness, and absolute.
    by_samples: L,
    by_variance: L,
}

/// One row of one level.
fn level(task: &Task, step: i32, y: usize, to: &mut [f32], light: &[f32], guides: &[f32]) {
    const TAPS: [(i32, f32); 3] = [(-1, 0.25), (0, 0.5), (1, 0.25)];
    let stride = task.stride;
    let finer = (step * step) as f32;
    let few_samples = FEW_SAMPLES / (step as f32 * (step as f32).sqrt());
    let row_of = |line: usize| {
        (&guides[line * GUIDES * stride..][..GUIDES * stride], &light[line * 3 * stride..][..3 * stride])
    };
    let lines: [Option<(&[f32], &[f32])>; 3] = TAPS.map(|(down, _)| {
        let line = y as i32 + down * step;
        (0..task.height as i32).contains(&line).then(|| row_of(line as usize))
    });
    let (own_guides, own_light) = row_of(y);
    for at in (PAD..PAD + task.width).step_by(L::WIDTH) {
        let own = |guide: Guide| L::load(&own_guides[guide as usize * stride + at..]);
        let light_at = |light: &[f32], at: usize| -> [L; 3] {
            [L::load(&light[at..]), L::load(&light[stride + at..]), L::load(&light[2 * stride + at..])]
        };
        let narrowness = own(Guide::Narrowness);
        let own_color = light_at(own_light, at);
        let mut mean = own_color;
        if !narrowness.eq(L::splat(UNFILTERED)).all() {
            let samples = own(Guide::Samples);
            let wider = L::one() + L::splat(few_samples) / samples.max(L::one());
            let center = Center {
                object: own(Guide::Object).to_bits(),
                normal: [own(Guide::NormalX), own(Guide::NormalY), own(Guide::NormalZ)],
                inverse_depth: own(Guide::InverseDepth),
                slope: [own(Guide::SlopeX), own(Guide::SlopeY)],
                narrowness,
                light: own_color,
                by_samples: samples * L::splat(finer / (NOISE_PER_SAMPLE * NOISE_PER_SAMPLE)),
                by_variance: own(Guide::Strictness) * L::splat(finer) / (wider * wider),
            };
            let (mut weights, mut sums) = (L::zero(), [L::zero(); 3]);
            for (line, (down, of_line)) in lines.iter().zip(TAPS) {
                let Some((guides, light)) = *line else { continue };
                for (right, of_column) in TAPS {
                    let (away, place) = ([right * step, down * step], (at as i32 + right * step) as usize);
                    let color = light_at(light, place);
                    let weight =
                        center.weight(guides, stride, place, away, &color) * L::splat(of_line * of_column);
                    weights = weights + weight;
                    for channel in 0..3 {
                        sums[channel] = color[channel].mul_add(weight, sums[channel]);
                    }
                }
            }
            let scale = L::one() / weights;
            mean = [sums[0] * scale, sums[1] * scale, sums[2] * scale];
        }
        for (channel, mean) in mean.iter().enumerate() {
            mean.store(&mut to[channel * stride + at..]);
        }
    }
}

impl Center {
    /// The edge-stopping weight of a tap `right` and `down` pixels away, without the blur's own weight.
    #[inline(always)]
    fn weight(&self, guides: &[f32], stride: usize, at: usize, [right, down]: [i32; 2], color: &[L; 3]) -> L {
        let (zero, one) = (L::zero(), L::one());
        let guide = |guide: Guide| L::load(&guides[guide as usize * stride + at..]);
        let square = |a: [L; 3], b: &[L; 3]| {
            let [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
            x.mul_add(x, y.mul_add(y, z * z))
        };
        let normal = [guide(Guide::NormalX), guide(Guide::NormalY), guide(Guide::NormalZ)];
        let normal_term = square(normal, &self.normal);
        let (x, y) = (L::splat(right as f32), L::splat(down as f32));
        let predicted = self.slope[0].mul_add(x, self.slope[1] * y);
        // Above 0 even where the depth is infinite.
        let tolerance = self.inverse_depth.mul_add(L::splat(DEPTH_TOLERANCE), L::splat(1e-20));
        let tolerance = predicted.abs().mul_add(L::splat(SLOPE_TOLERANCE), tolerance);
        let depth = (guide(Guide::InverseDepth) - self.inverse_depth - predicted) / tolerance;
        // The mean of both, times √3: the norm of three equal channels.
        let brightness = (color[0] + color[1] + color[2] + self.light[0] + self.light[1] + self.light[2])
            .mul_add(L::splat(0.288_675), L::splat(1e-4));
        let strictness = (self.by_samples / (brightness * brightness)).max(self.by_variance);
        let color_term = square(*color, &self.light) * strictness;
        let far = self.narrowness * L::splat((right * right + down * down) as f32);
        let stopping = normal_term.mul_add(L::splat(NORMAL_FACTOR), depth.mul_add(depth, color_term)) + far;
        let pass = stopping.mul_add(L::splat(-0.25), one).max(zero);
        let pass = (pass * pass) * (pass * pass);
        let same = guide(Guide::Object).to_bits().equals(self.object);
        L::select(same, pass * guide(Guide::Weight), zero)
    }
}
