//! The filter's guide buffers (feature buffers), in planes from which whole packets of taps are loaded.

use crate::rows::packet;
use octray_engine::film::Picture;
use octray_engine::integrate::aovs::Plane;
use octray_engine::integrate::edge_aovs::DenoiserAovs;
use octray_engine::lane::{Bits, F32x8, Lane, Mask8};
use octray_engine::math::MISS;

type L = F32x8;
type B = <L as Lane>::Bits;

/// A plane of the guide buffers.
#[derive(Clone, Copy, Debug)]
pub enum Guide {
    /// 1/depth.
    InverseDepth,
    /// Change of 1/depth from pixel to pixel.
    SlopeX,
    SlopeY,
    NormalX,
    NormalY,
    NormalZ,
    /// Bits of the object id; [`OUTSIDE`] outside the picture.
    Object,
    /// Mean albedo, the weight of the pixel as a tap.
    Weight,
    /// One over the squared distance, in pixels, at which a tap's weight is 1/e.
    Narrowness,
    Samples,
    /// One over the squared colour range, from the variance of the neighbourhood.
    Strictness,
}

pub const GUIDES: usize = Guide::Strictness as usize + 1;

/// Padding columns left of the picture, and right of it after the last packet: at least the distance of the
/// furthest tap.
pub const PAD: usize = 8;
/// The object id outside the picture: no object has it.
const OUTSIDE: u32 = MISS - 1;
/// Lower bound of albedo when demodulating: dividing by less would amplify noise.
pub const MIN_ALBEDO: f32 = 0.02;
/// [`Guide::Narrowness`] of pixels that are not filtered.
pub const UNFILTERED: f32 = 1e30;
/// Filter radius on glossy metal as a share of the lobe's footprint, which on the picture is about the lobe's
/// width times the picture's height, where the surroundings are as far from the metal as it is from the
/// camera. Of 1, 1/2 and 1/4 it is the one that increased next to no error over a filter that hardly filters
/// smooth metal, and halved the error at a roughness of 0.2.
const SHARE_OF_LOBE: f32 = 0.25;
/// The colour range of few samples, in standard deviations of the neighbourhood. Half of it leaves 1.6 to 1.9
/// times the error after 16 and 64 samples, and 0.97 times after four (geometric means of four built-in
/// scenes).
const SIGMA_COLOR: f32 = 3.2;
/// From this number of samples on, the colour range falls with their fourth root: the neighbourhood then
/// varies more by what it shows than by noise, and filtering would do harm.
const MANY_SAMPLES: f32 = 32.0;
/// Pixels to each side over which the variance of colours is estimated.
const WINDOW: i32 = 2;

pub const NORMALS: [(Guide, Plane); 3] =
    [(Guide::NormalX, Plane::NormalX), (Guide::NormalY, Plane::NormalY), (Guide::NormalZ, Plane::NormalZ)];
pub const ALBEDO: [Plane; 3] = [Plane::AlbedoRed, Plane::AlbedoGreen, Plane::AlbedoBlue];

/// The numbers of samples that a picture's pixels are means of.
#[derive(Clone, Copy, Debug)]
pub enum Samples<'a> {
    /// The same number for all pixels.
    Same(u32),
    /// One for each pixel, row by row from the top: [`crate::History::counts`].
    Each(&'a [f32]),
}

/// A picture to be filtered, and its AOVs.
pub struct Task<'a> {
    pub picture: &'a Picture,
    samples: Samples<'a>,
    pub aovs: &'a DenoiserAovs,
    pub width: usize,
    pub height: usize,
    /// Elements from one plane of a row to the next.
    pub stride: usize,
}

