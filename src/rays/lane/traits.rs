//! The traits of lanes: [`Mask`], [`Bits`] and [`Lane`].

use bytemuck::Pod;
use std::fmt::Debug;
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};

/// One truth value per lane.
pub trait Mask:
    Copy + Debug + BitAnd<Output = Self> + BitOr<Output = Self> + BitXor<Output = Self> + Not<Output = Self>
{
    /// The number of lanes.
    const WIDTH: usize;

    /// Returns the same truth value in every lane.
    fn splat(value: bool) -> Self;
    /// Returns a mask whose first `count` lanes are true; all are if `count` is the width or more.
    fn first(count: usize) -> Self;
    /// Tests whether any lane is true.
    fn any(self) -> bool;
    /// Tests whether every lane is true.
    fn all(self) -> bool;
    /// Returns lane `i` as bit `i`; the bits above the width are zero.
    fn bitmask(self) -> u32;
    /// Iterates over the indices of the lanes that are true, in ascending order.
    #[inline(always)]
    fn lanes(self) -> impl Iterator<Item = usize> {
        // The index is below the width already; the mask lets the compiler drop the bounds check of arrays of
        // that length.
        set_bits(self.bitmask()).map(|lane| lane & (Self::WIDTH - 1))
    }
    /// Returns the number of lanes that are true.
    #[inline(always)]
    fn count(self) -> usize {
        self.bitmask().count_ones() as usize
    }
}

/// Iterates over the indices of the bits that are set, in ascending order.
#[inline(always)]
pub fn set_bits(mask: impl Into<u64>) -> impl Iterator<Item = usize> {
    let mut rest: u64 = mask.into();
    std::iter::from_fn(move || {
        let bit = rest.trailing_zeros() as usize;
        // `n & (n - 1)` clears the lowest set bit.
        (rest != 0).then(|| (rest &= rest - 1, bit).1)
    })
}

/// Unsigned 32-bit integers in lanes: indices, keys, and the bit patterns of floats. Arithmetic wraps.
pub trait Bits:
    Copy
    + Debug
    + Pod
    + Send
    + Sync
    + BitAnd<Output = Self>
    + BitOr<Output = Self>
    + BitXor<Output = Self>
    + Not<Output = Self>
{
    /// The mask of this width.
    type Mask: Mask;

    /// Returns one integer in every lane.
    fn splat(value: u32) -> Self;
    /// Returns `f(i)` in lane `i`.
    fn from_fn(f: impl FnMut(usize) -> u32) -> Self;
    /// Returns the value of one lane.
    fn get(self, lane: usize) -> u32;
    /// Loads the first `WIDTH` numbers of `from`.
    ///
    /// # Panics
    /// If `from` is shorter than the width.
    fn load(from: &[u32]) -> Self;
    /// Writes the lanes to the first `WIDTH` numbers of `to`.
    ///
    /// # Panics
    /// If `to` is shorter than the width.
    fn store(self, to: &mut [u32]);
    /// Returns the sum modulo 2³².
    fn wrapping_add(self, other: Self) -> Self;
    /// Returns the product modulo 2³².
    fn wrapping_mul(self, other: Self) -> Self;
    /// Shifts left by the same `count` < 32 in every lane.
    fn shl(self, count: u32) -> Self;
    /// Shifts right, filling with zeros, by the same `count` < 32 in every lane.
    fn shr(self, count: u32) -> Self;
    /// Returns the lanes where both are equal.
    fn equals(self, other: Self) -> Self::Mask;
    /// Returns the lanes where self < other, as unsigned integers.
    fn less(self, other: Self) -> Self::Mask;
    /// Returns the smaller one, as signed integers in two's complement.
    fn min_signed(self, other: Self) -> Self;
    /// Returns the larger one, as signed integers in two's complement.
    fn max_signed(self, other: Self) -> Self;
    /// Returns the lanes where self ≤ other, as signed integers.
    fn le_signed(self, other: Self) -> Self::Mask;
    /// Selects one of two integers in each lane.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
    /// Moves the lanes of `mask` to the front and keeps their order (stream compaction). The lanes behind
    /// them are unspecified.
    fn compress(self, mask: Self::Mask) -> Self;
}

