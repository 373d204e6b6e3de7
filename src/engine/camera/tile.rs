//! Divides a picture into tiles.

/// The largest number of pixels in a tile: the paths of more do not fit a first-level cache. Tiles of 512
/// pixels are not faster, and smaller ones are slower.
pub const MAX_PIXELS: usize = 256;

/// The columns and rows of the blocks in which a tile's pixels are numbered: a packet of sixteen.
pub const BLOCK: u32 = 4;

/// A rectangle of pixels, at most [`MAX_PIXELS`] of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// The index in the picture's order of tiles.
    pub number: usize,
    /// The first column.
    pub x: u32,
    /// The first row.
    pub y: u32,
    /// The number of pixels in a row.
    pub width: u32,
    /// The number of rows.
    pub height: u32,
}

impl Tile {
    /// Iterates over the tiles of a picture, row by row, each at most `size` pixels wide and high.
    pub fn cover(resolution: [u32; 2], size: [u32; 2]) -> impl Iterator<Item = Tile> {
        let starts = move |axis: usize| (0..resolution[axis]).step_by(size[axis] as usize);
        let corners = starts(1).flat_map(move |y| starts(0).map(move |x| (x, y)));
        corners.enumerate().map(move |(number, (x, y))| Tile {
            number,
            x,
            y,
            width: size[0].min(resolution[0] - x),
            height: size[1].min(resolution[1] - y),
        })
    }
    /// Returns the number of pixels.
    pub fn pixels(&self) -> usize {
        (self.width * self.height) as usize
    }
    /// Iterates over the column and row in the picture of each pixel, in the order in which pixels are
    /// numbered: in bands of [`BLOCK`] rows, in a band by blocks of [`BLOCK`] columns, in a block row by row;
    /// the last band and the last block may be smaller. A packet of rays therefore sees a square or half of
    /// one, with fewer edges and primitives than a row of as many pixels.
    pub fn places(self) -> impl Iterator<Item = [u32; 2]> {
        let blocks = |length: u32| {
            (0..length).step_by(BLOCK as usize).map(move |first| (first, BLOCK.min(length - first)))
        };
        blocks(self.height).flat_map(move |(top, rows)| {
            blocks(self.width).flat_map(move |(left, columns)| {
                let rows = self.y + top..self.y + top + rows;
                rows.flat_map(move |y| (0..columns).map(move |column| [self.x + left + column, y]))
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sixteen_pixels_of_a_full_tile_are_a_block() {
        let tile = Tile { number: 0, x: 0, y: 0, width: 16, height: 16 };
        let places: Vec<_> = tile.places().collect();
        assert_eq!(&places[..6], &[[0, 0], [1, 0], [2, 0], [3, 0], [0, 1], [1, 1]]);
        assert_eq!((places[16], places[64], places[255]), ([4, 0], [0, 4], [15, 15]));
    }
}
