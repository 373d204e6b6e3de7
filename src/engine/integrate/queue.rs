//! The paths of a tile in structure-of-arrays form.

use super::extend::Segments;
use super::light::ShadowQueue;
use super::stats::{Meter, RayKind, Stage, Stats};
use super::World;
use crate::camera::{MAX_PIXELS, Tile};
use crate::lane::{Bits, F32x8, Lane};
use crate::math::{Hit, MISS, Ray, Vec3};
use crate::traverse::Visible;
use crate::traverse::batch::{Tracer, Traversal};
use crate::traverse::hierarchy::Hierarchy;
use crate::traverse::rays::{Hits, Rays};
use crate::traverse::tally::{Counter, Counts};
use bytemuck::Zeroable;

/// One packet more, so that the last packet may be stored whole.
const LENGTH: usize = MAX_PIXELS + F32x8::WIDTH;

pub type Column = [f32; LENGTH];
pub type Integers = [u32; LENGTH];

/// Three columns: a vector or a colour per path.
#[derive(Clone, Copy, Zeroable)]
#[repr(C)]
pub struct Vectors {
    pub x: Column,
    pub y: Column,
    pub z: Column,
}

impl Vectors {
    #[inline(always)]
    pub fn load<L: Lane>(&self, at: usize) -> Vec3<L> {
        Vec3::new(L::load(&self.x[at..]), L::load(&self.y[at..]), L::load(&self.z[at..]))
    }
    pub fn first(&self, count: usize) -> [&[f32]; 3] {
        [&self.x[..count], &self.y[..count], &self.z[..count]]
    }
    #[inline(always)]
    pub fn store<L: Lane>(&mut self, at: usize, v: Vec3<L>) {
        v.x.store(&mut self.x[at..]);
        v.y.store(&mut self.y[at..]);
        v.z.store(&mut self.z[at..]);
    }
}

/// A tile's paths, and what their last segment hit.
#[derive(Clone, Copy, Zeroable)]
#[repr(C)]
pub struct Queue {
    origin: Vectors,
    direction: Vectors,
    /// What radiance found from here on counts for in the pixel.
    throughput: Vectors,
    /// One over the density of the path's direction, per solid angle; 0 where light sampling could not have drawn it. Only where lights
    /// are sampled.
    inv_pdf: Column,
    /// Key of the path's random numbers.
    key: Integers,
    /// The path's pixel, counted row by row within its tile.
    slot: Integers,
    t: Column,
    primitive: Integers,
    u: Column,
    v: Column,
}

/// Radiance found by some paths, to be added to their pixels.
#[derive(Clone, Copy, Zeroable)]
#[repr(C)]
struct Events {
    radiance: Vectors,
    slot: Integers,
}

/// One thread's working memory: 24 KiB, which a first-level cache holds, 12 more for rays to lights, and that of traversals of a hierarchy.
pub struct Work {
    pub queue: Queue,
    pub search: ShadowQueue,
    tracer: Tracer,
    events: Events,
    /// One sample's radiance of each pixel of the tile.
    radiance: Vectors,
    /// Notes what the work takes, where somebody asks.
    meter: Option<Box<Meter>>,
    /// Notes how far each pixel's path goes, where somebody asks.
    probe: Option<Box<Probe>>,
    /// The same one while nobody asks.
    idle_probe: Option<Box<Probe>>,
}

/// How far a pixel's path went, and how full the packets were that it went in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathShape {
    /// Rays: 1 without a bounce.
    pub segments: u32,
    /// Active lanes of the packets that held them, summed.
    pub lanes: u32,
}

/// Notes the shape of a tile's paths, by slot.
pub struct Probe {
    pub paths: [PathShape; MAX_PIXELS],
}

impl Default for Probe {
    fn default() -> Self {
        Self { paths: [PathShape::default(); MAX_PIXELS] }
    }
}