/// One or several `f32` that take part in the same arithmetic.
pub trait Lane:
    Copy
    + Debug
    + Pod
    + Send
    + Sync
    + PartialEq
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The number of lanes.
    const WIDTH: usize;
    /// The mask of this width.
    type Mask: Mask;
    /// The integers of this width.
    type Bits: Bits<Mask = Self::Mask>;

    /// Returns one number in every lane.
    fn splat(value: f32) -> Self;
    /// Returns a number in memory in every lane, for loops that would otherwise wait for an execution port:
    /// at sixteen lanes it uses an instruction that the compiler does not choose.
    #[inline(always)]
    fn broadcast(number: &f32) -> Self {
        Self::splat(*number)
    }
    /// Returns `f(i)` in lane `i`.
    fn from_fn(f: impl FnMut(usize) -> f32) -> Self;
    /// Returns the value of one lane.
    fn get(self, lane: usize) -> f32;
    /// Loads the first `WIDTH` numbers of `from`.
    ///
    /// # Panics
    /// If `from` is shorter than the width.
    fn load(from: &[f32]) -> Self;
    /// Writes the lanes to the first `WIDTH` numbers of `to`.
    ///
    /// # Panics
    /// If `to` is shorter than the width.
    fn store(self, to: &mut [f32]);

    /// Returns `self · factor + addend`: one rounding where the target has FMA, two where it has not, at
    /// every width alike.
    fn mul_add(self, factor: Self, addend: Self) -> Self;
    /// Returns `addend − self · factor`, rounded like [`Lane::mul_add`].
    #[inline(always)]
    fn neg_mul_add(self, factor: Self, addend: Self) -> Self {
        (-self).mul_add(factor, addend)
    }
    /// Returns the correctly rounded square root.
    fn sqrt(self) -> Self;
    /// Returns the largest integer ≤ the value. Zeros keep their sign.
    fn floor(self) -> Self;

    /// Returns the lanes where self < other; false for NaN.
    fn lt(self, other: Self) -> Self::Mask;
    /// Returns the lanes where self ≤ other; false for NaN.
    fn le(self, other: Self) -> Self::Mask;
    /// Returns the lanes where self = other; false for NaN.
    fn eq(self, other: Self) -> Self::Mask;
    /// Returns the lanes where self > other; false for NaN.
    #[inline(always)]
    fn gt(self, other: Self) -> Self::Mask {
        other.lt(self)
    }
    /// Returns the lanes where self ≥ other; false for NaN.
    #[inline(always)]
    fn ge(self, other: Self) -> Self::Mask {
        other.le(self)
    }
    /// Selects one of two numbers in each lane.
    fn select(mask: Self::Mask, if_true: Self, if_false: Self) -> Self;
    /// Returns the value in the lanes of the mask, zero in the others.
    fn only(self, mask: Self::Mask) -> Self;
    /// Returns the sign bit as a mask, without a comparison. It is set in −0; NaN may have either sign.
    fn is_sign_negative(self) -> Self::Mask;

    /// Returns the bit pattern.
    fn to_bits(self) -> Self::Bits;
    /// Returns the numbers with these bits.
    fn from_bits(bits: Self::Bits) -> Self;
    /// Rounds towards zero to a signed integer in two's complement. Domain: |x| < 2³¹; outside it and for NaN
    /// the result is 0x8000_0000.
    fn truncate_to_int(self) -> Self::Bits;
    /// Returns the nearest float to a signed integer in two's complement.
    fn from_int(int: Self::Bits) -> Self;

    /// Compresses like [`Bits::compress`].
    #[inline(always)]
    fn compress(self, mask: Self::Mask) -> Self {
        Self::from_bits(self.to_bits().compress(mask))
    }

    /// Returns `table[index]` in each lane, for tables that fit one register. Domain: every index, in
    /// inactive lanes too, is below 8; the result of any other index is unspecified.
    fn pick(table: &[f32; 8], index: Self::Bits) -> Self;
    /// [`Lane::pick`] from a table of sixteen: one register at width 16, two at width 8.
    fn pick_of_16(table: &[f32; 16], index: Self::Bits) -> Self;
    /// Returns row `index` of a table in each lane, transposed: column `j` holds `rows[index][j]`.
    ///
    /// # Panics
    /// If an index, in any lane, is not below `rows.len()`.
    fn gather_rows<const N: usize>(rows: &[[f32; N]], index: Self::Bits) -> [Self; N];

    /// Returns `table[index]` in each lane.
    ///
    /// # Panics
    /// If an index, in any lane, is not below `table.len()`.
    fn gather_bits(table: &[u32], index: Self::Bits) -> Self::Bits;

    /// Returns 0 in every lane.
    #[inline(always)]
    fn zero() -> Self {
        Self::splat(0.0)
    }
    /// Returns 1 in every lane.
    #[inline(always)]
    fn one() -> Self {
        Self::splat(1.0)
    }

    /// Returns the smaller one; `other` if either is NaN or both are zeros. This is the rule of x86, so it
    /// costs one instruction there.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.lt(other), self, other)
    }
    /// Returns the larger one; `other` if either is NaN or both are zeros.
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.lt(self), self, other)
    }
    /// Clears the sign bit.
    #[inline(always)]
    fn abs(self) -> Self {
        Self::from_bits(self.to_bits() & Self::Bits::splat(0x7fff_ffff))
    }
    /// Returns the sign bit alone, as a float: +0 or −0.
    #[inline(always)]
    fn sign_bit(self) -> Self {
        Self::from_bits(self.to_bits() & Self::Bits::splat(0x8000_0000))
    }
    /// Flips the sign where `sign` has its sign bit set (zeros and NaN included).
    #[inline(always)]
    fn flip_sign(self, sign: Self) -> Self {
        Self::from_bits(self.to_bits() ^ sign.sign_bit().to_bits())
    }
    /// Returns the magnitude of `self` with the sign of `sign`.
    #[inline(always)]
    fn copysign(self, sign: Self) -> Self {
        Self::from_bits(self.abs().to_bits() | sign.sign_bit().to_bits())
    }
    /// Tests whether the value is neither infinite nor NaN.
    #[inline(always)]
    fn is_finite(self) -> Self::Mask {
        self.abs().lt(Self::splat(f32::INFINITY))
    }
}

/// Returns the index of each lane: 0, 1, 2, …
#[inline(always)]
pub fn lane_indices<L: Lane>() -> L::Bits {
    L::Bits::from_fn(|lane| lane as u32)
}
