//! Light that paths look for: at each scattering event a ray to a point of some emitter, and what arrives along it if nothing is in
//! between.
//!
//! Each direction towards an emitter may be found by chance (scattering) and by search (here); both count, weighted by the power
//! heuristic, and their weights sum to 1: Veach, Guibas, "Optimally Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH
//! 1995, §3.

use super::World;
use super::extend::{Segments, meet};
use super::queue::{Column, Integers, Path, Queue, Vectors, Work, pack};
use super::scatter::{Drawn, evaluate, samples_lights};
use super::shade::sky_radiance;
use super::stats::Stage;
use super::surface::{Surface, Worn, needs};
use crate::buffers::Needs;
use crate::kernel::light::{aim_at_sphere, aim_at_triangle};
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Ray, Vec3};
use crate::sampling::{Numbers, random};
use bytemuck::Zeroable;

/// A ray to a light ends this share of its length before it: far more than the error of a hit's distance, so that no light is in its
/// own way, and little enough that nothing which could be is overlooked.
const SHORT: f32 = 4e-6;

/// Rays to lights, and what arrives along those that nothing is in the way of.
#[derive(Clone, Copy, Zeroable)]
#[repr(C)]
pub struct Search {
    pub origin: Vectors,
    pub direction: Vectors,
    /// How far something would be in the way.
    pub reach: Column,
    radiance: Vectors,
    slot: Integers,
}

/// The weight of light found by chance, of the density `chance`, that search would have found with the density `search`: β = 2.
/// Given one over the one and the other itself; light found by search has what is left to 1.
#[inline(always)]
pub fn weight_by_chance<L: Lane>(inverse_chance: L, search: L) -> L {
    let ratio = inverse_chance * search;
    L::one() / ratio.mul_add(ratio, L::one())
}

/// Draws a light for each path of a packet that scatters at `surface`, and notes the ray behind `count` earlier ones; returns how many
/// there are now.
///
/// Never in line: it is much code, wanted in two places.
#[inline(never)]
pub fn look<L: Lane, const N: u32>(
    world: &World,
    (work, count): (&mut Work, usize),
    path: &Path<L>,
    drawn: &Drawn<L>,
    (surface, worn): (&Surface<L>, &Worn<L>),
    (numbers, found): (&Numbers, L::Mask),
) -> usize {
    let mask = found & samples_lights::<L>(worn);
    if !mask.any() {
        return count;
    }
    let (u, v) = numbers.pair::<L>(path.key, random::LIGHT_POINT);
    let number = |dimension: u32| numbers.one::<L>(path.key, dimension);
    let lights = &world.buffers.lights;
    let few = !needs(N, Needs::MANY_LIGHTS);
    let (light, u) = lights.choose::<L>(u, || number(random::LIGHT), || number(random::LIGHT_AGAIN), few);
    // From where the path goes on, so that scattering in the same direction would find the same density.
    let origin = drawn.path.ray.origin;
    let at = light.at - origin;
    let is_sphere = L::zero().lt(light.radius);
    let (spheres, triangles) = ((mask & is_sphere).any(), (mask & !is_sphere).any());
    let mut aim = match (needs(N, Needs::SPHERES) && spheres, needs(N, Needs::TRIANGLES) && triangles) {
        (true, false) => aim_at_sphere(at, light.radius, u, v),
        (false, _) => aim_at_triangle(at, light.ab, light.ac, u, v),
        (true, true) => {
            let triangle = aim_at_triangle(at, light.ab, light.ac, u, v);
            triangle.or(is_sphere, aim_at_sphere(at, light.radius, u, v))
        }
    };
    let mut emission = light.emission;
    if needs(N, Needs::SKY_TEXTURE)
        && let Some((sky, _)) = &lights.sky
    {
        let is_sky = mask & light.radius.lt(L::zero());
        if is_sky.any() {
            aim = aim.or(is_sky, sky.aim(u, v));
            let seen = sky_radiance::<L, N>(world, aim.direction, is_sky);
            emission = Vec3::select(is_sky, seen, emission);
        }
    }
    let passed = evaluate::<L, N>(path.ray.direction, surface, worn, aim.direction, mask);
    let density = light.chance * aim.density;
    let possible = mask & L::zero().lt(density);
    let inverse = L::one() / L::select(possible, density, L::one());
    // 1 − its complement would cancel; this is the same heuristic from the other side.
    let weight = weight_by_chance(inverse, passed.pdf);
    let radiance = path.throughput * passed.value * emission * (weight * inverse);
    let carries = possible & !(radiance.x + radiance.y + radiance.z).eq(L::zero());
    if !carries.any() {
        return count;
    }
    let end = aim.normal.mul_add(light.offset, aim.direction * aim.t);
    let length = end.dot(end).sqrt();
    let far = !aim.t.is_finite();
    let direction = Vec3::select(far, aim.direction, end * (L::one() / length));
    let reach = L::select(far, aim.t, length * L::splat(1.0 - SHORT));
    work.search.store(count, L::packing(carries), &Ray { origin, direction }, reach, radiance, path.slot);
    count + carries.count()
}

impl Search {
    /// The first `count` rays; their hits go where `queue` has its own.
    pub fn segments<'a>(&'a self, queue: &'a mut Queue, count: usize) -> Segments<'a> {
        let Search { origin, direction, reach, .. } = self;
        Segments { origin, direction, reach: Some(reach), ..queue.segments(count) }
    }
    #[inline(always)]
    fn store<L: Lane>(
        &mut self,
        at: usize,
        packing: L::Packing,
        ray: &Ray<L>,
        reach: L,
        radiance: Vec3<L>,
        slot: L::Bits,
    ) {
        self.origin.store(at, pack(ray.origin, packing));
        self.direction.store(at, pack(ray.direction, packing));
        reach.pack(packing).store(&mut self.reach[at..]);
        self.radiance.store(at, pack(radiance, packing));
        L::pack_bits(slot, packing).store(&mut self.slot[at..]);
    }
}

/// Traces the first `count` rays to lights and adds the light of those that arrive.
pub fn arrive<L: Lane>(world: &World, work: &mut Work, count: usize) {
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
