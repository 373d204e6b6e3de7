//! Width 8: the packet types, wrappers of the vectors of `wide`.

use super::traits::{Bits, Lane, Mask};
use bytemuck::{Pod, Zeroable};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};
use wide::{f32x4, f32x8, i32x8, u8x32, u32x8};

/// Eight floats, 32 bytes, aligned to 32.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct F32x8(f32x8);

/// Eight unsigned integers, 32 bytes, aligned to 32.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(transparent)]
pub struct U32x8(u32x8);

/// Eight truth values: a lane is all ones or all zeros.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(transparent)]
pub struct Mask8(f32x8);

impl F32x8 {
    pub const ZERO: Self = Self(f32x8::ZERO);
}

macro_rules! forward_operator {
    ($type:ident, $($trait:ident :: $method:ident),*) => {$(
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self($trait::$method(self.0, other.0))
            }
        }
    )*};
}
forward_operator!(F32x8, Add::add, Sub::sub, Mul::mul, Div::div);
forward_operator!(U32x8, BitAnd::bitand, BitOr::bitor, BitXor::bitxor);
forward_operator!(Mask8, BitAnd::bitand, BitOr::bitor, BitXor::bitxor);

impl Neg for F32x8 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl Not for U32x8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

/// `FIRST[n]`: the mask of the first n of eight lanes.
const FIRST: [[u32; 8]; 9] = {
    let mut table = [[0; 8]; 9];
    let mut count = 0;
    while count <= 8 {
        let mut lane = 0;
        while lane < count {
            table[count][lane] = u32::MAX;
            lane += 1;
        }
        count += 1;
    }
    table
};

