//! Collects statistics: time by stage, rays and packets by bounce, intersection tests by kind of ray.

use crate::rays::Counts;
use std::ops::AddAssign;
use std::time::Duration;

/// A stage of the integrator, to which time is attributed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Generates primary rays, without finding their hits.
    Generate,
    /// Finds the nearest hits of paths, primary rays included; under a sky, ends paths that miss after a
    /// bounce.
    Trace,
    /// Adds emitted radiance, samples BSDFs and lights, compresses.
    Shade,
    /// Traces shadow rays and adds the radiance of the unoccluded ones.
    ShadowRays,
    /// Adds the radiance emitted at the end of last segments, and the tiles' sample to the film.
    Finish,
}

impl Stage {
    /// All stages, in order.
    pub const ALL: [Self; 5] = [Self::Generate, Self::Trace, Self::Shade, Self::ShadowRays, Self::Finish];

    /// Returns the name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Generate => "generate",
            Self::Trace => "trace",
            Self::Shade => "shade",
            Self::ShadowRays => "shadow rays",
            Self::Finish => "finish",
        }
    }
}

/// The purpose of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RayKind {
    /// A ray from the camera.
    Primary,
    /// A ray from a surface that scattered.
    Bounce,
    /// A ray to a sampled point of a light.
    Shadow,
}

impl RayKind {
    /// All kinds, in order.
    pub const ALL: [Self; 3] = [Self::Primary, Self::Bounce, Self::Shadow];

    /// Returns the name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Bounce => "bounce",
            Self::Shadow => "shadow",
        }
    }
}

/// Sums over all tiles, samples and threads.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stats {
    /// The time of each stage, in the order of [`Stage::ALL`]: each instant belongs to one stage.
    pub times: [Duration; Stage::ALL.len()],
    /// The segments of paths: primary rays, then those after one bounce, and so on.
    pub segments: Vec<Segment>,
    /// All shadow rays.
    pub shadow_rays: Segment,
    /// The intersection tests, in the order of [`RayKind::ALL`].
    pub counts: [Counts; RayKind::ALL.len()],
}

/// The number of rays of one kind, or after one number of bounces.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Segment {
    /// The number of rays traced.
    pub rays: u64,
    /// The number of packets that hold them: single rays at a width of 1.
    pub packets: u64,
}

impl Segment {
    /// Counts rays in packets of `width`.
    pub fn of(rays: usize, width: usize) -> Self {
        Self { rays: rays as u64, packets: rays.div_ceil(width) as u64 }
    }
}

impl Stats {
    /// Returns the number of rays of a kind.
    pub fn rays(&self, kind: RayKind) -> u64 {
        match kind {
            RayKind::Primary => self.segments.first().map_or(0, |first| first.rays),
            RayKind::Bounce => self.segments.iter().skip(1).map(|segment| segment.rays).sum(),
            RayKind::Shadow => self.shadow_rays.rays,
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
        self.shadow_rays += other.shadow_rays;
        self.counts.iter_mut().zip(other.counts).for_each(|(counts, other)| *counts += other);
    }
}
