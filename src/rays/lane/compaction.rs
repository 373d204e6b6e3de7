//! Stream compaction of lists of 16-bit numbers.

/// The number of entries that [`compress_where`] processes at a time.
pub const CHUNK: usize = 32;

/// Writes the numbers of `from` whose mask has any of `bits` to the front of `to`, keeps their order, and
/// returns their count. The rest of `to` is unspecified.
#[inline(always)]
pub fn compress_where(from: &[u16; CHUNK], masks: &[u16; CHUNK], bits: u16, to: &mut [u16; CHUNK]) -> usize {
    #[cfg(all(target_feature = "avx512bw", target_feature = "avx512vbmi2"))]
    return super::instructions::compress_where(from, masks, bits, to);
    #[cfg(not(all(target_feature = "avx512bw", target_feature = "avx512vbmi2")))]
    compress_by_table(from, masks, bits, to)
}

/// Implements [`compress_where`], eight numbers at a time with a table.
#[cfg(any(test, not(all(target_feature = "avx512bw", target_feature = "avx512vbmi2"))))]
#[inline(always)]
fn compress_by_table(from: &[u16; CHUNK], masks: &[u16; CHUNK], bits: u16, to: &mut [u16; CHUNK]) -> usize {
    use wide::{u8x16, u16x8};
    let mut count = 0;
    for (from, masks) in from.as_chunks::<8>().0.iter().zip(masks.as_chunks::<8>().0) {
        let others = (u16x8::new(*masks) & u16x8::splat(bits)).simd_eq(u16x8::splat(0));
        let chosen = !others.to_bitmask() as usize & 0xff;
        let moved = bytemuck::cast::<_, u8x16>(*from).shuffle(u8x16::new(BYTES[chosen]));
        // `count` is at most the index of these eight in `from`, so there is room for them.
        to[count..count + 8].copy_from_slice(&bytemuck::cast::<_, [u16; 8]>(moved));
        count += chosen.count_ones() as usize;
    }
    count
}

/// `BYTES[m]`: the bytes of the numbers whose bits are set in m, in ascending order, then zeros. 4 KiB.
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

    type Compress = fn(&[u16; CHUNK], &[u16; CHUNK], u16, &mut [u16; CHUNK]) -> usize;

    #[test]
    fn the_chosen_numbers_stand_in_front_in_their_order() {
        let from: [u16; CHUNK] = std::array::from_fn(|lane| 1000 + 7 * lane as u16);
        // All masks of eight neighbours, then some of every lane.
        let neighbours = (0..4 * 256).map(|round: u32| (round & 255) << (8 * (round >> 8)));
        let some = (0..10_000_u32).map(|round| round.wrapping_mul(0x9e37_79b9));
        for chosen in neighbours.chain(some).chain([u32::MAX]) {
            let is_chosen = |lane: usize| chosen >> lane & 1 == 1;
            let expected: Vec<u16> =
                (0..CHUNK).filter(|&lane| is_chosen(lane)).map(|lane| from[lane]).collect();
            // One of the bits chooses; others never do.
            for (bits, one, others) in [(1 << 3, 1 << 3, 0), (0x8001, 0x8000, 0x7ffe), (u16::MAX, 1, 0)] {
                let masks = std::array::from_fn(|lane| others | if is_chosen(lane) { one } else { 0 });
                for compress in [compress_where as Compress, compress_by_table] {
                    let mut to = [0; CHUNK];
                    let count = compress(&from, &masks, bits, &mut to);
                    assert_eq!(to[..count], expected, "{chosen:#b}, bits {bits:#x}");
                }
            }
        }
    }
}