impl Probe {
    /// The first `rays` paths have a segment more. Before the first bounce each stands at the slot of its own number.
    #[cold]
    #[inline(never)]
    fn note<L: Lane>(&mut self, slots: &Integers, bounces: u32, rays: usize) {
        for (at, &slot) in slots.iter().enumerate().take(rays) {
            let packet = at - at % L::WIDTH;
            let path = &mut self.paths[if bounces == 0 { at } else { slot as usize }];
            path.segments += 1;
            path.lanes += L::WIDTH.min(rays - packet) as u32;
        }
    }
}

/// A path as it leaves a surface.
#[derive(Clone, Copy)]
pub struct Path<L: Lane> {
    pub ray: Ray<L>,
    pub throughput: Vec3<L>,
    /// One over the density of the ray's direction, in sr; 0 where light sampling could not have drawn it.
    pub inv_pdf: L,
    pub key: L::Bits,
    pub slot: L::Bits,
}

impl Queue {
    /// The first `count` rays, and their hits.
    pub fn segments(&mut self, count: usize) -> Segments<'_> {
        let Queue { origin, direction, t, primitive, u, v, .. } = self;
        Segments { count, origin, direction, t_max: None, t, primitive, u, v }
    }
    /// The first `count` rays.
    pub fn rays(&self, count: usize) -> Rays<'_> {
        Rays { origin: self.origin.first(count), direction: self.direction.first(count) }
    }
    #[inline(always)]
    pub fn ray<L: Lane>(&self, at: usize) -> Ray<L> {
        Ray { origin: self.origin.load(at), direction: self.direction.load(at) }
    }
    /// `lights`: are lights sampled? Without, what it says of densities means nothing.
    #[inline(always)]
    pub fn path<L: Lane>(&self, at: usize, lights: bool) -> Path<L> {
        Path {
            ray: self.ray(at),
            throughput: self.throughput.load(at),
            inv_pdf: if lights { L::load(&self.inv_pdf[at..]) } else { L::zero() },
            key: L::Bits::load(&self.key[at..]),
            slot: L::Bits::load(&self.slot[at..]),
        }
    }
    /// Direction and key of a path at its first segment, where origin, throughput and slot follow from the place in the queue.
    #[inline(always)]
    pub fn primary<L: Lane>(&self, at: usize) -> (Vec3<L>, L::Bits) {
        (self.direction.load(at), L::Bits::load(&self.key[at..]))
    }
    #[inline(always)]
    pub fn store_primary<L: Lane>(&mut self, at: usize, direction: Vec3<L>, key: L::Bits) {
        self.direction.store(at, direction);
        key.store(&mut self.key[at..]);
    }
    /// Where the ray at `at` and those of its packet start, where a traversal reads it.
    #[inline(always)]
    pub fn store_origin<L: Lane>(&mut self, at: usize, origin: Vec3<L>) {
        self.origin.store(at, origin);
    }
    #[inline(always)]
    pub fn store_path<L: Lane>(&mut self, at: usize, path: &Path<L>, lights: bool) {
        self.origin.store(at, path.ray.origin);
        self.direction.store(at, path.ray.direction);
        self.throughput.store(at, path.throughput);
        if lights {
            path.inv_pdf.store(&mut self.inv_pdf[at..]);
        }
        path.key.store(&mut self.key[at..]);
        path.slot.store(&mut self.slot[at..]);
    }
    /// Brings the directions of the first `count` paths back to unit length.
    pub fn normalize_directions<L: Lane>(&mut self, count: usize) {
        for at in (0..count).step_by(L::WIDTH) {
            let direction: Vec3<L> = self.direction.load(at);
            self.direction.store(at, direction.normalize());
        }
    }
    #[inline(always)]
    pub fn hit<L: Lane>(&self, at: usize) -> Hit<L> {
        Hit {
            t: L::load(&self.t[at..]),
            primitive: L::Bits::load(&self.primitive[at..]),
            u: L::load(&self.u[at..]),
            v: L::load(&self.v[at..]),
        }
    }
    /// `barycentric`: are there triangles? Without, what the queue says of u and v means nothing.
    #[inline(always)]
    pub fn store_hit<L: Lane>(&mut self, at: usize, hit: &Hit<L>, barycentric: bool) {
        hit.t.store(&mut self.t[at..]);
        hit.primitive.store(&mut self.primitive[at..]);
        if barycentric {
            hit.u.store(&mut self.u[at..]);
            hit.v.store(&mut self.v[at..]);
        }
    }
}