impl<'a> Task<'a> {
    pub fn new(picture: &'a Picture, samples: Samples<'a>, aovs: &'a DenoiserAovs) -> Self {
        let resolution = aovs.centers().resolution();
        assert_eq!([picture.width, picture.height], resolution, "picture and AOVs differ in size");
        if let Samples::Each(counts) = samples {
            assert_eq!(counts.len(), picture.pixels.len(), "picture and samples differ in size");
        }
        let [width, height] = resolution.map(|side| side as usize);
        let stride = PAD + width.next_multiple_of(L::WIDTH) + PAD;
        Self { picture, samples, aovs, width, height, stride }
    }

    /// Fills a row of guide buffers except [`Guide::Strictness`], and of demodulated radiance.
    pub fn prepare(&self, y: usize, guides: &mut [f32], light: &mut [f32]) {
        let (width, stride) = (self.width, self.stride);
        let row = |plane| self.aovs.centers().row(plane, y as u32);
        let (zero, one) = (L::zero(), L::one());
        for at in (0..width).step_by(L::WIDTH) {
            let mut set =
                |guide: Guide, number: L| number.store(&mut guides[guide as usize * stride + PAD + at..]);
            let object = packet(row(Plane::Object), at).to_bits();
            let inverse_depth = one / packet(row(Plane::Distance), at);
            set(Guide::Object, L::from_bits(object));
            set(Guide::InverseDepth, inverse_depth);
            let [slope_x, slope_y] = self.slopes([at, y], object, inverse_depth);
            set(Guide::SlopeX, slope_x);
            set(Guide::SlopeY, slope_y);
            for (guide, plane) in NORMALS {
                set(guide, packet(row(plane), at));
            }
            let least = L::splat(MIN_ALBEDO);
            let albedo = ALBEDO.map(|plane| packet(row(plane), at).max(least));
            set(Guide::Weight, (albedo[0] + albedo[1] + albedo[2]) * L::splat(1.0 / 3.0));
            let lobe = packet(row(Plane::Lobe), at);
            let radius = lobe * L::splat(SHARE_OF_LOBE * self.height as f32);
            let narrowness = L::select(lobe.lt(one), one / (radius * radius), zero);
            // A surface that glows and scatters has noise, too, but no guide shows the edges of its emission.
            let sharp = lobe.eq(zero) | !packet(row(Plane::Scale), at).eq(zero);
            set(Guide::Narrowness, L::select(sharp, L::splat(UNFILTERED), narrowness.min(L::splat(1e20))));
            let samples = match self.samples {
                Samples::Same(samples) => L::splat(samples as f32),
                Samples::Each(samples) => packet(&samples[y * width..][..width], at),
            };
            set(Guide::Samples, samples);
            let pixels = &self.picture.pixels[y * width..][..width];
            for (channel, albedo) in albedo.iter().enumerate() {
                let radiance = L::from_fn(|lane| pixels.get(at + lane).map_or(0.0, |pixel| pixel[channel]));
                (radiance / *albedo).store(&mut light[channel * stride + PAD + at..]);
            }
        }
        self.prepare_edges(y, guides, light);
        // Outside the picture: no object, and finite, since taps of weight 0 are multiplied, too.
        for (number, plane) in guides.chunks_mut(stride).enumerate() {
            let outside = match number {
                _ if number == Guide::Object as usize => f32::from_bits(OUTSIDE),
                _ if number == Guide::Narrowness as usize => UNFILTERED,
                _ => 1.0,
            };
            clear_sides(plane, width, outside);
        }
        light.chunks_mut(stride).for_each(|plane| clear_sides(plane, width, 0.0));
    }

    /// The number of samples of a pixel, counted row by row.
    pub fn samples_of(&self, pixel: usize) -> f32 {
        match self.samples {
            Samples::Same(samples) => samples as f32,
            Samples::Each(samples) => samples[pixel],
        }
    }

