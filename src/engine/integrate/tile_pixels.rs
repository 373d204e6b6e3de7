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
