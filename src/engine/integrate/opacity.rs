//! Takes rays through surfaces that are not opaque. A hit that a ray passes is replaced by the next one along
//! the same ray, with the passed hit as exclusive lower bound: t, pdfs and ray cones count from the ray's own
//! origin, and no bounce is counted.
//!
//! A path passes a hit or not, by a hash of its pixel, sample, bounce and the hit: at random in proportion to
//! the opacity, where it is blended. Emission counts only if the hit is not passed. Shadow rays pass every
//! hit and lose its opacity, which has the same mean and less noise. AOVs have no sample; there a surface is
//! seen if its opacity is above a half.
//!
//! Rays with lower bounds are traced one by one, so this code is scalar at every width.

use super::aovs::ALL;
use super::context::TraceContext;
use super::edge_aovs::CHOSEN;
use super::intersect::closest_of_queue;
use super::material::{MaterialSample, opacity_texel};
use super::queue::{Path, ShadowQueue};
use super::scratch::Scratch;
use super::shadow_rays::find_occluders;
use super::stats::{RayKind, Stage};
use crate::math::{Hit, MISS, Ray, Vec3};
use crate::primitives::Surface;
use crate::rays::{Hits, Rays, Tracer};
use crate::sampling::random::hit_number;
use std::ops::Range;

/// The largest number of surfaces that a ray passes; the next one counts as opaque.
const MAX_PASSED: u32 = 1024;
/// The share of its length by which a ray goes on behind a hit if the tests of primitives know no lower
/// bounds.
const STEP: f32 = 1e-6;

/// The rule that decides whether a ray passes a hit.
#[derive(Clone, Copy)]
pub enum Decision {
    /// A path does so at random: see [`hit_number`].
    Random {
        /// The number of the sample.
        sample: u32,
        /// The number of events on the path so far.
        bounce: u32,
    },
    /// A ray passes opacities up to a half.
    Half,
}

impl Decision {
    /// Returns the rule for paths of the current sample after `bounce` events.
    pub fn of_sample(scratch: &Scratch, bounce: u32) -> Self {
        Self::Random { sample: scratch.values.sample(), bounce }
    }
}

/// Takes the rays of a range of the path queue through the hits that they pass, to the first that they do
/// not. Counts the rays that were asked again. With `first`, the queue holds primary rays.
#[inline(never)]
pub fn pass_through(
    context: &TraceContext,
    scratch: &mut Scratch,
    paths: Range<usize>,
    bounce: u32,
    first: bool,
) {
    let decision = Decision::of_sample(scratch, bounce);
    let asked = pass_hits(context, scratch, paths, decision, first);
    let kind = if first { RayKind::Primary } else { RayKind::Bounce };
    scratch.observer.add_tests(kind, &mut scratch.tracer);
    scratch.observer.add_segments(bounce, asked as usize);
    scratch.asked_again += asked;
}

/// Finds the surfaces that AOVs show along the rays of a range of the path queue, and marks the keys of those
/// that samples may pass or not ([`CHOSEN`]). With `first`, the queue holds primary rays. The rays are not
/// counted.
pub fn closest_seen(
    context: &TraceContext,
    scratch: &mut Scratch,
    paths: Range<usize>,
    kind: RayKind,
    first: bool,
) {
    closest_of_queue(context, None, scratch, paths.clone(), kind);
    if context.has_opacity::<ALL>() {
        pass_hits(context, scratch, paths, Decision::Half, first);
    }
}

fn pass_hits(
    context: &TraceContext,
    scratch: &mut Scratch,
    paths: Range<usize>,
    decision: Decision,
    first: bool,
) -> u64 {
    let mut asked = 0;
    for at in paths {
        let hit: Hit<f32> = scratch.queue.hit(at);
        if context.buffers.opacities.may_pass(hit.primitive) {
            let path = match first {
                true => context.path::<f32, ALL, true>(&scratch.queue, at),
                false => context.path::<f32, ALL, false>(&scratch.queue, at),
            };
            let stop = first_stop(context, &mut scratch.tracer, &path, (hit, f32::INFINITY), decision);
            scratch.queue.other_hits().set(at, &stop.hit);
            if stop.is_random && matches!(decision, Decision::Half) {
                scratch.queue.mark_key(at, CHOSEN);
            }
            asked += u64::from(stop.asked);
        }
    }
    asked
}

/// The first hit that a ray does not pass.
pub(super) struct Stop {
    pub hit: Hit<f32>,
    /// The number of times that the ray was asked again.
    asked: u32,
    /// Whether a sample's ray would have passed some hit, up to this one, at random.
    is_random: bool,
}

