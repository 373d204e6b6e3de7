//! Stores the radiance of one sample of the pixels of all tiles that are traced together.

use super::queue::{IntColumn, Vec3Columns, compress};
use crate::camera::MAX_PIXELS;
use crate::lane::{Bits, Lane, Mask};
use crate::math::Vec3;
use bytemuck::Zeroable;

/// The largest number of tiles that are traced together.
pub const MAX_TILES: usize = 8;

/// The pixels of these tiles, and a quarter of a page and a cache line more, so that red, green and blue of a
/// pixel are in different sets of the cache.
const LENGTH: usize = MAX_TILES * MAX_PIXELS + 272;

/// The sums of radiance by the slots of [`super::queue::PathQueue`], and the contributions of a stage still
/// to be added.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(64))]
pub struct Radiance {
    contributions: Vec3Columns,
    slots: IntColumn,
    sums: [[f32; LENGTH]; 3],
}

impl Radiance {
    /// Sets the sums of a packet of neighbouring slots, before the first bounce.
    #[inline(always)]
    pub fn set<L: Lane>(&mut self, slot: u32, radiance: Vec3<L>) {
        let (slot, [red, green, blue]) = (slot as usize, &mut self.sums);
        radiance.x.store(&mut red[slot..]);
        radiance.y.store(&mut green[slot..]);
        radiance.z.store(&mut blue[slot..]);
    }

    /// Queues radiance of the lanes of `mask` behind `count` earlier contributions; returns their new number.
    /// [`Radiance::add`] adds them.
    #[inline(always)]
    pub fn push<L: Lane>(&mut self, count: usize, mask: L::Mask, slot: L::Bits, radiance: Vec3<L>) -> usize {
        self.contributions.store(count, compress(radiance, mask));
        slot.compress(mask).store(&mut self.slots[count..]);
        count + mask.count()
    }

    /// Adds the first `count` contributions to their slots, in their order.
    #[inline(never)]
    pub fn add(&mut self, count: usize) {
        let Vec3Columns { x, y, z } = &self.contributions;
        let [red, green, blue] = &mut self.sums;
        let events = self.slots[..count].iter().zip(&x[..count]).zip(&y[..count]).zip(&z[..count]);
        for (((&slot, &r), &g), &b) in events {
            // The slot is below that already; the remainder lets the compiler drop the bounds checks.
            let slot = slot as usize % (MAX_TILES * MAX_PIXELS);
            for (channel, value) in [(&mut *red, r), (&mut *green, g), (&mut *blue, b)] {
                channel[slot] += value;
            }
        }
    }

    /// Clamps the sums of the first `tiles` tiles to `most`. Infinite and NaN values stay, so that the film
    /// counts them.
    pub fn clamp(&mut self, tiles: usize, most: f32) {
        for channel in &mut self.sums {
            let values = channel[..tiles * MAX_PIXELS].iter_mut();
            values.filter(|value| **value > most && value.is_finite()).for_each(|value| *value = most);
        }
    }

    /// Returns red, green and blue of the pixels of the tile of this number among those that were traced
    /// together, in their order; elements behind them are unspecified.
    pub fn of_tile(&self, number: usize) -> [&[f32]; 3] {
        self.sums.each_ref().map(|channel| &channel[number * MAX_PIXELS..][..MAX_PIXELS])
    }
}
