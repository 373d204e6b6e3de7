//! Moves values between the lanes of a packet: stream compaction, table lookups, transposes.

use super::packet::{F32x8, F32x16, Mask8, Mask16, U32x8, U32x16};
use super::traits::{Bits, Lane, Mask};
use wide::{f32x4, f32x8, u32x8};

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

/// `JOIN[n]`: the first n of the lower eight lanes, then the upper eight, then lane 0.
#[cfg(not(target_feature = "avx512f"))]
static JOIN: [[u32; 16]; 9] = {
    let mut table = [[0; 16]; 9];
    let mut count = 0;
    while count <= 8 {
        let mut lane = 0;
        while lane < count + 8 {
            table[count][lane] = (if lane < count { lane } else { 8 + lane - count }) as u32;
            lane += 1;
        }
        count += 1;
    }
    table
};

impl U32x8 {
    /// Returns lane `indices[i]` in lane i; each index is below 8.
    #[inline(always)]
    pub(super) fn permuted(self, indices: Self) -> Self {
        Self(self.0.shuffle(indices.0))
    }
    /// Implements [`Bits::compress`].
    #[inline(always)]
    pub(super) fn compressed(self, mask: Mask8) -> Self {
        self.permuted(Self(u32x8::new(COMPRESS[(mask.bitmask() & 0xff) as usize])))
    }
}

impl F32x8 {
    /// Implements [`Lane::broadcast`].
    #[inline(always)]
    pub(super) fn broadcasted(number: &f32) -> Self {
        Self::splat(*number)
    }
    /// Implements [`Lane::pick`].
    #[inline(always)]
    pub(super) fn picked(table: &[f32; 8], index: U32x8) -> Self {
        Self(f32x8::new(*table).shuffle(index.0))
    }
    /// Implements [`Lane::pick_of_16`].
    #[inline(always)]
    pub(super) fn picked_of_16(table: &[f32; 16], index: U32x8) -> Self {
        let [low, high] = [0, 8].map(|first| Self::load(&table[first..]));
        // `shuffle` may read only the lowest three bits of an index, or all of them.
        let lane = index & U32x8::splat(7);
        let pick = |half: Self| Self(half.0.shuffle(lane.0));
        Self::select(Self::from_bits(index.shl(28)).is_sign_negative(), pick(high), pick(low))
    }
    /// Implements [`Lane::gather_rows`].
    #[inline(always)]
    pub(super) fn gathered<const N: usize>(rows: &[[f32; N]], index: U32x8) -> [Self; N] {
        // Plain loops: closures of `array` functions are not unrolled before values become registers.
        let index = index.0.to_array();
        let row = |lane: usize| &rows[index[lane] as usize];
        let mut columns = [Self::ZERO; N];
        if N == 8 {
            let mut loaded = [f32x8::ZERO; 8];
            for (lane, loaded) in loaded.iter_mut().enumerate() {
                *loaded = Self::load(row(lane)).0;
            }
            let transposed = f32x8::transpose(loaded);
            for (column, transposed) in columns.iter_mut().zip(&transposed) {
                *column = Self(*transposed);
            }
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
            for (index, column) in columns.iter_mut().enumerate() {
                *column = Self(bytemuck::cast([low[index], high[index]]));
            }
        } else {
            for (index, column) in columns.iter_mut().enumerate() {
                *column = Self::from_fn(|lane| row(lane)[index]);
            }
        }
        columns
    }
}

impl U32x16 {
    #[inline(always)]
    fn halves(self) -> [U32x8; 2] {
        bytemuck::cast(self)
    }
    /// Returns lane `indices[i]` in lane i; each index is below 16.
    #[inline(always)]
    pub(super) fn permuted(self, indices: Self) -> Self {
        if cfg!(target_feature = "avx512f") {
            Self(self.0.shuffle(indices.0))
        } else {
            // Without AVX-512, `wide` shuffles halves here.
            let (from, indices) = (self.0.to_array(), indices.0.to_array());
            Self::from_fn(|lane| from[indices[lane] as usize & 15])
        }
    }
    /// Implements [`Bits::compress`].
    #[cfg(target_feature = "avx512f")]
    #[inline(always)]
    pub(super) fn compressed(self, mask: Mask16) -> Self {
        super::instructions::compress(self, mask)
    }
    /// Implements [`Bits::compress`]. A table of all masks would take 4 MiB: the indices of each half come
    /// from its own mask, and are then joined.
    #[cfg(not(target_feature = "avx512f"))]
    #[inline(always)]
    pub(super) fn compressed(self, mask: Mask16) -> Self {
        let mask = mask.bitmask() as usize;
        let [low, high] = [mask & 0xff, mask >> 8 & 0xff].map(|half| U32x8(u32x8::new(COMPRESS[half])));
        let both: Self = bytemuck::cast([low, high.wrapping_add(U32x8::splat(8))]);
        let joined = both.permuted(Self(wide::u32x16::new(JOIN[(mask & 0xff).count_ones() as usize])));
        self.permuted(joined)
    }
}

impl F32x16 {
    /// Implements [`Lane::broadcast`].
    #[inline(always)]
    pub(super) fn broadcasted(number: &f32) -> Self {
        #[cfg(target_feature = "avx512f")]
        return super::instructions::broadcast(number);
        #[cfg(not(target_feature = "avx512f"))]
        Self::splat(*number)
    }
    /// Implements [`Lane::pick`].
    #[inline(always)]
    pub(super) fn picked(table: &[f32; 8], index: U32x16) -> Self {
        if cfg!(target_feature = "avx512f") {
            let table = F32x8::load(table);
            Self::from_bits(bytemuck::cast::<_, U32x16>([table; 2]).permuted(index))
        } else {
            bytemuck::cast(index.halves().map(|index| F32x8::picked(table, index)))
        }
    }
    /// Implements [`Lane::pick_of_16`].
    #[inline(always)]
    pub(super) fn picked_of_16(table: &[f32; 16], index: U32x16) -> Self {
        if cfg!(target_feature = "avx512f") {
            Self::from_bits(Self::load(table).to_bits().permuted(index))
        } else {
            bytemuck::cast(index.halves().map(|index| F32x8::picked_of_16(table, index)))
        }
    }
    /// Implements [`Lane::gather_rows`].
    #[inline(always)]
    pub(super) fn gathered<const N: usize>(rows: &[[f32; N]], index: U32x16) -> [Self; N] {
        let [low, high] = index.halves();
        let (low, high) = (F32x8::gathered(rows, low), F32x8::gathered(rows, high));
        let mut columns = [Self::ZERO; N];
        for (column, (low, high)) in columns.iter_mut().zip(low.iter().zip(&high)) {
            *column = bytemuck::cast([*low, *high]);
        }
        columns
    }
}
