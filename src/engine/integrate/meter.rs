//! Measures the statistics of one thread, and the lengths of its paths, for the heat maps of the viewer.
//!
//! While nothing is recorded, a stage costs one branch, and nothing is counted.

use super::queue::PathQueue;
use super::stats::{RayKind, Segment, Stage, Stats};
use crate::camera::MAX_PIXELS;
use crate::lane::Lane;
use crate::rays::Tracer;
use std::ops::Range;
use std::time::Instant;

/// The records of one thread's work.
#[derive(Default)]
pub struct Observer {
    /// Times and counts, while statistics are recorded.
    meter: Option<Box<Meter>>,
    /// Path lengths, while they are recorded.
    probe: Option<Box<Probe>>,
    /// The probe's memory while it is not in use.
    idle_probe: Option<Box<Probe>>,
}

impl Observer {
    /// Starts statistics.
    pub fn start_stats(&mut self) {
        self.meter = Some(Box::new(Meter { stats: Stats::default(), stage: None, since: Instant::now() }));
    }
    /// Ends statistics and returns them.
    pub fn take_stats(&mut self) -> Stats {
        self.meter.take().map(|meter| meter.stats).unwrap_or_default()
    }
    /// Attributes the time from now on to this stage, or to none. Returns the previous stage.
    #[inline(always)]
    pub fn begin(&mut self, stage: Option<Stage>) -> Option<Stage> {
        self.meter.as_mut().and_then(|meter| meter.begin(stage))
    }
    /// Begins a stage, and counts rays that have bounced `bounces` times.
    #[inline(always)]
    pub fn begin_rays<L: Lane>(
        &mut self,
        stage: Stage,
        bounces: u32,
        queue: &PathQueue,
        paths: &Range<usize>,
    ) {
        if let Some(meter) = &mut self.meter {
            meter.count_segment(bounces, paths.len(), L::WIDTH);
            meter.begin(Some(stage));
        }
        if let Some(probe) = &mut self.probe {
            probe.record::<L>(queue, bounces, paths.clone());
        }
    }
    /// Begins the shadow-ray stage, and counts its rays.
    #[inline(always)]
    pub fn begin_shadow_rays<L: Lane>(&mut self, rays: usize) {
        if let Some(meter) = &mut self.meter {
            meter.stats.shadow_rays += Segment::of(rays, L::WIDTH);
            meter.begin(Some(Stage::ShadowRays));
        }
    }
    /// Adds rays of paths that have bounced `bounces` times and were asked again, one by one.
    pub fn add_segments(&mut self, bounces: u32, rays: usize) {
        if let Some(meter) = &mut self.meter {
            meter.count_segment(bounces, rays, 1);
        }
    }
    /// Adds shadow rays that were asked again, one by one.
    pub fn add_shadow_rays(&mut self, rays: usize) {
        if let Some(meter) = &mut self.meter {
            meter.stats.shadow_rays += Segment::of(rays, 1);
        }
    }
    /// Adds the tests that a tracer has counted for a kind of ray.
    #[inline(always)]
    pub fn add_tests(&mut self, kind: RayKind, tracer: &mut Tracer) {
        if let Some(meter) = &mut self.meter {
            meter.stats.counts[kind as usize] += tracer.take_counts();
        }
    }
    /// Starts to record the lengths of a tile's paths.
    pub fn start_probe(&mut self) {
        let probe = self.idle_probe.take();
        let probe = self.probe.insert(probe.unwrap_or_default());
        probe.paths.fill(PathShape::default());
    }
    /// Ends the recording and returns it: the tile's pixels, in the order of [`crate::camera::Tile::places`].
    pub fn end_probe(&mut self) -> &Probe {
        self.idle_probe = self.probe.take();
        self.idle_probe.get_or_insert_default()
    }
}

/// The running statistics of one thread.
#[derive(Debug)]
struct Meter {
    stats: Stats,
    /// The current stage.
    stage: Option<Stage>,
    since: Instant,
}

impl Meter {
    #[cold]
    #[inline(never)]
    fn begin(&mut self, stage: Option<Stage>) -> Option<Stage> {
        let now = Instant::now();
        if let Some(stage) = self.stage {
            self.stats.times[stage as usize] += now - self.since;
        }
        self.since = now;
        std::mem::replace(&mut self.stage, stage)
    }
    /// Counts rays after `bounces` bounces, in packets of `width`.
    #[cold]
    #[inline(never)]
    fn count_segment(&mut self, bounces: u32, rays: usize, width: usize) {
        if rays == 0 {
            return;
        }
        let (segments, at) = (&mut self.stats.segments, bounces as usize);
        if segments.len() <= at {
            segments.resize(at + 1, Segment::default());
        }
        segments[at] += Segment::of(rays, width);
    }
}

/// The number of segments of a pixel's path, and the occupancy of the packets that traced them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PathShape {
    /// The number of rays: 1 without a bounce.
    pub segments: u32,
    /// The sum of the active lanes of the packets that held the rays.
    pub lanes: u32,
}

/// The recorded shapes of a tile's paths, by slot.
pub struct Probe {
    /// The shape of each path of the tile.
    pub paths: [PathShape; MAX_PIXELS],
}

impl Default for Probe {
    fn default() -> Self {
        Self { paths: [PathShape::default(); MAX_PIXELS] }
    }
}

impl Probe {
    /// Adds a segment to these paths of a queue.
    #[cold]
    #[inline(never)]
    pub fn record<L: Lane>(&mut self, queue: &PathQueue, bounces: u32, paths: Range<usize>) {
        for (number, at) in paths.clone().enumerate() {
            let before = number - number % L::WIDTH;
            let slot = if bounces == 0 { queue.primary_slot(at) } else { queue.slots()[at] };
            let path = &mut self.paths[slot as usize];
            path.segments += 1;
            path.lanes += L::WIDTH.min(paths.len() - before) as u32;
        }
    }
}
