//! Noise removed and edges kept: an edge-avoiding à-trous wavelet filter.
//!
//! For: [`Denoiser`]. May import: [`mod@planes`], `rows`, `lane`, the guides of `integrate`, `film`. Must never know: cameras, renderers.
//!
//! Source: Dammertz, Sewtz, Hanika, Lensch, "Edge-Avoiding À-Trous Wavelet Transform for fast Global Illumination Filtering", HPG 2010. Each
//! level is a small blur whose taps stand twice as far apart as those of the one before. A tap weighs less, the more it differs from the pixel:
//!
//! - It counts only on the same object, and less the more its normal is turned, or its distance is another than the pixel's slope foretells
//!   (in 1/distance, which is linear on a plane: a slanted floor is no edge).
//! - It counts less if its colour differs by more than noise would make it. What noise makes is known from both the number of samples and the
//!   pixels around; it narrows by half with every level, as the noise that is left does. A picture of many samples stays nearly as it is.
//! - Less where the surface is smooth, the further it is: what a mirror shows is not at the mirror, so no guide knows its edges. At roughness 0
//!   nothing else counts, and mirrors, glass and the sky are shown as they are, bit by bit.
//!
//! Colours are filtered without the surface's own (radiance over albedo), so that textures stay sharp; a tap's weight is in
//! proportion to its albedo, because the error of the quotient is in inverse proportion.
//!
//! Three departures from the paper: a level has 3×3 taps with weights 1 2 1 (the paper's 5×5 are 2.8 times as many, for 0.8 to 1.1 times the
//! error); e^(−x) is (1 − x/4)⁴ up to 4 and 0 from there on, which is an edge that nothing crosses; and the range of colours is as told above.

mod planes;

use super::rows;
use crate::film::Picture;
use crate::integrate::aovs::{Aovs, Plane};
use crate::lane::{Bits, F32x8, Lane, Mask};
use planes::{GUIDES, Guide, LEAST_ALBEDO, NARROWEST, PAD, Task};

type L = F32x8;

/// Blurs, each twice as wide as the one before: 63 pixels in all.
const LEVELS: u32 = 5;
/// How many times a sample's brightness its noise may be, at one sample a pixel: no wider than this, whatever the pixels around say.
const NOISE_OF_A_SAMPLE: f32 = 4.0;
/// Standard deviations of the pixels around that are taken for noise, and how many times more at one sample: then few of them hold most of
/// the light, and the others seem to agree.
const SPREAD: f32 = 3.0;
const FEW_SAMPLES: f32 = 2.0;
/// Stops by normals: 1/e at a turn of 20°, nothing from 41° on.
const TURN: f32 = 8.0;
/// Stops by distance, as shares of 1/distance and of what the slope makes of it over the step.
const SLACK: f32 = 0.02;
const SLOPE_SLACK: f32 = 0.5;

/// How many samples the pixels of a picture are the means of.
#[derive(Clone, Copy, Debug)]
pub enum Samples<'a> {
    /// All of as many.
    Same(u32),
    /// Row by row from the top, as [`super::History::counts`] tells.
    Each(&'a [f32]),
}

/// The filter. Cost: 45 taps a pixel and 25 looks at its neighbours, eight pixels at once; working memory: 80 bytes a pixel with the picture.
///
/// Law: what it shows is a mean of pixels of one object, times the pixel's albedo; a picture without noise stays nearly as it is.
#[derive(Clone, Debug, Default)]
pub struct Denoiser {
    guides: Vec<f32>,
    light: Vec<f32>,
    next: Vec<f32>,
    shown: Picture,
}

impl Denoiser {
    pub fn new() -> Self {
        Self::default()
    }

