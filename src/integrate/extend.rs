//! Second stage: what every ray of the queue hits.

use super::World;
use super::queue::{Queue, Work};
use crate::lane::Lane;
use crate::math::{Hit, Ray};
use crate::traverse::Batch;

/// Finds the nearest hit of the first `count` rays.
pub fn extend<L: Lane>(world: &World, work: &mut Work, count: usize) {
    world.primitives.for_batch::<L>(&world.buffers, None, Stage { queue: &mut work.queue, count });
}

struct Stage<'a> {
    queue: &'a mut Queue,
    count: usize,
}

impl<L: Lane> Batch<L> for Stage<'_> {
    #[inline(always)]
    fn run(self, closest: impl Fn(&Ray<L>) -> Hit<L>) {
        for at in (0..self.count).step_by(L::WIDTH) {
            let hit = closest(&self.queue.ray(at));
            self.queue.store_hit(at, &hit);
        }
    }
}
