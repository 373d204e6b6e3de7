//! Padded two-dimensional Sobol points, Owen-scrambled: well spread in each pair of dimensions, independent between pairs.
//!
//! In every pixel and every pair of dimensions the first 2ᵏ samples, whatever k, are a (0, k, 2)-net in base 2: each of the boxes of area
//! 2⁻ᵏ that halvings of the square make (2ᵏ × 1, 2ᵏ⁻¹ × 2, … 1 × 2ᵏ) holds exactly one of them. Owen's scrambling keeps that
//! and makes each point uniform, so that estimates have no bias, and their variance falls faster than that of
//! independent numbers: with n⁻³ for smooth functions of the square. Between pairs of dimensions nothing is gained: each pair takes
//! the points in an order of its own. Nor is there anything to lose but one thing: samples 2i and 2i + 1 lie in
//! opposite halves in every dimension, so that a function of nothing but the product of two halves gets twice its variance.
//! Points of four, six and all dimensions (Sobol's, the numbers of an event or of neighbouring events together) were tried: the box of
//! `scenes/cornell.json` gets 1 % less noise from them, not worth the loss of the nets.
//!
//! # How
//! Where a point comes in the order, and its scrambling, is the same in all pixels ([`point`], once for all packets). What each pixel
//! has of its own is a digital shift: random digits added to those of all its points. Of one pixel the points are
//! scrambled as Owen's are, over all seeds; and whatever the seed, each is uniform over pixels, and errors of pixels have nothing to do with
//! each other. So points cost no more than independent numbers. Scrambling every pixel's points for themselves was measured: the same noise, at four times the
//! cost.
//!
//! Words are scrambled with their digits reversed: bit j is digit j after the point. A hash in which bits are changed only by bits
//! below them (sums, products, and nothing that shifts to the right) is then an Owen scrambling (S. Laine, T. Karras, "Stratified Sampling for
//! Stochastic Transparency", 2011, §3.2).
//!
//! Sources: B. Burley, "Practical Hash-based Owen Scrambling", JCGT 2020 (shuffling, padding); N. Vegdahl, "Building a Better LK Hash",
//! 2021 (constants and form of the hash); A. B. Owen, "Scrambled Net Variance for Integrals of Smooth Functions", 1997.

use super::random::{GOLDEN, hashed, mix, seed_key, unit_interval};
use crate::lane::{Bits, Lane};

/// The point of sample `sample` in the dimensions `dimension` (even) and `dimension + 1` before it is shifted: two fractions / 2⁻³².
///
/// Domain: the points repeat after 2³² samples.
#[inline(always)]
pub fn point(seed: u32, sample: u32, dimension: u32) -> [u32; 2] {
    let order = hashed(seed_key(seed), dimension);
    let across = mix(order);
    let index = scramble(sample.reverse_bits(), order).reverse_bits();
    [scramble(index, across).reverse_bits(), scramble(pascal(index), mix(across)).reverse_bits()]
}

/// A point of [`point`], shifted for the pixels with these keys: multiples of 2⁻²⁴ in [0, 1). `dimension` is the first of both.
///
/// Domain: nets of more than 2²⁴ points are cut to the 24 bits of a float.
#[inline(always)]
pub fn pair<L: Lane>(key: L::Bits, [x, y]: [u32; 2], dimension: u32) -> (L, L) {
    let across = hashed(key, dimension);
    let down = across.wrapping_mul(L::Bits::splat(GOLDEN));
    (unit_interval(L::Bits::splat(x) ^ across), unit_interval(L::Bits::splat(y) ^ down))
}

/// Vegdahl's hash: Owen scrambling of reversed digits.
#[inline(always)]
fn scramble(x: u32, seed: u32) -> u32 {
    // A sum and a product with an odd number that depend on the seed; then three products with even ones, which can be undone.
    let spread = |x: u32, factor: u32| x ^ x.wrapping_mul(factor);
    let x = spread(x, 0x3d20_adea).wrapping_add(seed);
    let x = x.wrapping_mul(seed >> 16 | 1);
    spread(spread(x, 0x0552_6c56), 0x53a2_2864)
}

/// The second Sobol dimension of an index, digits reversed: digit k is the sum modulo 2 of the index's bits j with C(j, k) odd.
///
/// C(j, k) is odd where the bits of k are among those of j (Lucas), so that Pascal's triangle modulo 2 is a Kronecker power of its 2 × 2
/// corner, and one step for each bit of j is enough (A. Ahmed, "An Implementation Algorithm of 2D Sobol Sequence Fast, Elegant,
/// and Compact", 2024).
#[inline(always)]
fn pascal(index: u32) -> u32 {
    let fold = |x: u32, count: u32, low: u32| x ^ (x >> count & low);
    let x = index ^ index >> 16;
    let x = fold(x, 8, 0x00ff_00ff);
    let x = fold(x, 4, 0x0f0f_0f0f);
    let x = fold(x, 2, 0x3333_3333);
    fold(x, 1, 0x5555_5555)
}
