//! Width 1: `f32`, `u32` and `bool` as lanes. Every packet must give the same bits as this scalar path.

use super::traits::{Bits, Lane, Mask};

impl Mask for bool {
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(value: bool) -> Self {
        value
    }
    #[inline(always)]
    fn first(count: usize) -> Self {
        count > 0
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
    #[inline(always)]
    fn all(self) -> bool {
        self
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        self as u32
    }
}

impl Bits for u32 {
    type Mask = bool;

    #[inline(always)]
    fn splat(value: u32) -> Self {
        value
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> u32) -> Self {
        f(0)
    }
    #[inline(always)]
    fn get(self, lane: usize) -> u32 {
        debug_assert!(lane == 0);
        self
    }
    #[inline(always)]
    fn load(from: &[u32]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        to[0] = self;
    }
    #[inline(always)]
    fn wrapping_add(self, other: Self) -> Self {
        u32::wrapping_add(self, other)
    }
    #[inline(always)]
    fn wrapping_mul(self, other: Self) -> Self {
        u32::wrapping_mul(self, other)
    }
    #[inline(always)]
    fn shl(self, count: u32) -> Self {
        self << count
    }
    #[inline(always)]
    fn shr(self, count: u32) -> Self {
        self >> count
    }
    #[inline(always)]
    fn equals(self, other: Self) -> bool {
        self == other
    }
    #[inline(always)]
    fn less(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn min_signed(self, other: Self) -> Self {
        (self as i32).min(other as i32) as u32
    }
    #[inline(always)]
    fn max_signed(self, other: Self) -> Self {
        (self as i32).max(other as i32) as u32
    }
    #[inline(always)]
    fn le_signed(self, other: Self) -> bool {
        self as i32 <= other as i32
    }
    #[inline(always)]
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
    #[inline(always)]
    fn compress(self, _mask: bool) -> Self {
        self
    }
}

impl Lane for f32 {
    const WIDTH: usize = 1;
    type Mask = bool;
    type Bits = u32;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        value
    }
    #[inline(always)]
    fn from_fn(mut f: impl FnMut(usize) -> f32) -> Self {
        f(0)
    }
    #[inline(always)]
    fn get(self, lane: usize) -> f32 {
        debug_assert!(lane == 0);
        self
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        to[0] = self;
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        // Without FMA in the target, `f32::mul_add` calls a software routine, and `wide` does not.
        if super::FUSED { f32::mul_add(self, factor, addend) } else { self * factor + addend }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32::sqrt(self)
    }
    #[inline(always)]
    fn floor(self) -> Self {
        f32::floor(self)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn le(self, other: Self) -> bool {
        self <= other
    }
    #[inline(always)]
    fn eq(self, other: Self) -> bool {
        self == other
    }
    #[inline(always)]
    fn select(mask: bool, if_true: Self, if_false: Self) -> Self {
        if mask { if_true } else { if_false }
    }
    #[inline(always)]
    fn only(self, mask: bool) -> Self {
        if mask { self } else { 0.0 }
    }
    #[inline(always)]
    fn is_sign_negative(self) -> bool {
        self.is_sign_negative()
    }
    #[inline(always)]
    fn to_bits(self) -> u32 {
        f32::to_bits(self)
    }
    #[inline(always)]
    fn from_bits(bits: u32) -> Self {
        f32::from_bits(bits)
    }
    #[inline(always)]
    fn truncate_to_int(self) -> u32 {
        // `as` saturates; the vector instruction gives 0x8000_0000 for every value out of range, −2³¹
        // included.
        if self.abs() < 2_147_483_648.0 { (self as i32) as u32 } else { 0x8000_0000 }
    }
    #[inline(always)]
    fn from_int(int: u32) -> Self {
        int as i32 as f32
    }
    #[inline(always)]
    fn pick(table: &[f32; 8], index: u32) -> Self {
        table[(index & 7) as usize]
    }
    #[inline(always)]
    fn pick_of_16(table: &[f32; 16], index: u32) -> Self {
        table[(index & 15) as usize]
    }
    #[inline(always)]
    fn gather_rows<const N: usize>(rows: &[[f32; N]], index: u32) -> [Self; N] {
        rows[index as usize]
    }
    #[inline(always)]
    fn gather_bits(table: &[u32], index: u32) -> u32 {
        table[index as usize]
    }
}
