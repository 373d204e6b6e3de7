//! Path lengths by pixel, for the heat maps of the viewer.
//!
//! For: [`Probe`] and [`PathShape`].

use super::queue::PathQueue;
use crate::camera::MAX_PIXELS;
use crate::lane::Lane;
use std::ops::Range;

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
    /// Adds a segment to these paths of a queue.
    #[cold]
    #[inline(never)]
    pub fn record<L: Lane>(&mut self, queue: &PathQueue, bounces: u32, paths: Range<usize>) {
        for (number, at) in paths.clone().enumerate() {
            let before = number - number % L::WIDTH;
            let slot = if bounces == 0 { queue.primary_slot(at) } else { queue.slots()[at] };
            let path = &mut self.paths[slot as usize];
            path.segments += 1;
            path.lanes += L::WIDTH.min(paths.len() - before) as u32;
        }
    }
}
