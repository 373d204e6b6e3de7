//! Counter-based random numbers. They have no state, so no order of evaluation can change them.
//!
//! The key of a path is a hash of seed, pixel and sample; its value in a dimension is a hash of the key and
//! the dimension. For one seed the key is a bijection of the sample in every pixel, and of the pixel at every
//! sample: no two samples of a pixel share their values, nor do two pixels at the same sample. There are 2³²
//! keys, so a sample of one pixel may share its values with another sample of another pixel. Pixel and sample
//! are hashed one after the other, so that such pairs form no pattern. They bias no pixel.

use crate::lane::{Bits, Lane};

/// 2³² divided by the golden ratio, odd: its multiples are evenly spread.
pub(super) const GOLDEN: u32 = 0x9e37_79b9;
/// An odd number unrelated to [`GOLDEN`].
const STRIDE: u32 = 0x85eb_ca6b;

/// Hashes 32 bits by a bijection; one changed input bit changes half of the output bits on average.
///
/// Source: C. Wellons, "Prospecting for hash functions", 2018 (two rounds, bias 0.17).
#[inline(always)]
pub fn mix_bits<B: Bits>(x: B) -> B {
    let x = x ^ x.shr(16);
    let x = x.wrapping_mul(B::splat(0x7feb_352d));
    let x = x ^ x.shr(15);
    let x = x.wrapping_mul(B::splat(0x846c_a68b));
    x ^ x.shr(16)
}

/// Returns the keys of the pixels with these indices (y · width + x): for one seed a bijection. They are not
/// hashed; values derived from them are.
#[inline(always)]
pub fn pixel_key<B: Bits>(seed: u32, pixel: B) -> B {
    pixel ^ B::splat(seed_key(seed))
}

/// Returns the key of values that the pixels of an image share: a bijection of the seed.
#[inline(always)]
pub(super) fn seed_key(seed: u32) -> u32 {
    mix_bits(seed.wrapping_mul(GOLDEN).wrapping_add(STRIDE))
}

/// Returns the keys of paths of sample `sample` through the pixels with these indices: see the module's docs.
#[inline(always)]
pub fn path_key<B: Bits>(seed: u32, pixel: B, sample: u32) -> B {
    mix_bits(mix_bits(pixel_key(seed, pixel)).wrapping_add(B::splat(sample.wrapping_mul(GOLDEN))))
}

/// Returns the value of each path in `dimension`: uniform in [0, 1), a multiple of 2⁻²⁴, never 1.
#[inline(always)]
pub fn uniform<L: Lane>(key: L::Bits, dimension: u32) -> L {
    unit_interval(hash(key, dimension))
}

/// Returns 32 random bits for each key in `dimension`.
#[inline(always)]
pub(super) fn hash<B: Bits>(key: B, dimension: u32) -> B {
    mix_bits(key.wrapping_add(B::splat((dimension + 1).wrapping_mul(STRIDE))))
}

/// Returns a number for the decision of a path's segment at the hit `hit`, uniform in [0, 1): a hash of the
/// key, the sample, the bounce and the hit. It uses no dimension of a sampler, because a segment may have any
/// number of hits. The sample counts twice if it is part of the key already.
pub fn hit_number(key: u32, sample: u32, bounce: u32, hit: u32) -> f32 {
    let path = mix_bits(mix_bits(key).wrapping_add(sample.wrapping_mul(GOLDEN)));
    let segment = mix_bits(path.wrapping_add((bounce + 1).wrapping_mul(STRIDE)));
    unit_interval::<f32>(mix_bits(segment.wrapping_add(hit.wrapping_mul(GOLDEN))))
}

/// Returns the upper 24 bits as a number in [0, 1).
#[inline(always)]
pub fn unit_interval<L: Lane>(bits: L::Bits) -> L {
    L::from_int(bits.shr(8)) * L::splat(1.0 / 16_777_216.0)
}
