//! The digital shifts of the pixels in the first dimensions of a path: shifts of neighbours differ like the
//! points of a net, so that their errors cancel in a blur (blue noise).
//!
//! # Construction
//! The pixels of a square of [`SIZE`]² are numbered along a Z-order curve whose quadrants are permuted at
//! random at every level. Pixel number i gets the Sobol point i as its shift. In every aligned block of 2ᵏ ×
//! 2ᵏ pixels the same sample's points are therefore a (0, 2k, 2)-net: a block's error after a blur is the
//! error of a net of that many points (A. Ahmed, P. Wonka, "Screen-Space Blue-Noise Diffusion of Monte Carlo
//! Sampling Error via Hierarchical Ordering of Pixels", 2020).
//!
//! After 2ʲ samples the first digits of the shift no longer matter: the points of a pixel hold every
//! combination of them. The digits behind them matter, so these must spread over neighbours as well. A
//! triangular digit scrambling (`POLYNOMIALS`), which keeps the net property (J. Matoušek 1998), takes the
//! digits that change from pixel to pixel into all later ones. The variance of the mean over 4 × 4 pixels is
//! below that of independent shifts by a factor of 660, 170, 59, 20, 4.6 for a smooth function at 1, 2, 4, 8,
//! 16 samples (without the scrambling 20, 6.0, 1.6, 0.4, 0.1), and of 12, 5.0, 4.4, 2.4, 1.7 for an edge
//! (5.5, 2.0, 1.7, 1.0, 0.6).
//!
//! All pairs of dimensions read one table, each at an offset of its own: quadrants are permuted at random, so
//! the table's values at an offset have nothing in common with those without it. The table repeats after
//! [`SIZE`] pixels: pixels so far apart have the same values, and a mean over larger areas gains nothing from
//! them.

use super::random::{mix_bits, seed_key};
use super::sobol::second_dimension;
use crate::lane::{Bits, Lane};
use std::sync::LazyLock;

/// The number of pixels after which shifts repeat, in both directions; a power of two.
pub const SIZE: u32 = 128;
/// The number of digits of a pixel's number in the square.
const DIGITS: u32 = 2 * SIZE.ilog2();
/// The columns of a strip. The table is stored strip by strip, each row by row, so that the pixels of a block
/// are contiguous.
pub const STRIP: u32 = 4;
/// The distance from one strip to the next: behind each are the rows of the next period that the widest
/// packet, of sixteen pixels, reaches.
const STRIDE: u32 = STRIP * (SIZE + 16 / STRIP);
const LENGTH: usize = (SIZE / STRIP * STRIDE) as usize;

/// The triangular scrambling of each dimension: bit j is the share that the digit j places before has. They
/// are the pair, of 60 random ones, with the smallest errors of blocks of 4 × 4 and 2 × 2 pixels, for a
/// smooth function, an edge and a disc, at 1 to 16 samples.
const POLYNOMIALS: [u32; 2] = [0x8a4d_058b, 0x02c9_3a6b];

/// The shifts of all pixels: the upper half of a word is the shift of the pair's first dimension, the lower
/// half that of its second.
#[derive(Debug)]
#[repr(align(64))]
pub struct Shifts([u32; LENGTH]);

static SHIFTS: LazyLock<Box<Shifts>> = LazyLock::new(table);

/// Returns the table, which is computed once.
pub fn shifts() -> &'static Shifts {
    &SHIFTS
}

/// The coordinates of a packet's pixels in the picture.
#[derive(Clone, Copy, Debug)]
#[allow(missing_docs)] // The variants' text explains their fields.
pub enum PixelCoordinates<L: Lane> {
    /// Rows of [`STRIP`] pixels below each other, from (x, y) on. Domain: x is a multiple of [`STRIP`], or
    /// there is one lane.
    Block { x: u32, y: u32 },
    /// Any columns and rows.
    Any { x: L::Bits, y: L::Bits },
}

impl<L: Lane> PixelCoordinates<L> {
    /// Returns the shifts of the pixels in the pair of dimensions that begins at `dimension`, in the upper
    /// digits of both words. `of_seed` is [`seed_offset`].
    #[inline(always)]
    pub fn shift(self, shifts: &Shifts, of_seed: [u32; 2], dimension: u32) -> [L::Bits; 2] {
        let [right, down] = offset(dimension);
        let [right, down] = [right + of_seed[0], down + of_seed[1]];
        let both = match self {
            Self::Block { x, y } => {
                debug_assert!(L::WIDTH == 1 || x.is_multiple_of(STRIP), "a block lies in a strip");
                let (x, y) = ((x + right) % SIZE, (y + down) % SIZE);
                let at = (x / STRIP * STRIDE + y * STRIP + x % STRIP) as usize;
                L::Bits::load(&shifts.0[at..at + L::WIDTH])
            }
            Self::Any { x, y } => {
                let splat = L::Bits::splat;
                let wrapped = |x: L::Bits, by: u32| x.wrapping_add(splat(by)) & splat(SIZE - 1);
                let (x, y) = (wrapped(x, right), wrapped(y, down));
                let strip = x.shr(STRIP.ilog2()).wrapping_mul(splat(STRIDE));
                let in_strip = y.shl(STRIP.ilog2()).wrapping_add(x & splat(STRIP - 1));
                L::gather_bits(&shifts.0, strip.wrapping_add(in_strip))
            }
        };
        [both & L::Bits::splat(0xffff_0000), both.shl(16)]
    }
}

/// Returns the pair's offset in the table, different in both directions for the pairs of the pixel and of the
/// first event. Offsets to the right are multiples of sixteen, so that a block stays in a strip.
#[inline(always)]
pub const fn offset(dimension: u32) -> [u32; 2] {
    let pair = dimension / 2;
    [16 * (5 * pair % 8), 45 * pair % SIZE]
}

/// Returns all pairs' offset in the table: pictures of different seeds have different shifts.
#[inline(always)]
pub fn seed_offset(seed: u32) -> [u32; 2] {
    let key = seed_key(seed);
    [(key % SIZE) & !15, (key >> 16) % SIZE]
}

/// Computes words with their digits reversed: bit j is digit j after the point.
fn table() -> Box<Shifts> {
    let mut table = Box::new(Shifts([0; LENGTH]));
    for (strip, shifts) in (0..).zip(table.0.chunks_exact_mut(STRIDE as usize)) {
        for (at, shift) in (0..).zip(shifts) {
            let number = number_in_z_order(strip * STRIP + at % STRIP, at / STRIP % SIZE);
            let [first, second] = [(number, POLYNOMIALS[0]), (second_dimension(number), POLYNOMIALS[1])]
                .map(|(digits, polynomial)| scrambled(digits, polynomial).reverse_bits() >> 16);
            *shift = first << 16 | second;
        }
    }
    table
}

/// Returns the number of a pixel, its last digit first: the digits of its coordinates in turns, each flipped
/// by a random bit that is a function of the digits before it.
fn number_in_z_order(x: u32, y: u32) -> u32 {
    let digit = |place: u32| (if place.is_multiple_of(2) { x } else { y }) >> (place / 2) & 1;
    let mut before = 1;
    let mut number = 0;
    for place in (0..DIGITS).rev() {
        number |= (digit(place) ^ mix_bits::<u32>(before) & 1) << place;
        before = before << 1 | digit(place);
    }
    number
}

/// Adds to each digit a sum modulo 2 of digits before it: the product of polynomials over two elements.
fn scrambled(digits: u32, polynomial: u32) -> u32 {
    (0..32).filter(|place| polynomial >> place & 1 == 1).fold(0, |sum, place| sum ^ digits << place)
}
