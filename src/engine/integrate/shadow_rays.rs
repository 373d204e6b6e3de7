//! Next event estimation: traces shadow rays to sampled points of the lights.

use super::bsdf::ScatteredPath;
use super::context::TraceContext;
use super::context::has;
use super::emission::{mis_weight, sky_radiance};
use super::evaluation::{evaluate, has_sampled_lobe};
use super::material::{MaterialSample, scattered_cone};
use super::opacity;
use super::queue::{Path, ShadowQueue, ShadowRay};
use super::scratch::Scratch;
use super::stats::{RayKind, Stage};
use crate::buffers::{Features, MaterialCode};
use crate::kernel::ray_cone::Cone;
use crate::lane::{Lane, Mask};
use crate::math::{Hit, Ray, Vec3};
use crate::primitives::Surface;
use crate::primitives::{ChosenLight, LightSample};
use crate::rays::{Hits, Rays, Tracer};
use crate::sampling::{PacketValues, dimension};

/// The share of its length by which a shadow ray ends before the light: far more than the error of a hit's
/// distance, so that no light occludes itself, and so little that no occluder is missed.
const SHADOW_EPSILON: f32 = 4e-6;

/// A packet of paths at the surfaces that scatter them.
pub struct Scattering<'a, L: Lane> {
    /// The arriving paths.
    pub path: &'a Path<L>,
    /// The surfaces.
    pub surface: &'a Surface<L>,
    /// Their materials.
    pub material: &'a MaterialSample<L>,
    /// The scattered paths.
    pub scattered: &'a ScatteredPath<L>,
    /// The sample values of the event.
    pub numbers: &'a PacketValues<'a, L>,
    /// The lanes with a surface.
    pub found: L::Mask,
}

/// Samples a point of a light for each path of a packet, and queues the shadow rays behind `count` earlier
/// ones; returns their new number.
///
/// Not inlined, because it is much code that is called from two places.
#[inline(never)]
pub fn sample_direct_light<L: Lane, const N: u64>(
    context: &TraceContext,
    scratch: &mut Scratch,
    count: usize,
    at: &Scattering<L>,
) -> usize {
    let &Scattering { path, surface, material, scattered, numbers, found } = at;
    let mask = found & has_sampled_lobe::<L, N>(material);
    if !mask.any() {
        return count;
    }
    let (lights, (u, v)) = (&context.lights, numbers.get_2d(dimension::LIGHT_POINT));
    // Lights below the horizon add nothing.
    let n = material.interpolated.flip_sign(-path.ray.direction.dot(surface.ng));
    let side = LitSide::<L>::choose::<N>(at);
    let n = side.flip(n);
    let (light, u) = lights.choose::<L, N>((surface.point, n), u, numbers);
    // The origin of scattered rays, so that BSDF sampling of the same direction has the same light pdf.
    let origin = side.origin(scattered.offset_origin, at);
    let mut from = origin;
    if has(N, Features::PUNCTUAL_LIGHTS) {
        // On a huge primitive the offset may be no less than the distance of a point or spot, which no BSDF
        // sampling finds.
        let outward = side.flip(surface.ng.flip_sign(-path.ray.direction.dot(surface.ng)));
        from = Vec3::select(light.is_delta(), outward.mul_add(-surface.offset, origin), origin);
    }
    let sample = lights.sample::<L, N>(&light, from, (u, v), mask);
    let emission = emission::<L, N>(context, at, &light, &sample);

    let lobes = (material, &scattered.plastic);
    let bsdf = evaluate::<L, N>(path.ray.direction, surface, lobes, sample.wi, mask);
    let mut pdf = light.probability * sample.pdf;
    let mut possible = side.holds(sample.wi, at, mask) & L::zero().lt(pdf);
    if has(N, Features::PORTALS) && lights.mixes_sky() {
        // Other portals, or the whole sky, may sample the same direction: the pdf is that of their mixture.
        let of_sky = lights.sky_pdf::<L, N>(origin, sample.wi).unwrap_or(L::zero());
        pdf = L::select(light.kinds.are_sky::<N>(), of_sky, pdf);
        possible = possible & L::zero().lt(pdf);
    }
    let inv_pdf = L::one() / L::select(possible, pdf, L::one());
    // The probability is that by power, as in BSDF sampling: the weights of a direction sum to 1 with any
    // pdf. 1 − the weight of BSDF sampling would cancel; this is the same heuristic with the pdfs exchanged.
    let mut bsdf_pdf = bsdf.pdf;
    if has(N, Features::PUNCTUAL_LIGHTS) {
        bsdf_pdf = L::select(light.is_delta(), L::zero(), bsdf_pdf);
    }
    let weight = mis_weight(inv_pdf, bsdf_pdf);
    let radiance = path.throughput * bsdf.value * emission * (weight * inv_pdf * side.weight(light.weight));
    let carries = possible & !(radiance.x + radiance.y + radiance.z).eq(L::zero());
    if !carries.any() {
        return count;
    }

    let (direction, t_max) = segment_to(&sample, light.offset);
    let ray = ShadowRay { ray: Ray { origin, direction }, t_max, radiance, slot: path.slot };
    scratch.shadow_queue.store(count, carries, &ray);
    if lights.needs_hits() || context.has_opacity::<N>() {
        scratch.shadow_queue.store_light(count, carries, light.index, scattered_cones::<L, N>(context, at));
    }
    count + carries.count()
}