impl<L: Lane> Path<L> {
    /// The lanes of a indices moved to the front.
    #[inline(always)]
    pub fn compress(&self, indices: L::CompressIndices) -> Self {
        Path {
            ray: Ray {
                origin: compress(self.ray.origin, indices),
                direction: compress(self.ray.direction, indices),
            },
            throughput: compress(self.throughput, indices),
            inv_pdf: self.inv_pdf.compress(indices),
            key: L::compress_bits(self.key, indices),
            slot: L::compress_bits(self.slot, indices),
        }
    }
}

#[inline(always)]
pub fn compress<L: Lane>(v: Vec3<L>, indices: L::CompressIndices) -> Vec3<L> {
    Vec3::new(v.x.compress(indices), v.y.compress(indices), v.z.compress(indices))
}

/// Never in line: hardly ever wanted.
#[cold]
#[inline(never)]
fn note_segment(meter: &mut Meter, world: &World, tile: Tile, bounces: u32, (rays, width): (usize, usize)) {
    let visible = if bounces == 0 { world.visible.get(tile.number) } else { None };
    meter.segment(bounces, rays, width, tests_of_each(world, visible));
}

/// How many spheres and triangles each ray is tested against, where there is no hierarchy.
fn tests_of_each(world: &World, visible: Option<&Visible>) -> Option<[usize; 2]> {
    let linear = world.primitives.hierarchy().is_none();
    linear.then(|| world.primitives.linear(&world.buffers, visible))
}

impl Work {
    pub fn new() -> Box<Self> {
        let (queue, events, radiance) = (Queue::zeroed(), Events::zeroed(), Vectors::zeroed());
        Box::new(Self {
            queue,
            search: ShadowQueue::zeroed(),
            events,
            radiance,
            tracer: Tracer::new(),
            meter: None,
            probe: None,
            idle_probe: None,
        })
    }

    /// Notes what the work takes from here on.
    pub fn start_stats(&mut self) {
        self.meter = Some(Box::default());
    }
    /// What was noted; from here on no more is.
    pub fn take_stats(&mut self) -> Stats {
        self.meter.take().map(|meter| meter.stats()).unwrap_or_default()
    }
    /// Says which stage begins; `None` after the last.
    #[inline(always)]
    pub fn enter(&mut self, stage: Option<Stage>) {
        if let Some(meter) = &mut self.meter {
            meter.enter(stage);
        }
    }
    /// Says which stage begins, and that so many rays have bounced so many times.
    #[inline(always)]
    pub fn enter_with<L: Lane>(
        &mut self,
        stage: Stage,
        world: &World,
        tile: Tile,
        bounces: u32,
        rays: usize,
    ) {
        if let Some(meter) = &mut self.meter {
            note_segment(meter, world, tile, bounces, (rays, L::WIDTH));
            meter.enter(Some(stage));
        }
        if let Some(probe) = &mut self.probe {
            probe.note::<L>(&self.queue.slot, bounces, rays);
        }
    }

    /// Notes from here on how far the paths of a tile go.
    pub fn start_probe(&mut self) {
        let probe = self.idle_probe.take();
        let probe = self.probe.insert(probe.unwrap_or_default());
        probe.paths.fill(PathShape::default());
    }
    /// What was noted of the tile's pixels, row by row; from here on no more is.
    pub fn end_probe(&mut self) -> &Probe {
        self.idle_probe = self.probe.take();
        self.idle_probe.get_or_insert_default()
    }

