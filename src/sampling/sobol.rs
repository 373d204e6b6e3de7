//! Padded two-dimensional Sobol points, Owen-scrambled: well spread in each pair of dimensions, independent between pairs.
//!
//! In every pixel and every pair of dimensions the first 2ᵏ samples, whatever k, are a (0, k, 2)-net in base 2: each of the boxes of area
//! 2⁻ᵏ that halvings of the square make (2ᵏ × 1, 2ᵏ⁻¹ × 2, … 1 × 2ᵏ) holds exactly one of them. Owen's scrambling keeps that
//! and makes each point uniform, so that estimates have no bias, and their variance falls faster than that of
//! independent numbers: with n⁻³ for smooth functions of the square. Between pairs of dimensions nothing is gained: each pair takes
//! the points in an order of its own. Nor is there anything to lose but one thing: samples 2i and 2i + 1 lie in
//! opposite halves in every dimension, so that a function of nothing but the product of two halves gets twice its variance.
//!
//! # How
//! Words are read with their digits reversed: bit j is digit j after the point. A hash in which bits are changed only by bits below
//! them (sums, products, and nothing that shifts to the right) is then an Owen scrambling (S. Laine, T. Karras, "Stratified Sampling for
//! Stochastic Transparency", 2011, §3.2). The sample's number is the same in all lanes, so the hash that shuffles it is a full
//! one of a single number for each pair of dimensions, and one sum and one product for each pixel.
//!
//! Sources: B. Burley, "Practical Hash-based Owen Scrambling", JCGT 2020 (shuffling, padding); N. Vegdahl, "Building a Better LK Hash",
//! 2021 (constants and form of the hash); A. B. Owen, "Scrambled Net Variance for Integrals of Smooth Functions", 1997.

use super::random::{GOLDEN, hashed, unit_interval};
use crate::lane::{Bits, Lane};

/// Sample `sample` of the pixels with these keys, in the dimensions `dimension` (even) and `dimension + 1`: multiples of 2⁻²⁴ in [0, 1).
///
/// Domain: the points of one pixel repeat after 2³² samples; nets of more than 2²⁴ points are cut to the 24 bits of a float.
#[inline(always)]
pub fn pair<L: Lane>(key: L::Bits, sample: u32, dimension: u32) -> (L, L) {
    let first = hashed(key, dimension);
    // The low bits, which decide the first digits, come from high ones of `first`, so that both coordinates differ.
    let product = first.wrapping_mul(L::Bits::splat(GOLDEN));
    let second = product ^ product.shr(15);

    let order = shuffle(sample.reverse_bits(), hashed(0, dimension));
    let index = step(L::Bits::splat(order), first).reverse();
    let x = scramble(index, first).reverse();
    let y = scramble(pascal(index), second).reverse();
    (unit_interval(x), unit_interval(y))
}

/// Vegdahl's hash, whole: Owen scrambling of reversed digits.
#[inline(always)]
fn shuffle(x: u32, seed: u32) -> u32 {
    scramble(spread(x, 0x3d20_adea), seed)
}

/// The hash without its first round, which what is shuffled already does not need: mean square and tails of the error of integrals are those
/// of a true Owen scrambling (measured). With one round less the mean square is still the same, and the tails are heavier: the
/// fourth moment of the error is up to twice as large.
#[inline(always)]
fn scramble<B: Bits>(x: B, seed: B) -> B {
    spread(spread(step(x, seed), 0x0552_6c56), 0x53a2_2864)
}

/// The round that depends on the seed: a sum and a product with an odd number.
#[inline(always)]
fn step<B: Bits>(x: B, seed: B) -> B {
    x.wrapping_add(seed).wrapping_mul(seed.shr(16) | B::splat(1))
}

/// A round without the seed; `factor` is even, so that it can be undone.
#[inline(always)]
fn spread<B: Bits>(x: B, factor: u32) -> B {
    x ^ x.wrapping_mul(B::splat(factor))
}

/// The second Sobol dimension of an index, digits reversed: digit k is the sum modulo 2 of the index's bits j with C(j, k) odd.
///
/// C(j, k) is odd where the bits of k are among those of j (Lucas), so that Pascal's triangle modulo 2 is a Kronecker power of its 2 × 2
/// corner, and one step for each bit of j is enough (A. Ahmed, "An Implementation Algorithm of 2D Sobol Sequence Fast, Elegant,
/// and Compact", 2024).
#[inline(always)]
fn pascal<B: Bits>(index: B) -> B {
    let fold = |x: B, count: u32, low: u32| x ^ (x.shr(count) & B::splat(low));
    let x = index ^ index.shr(16);
    let x = fold(x, 8, 0x00ff_00ff);
    let x = fold(x, 4, 0x0f0f_0f0f);
    let x = fold(x, 2, 0x3333_3333);
    fold(x, 1, 0x5555_5555)
}
