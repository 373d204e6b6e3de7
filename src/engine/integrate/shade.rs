//! The third stage: shading. Adds emitted radiance, samples the BSDF and the lights, and compresses the paths
//! that continue.

use super::bsdf::{ScatteredPath, scatter};
use super::context::TraceContext;
use super::context::{ends_missed, has, reads_texels_first};
use super::emission::{missed_radiance, surface_radiance};
use super::glass;
use super::intersect::Intersected;
use super::material::scattered_cone;
use super::material::{MaterialSample, texel_indices};
use super::queue::IntColumn;
use super::queue::{Path, PathQueue};
use super::scratch::Scratch;
use super::shadow_rays::{Scattering, sample_direct_light};
use super::silhouettes::correct_hits;
use crate::buffers::Features;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Vec3};
use crate::primitives::Surface;
use std::ops::Range;

/// The numbers of rays after a run of [`shade`].
pub struct Shaded {
    /// The number of paths that continue, stored from the requested index on.
    pub alive: usize,
    /// The number of shadow rays at the front of their queue, for `trace_shadow_rays`.
    pub shadow_rays: usize,
}

/// Shades the hits of paths after `bounce` bounces, samples lights for them, and scatters them.
///
/// Paths that continue are stored from `to` on.
///
/// With `FIRST`, the queue holds primary rays, as [`super::generate()`] left them, and some missed.
pub fn shade<L: Lane, const N: u64, const FIRST: bool>(
    context: &TraceContext,
    scratch: &mut Scratch,
    &Intersected { hits: ref paths, contributions }: &Intersected,
    bounce: u32,
    to: usize,
) -> Shaded {
    let values = scratch.values.bounce(bounce);
    let mut accumulator = RadianceAccumulator::<FIRST> { contributions };
    debug_assert!(to <= paths.start, "{to} lies in {paths:?}");
    correct_triangles::<L, N, FIRST>(context, scratch, paths, bounce);
    let (mut going_on, mut shadow_rays) = (0, 0);
    let columns = context.columns::<N>();
    let sample_lights = has(N, Features::LIGHTS) && !context.lights.is_empty();
    if reads_texels_first(N) {
        texels_of_hits::<L, N, FIRST>(context, &scratch.queue, paths.clone(), &mut scratch.texels);
    }
    for at in paths.clone().step_by(L::WIDTH) {
        let mut path = context.path::<L, N, FIRST>(&scratch.queue, at);
        let SegmentEnds { hit, active, found, mut radiance } =
            SegmentEnds::of::<N, FIRST>(context, &scratch.queue, at..paths.end, &path);
        if (FIRST || !ends_missed(N)) && !found.any() {
            accumulator.add(scratch, at, active, &path, radiance);
            continue;
        }
        let surface = context.surface::<_, N>(&path, &hit, found);
        attenuate::<L, N>(context, &mut path, &hit, &surface, found);
        let mut material = material_of::<L, N>(context, scratch, at, &surface, found);
        if has(N, Features::EMISSION) {
            let emitted = surface_radiance::<L, N, FIRST>(&path, &surface, &material);
            radiance = Vec3::select(found, emitted, radiance);
        }
        accumulator.add(scratch, at, carries_radiance::<L, N>(active, found, radiance), &path, radiance);

        let numbers = &if FIRST {
            values.at_pixels(path.key, scratch.pixels.places(at - paths.start))
        } else {
            values.at_keys(path.key)
        };
        if has(N, Features::ROUGH_GLASS) && context.buffers.needs.contains(Features::ROUGH_GLASS) {
            glass::resolve(context, (&path, numbers), &surface, &mut material, found);
        }
        let mut scattered = scatter::<L, N>(&path, &surface, &material, numbers, found);
        if context.carries_cones::<N>() {
            scattered.path.cone = scattered_cone(&path, &surface, &material, scattered.is_delta);
        }
        if sample_lights {
            let (path, surface, material, scattered) = (&path, &surface, &material, &scattered);
            let at = Scattering { path, surface, material, scattered, numbers, found };
            shadow_rays = sample_direct_light::<L, N>(context, scratch, shadow_rays, &at);
        }
        // In place: no more paths continue than were read, and they are stored at or before these, so nothing
        // unread is overwritten.
        let ScatteredPath { path, alive, .. } = scattered;
        if alive.all() {
            scratch.queue.store_path(to + going_on, &path, columns);
        } else if alive.any() {
            let path = path.compress(alive, columns);
            scratch.queue.store_path(to + going_on, &path, columns);
        }
        going_on += alive.count();
    }
    accumulator.finish(scratch);
    Shaded { alive: going_on, shadow_rays }
}

/// Shades last segments: adds emitted radiance and scatters nothing.
pub fn shade_last<L: Lane, const N: u64, const FIRST: bool>(
    context: &TraceContext,
    scratch: &mut Scratch,
    &Intersected { ref hits, contributions }: &Intersected,
) {
    let mut accumulator = RadianceAccumulator::<FIRST> { contributions };
    let paths = if FIRST || !ends_missed(N) || has(N, Features::EMISSION) {
        hits.clone()
    } else {
        // Without emitters, hits add nothing.
        0..0
    };
    correct_triangles::<L, N, FIRST>(context, scratch, &paths, context.max_bounces);
    if reads_texels_first(N) {
        texels_of_hits::<L, N, FIRST>(context, &scratch.queue, paths.clone(), &mut scratch.texels);
    }
    for at in paths.clone().step_by(L::WIDTH) {
        let mut path = context.path::<L, N, FIRST>(&scratch.queue, at);
        let SegmentEnds { hit, active, found, mut radiance } =
            SegmentEnds::of::<N, FIRST>(context, &scratch.queue, at..paths.end, &path);
        if has(N, Features::EMISSION) && found.any() {
            let surface = context.surface::<_, N>(&path, &hit, found);
            attenuate::<L, N>(context, &mut path, &hit, &surface, found);
            let material = material_of::<L, N>(context, scratch, at, &surface, found);
            let emitted = surface_radiance::<L, N, FIRST>(&path, &surface, &material);
            radiance = Vec3::select(found, emitted, radiance);
        }
        accumulator.add(scratch, at, carries_radiance::<L, N>(active, found, radiance), &path, radiance);
    }
    accumulator.finish(scratch);
}

