//! Columns of a structure-of-arrays queue.
//!
//! For: [`Column`], [`IntColumn`], [`Vec3Columns`].

use crate::camera::MAX_PIXELS;
use crate::lane::{F32x16, Lane};
use crate::math::Vec3;
use bytemuck::Zeroable;

/// Paths of earlier tiles that wait, at most, when a tile begins.
pub const MAX_EARLIER: usize = 2 * MAX_PIXELS;
/// Those, a tile's, and the widest packet more, so that the last packet may be stored whole. Columns are
/// three quarters of a page and a cache line apart, so that the same part of all columns is spread evenly
/// over the sets of the cache.
const LENGTH: usize = MAX_EARLIER + MAX_PIXELS + F32x16::WIDTH;

pub type Column = [f32; LENGTH];
pub type IntColumn = [u32; LENGTH];

/// Three columns: a vector or a colour per path.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(64))]
pub struct Vec3Columns {
    pub x: Column,
    pub y: Column,
    pub z: Column,
}

impl Vec3Columns {
    #[inline(always)]
    pub fn load<L: Lane>(&self, at: usize) -> Vec3<L> {
        Vec3::new(L::load(&self.x[at..]), L::load(&self.y[at..]), L::load(&self.z[at..]))
    }
    pub fn from(&self, first: usize) -> [&[f32]; 3] {
        [&self.x, &self.y, &self.z].map(|column| &column[first..])
    }
    #[inline(always)]
    pub fn store<L: Lane>(&mut self, at: usize, v: Vec3<L>) {
        v.x.store(&mut self.x[at..]);
        v.y.store(&mut self.y[at..]);
        v.z.store(&mut self.z[at..]);
    }
}

/// The lanes of `mask`, moved to the front.
#[inline(always)]
pub fn compress<L: Lane>(v: Vec3<L>, mask: L::Mask) -> Vec3<L> {
    Vec3::new(v.x.compress(mask), v.y.compress(mask), v.z.compress(mask))
}
