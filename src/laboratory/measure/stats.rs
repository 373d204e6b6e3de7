//! The figures of `--stats`: time by stage, rays by kind, SIMD utilisation by bounce, tests per ray.

use super::ray_sets::Kind;
use crate::integrate::stats::{RayKind, Segment, Stage, Stats};
use crate::rays::{Counts, Tests};
use serde::Serialize;

/// Cost of some samples of a picture.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FrameStats {
    /// SIMD width: 1, 8 or 16.
    pub lanes: usize,
    /// Worker threads.
    pub threads: usize,
    /// Samples of every pixel.
    pub frames: u32,
    /// Rays of every kind.
    pub rays: u64,
    /// Seconds of all stages, summed over the threads, with the cost of the clock and of counting.
    pub seconds: f64,
    /// Time of each [`Stage`], in the order in which a path passes them.
    pub stages: Vec<StageStats>,
    /// Primary, bounce and shadow rays.
    pub kinds: Vec<KindStats>,
    /// Path segments by number of bounces, from 0.
    pub bounces: Vec<BounceStats>,
}

/// The time in a stage, summed over the threads.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StageStats {
    /// [`Stage::name`].
    pub stage: &'static str,
    /// Summed over the threads.
    pub seconds: f64,
    /// Share of the time of all stages.
    pub share: f64,
    /// Over all rays of every kind.
    pub ns_per_ray: f64,
}

/// The rays of one kind, and their tests.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct KindStats {
    /// `primary`, `bounce` or `shadow`: [`RayKind::name`].
    pub kind: &'static str,
    /// Rays traced, inactive lanes not counted.
    pub rays: u64,
    /// Flattened into this object in JSON.
    #[serde(flatten)]
    pub tests: TestStats,
}

/// The path segments after a number of bounces, shadow rays not counted.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BounceStats {
    /// Scattering events before; 0 for primary rays.
    pub bounce: usize,
    /// Rays traced, inactive lanes not counted.
    pub rays: u64,
    /// Packets of these rays; single rays in the scalar renderer.
    pub packets: u64,
    /// Rays over the lanes of the packets.
    pub simd_utilisation: f64,
}

/// The tests of one traversal for one kind of rays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RayStats {
    /// Kind of the rays.
    pub kind: Kind,
    /// [`crate::render::TraversalChoice::name`].
    pub traversal: &'static str,
    /// Rays of the set.
    pub rays: u64,
    /// Flattened into this object in JSON.
    #[serde(flatten)]
    pub tests: TestStats,
}

/// Tests by kind of primitive; [`crate::rays::Counts`] defines what counts.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct TestStats {
    /// Tests against boxes of the hierarchy.
    pub boxes: PerRay,
    /// Tests against triangles.
    pub triangles: PerRay,
    /// Tests against spheres.
    pub spheres: PerRay,
}

/// Tests of one kind, in total and per ray; 0 without rays.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PerRay {
    /// Tests of one ray, or one frustum of many rays, against one box or primitive.
    pub tests: u64,
    /// Steps of as many tests at once as the packet or the node is wide.
    pub steps: u64,
    /// `tests` over the rays.
    pub tests_per_ray: f64,
    /// `steps` over the rays.
    pub steps_per_ray: f64,
}

fn ratio(part: f64, whole: f64) -> f64 {
    if whole > 0.0 { part / whole } else { 0.0 }
}

impl TestStats {
    pub(crate) fn of(counts: &Counts, rays: u64) -> Self {
        let per_ray = |Tests { tests, steps }| {
            let [tests_per_ray, steps_per_ray] = [tests, steps].map(|count| ratio(count as f64, rays as f64));
            PerRay { tests, steps, tests_per_ray, steps_per_ray }
        };
        Self {
            boxes: per_ray(counts.boxes),
            triangles: per_ray(counts.of_kind(crate::rays::Kind::Triangle)),
            spheres: per_ray(counts.of_kind(crate::rays::Kind::Sphere)),
        }
    }
}

impl FrameStats {
    /// Computes the figures from the counters of `frames` samples of every pixel.
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
            let simd_utilisation = ratio(rays as f64, (packets * lanes as u64) as f64);
            BounceStats { bounce, rays, packets, simd_utilisation }
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
