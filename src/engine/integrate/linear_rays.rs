//! The rays of a tile as they are traced where every primitive is tested.
//!
//! For: [`LinearRays`], a batch of primary, bounce or shadow rays.

use super::queue::PathQueue;
use super::shadow_queue::ShadowQueue;
use crate::camera::Pinhole;
use crate::lane::Lane;
use crate::math::Ray;
use crate::traverse::Batch;
use std::ops::Range;

/// Where rays are read from.
pub enum RaySource<'a> {
    /// From this camera, in the directions of the path queue.
    Camera(Pinhole),
    /// The path queue.
    Paths,
    /// The shadow-ray queue.
    Shadow(&'a ShadowQueue),
}

/// Rays, and the path queue, which receives their hits. Those of shadow rays overwrite the paths' own, which
/// shading has read.
pub struct LinearRays<'a> {
    pub source: RaySource<'a>,
    pub queue: &'a mut PathQueue,
    /// The rays' indices in their queue, and those of their hits in the path queue.
    pub range: Range<usize>,
}

impl<L: Lane> Batch<L> for LinearRays<'_> {
    #[inline(always)]
    fn range(&self) -> Range<usize> {
        self.range.clone()
    }
    #[inline(always)]
    fn ray(&self, at: usize) -> Ray<L> {
        match self.source {
            RaySource::Camera(camera) => Ray { origin: camera.origin(), direction: self.queue.primary(at).0 },
            RaySource::Paths => self.queue.ray(at),
            RaySource::Shadow(queue) => queue.ray(at),
        }
    }
    #[inline(always)]
    fn t_max(&self, at: usize) -> L {
        match self.source {
            RaySource::Shadow(queue) => queue.t_max(at),
            _ => L::splat(f32::INFINITY),
        }
    }
    #[inline(always)]
    fn nearest(&self, at: usize) -> (L, L::Bits) {
        self.queue.nearest(at)
    }
    #[inline(always)]
    fn store_nearest(&mut self, at: usize, t: L, primitive: L::Bits) {
        self.queue.store_nearest(at, t, primitive);
    }
    #[inline(always)]
    fn store_barycentrics(&mut self, at: usize, u: L, v: L) {
        self.queue.store_barycentrics(at, u, v);
    }
}
