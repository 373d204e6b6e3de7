//! Third stage: light is added, paths scatter, and those that go on are packed to the front.

use super::World;
use super::generate::slots;
use super::light::{mis_weight, sample_direct_light};
use super::queue::{Path, Work};
use super::scatter::{ScatteredPath, scatter};
use super::surface::{MaterialSample, Surface, abilities, has};
use crate::buffers::Features;
use crate::kernel::surface::latitude_longitude;
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Hit, Ray, Vec3};
use crate::sampling::SampleValues;
use crate::scene::TexelKind;

/// Shades the hits of the first `count` paths, draws lights for them, and scatters them.
///
/// `FIRST`: the queue holds primary rays, as [`super::generate`] left them.
pub fn shade<L: Lane, const N: u32, const FIRST: bool>(
    world: &World,
    work: &mut Work,
    count: usize,
    numbers: &SampleValues,
) -> Shaded {
    let mut light = Light::<FIRST>::default();
    let (mut going_on, mut searching) = (0, 0);
    let search = has(N, Features::LIGHTS) && !world.buffers.lights.is_empty();
    for at in (0..count).step_by(L::WIDTH) {
        let path = load_path::<L, N, FIRST>(world, work, at);
        let hit: Hit<L> = work.queue.hit(at);
        let active = L::Mask::first(count - at);
        let found = hit.found() & active;
        let mut radiance = sky_where_missed::<L, N, FIRST>(world, &path, active & !found);
        if !found.any() {
            light.add(work, at, active, &path, radiance);
            continue;
        }
        let surface = Surface::of::<N>(world, &path, &hit, found);
        let material = MaterialSample::of::<N>(world, &surface, found);
        if has(N, Features::EMISSION) {
            radiance = Vec3::select(found, emitted::<L, N, FIRST>(&path, &surface, &material), radiance);
        }
        light.add(work, at, lit::<L, N>(active, found, radiance), &path, radiance);

        let drawn = scatter::<L, N>(&path, &surface, &material, numbers, found);
        if search {
            let (hit, when) = ((&surface, &material), (numbers, found));
            searching = sample_direct_light::<L, N>(world, (work, searching), &path, &drawn, hit, when);
        }
        // In place: no more paths go on than were read, so nothing unread is overwritten.
        let ScatteredPath { path, alive } = drawn;
        if alive.all() {
            work.queue.store_path(going_on, &path, has(N, Features::LIGHTS));
        } else if alive.any() {
            work.queue.store_path(
                going_on,
                &path.compress(L::compress_indices(alive)),
                has(N, Features::LIGHTS),
            );
        }
        going_on += alive.count();
    }
    light.finish(work);
    Shaded { going_on, searching }
}

/// What a run over the queue leaves in front of it.
pub struct Shaded {
    /// Paths that go on.
    pub going_on: usize,
    /// Rays to lights, for [`super::light::trace_shadow_rays`].
    pub searching: usize,
}

/// The light that the surfaces themselves give to their paths. What the search for lights may find as well counts by its weight.
#[inline(always)]
fn emitted<L: Lane, const N: u32, const FIRST: bool>(
    path: &Path<L>,
    surface: &Surface<L>,
    material: &MaterialSample<L>,
) -> Vec3<L> {
    let emitted = material.emission * path.throughput;
    if FIRST || !has(N, Features::LIGHTS) {
        return emitted;
    }
    emitted * mis_weight(path.inv_pdf, surface.light_pdf)
}

/// The last segment: adds light and scatters nothing.
pub fn finish<L: Lane, const N: u32, const FIRST: bool>(world: &World, work: &mut Work, count: usize) {
    let mut light = Light::<FIRST>::default();
    for at in (0..count).step_by(L::WIDTH) {
        let path = load_path::<L, N, FIRST>(world, work, at);
        let hit: Hit<L> = work.queue.hit(at);
        let active = L::Mask::first(count - at);
        let found = hit.found() & active;
        let mut radiance = sky_where_missed::<L, N, FIRST>(world, &path, active & !found);
        if has(N, Features::EMISSION) && found.any() {
            let surface = Surface::of::<N>(world, &path, &hit, found);
            let material = MaterialSample::of::<N>(world, &surface, found);
            radiance = Vec3::select(found, emitted::<L, N, FIRST>(&path, &surface, &material), radiance);
        }
        light.add(work, at, lit::<L, N>(active, found, radiance), &path, radiance);
    }
    light.finish(work);
}

