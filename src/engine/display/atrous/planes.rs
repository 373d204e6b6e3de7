//! What guides the filter, in planes that whole packets of taps are loaded from.
//!
//! For: [`Task`], [`Guide`]. May import: `rows`, `lane`, the guides of `integrate`, `film`. Must never know: the levels.

use super::super::rows::packet;
use super::{FEW_SAMPLES, SPREAD, Samples};
use crate::film::Picture;
use crate::integrate::aovs::{Aovs, Plane};
use crate::lane::{Bits, F32x8, Lane, Mask8};
use crate::math::MISS;

type L = F32x8;
type B = <L as Lane>::Bits;

/// One number of every pixel.
#[derive(Clone, Copy, Debug)]
pub enum Guide {
    /// 1/distance.
    Nearness,
    /// What it grows by from pixel to pixel.
    SlopeX,
    SlopeY,
    NormalX,
    NormalY,
    NormalZ,
    /// Bits of the object; [`NOTHING`] beside the picture.
    Object,
    /// Mean albedo.
    Weight,
    /// Over the squared distance in pixels at which a tap counts 1/e.
    Narrowness,
    Samples,
    /// Over the squared difference of colours that the pixels around show.
    Strictness,
}

pub const GUIDES: usize = Guide::Strictness as usize + 1;

/// Columns left of the picture and, besides the rest of the last packet, right of it: no tap is further away.
pub const PAD: usize = 16;
/// No object has this number.
const NOTHING: u32 = MISS - 1;
/// What is darker is taken to be as bright: its radiance says little of the light.
pub const LEAST_ALBEDO: f32 = 0.02;
/// [`Guide::Narrowness`] of what is not filtered.
pub const NARROWEST: f32 = 1e30;
/// What a pixel shows on metal is spread as wide as its lobe: on the picture about the lobe's width times the picture's height, where the
/// surroundings are as far from the metal as it is from the camera. Within this share of it pixels show nearly the same. Of 1, 1/2 and 1/4 it
/// is the one that made next to nothing worse than a filter that all but left smooth metal alone, and halved the error at a roughness of 0.2.
const SHARE_OF_LOBE: f32 = 0.25;
/// Pixels to each side in which the spread of colours is found.
const WINDOW: i32 = 2;

const NORMALS: [(Guide, Plane); 3] =
    [(Guide::NormalX, Plane::NormalX), (Guide::NormalY, Plane::NormalY), (Guide::NormalZ, Plane::NormalZ)];
const ALBEDO: [Plane; 3] = [Plane::AlbedoRed, Plane::AlbedoGreen, Plane::AlbedoBlue];

/// A picture to be filtered.
pub struct Task<'a> {
    picture: &'a Picture,
    samples: Samples<'a>,
    guides: &'a Aovs,
    pub width: usize,
    pub height: usize,
    /// From one plane of a row to the next.
    pub stride: usize,
}

impl<'a> Task<'a> {
    pub fn new(picture: &'a Picture, samples: Samples<'a>, guides: &'a Aovs) -> Self {
        assert_eq!([picture.width, picture.height], guides.resolution(), "a picture and its guides");
        if let Samples::Each(counts) = samples {
            assert_eq!(counts.len(), picture.pixels.len(), "a picture and its samples");
        }
        let [width, height] = guides.resolution().map(|side| side as usize);
        let stride = PAD + width.next_multiple_of(L::WIDTH) + PAD;
        Self { picture, samples, guides, width, height, stride }
    }

    /// Fills a row of guides, but for [`Guide::Strictness`], and of light: radiance over albedo.
    pub fn prepare(&self, y: usize, guides: &mut [f32], light: &mut [f32]) {
        let (width, stride) = (self.width, self.stride);
        let row = |plane| self.guides.row(plane, y as u32);
        let (zero, one) = (L::zero(), L::one());
        for at in (0..width).step_by(L::WIDTH) {
            let mut set =
                |guide: Guide, number: L| number.store(&mut guides[guide as usize * stride + PAD + at..]);
            let object = packet(row(Plane::Object), at).to_bits();
            let nearness = one / packet(row(Plane::Distance), at);
            set(Guide::Object, L::from_bits(object));
            set(Guide::Nearness, nearness);
            let [slope_x, slope_y] = self.slopes([at, y], object, nearness);
            set(Guide::SlopeX, slope_x);
            set(Guide::SlopeY, slope_y);
            for (guide, plane) in NORMALS {
                set(guide, packet(row(plane), at));
            }
            let least = L::splat(LEAST_ALBEDO);
            let albedo = ALBEDO.map(|plane| packet(row(plane), at).max(least));
            set(Guide::Weight, (albedo[0] + albedo[1] + albedo[2]) * L::splat(1.0 / 3.0));
            let lobe = packet(row(Plane::Lobe), at);
            let reach = lobe * L::splat(SHARE_OF_LOBE * self.height as f32);
            let narrowness = L::select(lobe.lt(one), one / (reach * reach), zero);
            let sharp = object.equals(B::splat(MISS)) | lobe.eq(zero);
            set(Guide::Narrowness, L::select(sharp, L::splat(NARROWEST), narrowness.min(L::splat(1e20))));
            set(
                Guide::Samples,
                match self.samples {
                    Samples::Same(samples) => L::splat(samples as f32),
                    Samples::Each(samples) => packet(&samples[y * width..][..width], at),
                },
            );
            let pixels = &self.picture.pixels[y * width..][..width];
            for (channel, albedo) in albedo.iter().enumerate() {
                let radiance = L::from_fn(|lane| pixels.get(at + lane).map_or(0.0, |pixel| pixel[channel]));
                (radiance / *albedo).store(&mut light[channel * stride + PAD + at..]);
            }
        }
        // Beside the picture: of no object, and finite, since even what counts nothing is multiplied.
        for (number, plane) in guides.chunks_mut(stride).enumerate() {
            let outside = match number {
                _ if number == Guide::Object as usize => f32::from_bits(NOTHING),
                _ if number == Guide::Narrowness as usize => NARROWEST,
                _ => 1.0,
            };
            clear_sides(plane, width, outside);
        }
        light.chunks_mut(stride).for_each(|plane| clear_sides(plane, width, 0.0));
    }

