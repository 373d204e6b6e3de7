//! What every stage reads.
//!
//! For: [`TraceContext`].

use super::features::{carries_cones, has};
use super::queue::{Path, PathQueue, QueueColumns};
use crate::buffers::{Buffers, Features};
use crate::camera::Pinhole;
use crate::kernel::ray_cone::Cone;
use crate::lane::{Bits, Lane, lane_indices};
use crate::math::Ray;
use crate::sampling::Sampler;
use crate::traverse::{PrimitiveList, Primitives};

/// The scene and settings of a picture, read-only while samples are taken.
pub struct TraceContext {
    /// The scene in flat form.
    pub buffers: Buffers,
    /// The scene for intersection.
    pub primitives: Primitives,
    /// The camera.
    pub camera: Pinhole,
    /// The primitives that the primary rays of each tile can hit, by [`crate::camera::Tile::number`]; empty
    /// where culling does not pay.
    pub visible: Vec<PrimitiveList>,
    /// Pixels in a row of the picture.
    pub width: u32,
    /// Scattering events allowed on a path.
    pub max_bounces: u32,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Where sample values come from.
    pub sampler: Sampler,
}

impl TraceContext {
    /// Whether paths carry ray cones.
    #[inline(always)]
    pub fn carries_cones<const N: u32>(&self) -> bool {
        carries_cones(N, self.buffers.needs)
    }
    /// The columns of the path queue that are stored.
    #[inline(always)]
    pub fn columns<const N: u32>(&self) -> QueueColumns {
        QueueColumns { lights: has(N, Features::LIGHTS), cones: self.carries_cones::<N>() }
    }
    /// The cones of primary rays.
    #[inline(always)]
    pub fn primary_cone<L: Lane, const N: u32>(&self) -> Cone<L> {
        if self.carries_cones::<N>() { Cone::of_pixel(self.camera.pixel_size()) } else { Cone::none() }
    }

    /// The paths of the packet at `at`. `FIRST`: at their first segment, of which the queue holds direction
    /// and key alone.
    #[inline(always)]
    pub fn path<L: Lane, const N: u32, const FIRST: bool>(&self, queue: &PathQueue, at: usize) -> Path<L> {
        if !FIRST {
            return queue.path(at, self.columns::<N>());
        }
        let (direction, key) = queue.primary(at);
        let ray = Ray { origin: self.camera.origin(), direction };
        let slot = lane_indices::<L>().wrapping_add(L::Bits::splat(queue.primary_slot(at)));
        Path::primary(ray, key, slot, self.primary_cone::<L, N>())
    }
}
