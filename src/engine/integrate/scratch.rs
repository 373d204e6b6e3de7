//! A thread's working memory.

use super::meter::Observer;
use super::queue::IntColumn;
use super::queue::PathQueue;
use super::queue::ShadowQueue;
use super::radiance::Radiance;
use super::stats::Stats;
use super::tile_pixels::TilePixels;
use crate::sampling::SampleTable;
use crate::traverse::Tracer;
use bytemuck::Zeroable;

/// One thread's working memory. In use at a time are 25 KiB, which a first-level cache holds, 11 more for
/// each 256 paths that wait, 12 for shadow rays, and the memory of the traversals of a hierarchy.
pub struct Scratch {
    /// The paths that are alive: those that wait, then those of a tile.
    pub queue: PathQueue,
    /// The shadow rays of a stage.
    pub shadow_queue: ShadowQueue,
    /// The values of the sample that is being taken.
    pub values: SampleTable,
    /// The places of the tile's pixels.
    pub pixels: Box<TilePixels>,
    /// Texels of the hits that are to be shaded.
    pub texels: IntColumn,
    /// The sample's radiance.
    pub radiance: Radiance,
    /// What traversals work with.
    pub tracer: Tracer,
    /// Statistics and path lengths, while they are wanted.
    pub observer: Observer,
}

impl Scratch {
    /// Empty queues on the heap.
    pub fn new() -> Box<Self> {
        Box::new(Self {
            queue: PathQueue::zeroed(),
            shadow_queue: ShadowQueue::zeroed(),
            values: SampleTable::default(),
            pixels: Box::new(TilePixels::new()),
            texels: IntColumn::zeroed(),
            radiance: Radiance::zeroed(),
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
