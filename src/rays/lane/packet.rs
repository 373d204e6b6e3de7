//! The packet types: wrappers of the vectors of `wide`, of eight and of sixteen lanes.
//!
//! Code that all widths share is written once, in the macro `packet!`; the operations that move values
//! between lanes differ by width and are in `permute`. Without AVX-512 a packet of sixteen is two vectors of
//! eight: equally correct, and no faster.

use super::traits::{Bits, Lane, Mask};
use bytemuck::{Pod, Zeroable};
use std::ops::{Add, BitAnd, BitOr, BitXor, Div, Mul, Neg, Not, Sub};
use wide::{f32x8, f32x16, i32x8, i32x16, u32x8, u32x16};

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

macro_rules! packet {
    ($width:literal lanes, $text:literal: $floats:ident($f32:ident), $ints:ident($u32:ident, $i32:ident),
     $mask:ident, $from_ints:ident) => {
        #[doc = concat!($text, " floats, aligned to their size.")]
        #[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
        #[repr(transparent)]
        pub struct $floats(pub(super) $f32);

        #[doc = concat!($text, " unsigned integers, aligned to their size.")]
        #[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
        #[repr(transparent)]
        pub struct $ints(pub(super) $u32);

        #[doc = concat!($text, " truth values: a lane is all ones or all zeros.")]
        #[derive(Clone, Copy, Debug, PartialEq)]
        #[repr(transparent)]
        pub struct $mask($f32);

        impl $floats {
            /// 0 in every lane.
            pub const ZERO: Self = Self($f32::ZERO);
        }

        forward_operator!($floats, Add::add, Sub::sub, Mul::mul, Div::div);
        forward_operator!($ints, BitAnd::bitand, BitOr::bitor, BitXor::bitxor);
        forward_operator!($mask, BitAnd::bitand, BitOr::bitor, BitXor::bitxor);

        impl $ints {
            #[inline(always)]
            fn signed(self) -> $i32 {
                bytemuck::cast(self.0)
            }
        }

        impl Neg for $floats {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                Self(-self.0)
            }
        }

        impl Not for $ints {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(!self.0)
            }
        }

        impl Not for $mask {
            type Output = Self;
            #[inline(always)]
            fn not(self) -> Self {
                Self(!self.0)
            }
        }

        impl Mask for $mask {
            const WIDTH: usize = $width;

            #[inline(always)]
            fn splat(value: bool) -> Self {
                Self(bytemuck::cast($u32::splat(if value { u32::MAX } else { 0 })))
            }
            #[inline(always)]
            fn first(count: usize) -> Self {
                const LANES: [i32; $width] = {
                    let mut lanes = [0; $width];
                    let mut lane = 0;
                    while lane < $width {
                        lanes[lane] = lane as i32;
                        lane += 1;
                    }
                    lanes
                };
                let count = $i32::splat(count.min($width) as i32);
                Self(bytemuck::cast($i32::new(LANES).simd_lt(count)))
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

        impl Bits for $ints {
            type Mask = $mask;

            #[inline(always)]
            fn splat(value: u32) -> Self {
                Self($u32::splat(value))
            }
            // A loop, because `array::from_fn` of sixteen is not inlined.
            #[inline(always)]
            fn from_fn(mut f: impl FnMut(usize) -> u32) -> Self {
                let mut lanes = [0; $width];
                for (lane, value) in lanes.iter_mut().enumerate() {
                    *value = f(lane);
                }
                Self($u32::new(lanes))
            }
            #[inline(always)]
            fn get(self, lane: usize) -> u32 {
                self.0.as_array()[lane]
            }
            #[inline(always)]
            fn load(from: &[u32]) -> Self {
                let lanes: &[u32; $width] = from.first_chunk().expect("load needs a number for every lane");
                Self($u32::new(*lanes))
            }
            #[inline(always)]
            fn store(self, to: &mut [u32]) {
                *to.first_chunk_mut().expect("store needs room for every lane") = self.0.to_array();
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
            fn equals(self, other: Self) -> $mask {
                $mask(bytemuck::cast(self.0.simd_eq(other.0)))
            }
            #[inline(always)]
            fn less(self, other: Self) -> $mask {
                $mask(bytemuck::cast(self.0.simd_lt(other.0)))
            }
            #[inline(always)]
            fn min_signed(self, other: Self) -> Self {
                Self(bytemuck::cast(self.signed().min(other.signed())))
            }
            #[inline(always)]
            fn max_signed(self, other: Self) -> Self {
                Self(bytemuck::cast(self.signed().max(other.signed())))
            }
            #[inline(always)]
            fn le_signed(self, other: Self) -> $mask {
                $mask(bytemuck::cast(self.signed().simd_le(other.signed())))
            }
            #[inline(always)]
            fn select(mask: $mask, if_true: Self, if_false: Self) -> Self {
                let as_floats = |ints: Self| bytemuck::cast::<_, $f32>(ints.0);
                Self(bytemuck::cast(mask.0.select(as_floats(if_true), as_floats(if_false))))
            }
            #[inline(always)]
            fn compress(self, mask: $mask) -> Self {
                self.compressed(mask)
            }
        }

        impl Lane for $floats {
            const WIDTH: usize = $width;
            type Mask = $mask;
            type Bits = $ints;

            #[inline(always)]
            fn splat(value: f32) -> Self {
                Self($f32::splat(value))
            }
            #[inline(always)]
            fn broadcast(number: &f32) -> Self {
                Self::broadcasted(number)
            }
            #[inline(always)]
            fn from_fn(mut f: impl FnMut(usize) -> f32) -> Self {
                let mut lanes = [0.0; $width];
                for (lane, value) in lanes.iter_mut().enumerate() {
                    *value = f(lane);
                }
                Self($f32::new(lanes))
            }
            #[inline(always)]
            fn get(self, lane: usize) -> f32 {
                self.0.as_array()[lane]
            }
            #[inline(always)]
            fn load(from: &[f32]) -> Self {
                let lanes: &[f32; $width] = from.first_chunk().expect("load needs a number for every lane");
                Self($f32::new(*lanes))
            }
            #[inline(always)]
            fn store(self, to: &mut [f32]) {
                *to.first_chunk_mut().expect("store needs room for every lane") = self.0.to_array();
            }
            #[inline(always)]
            fn mul_add(self, factor: Self, addend: Self) -> Self {
                if cfg!(target_feature = "fma") {
                    Self(self.0.mul_add(factor.0, addend.0))
                } else {
                    self * factor + addend
                }
            }
            // On x86 the min and max instructions follow the rule of [`Lane::min`]; the compiler does not
            // find them from compare and select.
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
            fn lt(self, other: Self) -> $mask {
                $mask(self.0.simd_lt(other.0))
            }
            #[inline(always)]
            fn le(self, other: Self) -> $mask {
                $mask(self.0.simd_le(other.0))
            }
            #[inline(always)]
            fn eq(self, other: Self) -> $mask {
                $mask(self.0.simd_eq(other.0))
            }
            #[inline(always)]
            fn select(mask: $mask, if_true: Self, if_false: Self) -> Self {
                Self(mask.0.select(if_true.0, if_false.0))
            }
            #[inline(always)]
            fn only(self, mask: $mask) -> Self {
                Self(self.0 & mask.0)
            }
            #[inline(always)]
            fn is_sign_negative(self) -> $mask {
                $mask(bytemuck::cast(bytemuck::cast::<_, $i32>(self.0).is_negative()))
            }
            #[inline(always)]
            fn to_bits(self) -> $ints {
                $ints(bytemuck::cast(self.0))
            }
            #[inline(always)]
            fn from_bits(bits: $ints) -> Self {
                Self(bytemuck::cast(bits.0))
            }
            #[inline(always)]
            fn truncate_to_int(self) -> $ints {
                $ints(bytemuck::cast(self.0.fast_trunc_int()))
            }
            #[inline(always)]
            fn from_int(int: $ints) -> Self {
                Self($f32::$from_ints(bytemuck::cast::<_, $i32>(int.0)))
            }
            #[inline(always)]
            fn pick(table: &[f32; 8], index: $ints) -> Self {
                Self::picked(table, index)
            }
            #[inline(always)]
            fn pick_of_16(table: &[f32; 16], index: $ints) -> Self {
                Self::picked_of_16(table, index)
            }
            #[inline(always)]
            fn gather_rows<const N: usize>(rows: &[[f32; N]], index: $ints) -> [Self; N] {
                Self::gathered(rows, index)
            }
            #[inline(always)]
            fn gather_bits(table: &[u32], index: $ints) -> $ints {
                let index = index.0.to_array();
                $ints::from_fn(|lane| table[index[lane] as usize])
            }
        }
    };
}

packet!(8 lanes, "Eight": F32x8(f32x8), U32x8(u32x8, i32x8), Mask8, from_i32x8);
packet!(16 lanes, "Sixteen": F32x16(f32x16), U32x16(u32x16, i32x16), Mask16, from_i32x16);
