//! The division of a picture into tiles.
//!
//! For: [`Tile`]. May import: nothing. Must never know: what is rendered in a tile.

/// Most pixels in a tile. Path queues have this length. Columns for more would lie whole pages apart, all in
/// the same few sets of the cache: 2 % slower.
pub const MAX_PIXELS: usize = 256;

/// A rectangle of pixels, at most [`MAX_PIXELS`] of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tile {
    /// Index in the picture's order of tiles.
    pub number: usize,
    /// Its first column.
    pub x: u32,
    /// Its first row.
    pub y: u32,
    /// Pixels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

impl Tile {
    /// The tiles of a picture, row by row, each at most `size` pixels wide and high.
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
    /// The number of its pixels.
    pub fn pixels(&self) -> usize {
        (self.width * self.height) as usize
    }
}
