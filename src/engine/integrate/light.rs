//! Light that paths sample_direct_light for: at each scattering event a ray to a point of some emitter, and what arrives along it if nothing is in
//! between.
//!
//! Each direction towards an emitter may be found by chance (scattering) and by search (here); both count, weighted by the power
//! heuristic, and their weights sum to 1: Veach, Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH
//! 1995, §3.

use super::World;
use super::extend::{Segments, meet};
use super::queue::{Column, Integers, Path, Queue, Vectors, Work, compress};
use super::scatter::{ScatteredPath, evaluate, samples_lights};
use super::shade::sky_radiance;
use super::stats::Stage;
use super::surface::{MaterialSample, Surface, has};
use crate::buffers::Features;
use crate::kernel::light::{LightSample, sample_sphere, sample_triangle};
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Ray, Vec3};
use crate::sampling::{SampleValues, dimension};
use bytemuck::Zeroable;

/// A ray to a light ends this share of its length before it: far more than the error of a hit's distance, so that no light is in its
/// own way, and little enough that nothing which could be is overlooked.
const SHADOW_EPSILON: f32 = 4e-6;

/// Rays to lights, and what arrives along those that nothing is in the way of.
#[derive(Clone, Copy, Zeroable)]
#[repr(C)]
pub struct ShadowQueue {
    pub origin: Vectors,
    pub direction: Vectors,
    /// How far something would be in the way.
    pub t_max: Column,
    radiance: Vectors,
    slot: Integers,
}

/// The weight of light found by chance, of the density `chance`, that search would have found with the density `search`: β = 2.
/// Given one over the one and the other itself; light found by search has what is left to 1.
#[inline(always)]
pub fn mis_weight<L: Lane>(inverse_chance: L, search: L) -> L {
    let ratio = inverse_chance * search;
    L::one() / ratio.mul_add(ratio, L::one())
}

/// Draws a light for each path of a packet that scatters at `surface`, and notes the ray behind `count` earlier ones; returns how many
/// there are now.
///
/// Never in line: it is much code, wanted in two places.
#[inline(never)]
pub fn sample_direct_light<L: Lane, const N: u32>(
    world: &World,
    (work, count): (&mut Work, usize),
    path: &Path<L>,
    drawn: &ScatteredPath<L>,
    (surface, material): (&Surface<L>, &MaterialSample<L>),
    (numbers, found): (&SampleValues, L::Mask),
) -> usize {
    let mask = found & samples_lights::<L>(material);
    if !mask.any() {
        return count;
    }
    let (u, v) = numbers.get_2d::<L>(path.key, dimension::LIGHT_POINT);
    let number = |dimension: u32| numbers.get_1d::<L>(path.key, dimension);
    let lights = &world.buffers.lights;
    let few = !has(N, Features::MANY_LIGHTS);
    let (light, u) =
        lights.choose::<L>(u, || number(dimension::LIGHT), || number(dimension::LIGHT_ALIAS), few);
    // From where the path goes on, so that scattering in the same direction would find the same density.
    let origin = drawn.path.ray.origin;
    let at = light.at - origin;
    let is_sphere = L::zero().lt(light.radius);
    let (spheres, triangles) = ((mask & is_sphere).any(), (mask & !is_sphere).any());
    let mut aim = match (has(N, Features::SPHERES) && spheres, has(N, Features::TRIANGLES) && triangles) {
        (true, false) => sample_sphere(at, light.radius, u, v),
        (false, _) => sample_triangle(at, light.ab, light.ac, u, v),
        (true, true) => {
            let triangle = sample_triangle(at, light.ab, light.ac, u, v);
            LightSample::select(is_sphere, sample_sphere(at, light.radius, u, v), triangle)
        }
    };
    let mut emission = light.emission;
    if has(N, Features::SKY_TEXTURE)
        && let Some((sky, _)) = &lights.sky
    {
        let is_sky = mask & light.radius.lt(L::zero());
        if is_sky.any() {
            aim = LightSample::select(is_sky, sky.sample(u, v), aim);
            let seen = sky_radiance::<L, N>(world, aim.wi, is_sky);
            emission = Vec3::select(is_sky, seen, emission);
        }
    }
    let passed = evaluate::<L, N>(path.ray.direction, surface, material, aim.wi, mask);
    let density = light.probability * aim.pdf;
    let possible = mask & L::zero().lt(density);
    let inv_pdf = L::one() / L::select(possible, density, L::one());
    // 1 − its complement would cancel; this is the same heuristic from the other side.
    let weight = mis_weight(inv_pdf, passed.pdf);
    let radiance = path.throughput * passed.value * emission * (weight * inv_pdf);
    let carries = possible & !(radiance.x + radiance.y + radiance.z).eq(L::zero());
    if !carries.any() {
        return count;
    }
    let end = aim.n.mul_add(light.offset, aim.wi * aim.t);
    let length = end.dot(end).sqrt();
    let far = !aim.t.is_finite();
    let direction = Vec3::select(far, aim.wi, end * (L::one() / length));
    let t_max = L::select(far, aim.t, length * L::splat(1.0 - SHADOW_EPSILON));
    work.search.store(
        count,
        L::compress_indices(carries),
        &Ray { origin, direction },
        t_max,
        radiance,
        path.slot,
    );
    count + carries.count()
}

impl ShadowQueue {
    /// The first `count` rays; their hits go where `queue` has its own.
    pub fn segments<'a>(&'a self, queue: &'a mut Queue, count: usize) -> Segments<'a> {
        let ShadowQueue { origin, direction, t_max, .. } = self;
        Segments { origin, direction, t_max: Some(t_max), ..queue.segments(count) }
    }
    #[inline(always)]
    fn store<L: Lane>(
        &mut self,
        at: usize,
        indices: L::CompressIndices,
        ray: &Ray<L>,
        t_max: L,
        radiance: Vec3<L>,
        slot: L::Bits,
    ) {
        self.origin.store(at, compress(ray.origin, indices));
        self.direction.store(at, compress(ray.direction, indices));
        t_max.compress(indices).store(&mut self.t_max[at..]);
        self.radiance.store(at, compress(radiance, indices));
        L::compress_bits(slot, indices).store(&mut self.slot[at..]);
    }
}

/// Traces the first `count` rays to lights and adds the light of those that trace_shadow_rays.
pub fn trace_shadow_rays<L: Lane>(world: &World, work: &mut Work, count: usize) {
    work.enter_search::<L>(world, count);
    match world.primitives.hierarchy() {
        Some((hierarchy, traversal)) => work.trace_search(hierarchy, traversal, count),
        None => meet::<L>(world, None, work.search.segments(&mut work.queue, count)),
    }
    let mut events = 0;
    for at in (0..count).step_by(L::WIDTH) {
        let hit: Hit<L> = work.queue.hit(at);
        let free = L::Mask::first(count - at) & !hit.found();
        if free.any() {
            let slot = L::Bits::load(&work.search.slot[at..]);
            let radiance: Vec3<L> = work.search.radiance.load(at);
            events = work.note(events, free, slot, radiance);
        }
    }
    work.flush(events);
    work.enter(Some(Stage::Shade));
}
