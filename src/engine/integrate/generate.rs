//! First stage: generates primary rays.
//!
//! For: [`generate`], a ray through a random point of every pixel of a tile, and [`pixel_centers`], rays
//! through their centres. May import: `intersect`, `scratch` and what stands above them. Must never know:
//! shading.
//!
//! Where every primitive is tested, generation and intersection are one pass, so that rays need not be read
//! back.

use super::context::TraceContext;
use super::features::has;
use super::intersect::intersect_linear;
use super::queue::{PathQueue, primary_slots};
use super::scratch::Scratch;
use super::stats::RayKind;
use crate::buffers::Features;
use crate::camera::{Pinhole, Tile};
use crate::lane::{Bits, F32x8, Lane, lane_indices};
use crate::math::{Hit, Ray};
use crate::sampling::SampleValues;
use crate::traverse::Batch;

/// Fills the queue with the tile's pixels, row by row, finds what they hit, and returns how many there are.
pub fn generate<L: Lane, const N: u32>(
    context: &TraceContext,
    tile: Tile,
    sample: u32,
    scratch: &mut Scratch,
) -> usize {
    let (count, visible) = (tile.pixels(), context.visible.get(tile.number));
    scratch.values.begin(context.sampler, context.seed, sample);
    let numbers = scratch.values.pixel();
    let batch = GenerateBatch::<N> { context, tile, sample, numbers, queue: &mut scratch.queue };
    let hierarchy = context.primitives.hierarchy();
    if hierarchy.is_none() && context.primitives.uses_default_methods() {
        context.primitives.for_default_batch::<L>(&context.buffers, visible, batch);
        return count;
    }
    Batch::<L>::run(batch, |_| Hit::miss());
    for at in (0..count).step_by(L::WIDTH) {
        scratch.queue.store_origin::<L>(at, context.camera.origin());
    }
    match hierarchy {
        Some((hierarchy, traversal)) => {
            scratch.intersect_hierarchy(hierarchy, traversal, count, RayKind::Primary);
        }
        None => intersect_linear::<L>(context, visible, scratch.queue.queries(count)),
    }
    count
}

struct GenerateBatch<'a, const N: u32> {
    context: &'a TraceContext,
    tile: Tile,
    sample: u32,
    numbers: SampleValues,
    queue: &'a mut PathQueue,
}

impl<L: Lane, const N: u32> Batch<L> for GenerateBatch<'_, N> {
    #[inline(always)]
    fn run(self, closest: impl Fn(&Ray<L>) -> Hit<L>) {
        let Tile { x: left, y: top, width, .. } = self.tile;
        let camera: Pinhole = self.context.camera;
        let (left, top) = (L::splat(left as f32), L::splat(top as f32));
        // Rows by multiplication: exact, because slots are below 2¹⁰ and the quotient is rounded down from
        // half a step up.
        let (per_row, row_length) = (L::splat(1.0 / width as f32), L::splat(width as f32));
        let half = L::splat(0.5);
        let TraceContext { sampler, seed, .. } = *self.context;
        for at in (0..self.tile.pixels()).step_by(L::WIDTH) {
            let slot = L::from_int(primary_slots::<L>(at));
            let row = L::from_int(((slot + half) * per_row).truncate_to_int());
            let (x, y) = (left + row.neg_mul_add(row_length, slot), top + row);
            // Exact: there are fewer than 2²⁸ pixels, but neither factor has more than 14 bits.
            let pixel = y.truncate_to_int().wrapping_mul(L::Bits::splat(self.context.width));
            let pixel = pixel.wrapping_add(x.truncate_to_int());
            let key = sampler.key(seed, pixel, self.sample);
            let (jitter_x, jitter_y) = self.numbers.get_2d::<L>(key, 0);
            let ray = camera.rays(x + jitter_x, y + jitter_y);
            self.queue.store_primary(at, ray.direction, key);
            self.queue.store_hit(at, &closest(&ray), has(N, Features::TRIANGLES));
        }
    }
}

/// Fills the queue with rays through the centres of `count` pixels of a row, from (x, y) on.
pub(super) fn pixel_centers(context: &TraceContext, [x, y]: [u32; 2], count: usize, scratch: &mut Scratch) {
    type L = F32x8;
    let y = L::splat(y as f32 + 0.5);
    for at in (0..count).step_by(L::WIDTH) {
        let x = L::from_int(lane_indices::<L>()) + L::splat((x as usize + at) as f32 + 0.5);
        let ray = context.camera.rays(x, y);
        scratch.queue.store_primary(at, ray.direction, <L as Lane>::Bits::splat(0));
        scratch.queue.store_origin(at, ray.origin);
    }
}