/// The side of surfaces on which lights are chosen. Rough glass is lit from both, but the choice among lights
/// depends on the normal, and lights below its horizon have no probability: half of the choices are for the
/// far side, and only light from the chosen side counts, twice.
struct LitSide<L: Lane> {
    /// The lanes with rough glass, and those in which the far side is chosen; `None` if no lane has any.
    rough_glass: Option<(L::Mask, L::Mask)>,
}

impl<L: Lane> LitSide<L> {
    #[inline(always)]
    fn choose<const N: u64>(at: &Scattering<L>) -> Self {
        let glass = match has(N, Features::ROUGH_GLASS) {
            true => at.material.has_lobe(MaterialCode::ROUGH_GLASS, at.found),
            false => L::Mask::splat(false),
        };
        let rough_glass = glass.any().then(|| {
            let number = at.material.lobe_number(at.numbers);
            (glass, glass & number.lt(L::splat(0.5)))
        });
        Self { rough_glass }
    }
    #[inline(always)]
    fn flip(&self, n: Vec3<L>) -> Vec3<L> {
        self.rough_glass.map_or(n, |(_, far)| Vec3::select(far, -n, n))
    }
    /// Returns the origins of shadow rays; `near` are those on the side of the ray.
    #[inline(always)]
    fn origin(&self, near: Vec3<L>, at: &Scattering<L>) -> Vec3<L> {
        let Some((_, far)) = self.rough_glass else { return near };
        let ng = at.surface.ng.flip_sign(at.path.ray.direction.dot(at.surface.ng));
        Vec3::select(far, ng.mul_add(at.surface.offset, at.surface.point), near)
    }
    /// Returns the lanes of `mask` in which light along `wi` is from the chosen side.
    #[inline(always)]
    fn holds(&self, wi: Vec3<L>, at: &Scattering<L>, mask: L::Mask) -> L::Mask {
        let Some((glass, far)) = self.rough_glass else { return mask };
        let ng = at.surface.ng.flip_sign(-at.path.ray.direction.dot(at.surface.ng));
        mask & (!glass | (far ^ L::zero().lt(wi.dot(ng))))
    }
    #[inline(always)]
    fn weight(&self, weight: L) -> L {
        self.rough_glass.map_or(weight, |(glass, _)| L::select(glass, weight + weight, weight))
    }
}

/// Returns the light's radiance, or 1 if its hit decides: see [`ChosenLight::emission`]. The radiance of the
/// environment, and through portals, is the sky's.
#[inline(always)]
fn emission<L: Lane, const N: u64>(
    context: &TraceContext,
    at: &Scattering<L>,
    light: &ChosenLight<L>,
    sample: &LightSample<L>,
) -> Vec3<L> {
    let seen = at.found & light.kinds.are_sky::<N>();
    if !Features(N).meets(Features::SKY_TEXTURE.with(Features::PORTALS)) || !seen.any() {
        return light.emission;
    }
    // The angle that BSDF sampling uses in the same direction: both weights must be those of one sky.
    let angle = scattered_cones::<L, N>(context, at).angle;
    let radiance = sky_radiance::<L, N>(context, sample.wi, angle, seen);
    Vec3::select(seen, radiance, light.emission)
}

