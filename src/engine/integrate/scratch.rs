//! The working memory of a thread.

use super::meter::Observer;
use super::queue::IntColumn;
use super::queue::PathQueue;
use super::queue::ShadowQueue;
use super::radiance::Radiance;
use super::stats::Stats;
use super::tile_pixels::TilePixels;
use crate::rays::Tracer;
use crate::sampling::SampleTable;
use bytemuck::Zeroable;

/// One thread's working memory. It uses 25 KiB at a time, which a first-level cache holds, 11 more for each
/// 256 waiting paths, 12 for shadow rays, and the memory of the traversals of a hierarchy.
pub struct Scratch {
    /// The paths that are alive: the waiting ones, then those of a tile.
    pub queue: PathQueue,
    /// The shadow rays of a stage.
    pub shadow_queue: ShadowQueue,
    /// The values of the current sample.
    pub values: SampleTable,
    /// The coordinates of the tile's pixels.
    pub pixels: Box<TilePixels>,
    /// The texels of the hits to be shaded.
    pub texels: IntColumn,
    /// The radiance of the sample.
    pub radiance: Radiance,
    /// The number of rays that passed a hit and were asked again, and are not yet in a ray count.
    pub asked_again: u64,
    /// The memory of traversals.
    pub tracer: Tracer,
    /// Statistics and path lengths, while they are recorded.
    pub observer: Observer,
}

impl Scratch {
    /// Creates empty queues on the heap.
    pub fn new() -> Box<Self> {
        Box::new(Self {
            queue: PathQueue::zeroed(),
            shadow_queue: ShadowQueue::zeroed(),
            values: SampleTable::default(),
            pixels: Box::new(TilePixels::new()),
            texels: IntColumn::zeroed(),
            radiance: Radiance::zeroed(),
            asked_again: 0,
            tracer: Tracer::new(),
            observer: Observer::default(),
        })
    }
    /// Starts statistics.
    pub fn start_stats(&mut self) {
        self.observer.start_stats();
        self.tracer.start_counting();
    }
    /// Ends statistics and returns them.
    pub fn take_stats(&mut self) -> Stats {
        self.tracer.stop_counting();
        self.observer.take_stats()
    }
}
