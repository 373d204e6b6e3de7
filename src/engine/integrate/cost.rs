//! What it takes to find what a camera ray meets.

use super::World;
use super::guides::aim;
use crate::camera::MAX_PIXELS;
use super::queue::{Work};
use crate::traverse::batch::Traversal;
use crate::traverse::tally::Counts;

/// Tests of one ray by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cost {
    pub boxes: u32,
    /// Spheres and triangles.
    pub primitives: u32,
}

impl From<Counts> for Cost {
    fn from(counts: Counts) -> Self {
        Self {
            boxes: counts.boxes.tests as u32,
            primitives: (counts.spheres.tests + counts.triangles.tests) as u32,
        }
    }
}

/// The costs of a row of pixels, of the rays through their middles.
pub(crate) fn of_row(world: &World, tile_size: [u32; 2], y: u32, row: &mut [Cost], work: &mut Work) {
    let Some((hierarchy, traversal)) = world.primitives.hierarchy() else {
        let tiles_across = row.len().div_ceil(tile_size[0] as usize);
        let first = (y / tile_size[1]) as usize * tiles_across;
        for (tile, pixels) in row.chunks_mut(tile_size[0] as usize).enumerate() {
            let [spheres, triangles] =
                world.primitives.linear(&world.buffers, world.visible.get(first + tile));
            pixels.fill(Cost { boxes: 0, primitives: (spheres + triangles) as u32 });
        }
        return;
    };
    // Rays by themselves: what they share with others has no pixel of its own.
    let traversal = if traversal == Traversal::Scalar { Traversal::Scalar } else { Traversal::Single };
    for (part, pixels) in row.chunks_mut(MAX_PIXELS).enumerate() {
        aim(world, [(part * MAX_PIXELS) as u32, y], pixels.len(), work);
        for (at, cost) in pixels.iter_mut().enumerate() {
            *cost = work.count_one(hierarchy, traversal, at).into();
        }
    }
}
