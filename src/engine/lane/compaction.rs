//! Stream compaction of lists of 16-bit numbers.
//!
//! For: [`compress_where`]. May import: `avx512`, `wide`. Must never know: what is listed.

/// Numbers that [`compress_where`] takes at a time.
pub const CHUNK: usize = 32;

/// Writes those numbers of `from` whose mask has any of `bits` to the front of `to`, in their order, and
/// returns how many they are. What is behind them in `to` is unspecified.
#[inline(always)]
pub fn compress_where(from: &[u16; CHUNK], masks: &[u16; CHUNK], bits: u16, to: &mut [u16; CHUNK]) -> usize {
    #[cfg(all(target_feature = "avx512bw", target_feature = "avx512vbmi2"))]
    return super::avx512::compress_where(from, masks, bits, to);
    #[cfg(not(all(target_feature = "avx512bw", target_feature = "avx512vbmi2")))]
    compress_by_eight(from, masks, bits, to)
}

/// The same, eight numbers at a time by a table.
#[cfg(any(test, not(all(target_feature = "avx512bw", target_feature = "avx512vbmi2"))))]
#[inline(always)]
fn compress_by_eight(from: &[u16; CHUNK], masks: &[u16; CHUNK], bits: u16, to: &mut [u16; CHUNK]) -> usize {
    use wide::{u8x16, u16x8};
    let mut count = 0;
    for (from, masks) in from.as_chunks::<8>().0.iter().zip(masks.as_chunks::<8>().0) {
        let others = (u16x8::new(*masks) & u16x8::splat(bits)).simd_eq(u16x8::splat(0));
        let chosen = !others.to_bitmask() as usize & 0xff;
        let moved = bytemuck::cast::<_, u8x16>(*from).shuffle(u8x16::new(BYTES[chosen]));
        // No more than `from` holds before, so that there is room for eight.
        to[count..count + 8].copy_from_slice(bytemuck::cast_ref::<_, [u16; 8]>(&moved));
        count += chosen.count_ones() as usize;
    }
    count
}

/// `BYTES[m]`: the bytes of the 16-bit numbers whose bits are set in m, in ascending order, then zeros. 4
/// KiB.
#[cfg(any(test, not(all(target_feature = "avx512bw", target_feature = "avx512vbmi2"))))]
static BYTES: [[u8; 16]; 256] = {
    let mut table = [[0; 16]; 256];
    let mut mask = 0;
    while mask < 256 {
        let (mut lane, mut next) = (0, 0);
        while lane < 8 {
            if mask >> lane & 1 == 1 {
                table[mask][next] = 2 * lane;
                table[mask][next + 1] = 2 * lane + 1;
                next += 2;
            }
            lane += 1;
        }
        mask += 1;
    }
    table
};

#[cfg(test)]
mod tests {
    use super::*;

    /// One number after the other.
    fn expected(from: &[u16; CHUNK], masks: &[u16; CHUNK], bits: u16) -> Vec<u16> {
        let chosen = from.iter().zip(masks).filter(|(_, mask)| *mask & bits != 0);
        chosen.map(|(&number, _)| number).collect()
    }

    #[test]
    fn the_chosen_numbers_stand_in_front_in_their_order() {
        let from = std::array::from_fn(|lane| 1000 + 7 * lane as u16);
        let mut random = 0x9e37_79b9_u32;
        let mut next = || {
            random = random.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            random >> 16
        };
        // Every mask of eight numbers in each place, then masks of all 32.
        let rounds = (0..4 * 256).map(|round| (round & 255) << (8 * (round >> 8)));
        let random: Vec<u32> = (0..10_000).map(|_| next() << 16 | next()).collect();
        for chosen in rounds.chain([u32::MAX]).chain(random) {
            for (bits, others) in [(1 << (chosen & 15), 0), (0x8001, 0x7ffe), (u16::MAX, 0)] {
                // One of the bits chooses; the others never do.
                let one = bits & bits.wrapping_neg();
                let masks =
                    std::array::from_fn(|lane| others | if chosen >> lane & 1 == 1 { one } else { 0 });
                let expected = expected(&from, &masks, bits);
                for compress in [compress_where, compress_by_eight] {
                    let mut to = [0; CHUNK];
                    let count = compress(&from, &masks, bits, &mut to);
                    assert_eq!(to[..count], expected, "{chosen:#b}, bits {bits:#x}");
                }
            }
        }
    }
}