/// The lanes that found light: those that missed, and, where surfaces shine, those with some radiance.
#[inline(always)]
fn lit<L: Lane, const N: u32>(active: L::Mask, found: L::Mask, radiance: Vec3<L>) -> L::Mask {
    if has(N, Features::EMISSION) {
        // Not `0 < sum`: NaN must reach the film, where it is counted.
        active & !(radiance.x + radiance.y + radiance.z).eq(L::zero())
    } else {
        active & !found
    }
}

/// The paths of a packet.
#[inline(always)]
fn load_path<L: Lane, const N: u32, const FIRST: bool>(world: &World, work: &Work, at: usize) -> Path<L> {
    if !FIRST {
        return work.queue.path(at, has(N, Features::LIGHTS));
    }
    let (direction, key) = work.queue.primary(at);
    let ray = Ray { origin: world.camera.origin(), direction };
    Path { ray, throughput: Vec3::repeat(L::one()), inv_pdf: L::zero(), key, slot: slots::<L>(at) }
}

/// Where light goes: at the first segment every path still stands at its pixel's own place and whole packets are stored; later,
/// events are noted and added at the end of the stage.
#[derive(Default)]
struct Light<const FIRST: bool> {
    events: usize,
}

impl<const FIRST: bool> Light<FIRST> {
    #[inline(always)]
    fn add<L: Lane>(&mut self, work: &mut Work, at: usize, lit: L::Mask, path: &Path<L>, radiance: Vec3<L>) {
        if FIRST {
            work.set_radiance(at, Vec3::select(lit, radiance, Vec3::zero()));
        } else if lit.any() {
            self.events = work.note(self.events, lit, path.slot, radiance);
        }
    }
    fn finish(self, work: &mut Work) {
        work.flush(self.events);
    }
}

/// The sky's light along paths that left the scene; 0 elsewhere. What the search for lights may find as well counts by its weight.
#[inline(always)]
fn sky_where_missed<L: Lane, const N: u32, const FIRST: bool>(
    world: &World,
    path: &Path<L>,
    missed: L::Mask,
) -> Vec3<L> {
    if !missed.any() {
        return Vec3::zero();
    }
    let mut radiance = sky_radiance::<L, N>(world, path.ray.direction, missed) * path.throughput;
    if !FIRST
        && has(N, Features::LIGHTS)
        && has(N, Features::SKY_TEXTURE)
        && let Some((sky, chance)) = &world.buffers.lights.sky
    {
        let density = sky.pdf(latitude_longitude(path.ray.direction)) * L::splat(*chance);
        radiance = radiance * mis_weight(path.inv_pdf, density);
    }
    Vec3::select(missed, radiance, Vec3::zero())
}

/// The sky in a direction; unspecified where it is not `wanted`.
#[inline(always)]
pub fn sky_radiance<L: Lane, const N: u32>(world: &World, direction: Vec3<L>, wanted: L::Mask) -> Vec3<L> {
    let sky = &world.buffers.sky;
    let mut radiance = Vec3::splat(sky.bottom);
    if has(N, Features::SKY_GRADIENT) {
        let height = L::splat(0.5).mul_add(direction.y, L::splat(0.5));
        radiance = Vec3::splat(sky.rise).mul_add(height, radiance);
    }
    if has(N, Features::SKY_TEXTURE) && world.buffers.needs.contains(Features::SKY_TEXTURE) {
        let coordinates = latitude_longitude(direction);
        let index = L::Bits::splat(sky.texture);
        let everywhere = L::Mask::splat(true);
        radiance = radiance
            * world.buffers.textures.sample(
                index,
                coordinates,
                everywhere,
                wanted,
                abilities(N),
                TexelKind::Color,
            );
    }
    radiance
}
