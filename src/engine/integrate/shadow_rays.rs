//! Next event estimation: shadow rays to sampled points of the lights.

use super::bsdf::{ScatteredPath, evaluate, has_sampled_lobe};
use super::context::TraceContext;
use super::context::has;
use super::emission::{environment_radiance, mis_weight};
use super::material::MaterialSample;
use super::material::scattered_cone;
use super::queue::{Path, ShadowQueue};
use super::scratch::Scratch;
use super::stats::{RayKind, Stage};
use super::surface::Surface;
use crate::buffers::{Features, Lights};
use crate::kernel::light::{LightSample, sample_flat, sample_sphere};
use crate::kernel::ray_cone::Cone;
use crate::lane::{Lane, Mask};
use crate::math::{Hit, Ray, Vec3};
use crate::sampling::{PacketValues, dimension};

/// A shadow ray ends this share of its length before the light: far more than the error of a hit's distance,
/// so that no light occludes itself, and so little that no occluder is missed.
const SHADOW_EPSILON: f32 = 4e-6;

/// Samples a point of a light for each path of a packet that scatters at `surface`, and queues the shadow
/// rays behind `count` earlier ones; returns how many there are now.
///
/// Not inlined: it is much code, called from two places.
#[inline(never)]
pub fn sample_direct_light<L: Lane, const N: u32>(
    context: &TraceContext,
    (scratch, count): (&mut Scratch, usize),
    path: &Path<L>,
    scattered: &ScatteredPath<L>,
    (surface, material): (&Surface<L>, &MaterialSample<L>),
    (numbers, found): (&PacketValues<L>, L::Mask),
) -> usize {
    let mask = found & has_sampled_lobe::<L, N>(material);
    if !mask.any() {
        return count;
    }
    let (u, v) = numbers.get_2d(dimension::LIGHT_POINT);
    let lights = &context.buffers.lights;
    let fits_registers = !has(N, Features::MANY_LIGHTS);
    // As scattered rays, so that BSDF sampling of the same direction has the same light pdf.
    let origin = scattered.offset_origin;
    let by_irradiance = lights.are_chosen_by_irradiance();
    // Lights below the horizon add nothing.
    let n = material.interpolated.flip_sign(-path.ray.direction.dot(surface.ng));
    let (light, u) = if by_irradiance && (fits_registers || lights.len() <= Lights::MAX_COMPARED) {
        lights.compare((surface.point, n), u, fits_registers)
    } else if by_irradiance && has(N, Features::MANY_LIGHTS) {
        let numbers = [dimension::LIGHT, dimension::LIGHT_ALIAS, dimension::LIGHT_RESAMPLED]
            .map(|dimension| numbers.get_1d(dimension));
        (lights.resample((surface.point, n), numbers), u)
    } else {
        lights.choose::<L>(
            u,
            || numbers.get_1d(dimension::LIGHT),
            || numbers.get_1d(dimension::LIGHT_ALIAS),
            fits_registers,
        )
    };
    let at = light.at - origin;
    let is_sphere = L::zero().lt(light.radius);
    let (spheres, flats) = ((mask & is_sphere).any(), (mask & !is_sphere).any());
    let flat = light.flat(origin);
    let mut sample = match (has(N, Features::SPHERES) && spheres, has(N, Features::TRIANGLES) && flats) {
        (true, false) => sample_sphere(at, light.radius, u, v),
        (false, _) => sample_flat(&flat, u, v),
        (true, true) => {
            let flat = sample_flat(&flat, u, v);
            LightSample::select(is_sphere, sample_sphere(at, light.radius, u, v), flat)
        }
    };
    let hits_decide = lights.hits_decide();
    // Where hits decide, what they emit is known then.
    let mut emission = if hits_decide { Vec3::repeat(L::one()) } else { light.emission };
    if has(N, Features::SKY_TEXTURE)
        && let Some((sky, _)) = &lights.sky
    {
        let is_sky = mask & light.radius.lt(L::zero());
        if is_sky.any() {
            sample = LightSample::select(is_sky, sky.sample(u, v), sample);
            // As BSDF sampling sees the same direction: the weights of the two must sum to 1 over one sky.
            let mut cone_angle = L::zero();
            if context.carries_cones::<N>() {
                cone_angle = scattered_cone(path, surface, material, L::Mask::splat(false)).angle;
            }
            let seen = environment_radiance::<L, N>(context, sample.wi, cone_angle, is_sky);
            emission = Vec3::select(is_sky, seen, emission);
        }
    }
    let lobes = (material, &scattered.plastic);
    let bsdf = evaluate::<L, N>(path.ray.direction, surface, lobes, sample.wi, mask);
    let pdf = light.probability * sample.pdf;
    let possible = mask & L::zero().lt(pdf);
    let inv_pdf = L::one() / L::select(possible, pdf, L::one());
    // By the probability of power, as BSDF sampling compares: the weights of a direction sum to 1, whatever
    // pdf they take. 1 − the weight of BSDF sampling would cancel; this is the same heuristic with the pdfs
    // exchanged.
    let weight = mis_weight(inv_pdf, bsdf.pdf);
    let radiance = path.throughput * bsdf.value * emission * (weight * inv_pdf * light.weight);
    let carries = possible & !(radiance.x + radiance.y + radiance.z).eq(L::zero());
    if !carries.any() {
        return count;
    }
    let end = sample.n.mul_add(light.offset, sample.wi * sample.t);
    let length = end.dot(end).sqrt();
    let far = !sample.t.is_finite();
    let mut direction = Vec3::select(far, sample.wi, end * (L::one() / length));
    let mut t_max = L::select(far, sample.t, length * L::splat(1.0 - SHADOW_EPSILON));
    if hits_decide {
        let mut cone = Cone::none();
        if context.carries_cones::<N>() {
            cone = scattered_cone(path, surface, material, L::Mask::splat(false));
        }
        scratch.shadow_queue.store_light(count, carries, light.index, cone);
        // The ray that BSDF sampling would see, so that both find the same hit.
        (direction, t_max) = (sample.wi, L::splat(f32::INFINITY));
    }
    scratch.shadow_queue.store(count, carries, &Ray { origin, direction }, t_max, radiance, path.slot);
    count + carries.count()
}

