//! Two-dimensional Sobol points, Owen-scrambled and padded: stratified in each pair of dimensions,
//! independent between pairs.
//!
//! In every pixel and every pair of dimensions the first 2ᵏ samples, for every k, are a (0, k, 2)-net in base
//! 2: each elementary interval of area 2⁻ᵏ (2ᵏ × 1, 2ᵏ⁻¹ × 2, … 1 × 2ᵏ) holds exactly one of them. Owen
//! scrambling keeps that property and makes each point uniform. Estimates therefore have no bias, and for
//! smooth functions of the square the variance falls with n⁻³, faster than that of independent values.
//! Padding gains nothing between pairs of dimensions: each pair takes the points in an order of its own (a
//! shuffle). It has one cost: samples 2i and 2i + 1 lie in opposite halves in every dimension, so a function
//! that is only the product of two halves gets twice its variance. Points of four, six and all dimensions
//! (Sobol's, over the dimensions of one event or of neighbouring events) were tried: `scenes/cornell.json`
//! gets 1 % less noise from them, not worth the loss of the nets.
//!
//! # Construction
//! Shuffle and scrambling are the same in all pixels ([`point`], once for all packets). Each pixel adds a
//! digital shift to all its points (a Cranley-Patterson rotation in base 2, by exclusive or). Over all seeds
//! the points of one pixel are scrambled as Owen's are. Before the first bounce the shifts of neighbours
//! spread as the points of a net do ([`super::blue_noise`]); later they are random ([`shift`]): for every
//! seed each point is uniform over the pixels, and the errors of different pixels are independent. Points
//! therefore cost no more than independent values. Scrambling the points of each pixel separately gave the
//! same noise at four times the cost (measured).
//!
//! Words are scrambled with their digits reversed: bit j is digit j after the point. A hash in which only
//! lower bits change a bit (sums and products, no right shifts) is then an Owen scrambling (S. Laine, T.
//! Karras, "Stratified Sampling for Stochastic Transparency", 2011, §3.2).
//!
//! Sources: B. Burley, "Practical Hash-based Owen Scrambling", JCGT 2020 (shuffling, padding); N. Vegdahl,
//! "Building a Better LK Hash", 2021 (constants and form of the hash); A. B. Owen, "Scrambled Net Variance
//! for Integrals of Smooth Functions", 1997.

use super::random::{GOLDEN, hash, mix_bits, seed_key, unit_interval};
use crate::lane::{Bits, Lane};

/// Returns the point of sample `sample` in dimensions `dimension` (even) and `dimension + 1`, before the
/// digital shift.
///
/// Units: 2⁻³².
///
/// Domain: the points repeat after 2³² samples.
#[inline(always)]
pub fn point(seed: u32, sample: u32, dimension: u32) -> [u32; 2] {
    let shuffle_seed = hash(seed_key(seed), dimension);
    let x_seed = mix_bits(shuffle_seed);
    let y_seed = mix_bits(x_seed);
    // The first Sobol dimension is the radical inverse: the bits of the index in reverse order.
    let index = owen_scramble(sample.reverse_bits(), shuffle_seed).reverse_bits();
    [
        owen_scramble(index, x_seed).reverse_bits(),
        owen_scramble(second_dimension(index), y_seed).reverse_bits(),
    ]
}

/// Returns the digital shifts of the pixels with these keys. `dimension` is the first of the pair.
#[inline(always)]
pub fn shift<B: Bits>(key: B, dimension: u32) -> [B; 2] {
    let x = hash(key, dimension);
    [x, x.wrapping_mul(B::splat(GOLDEN))]
}

/// Applies a digital shift to a point of [`point`]; the results are multiples of 2⁻²⁴ in [0, 1).
///
/// Domain: nets of more than 2²⁴ points are truncated to the 24 bits of a float.
#[inline(always)]
pub fn shifted<L: Lane>([x, y]: [u32; 2], [shift_x, shift_y]: [L::Bits; 2]) -> (L, L) {
    (unit_interval(L::Bits::splat(x) ^ shift_x), unit_interval(L::Bits::splat(y) ^ shift_y))
}

/// Applies Owen scrambling to reversed digits, by Vegdahl's hash.
#[inline(always)]
fn owen_scramble(x: u32, seed: u32) -> u32 {
    // A sum, and a product with an odd number, that depend on the seed; x ^ x · even is a bijection too.
    let mix = |x: u32, factor: u32| x ^ x.wrapping_mul(factor);
    let x = mix(x, 0x3d20_adea).wrapping_add(seed);
    let x = x.wrapping_mul(seed >> 16 | 1);
    mix(mix(x, 0x0552_6c56), 0x53a2_2864)
}

/// Returns the second Sobol dimension of an index, digits reversed: digit k is the sum modulo 2 of the bits j
/// of the index with C(j, k) odd.
///
/// C(j, k) is odd if the bits of k are among those of j (Lucas), so that Pascal's triangle modulo 2 is a
/// Kronecker power of its 2 × 2 corner, and one step for each bit of j is enough (A. Ahmed, "An
/// Implementation Algorithm of 2D Sobol Sequence Fast, Elegant, and Compact", 2024).
#[inline(always)]
pub(super) fn second_dimension(index: u32) -> u32 {
    let fold = |x: u32, count: u32, low: u32| x ^ (x >> count & low);
    let x = index ^ index >> 16;
    let x = fold(x, 8, 0x00ff_00ff);
    let x = fold(x, 4, 0x0f0f_0f0f);
    let x = fold(x, 2, 0x3333_3333);
    fold(x, 1, 0x5555_5555)
}
