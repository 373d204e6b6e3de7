//! Second stage: what every ray of the queue hits.

use super::World;
use super::queue::{Queue, Work};
use super::stats::RayKind;
use super::surface::needs;
use crate::buffers::Needs;
use crate::lane::Lane;
use crate::math::{Hit, Ray};
use crate::traverse::Batch;

/// Finds the nearest hit of the first `count` rays.
pub fn extend<L: Lane, const N: u32>(world: &World, work: &mut Work, count: usize) {
    if let Some((hierarchy, traversal)) = world.primitives.hierarchy() {
        work.trace(hierarchy, traversal, count, RayKind::Bounce);
        return;
    }
    let stage = Stage::<N> { queue: &mut work.queue, count };
    if const { N == Needs::ALL.0 } {
        world.primitives.for_batch::<L>(&world.buffers, None, stage);
    } else {
        world.primitives.for_default_batch::<L>(&world.buffers, None, stage);
    }
}

struct Stage<'a, const N: u32> {
    queue: &'a mut Queue,
    count: usize,
}

impl<L: Lane, const N: u32> Batch<L> for Stage<'_, N> {
    #[inline(always)]
    fn run(self, closest: impl Fn(&Ray<L>) -> Hit<L>) {
        for at in (0..self.count).step_by(L::WIDTH) {
            let hit = closest(&self.queue.ray(at));
            self.queue.store_hit(at, &hit, needs(N, Needs::TRIANGLES));
        }
    }
}
