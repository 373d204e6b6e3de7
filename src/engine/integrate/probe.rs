//! Path lengths by pixel, for the heat maps of the viewer.
//!
//! For: [`Probe`] and [`PathShape`]. May import: `columns`, `camera` (the size of a tile). Must never know:
//! scenes, stages.

use super::columns::IntColumn;
use crate::camera::MAX_PIXELS;
use crate::lane::Lane;

/// The number of segments of a pixel's path, and the occupancy of the packets that traced them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathShape {
    /// Rays: 1 without a bounce.
    pub segments: u32,
    /// Active lanes of the packets that held them, summed.
    pub lanes: u32,
}

/// Records the shape of a tile's paths, by slot.
pub struct Probe {
    /// One for each path of the tile.
    pub paths: [PathShape; MAX_PIXELS],
}

impl Default for Probe {
    fn default() -> Self {
        Self { paths: [PathShape::default(); MAX_PIXELS] }
    }
}

impl Probe {
    /// Adds a segment to the first `rays` paths. Before the first bounce each is at the index of its slot.
    #[cold]
    #[inline(never)]
    pub fn record<L: Lane>(&mut self, slots: &IntColumn, bounces: u32, rays: usize) {
        for (at, &slot) in slots.iter().enumerate().take(rays) {
            let packet = at - at % L::WIDTH;
            let path = &mut self.paths[if bounces == 0 { at } else { slot as usize }];
            path.segments += 1;
            path.lanes += L::WIDTH.min(rays - packet) as u32;
        }
    }
}