/// Returns the cones of rays that lobes other than delta lobes scatter; no cones if paths carry none.
#[inline(always)]
fn scattered_cones<L: Lane, const N: u64>(context: &TraceContext, at: &Scattering<L>) -> Cone<L> {
    match context.carries_cones::<N>() {
        true => scattered_cone(at.path, at.surface, at.material, L::Mask::splat(false)),
        false => Cone::none(),
    }
}

/// Returns the direction and t_max of shadow rays to points of lights, which end `offset` before them.
#[inline(always)]
fn segment_to<L: Lane>(sample: &LightSample<L>, offset: L) -> (Vec3<L>, L) {
    let end = sample.n.mul_add(offset, sample.wi * sample.t);
    let length = end.dot(end).sqrt();
    let is_endless = !sample.t.is_finite();
    let direction = Vec3::select(is_endless, sample.wi, end * (L::one() / length));
    (direction, L::select(is_endless, sample.t, length * L::splat(1.0 - SHADOW_EPSILON)))
}

/// Traces the first `count` shadow rays and adds the radiance of the unoccluded ones.
pub fn trace_shadow_rays<L: Lane>(context: &TraceContext, scratch: &mut Scratch, count: usize) {
    let Scratch { queue, shadow_queue, tracer, observer, radiance: sums, .. } = scratch;
    observer.begin_shadow_rays::<L>(count);
    if context.has_opacity::<{ Features::ALL.0 }>() {
        return opacity::trace_shadow_rays(context, scratch, count);
    }
    let (rays, mut hits) = shadow_queue.queries(queue, count);
    find_occluders(context, tracer, &rays, &mut hits);
    observer.add_tests(RayKind::Shadow, tracer);
    let mut contributions = 0;
    for at in (0..count).step_by(L::WIDTH) {
        let (rays, hit) = (L::Mask::first(count - at), hits.packet::<L>(at));
        let (arrives, (slot, radiance)) = arriving_radiance::<L>(context, shadow_queue, at, &hit, rays);
        if arrives.any() {
            contributions = sums.push(contributions, arrives, slot, radiance);
        }
    }
    sums.add(contributions);
    observer.begin(Some(Stage::Shade));
}

/// Traces shadow rays: finds whether they are occluded or, if [`crate::lights::Lights::needs_hits`] or rays
/// may pass surfaces, their hits.
pub(super) fn find_occluders(context: &TraceContext, tracer: &mut Tracer, rays: &Rays, hits: &mut Hits) {
    match context.lights.needs_hits() || context.has_opacity::<{ Features::ALL.0 }>() {
        true => tracer.closest_in_scene(&context.structure, rays, hits),
        false => tracer.occluded_in_scene(&context.structure, rays, hits),
    }
}

/// Returns the lanes of `rays` whose shadow rays reach their lights, and the slots and the radiance of their
/// contributions.
#[inline(always)]
pub(super) fn arriving_radiance<L: Lane>(
    context: &TraceContext,
    queue: &ShadowQueue,
    at: usize,
    hit: &Hit<L>,
    rays: L::Mask,
) -> (L::Mask, (L::Bits, Vec3<L>)) {
    match context.lights.needs_hits() {
        true => emitted_by_hits(context, queue, at, hit, rays),
        false => (rays & !hit.found(), queue.contribution(at)),
    }
}

/// [`arriving_radiance`] for rays that hit the primitives of their lights: the radiance of the hits.
#[inline(never)]
fn emitted_by_hits<L: Lane>(
    context: &TraceContext,
    queue: &ShadowQueue,
    at: usize,
    hit: &Hit<L>,
    rays: L::Mask,
) -> (L::Mask, (L::Bits, Vec3<L>)) {
    const ALL: u64 = Features::ALL.0;
    let (light, path) = queue.to_light::<L>(at);
    let seen = rays & context.lights.is_primitive_of_light::<L>(hit.primitive, light);
    let found = seen & hit.found();
    let mut radiance = path.throughput;
    if found.any() {
        let surface = context.surface::<_, ALL>(&path, hit, found);
        let emission = MaterialSample::of::<ALL>(context, &surface, found).emission;
        radiance = Vec3::select(found, radiance * emission, radiance);
    }
    (seen, (path.slot, radiance))
}
