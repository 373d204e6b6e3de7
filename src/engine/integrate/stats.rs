//! What the work took, where somebody asks: time by stage, rays and packets by bounce, tests by kind of ray.
//!
//! A thread's [`Meter`] notes it tile by tile. Without one, a stage costs one branch more, and nothing is counted.

use crate::traverse::counter::{Counter, Counts};
use std::ops::AddAssign;
use std::time::{Duration, Instant};

/// Where time goes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Makes primary rays; where every primitive is tested, finds what they hit in the same go.
    Generate,
    /// Finds what rays that bounced hit, where every primitive is tested.
    Extend,
    /// Finds what rays hit in a hierarchy.
    Trace,
    /// Adds light, scatters, draws lights, packs.
    Shade,
    /// Finds out which lights are seen, and adds theirs.
    Light,
    /// Adds the light of paths that have had all their bounces, and the tile's sample to the film.
    Finish,
}

impl Stage {
    pub const ALL: [Self; 6] =
        [Self::Generate, Self::Extend, Self::Trace, Self::Shade, Self::Light, Self::Finish];

    /// As reports name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Generate => "generate",
            Self::Extend => "extend",
            Self::Trace => "trace",
            Self::Shade => "shade",
            Self::Light => "light",
            Self::Finish => "finish",
        }
    }
}

/// What a ray is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// From the camera.
    Primary,
    /// From a surface that scattered.
    Bounce,
    /// To a point of a light.
    Light,
}

impl RayKind {
    pub const ALL: [Self; 3] = [Self::Primary, Self::Bounce, Self::Light];

    /// As reports name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Bounce => "bounce",
            Self::Light => "light",
        }
    }
}

/// Sums over all tiles, samples and threads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    /// In the order of [`Stage::ALL`]: each instant belongs to one stage.
    pub times: [Duration; Stage::ALL.len()],
    /// Segments of paths: primary rays, then those after one bounce, and so on.
    pub segments: Vec<Segment>,
    /// Rays to lights.
    pub search: Segment,
    /// What rays are tested against, in the order of [`RayKind::ALL`].
    pub counts: [Counts; RayKind::ALL.len()],
}

/// The rays that have bounced so many times.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Segment {
    pub rays: u64,
    /// Packets that hold them, single rays at a width of 1.
    pub packets: u64,
}

impl Stats {
    /// How many rays there were of a kind.
    pub fn rays(&self, kind: RayKind) -> u64 {
        match kind {
            RayKind::Primary => self.segments.first().map_or(0, |first| first.rays),
            RayKind::Bounce => self.segments.iter().skip(1).map(|segment| segment.rays).sum(),
            RayKind::Light => self.search.rays,
        }
    }
}

impl AddAssign for Segment {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.packets += other.packets;
    }
}

impl AddAssign<&Self> for Stats {
    fn add_assign(&mut self, other: &Self) {
        self.times.iter_mut().zip(other.times).for_each(|(time, other)| *time += other);
        let most = self.segments.len().max(other.segments.len());
        self.segments.resize(most, Segment::default());
        self.segments.iter_mut().zip(&other.segments).for_each(|(segment, other)| *segment += *other);
        self.search += other.search;
        self.counts.iter_mut().zip(other.counts).for_each(|(counts, other)| *counts += other);
    }
}

/// Notes what one thread does.
#[derive(Debug)]
pub struct Meter {
    times: [Duration; Stage::ALL.len()],
    segments: Vec<Segment>,
    search: Segment,
    counters: [Counter; RayKind::ALL.len()],
    /// The stage under way.
    stage: Option<Stage>,
    since: Instant,
}

impl Default for Meter {
    fn default() -> Self {
        Self {
            times: [Duration::ZERO; Stage::ALL.len()],
            segments: Vec::new(),
            search: Segment::default(),
            counters: Default::default(),
            stage: None,
            since: Instant::now(),
        }
    }
}

impl Meter {
    pub fn stats(&self) -> Stats {
        let Self { times, ref segments, search, ref counters, .. } = *self;
        Stats { times, segments: segments.clone(), search, counts: counters.each_ref().map(Counter::get) }
    }
    /// From here on time belongs to this stage, or to none. Returns the stage that it belonged to.
    #[cold]
    #[inline(never)]
    pub fn enter(&mut self, stage: Option<Stage>) -> Option<Stage> {
        let now = Instant::now();
        if let Some(stage) = self.stage {
            self.times[stage as usize] += now - self.since;
        }
        self.since = now;
        std::mem::replace(&mut self.stage, stage)
    }
    /// So many rays have bounced so many times, are held by packets of `width`, and, where there is no hierarchy, are tested against so
    /// many spheres and triangles each.
    pub fn segment(&mut self, bounces: u32, rays: usize, width: usize, each: Option<[usize; 2]>) {
        let (at, packets) = (bounces as usize, rays.div_ceil(width));
        if rays == 0 {
            return;
        }
        if self.segments.len() <= at {
            self.segments.resize(at + 1, Segment::default());
        }
        self.segments[at] += Segment { rays: rays as u64, packets: packets as u64 };
        let kind = if bounces == 0 { RayKind::Primary } else { RayKind::Bounce };
        if let Some(each) = each {
            self.counter(kind).linear(each, packets, rays);
        }
    }
    /// So many rays go to lights; the rest as in [`Meter::segment`].
    #[cold]
    #[inline(never)]
    pub fn search(&mut self, rays: usize, width: usize, each: Option<[usize; 2]>) {
        let packets = rays.div_ceil(width);
        self.search += Segment { rays: rays as u64, packets: packets as u64 };
        if let Some(each) = each {
            self.counter(RayKind::Light).linear(each, packets, rays);
        }
    }
    /// Where tests of rays of a kind count.
    pub fn counter(&self, kind: RayKind) -> &Counter {
        &self.counters[kind as usize]
    }
}
