//! A thread's working memory.
//!
//! For: [`Scratch`]: queues, one sample's radiance, and the optional meter and probe. May import: the queues,
//! `meter`, `probe`, `context`. Must never know: what the stages compute.

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

/// One thread's working memory: 25 KiB, which a first-level cache holds, 12 more for shadow rays, 17 more
/// where paths end at emitters, and that of the traversals of a hierarchy.
pub struct Scratch {
    /// The paths that are alive.
    pub queue: PathQueue,
    /// The tile's paths that have ended on a surface, in full packets, for `finish`.
    pub ended: PathQueue,
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
    /// One sample's radiance of each pixel of the tile.
    radiance: Vec3Columns,
    /// Measures times and counts while statistics are wanted.
    meter: Option<Box<Meter>>,
    /// Records path lengths while they are wanted.
    probe: Option<Box<Probe>>,
    /// The probe's memory while it is not in use.
    idle_probe: Option<Box<Probe>>,
}

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
    tile: Tile,
    bounces: u32,
    (rays, width): (usize, usize),
) {
    let tests = context.linear_tests((bounces == 0).then_some(tile));
    meter.count_segment(bounces, rays, width, tests);
}

impl Scratch {
    /// Empty queues on the heap.
    pub fn new() -> Box<Self> {
        let (queue, ended, contributions) =
            (PathQueue::zeroed(), PathQueue::zeroed(), Contributions::zeroed());
        Box::new(Self {
            queue,
            ended,
            shadow_queue: ShadowQueue::zeroed(),
            values: SampleTable::default(),
            pixels: Box::new(TilePixels::new()),
            texels: IntColumn::zeroed(),
            contributions,
            radiance: Vec3Columns::zeroed(),
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
    /// Begins a stage for statistics, and counts `rays` rays that have bounced `bounces` times.
    #[inline(always)]
    pub fn begin_stage_with_rays<L: Lane>(
        &mut self,
        stage: Stage,
        context: &TraceContext,
        tile: Tile,
        bounces: u32,
        rays: usize,
    ) {
        if let Some(meter) = &mut self.meter {
            count_segment(meter, context, tile, bounces, (rays, L::WIDTH));
            meter.begin(Some(stage));
        }
        if let Some(probe) = &mut self.probe {
            probe.record::<L>(self.queue.slots(), bounces, rays);
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

    /// Finds the nearest hits of the first `count` rays of the path queue in a hierarchy.
    #[inline(always)]
    pub fn intersect_hierarchy(
        &mut self,
        hierarchy: &Hierarchy,
        traversal: Traversal,
        count: usize,
        kind: RayKind,
    ) {
        let before = self.meter.as_mut().and_then(|meter| meter.begin(Some(Stage::Trace)));
        let counter = self.meter.as_ref().map(|meter| meter.counter(kind));
        self.queue.queries(count).trace::<false>(&mut self.tracer, hierarchy, traversal, counter);
        self.begin_stage(before);
    }

    /// Counts the tests that find the nearest hit of the ray at `at`, traced by itself.
    pub fn count_tests(&mut self, hierarchy: &Hierarchy, traversal: Traversal, at: usize) -> Counts {
        let counter = Counter::default();
        let rays = self.queue.rays(at + 1).range(at..at + 1);
        let (mut t, mut primitive, mut u, mut v) = ([f32::INFINITY], [MISS], [0.0], [0.0]);
        let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
        self.tracer.count::<false>(traversal, hierarchy, &rays, &mut hits, &counter);
        counter.get()
    }

    /// Sets the radiance of the pixels of the packet at `at`, before the first bounce.
    #[inline(always)]
    pub fn set_radiance<L: Lane>(&mut self, at: usize, radiance: Vec3<L>) {
        self.radiance.store(at, radiance);
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
        let indices = L::compress_indices(mask);
        self.contributions.radiance.store(count, compress(radiance, indices));
        L::compress_bits(slot, indices).store(&mut self.contributions.slot[count..]);
        count + mask.count()
    }

    /// Adds the first `count` contributions to their pixels, in their order.
    #[inline(never)]
    pub fn add_contributions(&mut self, count: usize) {
        let Contributions { radiance: Vec3Columns { x, y, z }, slot } = &self.contributions;
        let Vec3Columns { x: red, y: green, z: blue } = &mut self.radiance;
        let events = slot[..count].iter().zip(&x[..count]).zip(&y[..count]).zip(&z[..count]);
        for (((&slot, &r), &g), &b) in events {
            // It is below the number of pixels already; this lets the compiler drop the bounds checks.
            let slot = slot as usize % MAX_PIXELS;
            red[slot] += r;
            green[slot] += g;
            blue[slot] += b;
        }
    }

    /// Clamps radiance to `most`. Infinite and NaN values stay; the film counts them.
    pub fn clamp_radiance(&mut self, most: f32) {
        let Vec3Columns { x, y, z } = &mut self.radiance;
        for value in [x, y, z].into_iter().flatten().filter(|value| **value > most && value.is_finite()) {
            *value = most;
        }
    }

    /// Red, green and blue of the tile's pixels, in their order; elements behind them are unspecified.
    pub fn radiance(&self) -> [&[f32]; 3] {
        [&self.radiance.x, &self.radiance.y, &self.radiance.z]
    }
}
