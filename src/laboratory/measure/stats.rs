//! What `--stats` reports: time by stage, rays by kind, lanes in use by bounce, tests a ray.
//!
//! For: [`FrameStats`] of rendering, [`RayStats`] of rays in prepared arrays. May import: `integrate`'s and `traverse`'s counts,
//! `ways`, `ray_sets`. Must never know: how figures are shown.

use super::ray_sets::{Kind, RaySet};
use super::ways::{Ground, Way};
use crate::integrate::stats::{RayKind, Segment, Stage, Stats};
use crate::traverse::counter::{Counts, Tests};
use serde::Serialize;

/// What some samples of a picture took.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameStats {
    pub lanes: usize,
    pub threads: usize,
    /// Samples of every pixel.
    pub frames: u32,
    pub rays: u64,
    /// Seconds of all stages, summed over the threads; the clock's own cost and that of counting are in them.
    pub seconds: f64,
    pub stages: Vec<StageStats>,
    /// Primary rays, those that bounced, those to lights.
    pub kinds: Vec<KindStats>,
    /// By how often rays have bounced, from 0.
    pub bounces: Vec<BounceStats>,
}

/// The time in a stage, summed over the threads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageStats {
    pub stage: &'static str,
    pub seconds: f64,
    /// Of the time of all stages.
    pub share: f64,
    /// For every ray, of whatever kind.
    pub ns_per_ray: f64,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KindStats {
    /// `primary`, `bounce` or `light`.
    pub kind: &'static str,
    pub rays: u64,
    #[serde(flatten)]
    pub tests: TestStats,
}

#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BounceStats {
    pub bounce: usize,
    pub rays: u64,
    /// Packets that hold them, single rays in the scalar path.
    pub packets: u64,
    /// Rays over the packets' lanes.
    pub lanes_in_use: f64,
}

/// What one way of tracing tests for one kind of rays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayStats {
    pub kind: Kind,
    pub traversal: &'static str,
    pub rays: u64,
    #[serde(flatten)]
    pub tests: TestStats,
}

/// What rays are tested against; [`crate::traverse::counter`] says what counts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestStats {
    pub boxes: PerRay,
    pub triangles: PerRay,
    pub spheres: PerRay,
}

/// Tests of one kind, in all and by the ray; 0 where there are no rays.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PerRay {
    /// One ray, or one frustum around many, against one box or primitive.
    pub tests: u64,
    /// Up to eight of them at once.
    pub steps: u64,
    pub tests_per_ray: f64,
    pub steps_per_ray: f64,
}

fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

impl TestStats {
    fn of(counts: &Counts, rays: u64) -> Self {
        let per_ray = |Tests { tests, steps }| {
            let [tests_per_ray, steps_per_ray] = [tests, steps].map(|count| ratio(count as f64, rays as f64));
            PerRay { tests, steps, tests_per_ray, steps_per_ray }
        };
        Self {
            boxes: per_ray(counts.boxes),
            triangles: per_ray(counts.triangles),
            spheres: per_ray(counts.spheres),
        }
    }
}

impl FrameStats {
    /// Of so many samples of every pixel.
    pub fn of(stats: &Stats, lanes: usize, threads: usize, frames: u32) -> Self {
        let rays = RayKind::ALL.iter().map(|&kind| stats.rays(kind)).sum();
        let seconds = stats.times.iter().map(|time| time.as_secs_f64()).sum();
        let stage = |(stage, time): (Stage, &std::time::Duration)| {
            let time = time.as_secs_f64();
            let (share, ns_per_ray) = (ratio(time, seconds), ratio(time * 1e9, rays as f64));
            StageStats { stage: stage.name(), seconds: time, share, ns_per_ray }
        };
        let kind = |(kind, counts): (RayKind, &Counts)| {
            let rays = stats.rays(kind);
            KindStats { kind: kind.name(), rays, tests: TestStats::of(counts, rays) }
        };
        let bounce = |(bounce, &Segment { rays, packets }): (usize, &Segment)| {
            let lanes_in_use = ratio(rays as f64, (packets * lanes as u64) as f64);
            BounceStats { bounce, rays, packets, lanes_in_use }
        };
        Self {
            lanes,
            threads,
            frames,
            rays,
            seconds,
            stages: Stage::ALL.into_iter().zip(&stats.times).map(stage).collect(),
            kinds: RayKind::ALL.into_iter().zip(&stats.counts).map(kind).collect(),
            bounces: stats.segments.iter().enumerate().map(bounce).collect(),
        }
    }
}

impl RayStats {
    /// Traces the rays once more and counts. It takes one thread, and the counts are those of any number of them.
    pub fn count(ground: &Ground, way: Way, set: &RaySet) -> Self {
        let rays = set.len() as u64;
        let tests = TestStats::of(&ground.count(way, set), rays);
        Self { kind: set.kind, traversal: way.name(), rays, tests }
    }
}
