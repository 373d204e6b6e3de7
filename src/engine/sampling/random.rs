//! Counter-based random numbers: no state, so no order of evaluation can change them.
//!
//! A path's key mixes seed, pixel and sample; number `dimension` of the path is a mix of its key and the dimension. For one
//! seed the key is a bijection of the sample in every pixel, and of the pixel at every sample: no two samples of a pixel share their
//! numbers, nor do two pixels of a frame. There are 2³² keys, so a sample of one pixel may share them with another sample of some other
//! pixel; pixels and samples are mixed one after the other, so that such pairs stand nowhere in rows. They bias no pixel.
//!
//! # Dimensions
//! They come in pairs, an even one and the next, which [`super::sobol`] spreads together. [`PIXEL`] (a pair) places the sample in
//! its pixel. Scattering event b, counted from 0, owns the [`PER_BOUNCE`] numbers from [`bounce`]`(b)` on: [`LOBE`] chooses
//! between the lobes of a material, [`DIRECTION`] (a pair) gives the new direction and [`LIGHT_POINT`] (a pair) the light and the point on
//! it; among many lights [`LIGHT`] (with [`LOBE`] a pair) and [`LIGHT_AGAIN`] choose; 7 is free.

use crate::lane::{Bits, Lane};

/// A pair: where in the pixel.
pub const PIXEL: u32 = 0;
/// Numbers that belong to one scattering event; even, so that pairs stay pairs.
pub const PER_BOUNCE: u32 = 8;
/// Within an event: reflect or refract.
pub const LOBE: u32 = 0;
/// Within an event: which light, where [`LIGHT_POINT`] has too few digits for light and point.
pub const LIGHT: u32 = 1;
/// Within an event, a pair: the new direction.
pub const DIRECTION: u32 = 2;
/// Within an event, a pair: which light, and where on it.
pub const LIGHT_POINT: u32 = 4;
/// Within an event: which of two lights, where [`LIGHT`] chose both.
pub const LIGHT_AGAIN: u32 = 6;

/// 2³² divided by the golden ratio, odd: multiples spread evenly.
pub(super) const GOLDEN: u32 = 0x9e37_79b9;
/// Odd, and unrelated to [`GOLDEN`].
const STRIDE: u32 = 0x85eb_ca6b;

/// First dimension of scattering event `bounce`, counted from 0.
#[inline(always)]
pub const fn bounce(bounce: u32) -> u32 {
    PER_BOUNCE * (bounce + 1)
}

/// A bijection of 32 bits that changes half of the output bits on average when one input bit changes.
///
/// Source: C. Wellons, "Prospecting for hash functions", 2018 (two rounds, bias 0.17).
#[inline(always)]
pub fn mix<B: Bits>(x: B) -> B {
    let x = x ^ x.shr(16);
    let x = x.wrapping_mul(B::splat(0x7feb_352d));
    let x = x ^ x.shr(15);
    let x = x.wrapping_mul(B::splat(0x846c_a68b));
    x ^ x.shr(16)
}

/// The key of the pixels with these indices (y · width + x): for one seed a bijection.
#[inline(always)]
pub fn pixel_key<B: Bits>(seed: u32, pixel: B) -> B {
    mix(pixel ^ B::splat(seed_key(seed)))
}

/// The key of all that the pixels of a picture share: a bijection.
#[inline(always)]
pub(super) fn seed_key(seed: u32) -> u32 {
    mix(seed.wrapping_mul(GOLDEN).wrapping_add(STRIDE))
}

/// The key of the paths of sample `sample` in the pixels with these indices.
#[inline(always)]
pub fn path_key<B: Bits>(seed: u32, pixel: B, sample: u32) -> B {
    mix(pixel_key(seed, pixel).wrapping_add(B::splat(sample.wrapping_mul(GOLDEN))))
}

/// Number `dimension` of each path, uniform in [0, 1): a multiple of 2⁻²⁴, never 1.
#[inline(always)]
pub fn uniform<L: Lane>(key: L::Bits, dimension: u32) -> L {
    unit_interval(hashed(key, dimension))
}

/// 32 bits for each key in dimension `dimension`.
#[inline(always)]
pub(super) fn hashed<B: Bits>(key: B, dimension: u32) -> B {
    mix(key.wrapping_add(B::splat((dimension + 1).wrapping_mul(STRIDE))))
}

/// The upper 24 bits as a number in [0, 1).
#[inline(always)]
pub fn unit_interval<L: Lane>(bits: L::Bits) -> L {
    L::from_int(bits.shr(8)) * L::splat(1.0 / 16_777_216.0)
}
