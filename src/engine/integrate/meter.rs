//! Measures the statistics of one thread.
//!
//! For: [`Meter`].
//!
//! Without a meter, a stage costs one branch, and nothing is counted.

use super::stats::{RayKind, Segment, Stage, Stats};
use crate::traverse::counter::Counter;
use std::time::{Duration, Instant};

/// The running statistics of one thread.
#[derive(Debug)]
pub struct Meter {
    times: [Duration; Stage::ALL.len()],
    segments: Vec<Segment>,
    shadow_rays: Segment,
    counters: [Counter; RayKind::ALL.len()],
    /// The current stage.
    stage: Option<Stage>,
    since: Instant,
}

impl Default for Meter {
    fn default() -> Self {
        Self {
            times: [Duration::ZERO; Stage::ALL.len()],
            segments: Vec::new(),
            shadow_rays: Segment::default(),
            counters: Default::default(),
            stage: None,
            since: Instant::now(),
        }
    }
}

impl Meter {
    pub fn stats(&self) -> Stats {
        let Self { times, ref segments, shadow_rays, ref counters, .. } = *self;
        Stats {
            times,
            segments: segments.clone(),
            shadow_rays,
            counts: counters.each_ref().map(Counter::get),
        }
    }
    /// Attributes time to this stage, or to none, from now on. Returns the previous stage.
    #[cold]
    #[inline(never)]
    pub fn begin(&mut self, stage: Option<Stage>) -> Option<Stage> {
        let now = Instant::now();
        if let Some(stage) = self.stage {
            self.times[stage as usize] += now - self.since;
        }
        self.since = now;
        std::mem::replace(&mut self.stage, stage)
    }
    /// Counts rays after `bounces` bounces, in packets of `width`. Where there is no hierarchy, `tests` is
    /// the number of spheres and triangles that each is tested against.
    pub fn count_segment(&mut self, bounces: u32, rays: usize, width: usize, tests: Option<[usize; 2]>) {
        let (at, packets) = (bounces as usize, rays.div_ceil(width));
        if rays == 0 {
            return;
        }
        if self.segments.len() <= at {
            self.segments.resize(at + 1, Segment::default());
        }
        self.segments[at] += Segment { rays: rays as u64, packets: packets as u64 };
        let kind = if bounces == 0 { RayKind::Primary } else { RayKind::Bounce };
        if let Some(tests) = tests {
            self.counter(kind).linear(tests, packets, rays);
        }
    }
    /// Counts shadow rays; parameters as in [`Meter::count_segment`].
    #[cold]
    #[inline(never)]
    pub fn count_shadow_rays(&mut self, rays: usize, width: usize, tests: Option<[usize; 2]>) {
        let packets = rays.div_ceil(width);
        self.shadow_rays += Segment { rays: rays as u64, packets: packets as u64 };
        if let Some(tests) = tests {
            self.counter(RayKind::Shadow).linear(tests, packets, rays);
        }
    }
    /// The counter of intersection tests of a kind of ray.
    pub fn counter(&self, kind: RayKind) -> &Counter {
        &self.counters[kind as usize]
    }
}
