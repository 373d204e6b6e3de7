//! The shadow-ray queue.
//!
//! For: [`ShadowQueue`].

use super::columns::{Column, IntColumn, Vec3Columns, compress};
use super::queue::PathQueue;
use crate::lane::{Bits, Lane};
use crate::math::{Ray, Vec3};
use crate::traverse::rays::{Hits, Rays};
use bytemuck::Zeroable;

/// Shadow rays, and the radiance that each unoccluded one adds to its pixel.
#[derive(Clone, Copy, Zeroable)]
#[repr(C)]
pub struct ShadowQueue {
    origin: Vec3Columns,
    direction: Vec3Columns,
    /// Hits from here on do not occlude.
    t_max: Column,
    radiance: Vec3Columns,
    slot: IntColumn,
}

impl ShadowQueue {
    /// The first `count` rays; their hits overwrite those in the path queue, which shading has
    /// read, or which waiting paths do not have yet.
    #[inline(always)]
    pub fn queries<'a>(&'a self, queue: &'a mut PathQueue, count: usize) -> (Rays<'a>, Hits<'a>) {
        let rays = Rays::first(count, self.origin.from(0), self.direction.from(0));
        (rays, queue.other_hits(&self.t_max[..count]))
    }
    /// The pixels of the packet at `at`, and the radiance that its rays carry.
    #[inline(always)]
    pub fn contribution<L: Lane>(&self, at: usize) -> (L::Bits, Vec3<L>) {
        (L::Bits::load(&self.slot[at..]), self.radiance.load(at))
    }
    /// Stores the lanes of `mask` from `at` on.
    #[inline(always)]
    pub fn store<L: Lane>(
        &mut self,
        at: usize,
        mask: L::Mask,
        ray: &Ray<L>,
        t_max: L,
        radiance: Vec3<L>,
        slot: L::Bits,
    ) {
        self.origin.store(at, compress(ray.origin, mask));
        self.direction.store(at, compress(ray.direction, mask));
        t_max.compress(mask).store(&mut self.t_max[at..]);
        self.radiance.store(at, compress(radiance, mask));
        slot.compress(mask).store(&mut self.slot[at..]);
    }
}
