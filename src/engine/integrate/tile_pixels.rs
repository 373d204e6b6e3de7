//! Computes the coordinates of a tile's pixels in the picture.

use crate::camera::{BLOCK, MAX_PIXELS, Tile};
use crate::lane::{Bits, F32x16, Lane};
use crate::sampling::{PixelCoordinates, blue_noise};

/// The columns and rows of a tile's pixels from its first, in the order of [`Tile::places`]; entries behind
/// them are unspecified.
type Steps = [[u8; 2]; MAX_PIXELS];

// Whole packets, so that the last one can be read too.
const _: () = assert!(MAX_PIXELS.is_multiple_of(F32x16::WIDTH));

/// The pixels of a tile. Its table is the same for every sample, and for the next tile if that is as large.
pub struct TilePixels {
    tile: Tile,
    /// The number of pixels at the front whose packets are rows of [`BLOCK`] pixels below each other.
    in_blocks: usize,
    steps: Steps,
}

// The pixels of a block are read from one place of the table of shifts.
const _: () = assert!(BLOCK == blue_noise::STRIP);

impl TilePixels {
    /// Creates a table of no tile.
    pub fn new() -> Self {
        let tile = Tile { number: 0, x: 0, y: 0, width: 0, height: 0 };
        Self { tile, in_blocks: 0, steps: [[0; 2]; MAX_PIXELS] }
    }

    /// Sets the tile.
    pub fn begin(&mut self, tile: Tile) {
        let before = std::mem::replace(&mut self.tile, tile);
        let Tile { width, height, .. } = tile;
        if [before.width, before.height] != [width, height] {
            let places = Tile { number: 0, x: 0, y: 0, width, height }.places();
            for (step, place) in self.steps.iter_mut().zip(places) {
                *step = place.map(|coordinate| coordinate as u8);
            }
        }
        let is_aligned = tile.width.is_multiple_of(BLOCK) && tile.x.is_multiple_of(BLOCK);
        let rows = if is_aligned { tile.height / BLOCK * BLOCK } else { 0 };
        self.in_blocks = (rows * tile.width) as usize;
    }

    /// Returns the coordinates of the packet at `at`, a multiple of its width; unspecified beyond the end.
    #[inline(always)]
    pub fn places<L: Lane>(&self, at: usize) -> PixelCoordinates<L> {
        if L::WIDTH == 1 || at < self.in_blocks {
            let [x, y] = self.steps[at];
            PixelCoordinates::Block { x: self.tile.x + u32::from(x), y: self.tile.y + u32::from(y) }
        } else {
            let steps = &self.steps[at..at + L::WIDTH];
            let coordinates = |first: u32, axis: usize| {
                let steps = L::Bits::from_fn(|lane| u32::from(steps[lane][axis]));
                L::Bits::splat(first).wrapping_add(steps)
            };
            PixelCoordinates::Any { x: coordinates(self.tile.x, 0), y: coordinates(self.tile.y, 1) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lane::{F32x8, F32x16, lane_indices};

    fn check<L: Lane>(tile: Tile, pixels: &TilePixels) {
        let expected: Vec<_> = tile.places().collect();
        for at in (0..tile.pixels()).step_by(L::WIDTH) {
            let places = pixels.places::<L>(at);
            // No packet is a block in a last band with fewer rows, nor if columns are unaligned to strips.
            let is_aligned = tile.width.is_multiple_of(BLOCK) && tile.x.is_multiple_of(BLOCK);
            let is_whole = is_aligned && expected[at][1] - tile.y < tile.height / BLOCK * BLOCK;
            let is_block = matches!(places, PixelCoordinates::Block { .. });
            assert_eq!(is_block, is_whole || L::WIDTH == 1, "packet at {at} of {tile:?}");
            let [x, y] = match places {
                PixelCoordinates::Any { x, y } => [x, y],
                PixelCoordinates::Block { x, y } => {
                    let lanes = lane_indices::<L>();
                    let from = |first: u32, steps: L::Bits| L::Bits::splat(first).wrapping_add(steps);
                    [from(x, lanes & L::Bits::splat(BLOCK - 1)), from(y, lanes.shr(BLOCK.ilog2()))]
                }
            };
            for (lane, &place) in expected[at..].iter().take(L::WIDTH).enumerate() {
                assert_eq!([x.get(lane), y.get(lane)], place, "pixel {} of {tile:?}", at + lane);
            }
        }
    }

    #[test]
    fn places_are_those_of_the_tile_and_blocks_where_it_has_them() {
        let mut pixels = TilePixels::new();
        let sizes = [[16, 16], [16, 7], [10, 5], [3, 3], [1, 9], [64, 4], [256, 1], [5, 51]];
        for [width, height] in sizes {
            for [x, y] in [[32, 7], [30, 7], [48, 8], [46, 8]] {
                let tile = Tile { number: 0, x, y, width, height };
                pixels.begin(tile);
                check::<f32>(tile, &pixels);
                check::<F32x8>(tile, &pixels);
                check::<F32x16>(tile, &pixels);
            }
        }
    }

    #[test]
    fn packets_of_whole_blocks_are_blocks() {
        let mut pixels = TilePixels::new();
        pixels.begin(Tile { number: 0, x: 32, y: 7, width: 16, height: 7 });
        let is_block = |at| matches!(pixels.places::<F32x16>(at), PixelCoordinates::Block { .. });
        assert_eq!([0, 48, 64].map(is_block), [true, true, false]);
    }
}