    /// What the nearness grows by to the right and down: the lesser one of the two sides that are on the same object.
    fn slopes(&self, [at, y]: [usize; 2], object: B, nearness: L) -> [L; 2] {
        let line = |y: usize| [Plane::Distance, Plane::Object].map(|plane| self.guides.row(plane, y as u32));
        let shifted = |x: i32| {
            let [distance, objects] = line(y);
            let pixel =
                |row: &[f32], lane: usize| row.get((at + lane).wrapping_add_signed(x as isize)).copied();
            let near = L::from_fn(|lane| pixel(distance, lane).map_or(0.0, |distance| 1.0 / distance));
            let nothing = f32::from_bits(NOTHING);
            (near, L::from_fn(|lane| pixel(objects, lane).unwrap_or(nothing)).to_bits().equals(object))
        };
        let moved = |y: Option<usize>| {
            let Some(y) = y.filter(|&y| y < self.height) else {
                return (nearness, B::splat(NOTHING).equals(object));
            };
            let [distance, objects] = line(y);
            (L::one() / packet(distance, at), packet(objects, at).to_bits().equals(object))
        };
        let lesser = |(before, before_is): (L, Mask8), (behind, behind_is): (L, Mask8)| {
            let (a, b) = (nearness - before, behind - nearness);
            let first = before_is & (a.abs().lt(b.abs()) | !behind_is);
            L::select(first, a, b.only(behind_is))
        };
        [lesser(shifted(-1), shifted(1)), lesser(moved(y.checked_sub(1)), moved(Some(y + 1)))]
    }

    /// Fills [`Guide::Strictness`] of a row: how far the light of the pixels around differs on the same object.
    pub fn find_spread(&self, y: usize, guides: &mut [f32], light: &[f32]) {
        let stride = self.stride;
        let lines = (y as i32 - WINDOW).max(0)..(y as i32 + WINDOW + 1).min(self.height as i32);
        for at in (0..self.width).step_by(L::WIDTH) {
            let own = |guide: Guide| L::load(&guides[guide as usize * stride + PAD + at..]);
            let object = own(Guide::Object).to_bits();
            let (mut count, mut sum, mut squares) = (L::zero(), L::zero(), L::zero());
            for line in lines.clone() {
                let objects = self.guides.objects(line as u32);
                let light = &light[line as usize * 3 * stride..][..3 * stride];
                for right in -WINDOW..=WINDOW {
                    let x = at as i32 + right;
                    let tap = match usize::try_from(x).ok().and_then(|x| objects.get(x..x + L::WIDTH)) {
                        Some(whole) => B::load(whole),
                        None => B::from_fn(|lane| {
                            usize::try_from(x + lane as i32)
                                .ok()
                                .and_then(|x| objects.get(x))
                                .copied()
                                .unwrap_or(NOTHING)
                        }),
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
            // A third of the variance of the sum of three channels: that of one, thrice, if they are alike.
            let share = L::one() / count.max(L::one());
            let mean = sum * share;
            let variance = (squares * share - mean * mean).max(L::splat(1e-10)) * L::splat(1.0 / 3.0);
            let more = L::splat(FEW_SAMPLES) / own(Guide::Samples).max(L::one()) + L::one();
            let spread = more * more * L::splat(SPREAD * SPREAD);
            let strictness = L::one() / (variance * spread);
            strictness.store(&mut guides[Guide::Strictness as usize * stride + PAD + at..]);
        }
    }
}

/// Fills what is left and right of the picture's columns.
fn clear_sides(plane: &mut [f32], width: usize, outside: f32) {
    plane[..PAD].fill(outside);
    plane[PAD + width..].fill(outside);
}