/// `COMPRESS[m]`: the indices of the set bits of m in ascending order, then zeros. 8 KiB.
static COMPRESS: [[u32; 8]; 256] = {
    let mut table = [[0; 8]; 256];
    let mut mask = 0;
    while mask < 256 {
        let mut lane = 0;
        let mut next = 0;
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask][next] = lane;
                next += 1;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

/// Byte-shuffle control: reverses the bytes of each 32-bit lane. Indices count within 128-bit halves.
const REVERSE_BYTES: [u8; 32] = {
    let mut table = [0; 32];
    let mut byte = 0;
    while byte < 32 {
        table[byte] = (byte % 16) as u8 ^ 3;
        byte += 1;
    }
    table
};

/// Lookup tables of bit-reversed nibbles, in the low and in the high nibble of a byte. Each table stands
/// twice because bytes are shuffled within 128-bit halves.
const REVERSED_TO_LOW: [u8; 32] = reversed(4);
const REVERSED_TO_HIGH: [u8; 32] = reversed(0);

/// `table[n]`: the 8 bits of n mod 16 in reverse order, shifted right.
const fn reversed(shift: u32) -> [u8; 32] {
    let mut table = [0; 32];
    let mut index = 0;
    while index < 32 {
        table[index] = (index as u8 % 16).reverse_bits() >> shift;
        index += 1;
    }
    table
}

impl Mask for Mask8 {
    #[inline(always)]
    fn splat(value: bool) -> Self {
        Self::first(if value { 8 } else { 0 })
    }
    #[inline(always)]
    fn first(count: usize) -> Self {
        Self(bytemuck::cast(u32x8::new(FIRST[count.min(8)])))
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0.any()
    }
    #[inline(always)]
    fn all(self) -> bool {
        self.0.all()
    }
    #[inline(always)]
    fn bitmask(self) -> u32 {
        self.0.to_bitmask()
    }
}

impl Bits for U32x8 {
    type Mask = Mask8;

    #[inline(always)]
    fn splat(value: u32) -> Self {
        Self(u32x8::splat(value))
    }
    #[inline(always)]
    fn from_fn(f: impl FnMut(usize) -> u32) -> Self {
        Self(u32x8::new(std::array::from_fn(f)))
    }
    #[inline(always)]
    fn get(self, lane: usize) -> u32 {
        self.0.as_array()[lane]
    }
    #[inline(always)]
    fn load(from: &[u32]) -> Self {
        let lanes: &[u32; 8] = from.first_chunk().expect("load needs eight numbers");
        Self(u32x8::new(*lanes))
    }
    #[inline(always)]
    fn store(self, to: &mut [u32]) {
        *to.first_chunk_mut().expect("store needs room for eight numbers") = self.0.to_array();
    }
    #[inline(always)]
    fn wrapping_add(self, other: Self) -> Self {
        Self(self.0 + other.0)
    }
    #[inline(always)]
    fn wrapping_mul(self, other: Self) -> Self {
        Self(self.0 * other.0)
    }
    #[inline(always)]
    fn shl(self, count: u32) -> Self {
        Self(self.0 << count)
    }
    #[inline(always)]
    fn shr(self, count: u32) -> Self {
        Self(self.0 >> count)
    }
    #[inline(always)]
    fn reverse(self) -> Self {
        if cfg!(target_feature = "avx2") {
            // Byte shuffles: reverse the bytes of each lane, then look up the reverse of each nibble.
            let bytes: u8x32 = bytemuck::cast(self.0);
            let reversed = Self(bytemuck::cast(bytes.swizzle_half_relaxed(u8x32::new(REVERSE_BYTES))));
            let nibble = Self::splat(0x0f0f_0f0f);
            let look_up = |table: [u8; 32], index: Self| {
                Self(bytemuck::cast(u8x32::new(table).swizzle_half_relaxed(bytemuck::cast(index.0))))
            };
            look_up(REVERSED_TO_HIGH, reversed & nibble) | look_up(REVERSED_TO_LOW, reversed.shr(4) & nibble)
        } else {
            // Swap neighbouring bits, pairs, nibbles, bytes, and 16-bit halves.
            let swap = |x: Self, count: u32, low: u32| {
                let low = Self::splat(low);
                (x.shr(count) & low) | (x & low).shl(count)
            };
            let x = swap(self, 1, 0x5555_5555);
            let x = swap(x, 2, 0x3333_3333);
            let x = swap(x, 4, 0x0f0f_0f0f);
            let x = swap(x, 8, 0x00ff_00ff);
            x.shr(16) | x.shl(16)
        }
    }
    #[inline(always)]
    fn equals(self, other: Self) -> Mask8 {
        Mask8(bytemuck::cast(self.0.simd_eq(other.0)))
    }
    #[inline(always)]
    fn less(self, other: Self) -> Mask8 {
        Mask8(bytemuck::cast(self.0.simd_lt(other.0)))
    }
    #[inline(always)]
    fn select(mask: Mask8, if_true: Self, if_false: Self) -> Self {
        Self(bytemuck::cast(
            mask.0.select(bytemuck::cast::<_, f32x8>(if_true.0), bytemuck::cast::<_, f32x8>(if_false.0)),
        ))
    }
}

impl Lane for F32x8 {
    const WIDTH: usize = 8;
    type Mask = Mask8;
    type Bits = U32x8;
    type CompressIndices = U32x8;

    #[inline(always)]
    fn splat(value: f32) -> Self {
        Self(f32x8::splat(value))
    }
    #[inline(always)]
    fn from_fn(f: impl FnMut(usize) -> f32) -> Self {
        Self(f32x8::new(std::array::from_fn(f)))
    }
    #[inline(always)]
    fn get(self, lane: usize) -> f32 {
        self.0.as_array()[lane]
    }
    #[inline(always)]
    fn load(from: &[f32]) -> Self {
        let lanes: &[f32; 8] = from.first_chunk().expect("load needs eight numbers");
        Self(f32x8::new(*lanes))
    }
    #[inline(always)]
    fn store(self, to: &mut [f32]) {
        *to.first_chunk_mut().expect("store needs room for eight numbers") = self.0.to_array();
    }
    #[inline(always)]
    fn mul_add(self, factor: Self, addend: Self) -> Self {
        if cfg!(target_feature = "fma") {
            Self(self.0.mul_add(factor.0, addend.0))
        } else {
            self * factor + addend
        }
    }
    // On x86 the min and max instructions follow the rule of [`Lane::min`]; the compiler does not find them
    // from compare and select.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if cfg!(target_arch = "x86_64") {
            Self(self.0.fast_min(other.0))
        } else {
            Self::select(self.lt(other), self, other)
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if cfg!(target_arch = "x86_64") {
            Self(self.0.fast_max(other.0))
        } else {
            Self::select(other.lt(self), self, other)
        }
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }
    #[inline(always)]
    fn floor(self) -> Self {
        Self(self.0.floor())
    }
    #[inline(always)]
    fn lt(self, other: Self) -> Mask8 {
        Mask8(self.0.simd_lt(other.0))
    }
    #[inline(always)]
    fn le(self, other: Self) -> Mask8 {
        Mask8(self.0.simd_le(other.0))
    }
    #[inline(always)]
    fn eq(self, other: Self) -> Mask8 {
        Mask8(self.0.simd_eq(other.0))
    }
    #[inline(always)]
    fn select(mask: Mask8, if_true: Self, if_false: Self) -> Self {
        Self(mask.0.select(if_true.0, if_false.0))
    }
    #[inline(always)]
    fn only(self, mask: Mask8) -> Self {
        Self(self.0 & mask.0)
    }
    #[inline(always)]
    fn is_sign_negative(self) -> Mask8 {
        Mask8(bytemuck::cast(bytemuck::cast::<_, i32x8>(self.0).is_negative()))
    }
    #[inline(always)]
    fn to_bits(self) -> U32x8 {
        U32x8(bytemuck::cast(self.0))
    }
    #[inline(always)]
    fn from_bits(bits: U32x8) -> Self {
        Self(bytemuck::cast(bits.0))
    }
    #[inline(always)]
    fn truncate_to_int(self) -> U32x8 {
        U32x8(bytemuck::cast(self.0.fast_trunc_int()))
    }
    #[inline(always)]
    fn from_int(int: U32x8) -> Self {
        Self(f32x8::from_i32x8(bytemuck::cast::<_, i32x8>(int.0)))
    }
    #[inline(always)]
    fn compress_indices(mask: Mask8) -> U32x8 {
        U32x8(u32x8::new(COMPRESS[(mask.bitmask() & 0xff) as usize]))
    }
    #[inline(always)]
    fn compress(self, indices: U32x8) -> Self {
        Self(self.0.shuffle(indices.0))
    }
    #[inline(always)]
    fn compress_bits(bits: U32x8, indices: U32x8) -> U32x8 {
        U32x8(bits.0.shuffle(indices.0))
    }
    #[inline(always)]
    fn pick(table: &[f32; 8], index: U32x8) -> Self {
        Self(f32x8::new(*table).shuffle(index.0))
    }
    #[inline(always)]
    fn gather_rows<const N: usize>(rows: &[[f32; N]], index: U32x8) -> [Self; N] {
        let index = index.0.to_array();
        let row = |lane: usize| &rows[index[lane] as usize];
        if N == 8 {
            let columns = f32x8::transpose(std::array::from_fn(|lane| Self::load(row(lane)).0));
            std::array::from_fn(|column| Self(columns[column]))
        } else if N == 4 {
            // Two 4 × 4 transposes.
            let columns_of = |first: usize| {
                let quad = |i: usize| {
                    let row = row(first + i);
                    f32x4::new([row[0], row[1], row[2], row[3]])
                };
                let [a, b, c, d] = [quad(0), quad(1), quad(2), quad(3)];
                let (ac_low, ac_high) = (a.unpack_lo(c), a.unpack_hi(c));
                let (bd_low, bd_high) = (b.unpack_lo(d), b.unpack_hi(d));
                [
                    ac_low.unpack_lo(bd_low),
                    ac_low.unpack_hi(bd_low),
                    ac_high.unpack_lo(bd_high),
                    ac_high.unpack_hi(bd_high),
                ]
            };
            let (low, high) = (columns_of(0), columns_of(4));
            std::array::from_fn(|column| Self(bytemuck::cast([low[column], high[column]])))
        } else {
            let rows: [_; 8] = std::array::from_fn(row);
            std::array::from_fn(|column| Self::from_fn(|lane| rows[lane][column]))
        }
    }
    #[inline(always)]
    fn gather_bits(table: &[u32], index: U32x8) -> U32x8 {
        let index = index.0.to_array();
        U32x8::from_fn(|lane| table[index[lane] as usize])
    }
}
