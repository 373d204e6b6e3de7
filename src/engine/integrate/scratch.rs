//! A thread's working memory.
//!
//! For: [`Scratch`]: queues, one sample's radiance, and the optional meter and probe.

use super::columns::{IntColumn, Vec3Columns, compress};
use super::context::TraceContext;
use super::meter::Meter;
use super::probe::{PathShape, Probe};
use super::queue::PathQueue;
use super::shadow_queue::ShadowQueue;
use super::stats::{RayKind, Stage, Stats};
use super::tile_pixels::TilePixels;
use crate::camera::{MAX_PIXELS, Tile};
use crate::lane::{Bits, Lane, Mask};
use crate::math::{MISS, Vec3};
use crate::sampling::SampleTable;
use crate::traverse::batch::{Tracer, Traversal};
use crate::traverse::counter::{Counter, Counts};
use crate::traverse::hierarchy::Hierarchy;
use crate::traverse::rays::Hits;
use bytemuck::Zeroable;
use std::ops::Range;

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
    tracer: Tracer,
    contributions: Contributions,
    radiance: Radiance,
    /// Measures times and counts while statistics are wanted.
    meter: Option<Box<Meter>>,
    /// Records path lengths while they are wanted.
    probe: Option<Box<Probe>>,
    /// The probe's memory while it is not in use.
    idle_probe: Option<Box<Probe>>,
}

/// Most tiles that are traced together.
pub const MAX_TILES: usize = 8;

/// Pixels of these tiles, and a quarter of a page and a cache line more, so that red, green and blue of a
/// pixel are in different sets of the cache.
const RADIANCE_LENGTH: usize = MAX_TILES * MAX_PIXELS + 272;

/// Red, green and blue of one sample of the pixels of all tiles that are traced together.
#[derive(Clone, Copy, Zeroable)]
#[repr(C, align(64))]
struct Radiance([[f32; RADIANCE_LENGTH]; 3]);

/// Radiance to be added to pixels.
#[derive(Clone, Copy, Zeroable)]
#[repr(C)]
struct Contributions {
    radiance: Vec3Columns,
    slot: IntColumn,
}