/// Traces the first `count` shadow rays and adds the radiance of the unoccluded ones.
pub fn trace_shadow_rays<L: Lane>(context: &TraceContext, scratch: &mut Scratch, count: usize) {
    let hits_decide = context.buffers.lights.hits_decide();
    let Scratch { queue, shadow_queue, tracer, observer, radiance: sums, .. } = scratch;
    observer.begin_shadow_rays::<L>(count);
    let (rays, mut hits) = shadow_queue.queries(queue, count);
    if hits_decide {
        tracer.closest_in_scene(&context.structure, &rays, &mut hits);
    } else {
        tracer.occluded_in_scene(&context.structure, &rays, &mut hits);
    }
    observer.add_tests(RayKind::Shadow, tracer);
    let mut contributions = 0;
    for at in (0..count).step_by(L::WIDTH) {
        let (rays, hit) = (L::Mask::first(count - at), hits.packet::<L>(at));
        let (unoccluded, (slot, radiance)) = if hits_decide {
            radiance_of_hits::<L>(context, shadow_queue, at, &hit, rays)
        } else {
            (rays & !hit.found(), shadow_queue.contribution::<L>(at))
        };
        if unoccluded.any() {
            contributions = sums.push(contributions, unoccluded, slot, radiance);
        }
    }
    sums.add(contributions);
    observer.begin(Some(Stage::Shade));
}

/// Which of a packet's shadow rays hit the light that they run to, and what they add to which slots: what
/// their hits emit.
#[inline(never)]
fn radiance_of_hits<L: Lane>(
    context: &TraceContext,
    queue: &ShadowQueue,
    at: usize,
    hit: &Hit<L>,
    rays: L::Mask,
) -> (L::Mask, (L::Bits, Vec3<L>)) {
    const ALL: u32 = Features::ALL.0;
    let (light, path) = queue.to_light::<L>(at);
    let seen = rays & context.buffers.lights.are::<L>(light, hit.primitive);
    let found = seen & hit.found();
    let mut radiance = path.throughput;
    if found.any() {
        let surface = Surface::of::<ALL>(context, &path, hit, found);
        let emission = MaterialSample::of::<ALL>(context, &surface, found).emission;
        radiance = Vec3::select(found, radiance * emission, radiance);
    }
    (seen, (path.slot, radiance))
}
