//! Hashes a picture: equal bits give equal hashes on any machine.

use super::Picture;

impl Picture {
    /// Returns the 64-bit FNV-1a hash of the picture: of its width and height (u32), then of the red, green
    /// and blue of each pixel (f32), row by row from the top, all as little-endian bytes. An EXR file of the
    /// picture holds the same numbers.
    ///
    /// Source: G. Fowler, L. C. Noll, K.-P. Vo, D. Eastlake, "The FNV Non-Cryptographic Hash Algorithm".
    pub fn hash(&self) -> u64 {
        const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
        const PRIME: u64 = 0x0000_0100_0000_01b3;
        let pixels = self.pixels.as_flattened().iter().map(|channel| channel.to_bits());
        let bytes = [self.width, self.height].into_iter().chain(pixels).flat_map(u32::to_le_bytes);
        bytes.fold(OFFSET_BASIS, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hash_is_fnv_1a_of_the_documented_bytes() {
        // Without pixels, the hash of eight zero bytes, computed by a program in another language.
        assert_eq!(Picture::default().hash(), 0xa8c7_f832_281a_39c5);
        let picture = Picture { width: 1, height: 1, pixels: vec![[1.0, -0.0, 0.5]] };
        assert_eq!(picture.hash(), 0x621e_7a67_bada_ad05);
    }
}