/// Not inlined: statistics are rarely on.
#[cold]
#[inline(never)]
fn count_segment(
    meter: &mut Meter,
    context: &TraceContext,
    tile: Option<Tile>,
    bounces: u32,
    (rays, width): (usize, usize),
) {
    let tests = context.linear_tests(tile);
    meter.count_segment(bounces, rays, width, tests);
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
            contributions: Contributions::zeroed(),
            radiance: Radiance::zeroed(),
            tracer: Tracer::new(),
            meter: None,
            probe: None,
            idle_probe: None,
        })
    }

    /// Starts statistics.
    pub fn start_stats(&mut self) {
        self.meter = Some(Box::default());
    }
    /// Ends statistics and returns them.
    pub fn take_stats(&mut self) -> Stats {
        self.meter.take().map(|meter| meter.stats()).unwrap_or_default()
    }
    /// Begins a stage for statistics; `None` after the last.
    #[inline(always)]
    pub fn begin_stage(&mut self, stage: Option<Stage>) {
        if let Some(meter) = &mut self.meter {
            meter.begin(stage);
        }
    }
    /// Begins a stage for statistics, and counts rays that have bounced `bounces` times: primary rays with
    /// their `tile`.
    #[inline(always)]
    pub fn begin_stage_with_rays<L: Lane>(
        &mut self,
        stage: Stage,
        context: &TraceContext,
        tile: Option<Tile>,
        bounces: u32,
        paths: &Range<usize>,
    ) {
        if let Some(meter) = &mut self.meter {
            count_segment(meter, context, tile, bounces, (paths.len(), L::WIDTH));
            meter.begin(Some(stage));
        }
        if let Some(probe) = &mut self.probe {
            probe.record::<L>(&self.queue, bounces, paths.clone());
        }
    }
    /// Begins the shadow-ray stage for statistics, and counts its rays.
    #[inline(always)]
    pub fn begin_shadow_rays<L: Lane>(&mut self, context: &TraceContext, rays: usize) {
        if let Some(meter) = &mut self.meter {
            meter.count_shadow_rays(rays, L::WIDTH, context.linear_shadow_tests());
            meter.begin(Some(Stage::ShadowRays));
        }
    }

    /// Starts to record how long the paths of a tile are.
    pub fn start_probe(&mut self) {
        let probe = self.idle_probe.take();
        let probe = self.probe.insert(probe.unwrap_or_default());
        probe.paths.fill(PathShape::default());
    }
    /// Ends the recording and returns it: the tile's pixels, in the order of
    /// [`crate::camera::Tile::places`].
    pub fn end_probe(&mut self) -> &Probe {
        self.idle_probe = self.probe.take();
        self.idle_probe.get_or_insert_default()
    }

    /// Finds which of the first `count` shadow rays are occluded: their hits in the path queue are not
    /// misses.
    pub fn occlude_in_hierarchy(&mut self, hierarchy: &Hierarchy, traversal: Traversal, count: usize) {
        let counter = self.meter.as_ref().map(|meter| meter.counter(RayKind::Shadow));
        let queries = self.shadow_queue.queries(&mut self.queue, count);
        queries.trace::<true>(&mut self.tracer, hierarchy, traversal, counter);
    }

    /// Finds the nearest hits of a range of the path queue in a hierarchy.
    #[inline(always)]
    pub fn intersect_hierarchy(
        &mut self,
        hierarchy: &Hierarchy,
        traversal: Traversal,
        paths: Range<usize>,
        kind: RayKind,
    ) {
        let before = self.meter.as_mut().and_then(|meter| meter.begin(Some(Stage::Trace)));
        let counter = self.meter.as_ref().map(|meter| meter.counter(kind));
        self.queue.queries(paths).trace::<false>(&mut self.tracer, hierarchy, traversal, counter);
        self.begin_stage(before);
    }

    /// Counts the tests that find the nearest hit of the ray at `at`, traced by itself.
    pub fn count_tests(&mut self, hierarchy: &Hierarchy, traversal: Traversal, at: usize) -> Counts {
        let counter = Counter::default();
        let rays = self.queue.rays(at..at + 1);
        let (mut t, mut primitive, mut u, mut v) = ([f32::INFINITY], [MISS], [0.0], [0.0]);
        let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
        self.tracer.count::<false>(traversal, hierarchy, &rays, &mut hits, &counter);
        counter.get()
    }

    /// Sets the radiance of the pixels of the packet at `at`, before the first bounce.
    #[inline(always)]
    pub fn set_radiance<L: Lane>(&mut self, at: usize, radiance: Vec3<L>) {
        let slot = self.queue.primary_slot(at) as usize;
        let [red, green, blue] = &mut self.radiance.0;
        radiance.x.store(&mut red[slot..]);
        radiance.y.store(&mut green[slot..]);
        radiance.z.store(&mut blue[slot..]);
    }

    /// Queues radiance of the lanes of `mask` behind `count` earlier contributions; returns how many there
    /// are now. [`Scratch::add_contributions`] adds them to their pixels.
    #[inline(always)]
    pub fn push_contribution<L: Lane>(
        &mut self,
        count: usize,
        mask: L::Mask,
        slot: L::Bits,
        radiance: Vec3<L>,
    ) -> usize {
        self.contributions.radiance.store(count, compress(radiance, mask));
        slot.compress(mask).store(&mut self.contributions.slot[count..]);
        count + mask.count()
    }

    /// Adds the first `count` contributions to their pixels, in their order.
    #[inline(never)]
    pub fn add_contributions(&mut self, count: usize) {
        let Contributions { radiance: Vec3Columns { x, y, z }, slot } = &self.contributions;
        let [red, green, blue] = &mut self.radiance.0;
        let events = slot[..count].iter().zip(&x[..count]).zip(&y[..count]).zip(&z[..count]);
        for (((&slot, &r), &g), &b) in events {
            // It is below that already; this lets the compiler drop the bounds checks.
            let slot = slot as usize % (MAX_TILES * MAX_PIXELS);
            for (channel, value) in [(&mut *red, r), (&mut *green, g), (&mut *blue, b)] {
                channel[slot] += value;
            }
        }
    }

    /// Clamps radiance of the first `tiles` tiles to `most`. Infinite and NaN values stay; the film counts
    /// them.
    pub fn clamp_radiance(&mut self, tiles: usize, most: f32) {
        for channel in &mut self.radiance.0 {
            let values = channel[..tiles * MAX_PIXELS].iter_mut();
            values.filter(|value| **value > most && value.is_finite()).for_each(|value| *value = most);
        }
    }

    /// Red, green and blue of the pixels of the tile of this number among those that were traced together, in
    /// their order; elements behind them are unspecified.
    pub fn radiance(&self, number: usize) -> [&[f32]; 3] {
        self.radiance.0.each_ref().map(|channel| &channel[number * MAX_PIXELS..][..MAX_PIXELS])
    }
}