/// Finds the first hit before `t_max`, from `hit` on, that a path does not pass.
pub(super) fn first_stop(
    context: &TraceContext,
    tracer: &mut Tracer,
    path: &Path<f32>,
    (hit, t_max): (Hit<f32>, f32),
    decision: Decision,
) -> Stop {
    let mut stop = Stop { hit, asked: 0, is_random: false };
    while context.buffers.opacities.may_pass(stop.hit.primitive) {
        let surface = context.surface::<f32, ALL>(path, &stop.hit, true);
        let opacity = opacity(context, &surface);
        let number = match decision {
            // A ray hits a sphere twice, from either side.
            Decision::Random { sample, bounce } => {
                let hit = stop.hit.primitive << 1 | u32::from(surface.facing < 0.0);
                hit_number(path.key, sample, bounce, hit)
            }
            Decision::Half => 0.5,
        };
        stop.is_random |= 0.0 < opacity && opacity < 1.0;
        if number < opacity || stop.asked == MAX_PASSED {
            break;
        }
        stop.hit = next_hit(context, tracer, &path.ray, (&stop.hit, t_max));
        stop.asked += 1;
    }
    stop
}

/// Returns the opacity of a surface that may be passed.
fn opacity(context: &TraceContext, surface: &Surface<f32>) -> f32 {
    let opacity = context.buffers.opacities.of_material(surface.material);
    opacity.at(if opacity.map == 0 { 1.0 } else { opacity_texel(context, surface, opacity.map) })
}

/// Returns the hit behind another one, before `t_max`.
fn next_hit(
    context: &TraceContext,
    tracer: &mut Tracer,
    ray: &Ray<f32>,
    (hit, t_max): (&Hit<f32>, f32),
) -> Hit<f32> {
    let has_bounds = context.structure.accepts_lower_bounds();
    let start = if has_bounds { 0.0 } else { hit.t * (1.0 + STEP) };
    let origin = if has_bounds { ray.origin } else { ray.at(start) };
    let [origin, direction] = [origin, ray.direction].map(|v| v.get(0).to_array().map(|x| [x]));
    let rays = Rays::new(origin.each_ref().map(|x| &x[..]), direction.each_ref().map(|x| &x[..]));
    let (end, bound) = ([t_max - start], ([hit.t], [hit.primitive]));
    let rays = rays.until(&end);
    let rays = if has_bounds { rays.beyond(&bound.0, &bound.1) } else { rays };
    let [mut t, mut u, mut v] = [[0.0]; 3];
    let mut hits = Hits { t: &mut t, primitive: &mut [MISS], u: &mut u, v: &mut v };
    tracer.closest_in_scene(&context.structure, &rays, &mut hits);
    let found = hits.get(0);
    Hit { t: found.t + start, ..found }
}

/// Traces the first `count` shadow rays through surfaces, and adds the radiance that arrives.
#[inline(never)]
pub(super) fn trace_shadow_rays(context: &TraceContext, scratch: &mut Scratch, count: usize) {
    let Scratch { queue, shadow_queue, tracer, observer, radiance: sums, .. } = scratch;
    let (rays, mut hits) = shadow_queue.queries(queue, count);
    find_occluders(context, tracer, &rays, &mut hits);
    let (mut contributions, mut asked) = (0, 0);
    for at in 0..count {
        let (radiance, more) = arriving_radiance(context, tracer, shadow_queue, at, hits.get(at));
        asked += more as usize;
        if radiance.get(0) != glam::Vec3::ZERO {
            let (slot, _) = shadow_queue.contribution::<f32>(at);
            contributions = sums.push::<f32>(contributions, true, slot, radiance);
        }
    }
    observer.add_tests(RayKind::Shadow, tracer);
    observer.add_shadow_rays(asked);
    sums.add(contributions);
    scratch.asked_again += asked as u64;
    observer.begin(Some(Stage::Shade));
}

/// Returns the radiance that a shadow ray brings through the surfaces before its end, and how often it was
/// asked again. `hit` is its first hit.
///
/// If hits decide ([`crate::lights::Lights::needs_hits`]), every hit on the light adds what it emits: a ray
/// passes both sides of a transparent sphere, and either may be hit by scattering.
pub(super) fn arriving_radiance(
    context: &TraceContext,
    tracer: &mut Tracer,
    queue: &ShadowQueue,
    at: usize,
    mut hit: Hit<f32>,
) -> (Vec3<f32>, u32) {
    let (light, path) = queue.to_light::<f32>(at);
    let (lights, decides) = (&context.lights, context.lights.needs_hits());
    let is_light = |hit: &Hit<f32>| decides && lights.is_primitive_of_light::<f32>(hit.primitive, light);
    let (mut radiance, mut left, mut asked) = (Vec3::zero(), 1.0, 0);
    loop {
        if hit.primitive == MISS {
            let arrives = !decides || is_light(&hit);
            let rest = if arrives { path.throughput * left } else { Vec3::zero() };
            return (radiance + rest, asked);
        }
        let mut opacity_here = 1.0;
        if is_light(&hit) || context.buffers.opacities.may_pass(hit.primitive) {
            let surface = context.surface::<f32, ALL>(&path, &hit, true);
            if context.buffers.opacities.may_pass(hit.primitive) {
                opacity_here = opacity(context, &surface);
            }
            if is_light(&hit) {
                let emission = MaterialSample::of::<ALL>(context, &surface, true).emission;
                radiance = radiance + path.throughput * emission * (left * opacity_here);
            }
        }
        left *= 1.0 - opacity_here;
        if left == 0.0 || asked == MAX_PASSED {
            return (radiance, asked);
        }
        hit = next_hit(context, tracer, &path.ray, (&hit, queue.t_max(at)));
        asked += 1;
    }
}