    /// The picture without its noise; `guides` are those of its camera.
    ///
    /// # Panics
    /// If picture, samples and guides differ in size.
    pub fn filter(&mut self, picture: &Picture, samples: Samples, guides: &Aovs) -> &Picture {
        let task = Task::new(picture, samples, guides);
        let (stride, width) = (task.stride, task.width);
        self.guides.resize(stride * GUIDES * task.height, 0.0);
        self.light.resize(stride * 3 * task.height, 0.0);
        self.next.resize(stride * 3 * task.height, 0.0);
        let [of_guides, of_light] = [stride * GUIDES, stride * 3];
        rows::each_two((&mut self.guides, of_guides), (&mut self.light, of_light), |y, guides, light| {
            task.prepare(y, guides, light);
        });
        let light = &self.light;
        rows::each(&mut self.guides, of_guides, |y, row| task.find_spread(y, row, light));
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
            let plane = |plane| guides.row(plane, y as u32);
            let albedo = [Plane::AlbedoRed, Plane::AlbedoGreen, Plane::AlbedoBlue].map(plane);
            let narrow = &self.guides[y * of_guides + Guide::Narrowness as usize * stride + PAD..];
            for (x, pixel) in row.iter_mut().enumerate() {
                *pixel = if narrow[x] == NARROWEST {
                    picture.pixels[y * width + x]
                } else {
                    let [r, g, b] = albedo.map(|albedo| albedo[x].max(LEAST_ALBEDO));
                    [red[x] * r, green[x] * g, blue[x] * b]
                };
            }
        });
        &self.shown
    }
}

/// What a tap is held against.
struct Center {
    object: <L as Lane>::Bits,
    normal: [L; 3],
    nearness: L,
    slope: [L; 2],
    narrowness: L,
    light: [L; 3],
    /// Factors of a squared difference of colours: over the squared brightness, and by itself.
    by_samples: L,
    by_spread: L,
}

/// One row of one level.
fn level(task: &Task, step: i32, y: usize, to: &mut [f32], light: &[f32], guides: &[f32]) {
    const TAPS: [(i32, f32); 3] = [(-1, 0.25), (0, 0.5), (1, 0.25)];
    let stride = task.stride;
    let finer = (step * step) as f32;
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
        if !narrowness.eq(L::splat(NARROWEST)).all() {
            let center = Center {
                object: own(Guide::Object).to_bits(),
                normal: [own(Guide::NormalX), own(Guide::NormalY), own(Guide::NormalZ)],
                nearness: own(Guide::Nearness),
                slope: [own(Guide::SlopeX), own(Guide::SlopeY)],
                narrowness,
                light: own_color,
                by_samples: own(Guide::Samples) * L::splat(finer / (NOISE_OF_A_SAMPLE * NOISE_OF_A_SAMPLE)),
                by_spread: own(Guide::Strictness) * L::splat(finer),
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
    /// What a tap so many pixels to the right and down counts, but for its part in the blur.
    #[inline(always)]
    fn weight(&self, guides: &[f32], stride: usize, at: usize, [right, down]: [i32; 2], color: &[L; 3]) -> L {
        let (zero, one) = (L::zero(), L::one());
        let guide = |guide: Guide| L::load(&guides[guide as usize * stride + at..]);
        let square = |a: [L; 3], b: &[L; 3]| {
            let [x, y, z] = [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
            x.mul_add(x, y.mul_add(y, z * z))
        };
        let normal = [guide(Guide::NormalX), guide(Guide::NormalY), guide(Guide::NormalZ)];
        let turn = square(normal, &self.normal);
        let (x, y) = (L::splat(right as f32), L::splat(down as f32));
        let foretold = self.slope[0].mul_add(x, self.slope[1] * y);
        // Never 0, which the nearness of what is infinitely far is.
        let slack = self.nearness.mul_add(L::splat(SLACK), L::splat(1e-20));
        let slack = foretold.abs().mul_add(L::splat(SLOPE_SLACK), slack);
        let off = (guide(Guide::Nearness) - self.nearness - foretold) / slack;
        // The mean of both, times √3, as the root of the squares of three channels is.
        let brightness = (color[0] + color[1] + color[2] + self.light[0] + self.light[1] + self.light[2])
            .mul_add(L::splat(0.288_675), L::splat(1e-4));
        let strictness = (self.by_samples / (brightness * brightness)).max(self.by_spread);
        let differs = square(*color, &self.light) * strictness;
        let far = self.narrowness * L::splat((right * right + down * down) as f32);
        let stop = turn.mul_add(L::splat(TURN), off.mul_add(off, differs)) + far;
        let pass = stop.mul_add(L::splat(-0.25), one).max(zero);
        let pass = (pass * pass) * (pass * pass);
        let same = guide(Guide::Object).to_bits().equals(self.object);
        L::select(same, pass * guide(Guide::Weight), zero)
    }
}
