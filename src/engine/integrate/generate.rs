//! The first stage: generates primary rays and finds their hits.
//!
//! Generation is a loop of its own, and so is the test of every primitive: see [`crate::rays::Structure`].
//! Statistics attribute the second loop to [`Stage::Trace`].

use super::context::TraceContext;
use super::intersect::closest_of_queue;
use super::scratch::Scratch;
use super::stats::{RayKind, Stage};
use crate::camera::{BLOCK, PreparedCamera, Tile};
use crate::lane::{Bits, F32x8, F32x16, Lane, lane_indices};
use crate::sampling::{PixelCoordinates, dimension};
use std::ops::Range;

/// Queues the tile's pixels in their order behind `waiting` paths, finds their hits, and returns their range
/// in the queue. `number` is the tile's among those that are traced together.
pub fn generate<L: Lane>(
    context: &TraceContext,
    (number, tile): (usize, Tile),
    sample: u32,
    waiting: usize,
    scratch: &mut Scratch,
) -> Range<usize> {
    let (count, visible) = (tile.pixels(), context.visible.get(tile.number));
    let first = waiting.next_multiple_of(F32x16::WIDTH);
    let paths = first..first + count;
    scratch.queue.begin_tile(number, first);
    scratch.values.begin(context.sampler, context.seed, sample, context.max_bounces);
    scratch.pixels.begin(tile);
    match context.camera.common_origin() {
        Some(_) => camera_rays::<L, true>(context, sample, paths.clone(), scratch),
        None => camera_rays::<L, false>(context, sample, paths.clone(), scratch),
    }
    scratch.observer.begin(Some(Stage::Trace));
    closest_of_queue(context, visible, scratch, paths.clone(), RayKind::Primary);
    paths
}

/// Stores a ray through a random point of each of the tile's pixels: of a `PINHOLE`, or of any camera.
#[inline(always)]
fn camera_rays<L: Lane, const PINHOLE: bool>(
    context: &TraceContext,
    sample: u32,
    paths: Range<usize>,
    scratch: &mut Scratch,
) {
    let Scratch { queue, values, pixels, .. } = scratch;
    let numbers = values.pixel();
    let camera: PreparedCamera = context.camera;
    let TraceContext { sampler, seed, width, .. } = *context;
    for at in paths.clone().step_by(L::WIDTH) {
        let places = pixels.places::<L>(at - paths.start);
        let (x, y, pixel) = match places {
            PixelCoordinates::Block { x, y } => {
                let lanes = lane_indices::<L>();
                let (column, row) = (lanes & L::Bits::splat(BLOCK - 1), lanes.shr(BLOCK.ilog2()));
                let pixel = row.wrapping_mul(L::Bits::splat(width)).wrapping_add(column);
                let first = L::Bits::splat(y * width + x);
                let from = |first: u32, steps: L::Bits| L::splat(first as f32) + L::from_int(steps);
                (from(x, column), from(y, row), first.wrapping_add(pixel))
            }
            PixelCoordinates::Any { x, y } => {
                let before = y.wrapping_mul(L::Bits::splat(width));
                (L::from_int(x), L::from_int(y), before.wrapping_add(x))
            }
        };
        let key = sampler.key(seed, pixel, sample);
        let numbers = numbers.at_pixels(key, places);
        let (jitter_x, jitter_y) = numbers.get_2d(dimension::PIXEL);
        let (x, y) = (x + jitter_x, y + jitter_y);
        let ray = if PINHOLE {
            camera.pinhole_rays(x, y)
        } else {
            let (u, v) = numbers.get_2d(dimension::LENS);
            camera.sample_rays(x, y, u, v)
        };
        queue.store_primary(at, ray.direction, key);
        if !PINHOLE {
            queue.store_origins(at, ray.origin);
        }
    }
}

/// Fills the queue with rays through the centres of `count` pixels of a row, from (x, y) on, and through the
/// middle of the lens.
pub(super) fn pixel_centers(context: &TraceContext, [x, y]: [u32; 2], count: usize, scratch: &mut Scratch) {
    type L = F32x8;
    let y = L::splat(y as f32 + 0.5);
    for at in (0..count).step_by(L::WIDTH) {
        let x = L::from_int(lane_indices::<L>()) + L::splat((x as usize + at) as f32 + 0.5);
        let ray = context.camera.rays(x, y);
        scratch.queue.store_primary(at, ray.direction, <L as Lane>::Bits::splat(0));
        scratch.queue.store_origins(at, ray.origin);
    }
}