    /// The slopes of 1/depth to the right and down: of the two one-sided differences on the same object, the
    /// smaller one.
    fn slopes(&self, [at, y]: [usize; 2], object: B, inverse_depth: L) -> [L; 2] {
        let line =
            |y: usize| [Plane::Distance, Plane::Object].map(|plane| self.aovs.centers().row(plane, y as u32));
        let shifted = |x: i32| {
            let [distance, objects] = line(y);
            let pixel =
                |row: &[f32], lane: usize| row.get((at + lane).wrapping_add_signed(x as isize)).copied();
            let near = L::from_fn(|lane| pixel(distance, lane).map_or(0.0, |distance| 1.0 / distance));
            let outside = f32::from_bits(OUTSIDE);
            (near, L::from_fn(|lane| pixel(objects, lane).unwrap_or(outside)).to_bits().equals(object))
        };
        let moved = |y: Option<usize>| {
            let Some(y) = y.filter(|&y| y < self.height) else {
                return (inverse_depth, B::splat(OUTSIDE).equals(object));
            };
            let [distance, objects] = line(y);
            (L::one() / packet(distance, at), packet(objects, at).to_bits().equals(object))
        };
        let lesser = |(before, before_is): (L, Mask8), (behind, behind_is): (L, Mask8)| {
            let (a, b) = (inverse_depth - before, behind - inverse_depth);
            let first = before_is & (a.abs().lt(b.abs()) | !behind_is);
            L::select(first, a, b.only(behind_is))
        };
        [lesser(shifted(-1), shifted(1)), lesser(moved(y.checked_sub(1)), moved(Some(y + 1)))]
    }

    /// Fills [`Guide::Strictness`] of a row from the variance of the neighbourhood on the same object.
    pub fn estimate_variance(&self, y: usize, guides: &mut [f32], light: &[f32]) {
        let stride = self.stride;
        let lines = (y as i32 - WINDOW).max(0)..(y as i32 + WINDOW + 1).min(self.height as i32);
        for at in (0..self.width).step_by(L::WIDTH) {
            let own = |guide: Guide| L::load(&guides[guide as usize * stride + PAD + at..]);
            let object = own(Guide::Object).to_bits();
            let (mut count, mut sum, mut squares) = (L::zero(), L::zero(), L::zero());
            for line in lines.clone() {
                let objects = self.aovs.centers().objects(line as u32);
                let light = &light[line as usize * 3 * stride..][..3 * stride];
                for right in -WINDOW..=WINDOW {
                    let x = at as i32 + right;
                    let pixel = |lane: usize| objects.get(usize::try_from(x + lane as i32).ok()?).copied();
                    let tap = match usize::try_from(x).ok().and_then(|x| objects.get(x..x + L::WIDTH)) {
                        Some(whole) => B::load(whole),
                        None => B::from_fn(|lane| pixel(lane).unwrap_or(OUTSIDE)),
                    };
                    let same = tap.equals(object);
                    let place = (PAD as i32 + x) as usize;
                    let brightness = L::load(&light[place..])
                        + L::load(&light[stride + place..])
                        + L::load(&light[2 * stride + place..]);
                    let brightness = brightness.only(same);
                    count = count + L::one().only(same);
                    sum = sum + brightness;
                    squares = brightness.mul_add(brightness, squares);
                }
            }
            // A third of the variance of the sum of three channels: three times that of one channel if they
            // are equal.
            let share = L::one() / count.max(L::one());
            let mean = sum * share;
            let variance = (squares * share - mean * mean).max(L::splat(1e-10)) * L::splat(1.0 / 3.0);
            let many = (own(Guide::Samples) * L::splat(1.0 / MANY_SAMPLES)).max(L::one());
            let strictness = many.sqrt() / (variance * L::splat(SIGMA_COLOR * SIGMA_COLOR));
            strictness.store(&mut guides[Guide::Strictness as usize * stride + PAD + at..]);
        }
    }
}

/// Fills the padding left and right of the picture's columns.
fn clear_sides(plane: &mut [f32], width: usize, outside: f32) {
    plane[..PAD].fill(outside);
    plane[PAD + width..].fill(outside);
}
