//! First stage: a primary ray through a random point of every pixel of the tile, and what it hits. One pass, so that rays need not
//! be read back.

use super::extend::meet;
use super::queue::{Queue, Work};
use super::stats::RayKind;
use super::surface::has;
use super::World;
use crate::buffers::Features;
use crate::camera::{Pinhole, Tile};
use crate::lane::{Bits, Lane, lane_indices};
use crate::math::{Hit, Ray};
use crate::sampling::{Numbers, random};
use crate::traverse::Batch;

/// Fills the queue with the tile's pixels, row by row, and returns how many there are.
pub fn generate<L: Lane, const N: u32>(world: &World, tile: Tile, sample: u32, work: &mut Work) -> usize {
    let (count, visible) = (tile.pixels(), world.visible.get(tile.number));
    let stage = Stage::<N> { world, tile, sample, queue: &mut work.queue };
    let hierarchy = world.primitives.hierarchy();
    if hierarchy.is_none() && world.primitives.uses_default_methods() {
        world.primitives.for_default_batch::<L>(&world.buffers, visible, stage);
        return count;
    }
    Batch::<L>::run(stage, |_| Hit::miss());
    for at in (0..count).step_by(L::WIDTH) {
        work.queue.store_origin::<L>(at, world.camera.origin());
    }
    match hierarchy {
        Some((hierarchy, traversal)) => work.trace(hierarchy, traversal, count, RayKind::Primary),
        None => meet::<L>(world, visible, work.queue.segments(count)),
    }
    count
}

struct Stage<'a, const N: u32> {
    world: &'a World,
    tile: Tile,
    sample: u32,
    queue: &'a mut Queue,
}

impl<L: Lane, const N: u32> Batch<L> for Stage<'_, N> {
    #[inline(always)]
    fn run(self, closest: impl Fn(&Ray<L>) -> Hit<L>) {
        let Tile { x: left, y: top, width, .. } = self.tile;
        let camera: Pinhole = self.world.camera;
        let (left, top) = (L::splat(left as f32), L::splat(top as f32));
        // Rows by multiplication: exact, because slots are below 2¹⁰ and the quotient is rounded down from half a step up.
        let (per_row, row_length) = (L::splat(1.0 / width as f32), L::splat(width as f32));
        let half = L::splat(0.5);
        let World { sampler, seed, .. } = *self.world;
        let numbers = Numbers::new(sampler, seed, self.sample, random::PIXEL);
        for at in (0..self.tile.pixels()).step_by(L::WIDTH) {
            let slot = L::from_int(slots::<L>(at));
            let row = L::from_int(((slot + half) * per_row).truncate_to_int());
            let (x, y) = (left + row.neg_mul_add(row_length, slot), top + row);
            // Exact: there are fewer than 2²⁸ pixels, but neither factor has more than 14 bits.
            let pixel = y.truncate_to_int().wrapping_mul(L::Bits::splat(self.world.width));
            let pixel = pixel.wrapping_add(x.truncate_to_int());
            let key = sampler.key(seed, pixel, self.sample);
            let (jitter_x, jitter_y) = numbers.pair::<L>(key, 0);
            let ray = camera.rays(x + jitter_x, y + jitter_y);
            self.queue.store_primary(at, ray.direction, key);
            self.queue.store_hit(at, &closest(&ray), has(N, Features::TRIANGLES));
        }
    }
}

/// The pixels of the packet that starts at `at`, before any path has moved.
#[inline(always)]
pub fn slots<L: Lane>(at: usize) -> L::Bits {
    lane_indices::<L>().wrapping_add(L::Bits::splat(at as u32))
}