    /// Says that rays to lights are traced next, and how many.
    #[inline(always)]
    pub fn enter_search<L: Lane>(&mut self, world: &World, rays: usize) {
        if let Some(meter) = &mut self.meter {
            meter.search(rays, L::WIDTH, tests_of_each(world, None));
            meter.enter(Some(Stage::Light));
        }
    }

    /// Finds out which of the first `count` rays to lights meet something within their reach: notes it as their hit in the queue.
    pub fn trace_search(&mut self, hierarchy: &Hierarchy, traversal: Traversal, count: usize) {
        let counter = self.meter.as_ref().map(|meter| meter.counter(RayKind::Light));
        let segments = self.search.segments(&mut self.queue, count);
        segments.trace::<true>(&mut self.tracer, hierarchy, traversal, counter);
    }

    /// Finds the nearest hits of the first `count` rays, primary ones or others, in a hierarchy.
    #[inline(always)]
    pub fn trace(&mut self, hierarchy: &Hierarchy, traversal: Traversal, count: usize, kind: RayKind) {
        let before = self.meter.as_mut().and_then(|meter| meter.enter(Some(Stage::Trace)));
        let counter = self.meter.as_ref().map(|meter| meter.counter(kind));
        self.queue.segments(count).trace::<false>(&mut self.tracer, hierarchy, traversal, counter);
        self.enter(before);
    }

    /// What it takes to find the nearest hit of the ray at `at`, traced by itself.
    pub fn count_one(&mut self, hierarchy: &Hierarchy, traversal: Traversal, at: usize) -> Counts {
        let counter = Counter::default();
        let rays = self.queue.rays(at + 1).range(at..at + 1);
        let (mut t, mut primitive, mut u, mut v) = ([f32::INFINITY], [MISS], [0.0], [0.0]);
        let mut hits = Hits { t: &mut t, primitive: &mut primitive, u: &mut u, v: &mut v };
        self.tracer.count::<false>(traversal, hierarchy, &rays, &mut hits, &counter);
        counter.get()
    }

    /// Sets the radiance of the pixels `at`, … where every path is still at the slot of its own number.
    #[inline(always)]
    pub fn set_radiance<L: Lane>(&mut self, at: usize, radiance: Vec3<L>) {
        self.radiance.store(at, radiance);
    }

    /// Notes radiance for the lanes of `mask`, behind `events` earlier ones; returns how many there are now. Counted by
    /// [`Work::flush`].
    #[inline(always)]
    pub fn note<L: Lane>(&mut self, events: usize, mask: L::Mask, slot: L::Bits, radiance: Vec3<L>) -> usize {
        use crate::lane::Mask;
        let indices = L::compress_indices(mask);
        self.events.radiance.store(events, compress(radiance, indices));
        L::compress_bits(slot, indices).store(&mut self.events.slot[events..]);
        events + mask.count()
    }

    /// Adds the first `events` noted events to their pixels, in their order.
    pub fn flush(&mut self, events: usize) {
        let Vectors { x, y, z } = &self.events.radiance;
        for (((&slot, &r), &g), &b) in self.events.slot.iter().zip(x).zip(y).zip(z).take(events) {
            let slot = slot as usize;
            self.radiance.x[slot] += r;
            self.radiance.y[slot] += g;
            self.radiance.z[slot] += b;
        }
    }

    /// Cuts radiance off above `most`. What is not finite stays, to be counted at the film.
    pub fn clamp(&mut self, most: f32) {
        let Vectors { x, y, z } = &mut self.radiance;
        for value in [x, y, z].into_iter().flatten().filter(|value| **value > most && value.is_finite()) {
            *value = most;
        }
    }

    /// Red, green and blue of the tile's pixels, row by row; what stands behind them is unspecified.
    pub fn radiance(&self) -> [&[f32]; 3] {
        [&self.radiance.x, &self.radiance.y, &self.radiance.z]
    }
}