/// Applies [`correct_hits`] if triangles may hide each other at edges.
#[inline(always)]
fn correct_triangles<L: Lane, const N: u64, const FIRST: bool>(
    context: &TraceContext,
    scratch: &mut Scratch,
    paths: &Range<usize>,
    bounce: u32,
) {
    if has(N, Features::TRIANGLES) && !context.primitives.triangles.are_parallel {
        correct_hits::<L, N, FIRST>(context, scratch, paths.clone(), bounce);
    }
}

/// Applies [`glass::attenuate`] in scenes with glass that absorbs light.
#[inline(always)]
fn attenuate<L: Lane, const N: u64>(
    context: &TraceContext,
    path: &mut Path<L>,
    hit: &Hit<L>,
    surface: &Surface<L>,
    found: L::Mask,
) {
    if has(N, Features::TRANSMISSION) && context.buffers.needs.contains(Features::TRANSMISSION) {
        glass::attenuate(context, path, hit.t, surface, found);
    }
}

/// Returns the materials of the packet at `at`.
#[inline(always)]
fn material_of<L: Lane, const N: u64>(
    context: &TraceContext,
    scratch: &Scratch,
    at: usize,
    surface: &Surface<L>,
    found: L::Mask,
) -> MaterialSample<L> {
    let mut material = MaterialSample::of::<N>(context, surface, found);
    if reads_texels_first(N) {
        let texels = L::Bits::load(&scratch.texels[at..]);
        material.multiply_texels::<N>(context, surface, found, texels);
    }
    material
}

/// The ends of a packet of path segments.
struct SegmentEnds<L: Lane> {
    hit: Hit<L>,
    active: L::Mask,
    /// The active lanes that hit a surface.
    found: L::Mask,
    /// The environment's radiance in active lanes that missed; 0 elsewhere.
    radiance: Vec3<L>,
}

impl<L: Lane> SegmentEnds<L> {
    /// Finds the ends of the first packet of `paths` in a queue. They do not include the path itself, which
    /// would be copied through memory.
    #[inline(always)]
    fn of<const N: u64, const FIRST: bool>(
        context: &TraceContext,
        queue: &PathQueue,
        paths: Range<usize>,
        path: &Path<L>,
    ) -> Self {
        let hit: Hit<L> = queue.hit(paths.start);
        let active = L::Mask::first(paths.len());
        if !FIRST && ends_missed(N) {
            return Self { hit, active, found: active, radiance: Vec3::zero() };
        }
        let found = hit.found() & active;
        let radiance = missed_radiance::<L, N, FIRST>(context, path, active & !found);
        Self { hit, active, found, radiance }
    }
}

/// Returns the lanes that add radiance: those that missed, and, if surfaces emit, those with radiance other
/// than 0.
#[inline(always)]
fn carries_radiance<L: Lane, const N: u64>(active: L::Mask, found: L::Mask, radiance: Vec3<L>) -> L::Mask {
    if has(N, Features::EMISSION) {
        // Not `0 < sum`: NaN must reach the film, where it is counted.
        active & !(radiance.x + radiance.y + radiance.z).eq(L::zero())
    } else {
        active & !found
    }
}

/// Adds radiance to pixels. At the first segment paths are in the order of their pixels and whole packets are
/// stored; later, contributions are queued and added at the end of the stage.
struct RadianceAccumulator<const FIRST: bool> {
    contributions: usize,
}

impl<const FIRST: bool> RadianceAccumulator<FIRST> {
    #[inline(always)]
    fn add<L: Lane>(
        &mut self,
        scratch: &mut Scratch,
        at: usize,
        mask: L::Mask,
        path: &Path<L>,
        radiance: Vec3<L>,
    ) {
        if FIRST {
            let slot = scratch.queue.primary_slot(at);
            scratch.radiance.set(slot, Vec3::select(mask, radiance, Vec3::zero()));
        } else if mask.any() {
            self.contributions = scratch.radiance.push(self.contributions, mask, path.slot, radiance);
        }
    }
    fn finish(self, scratch: &mut Scratch) {
        scratch.radiance.add(self.contributions);
    }
}

/// Reads the texels of the hits of a range of a queue; with `FIRST`, of primary rays.
#[inline(always)]
pub fn texels_of_hits<L: Lane, const N: u64, const FIRST: bool>(
    context: &TraceContext,
    queue: &PathQueue,
    paths: Range<usize>,
    texels: &mut IntColumn,
) {
    for at in paths.clone().step_by(L::WIDTH) {
        let path = context.path::<L, N, FIRST>(queue, at);
        let hit: Hit<L> = queue.hit(at);
        let found = hit.found() & L::Mask::first(paths.end - at);
        let surface = context.surface::<_, N>(&path, &hit, found);
        texel_indices::<L, N>(context, &surface, found).store(&mut texels[at..]);
    }
    context.buffers.textures.read_texels(&mut texels[paths]);
}
