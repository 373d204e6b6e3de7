//! Computes the radiance emitted at the end of a segment, by surfaces and by the environment.
//!
//! A light may be found by BSDF sampling (here) and by next event estimation (`shadow_rays`); both count,
//! weighted by the power heuristic so that the weights of a direction sum to 1: Veach, Guibas, "Optimally
//! Combining Sampling Techniques for Monte Carlo Rendering", SIGGRAPH 1995, §3.

use super::context::TraceContext;
use super::context::{abilities, has};
use super::material::MaterialSample;
use super::queue::Path;
use crate::buffers::{Abilities, Features};
use crate::kernel::ray_cone;
use crate::kernel::surface::latitude_longitude;
use crate::kernel::texture::TexturePoint;
use crate::lane::{Bits, Lane, Mask};
use crate::lights::sun_radiance;
use crate::math::Vec3;
use crate::primitives::Surface;
use crate::scene::TexelKind;

/// Computes the power heuristic (β = 2): the weight of a direction sampled with the pdf 1 / `inv_pdf`, which
/// the other technique samples with `other_pdf`.
#[inline(always)]
pub fn mis_weight<L: Lane>(inv_pdf: L, other_pdf: L) -> L {
    let ratio = inv_pdf * other_pdf;
    L::one() / ratio.mul_add(ratio, L::one())
}

/// Returns surfaces' emitted radiance times throughput and, after a bounce, the MIS weight of BSDF sampling.
///
/// With `FIRST`, the paths are primary rays, which only the camera generates.
#[inline(always)]
pub fn surface_radiance<L: Lane, const N: u64, const FIRST: bool>(
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

/// Returns the environment's radiance along the paths of the lanes in `missed`, times throughput and, after a
/// bounce, the MIS weight of BSDF sampling; 0 in other lanes.
#[inline(always)]
pub fn missed_radiance<L: Lane, const N: u64, const FIRST: bool>(
    context: &TraceContext,
    path: &Path<L>,
    missed: L::Mask,
) -> Vec3<L> {
    if !missed.any() {
        return Vec3::zero();
    }
    let mut radiance =
        sky_radiance::<L, N>(context, path.ray.direction, path.cone.angle, missed) * path.throughput;
    if !FIRST
        && has(N, Features::LIGHTS)
        && let Some(pdf) = context.lights.sky_pdf::<L, N>(path.ray.origin, path.ray.direction)
    {
        radiance = radiance * mis_weight(path.inv_pdf, pdf);
    }
    if has(N, Features::PUNCTUAL_LIGHTS) && !context.lights.suns.is_empty() {
        let suns = sun_radiance(&context.lights.suns, path.ray.direction, path.inv_pdf, mis_weight);
        radiance = radiance + suns * path.throughput;
    }
    Vec3::select(missed, radiance, Vec3::zero())
}

/// Returns the radiance of the sky and of the discs of directional lights from a direction, in a cone of this
/// `angle`; unspecified in lanes outside `mask`.
#[inline(always)]
pub fn environment_radiance<L: Lane, const N: u64>(
    context: &TraceContext,
    direction: Vec3<L>,
    angle: L,
    mask: L::Mask,
) -> Vec3<L> {
    let sky = sky_radiance::<L, N>(context, direction, angle, mask);
    match context.lights.suns.as_slice() {
        [] => sky,
        suns => sky + sun_radiance(suns, direction, L::zero(), mis_weight),
    }
}

/// Returns the radiance of the sky from a direction, in a cone of this `angle`; unspecified in lanes outside
/// `mask`.
#[inline(always)]
pub fn sky_radiance<L: Lane, const N: u64>(
    context: &TraceContext,
    direction: Vec3<L>,
    angle: L,
    mask: L::Mask,
) -> Vec3<L> {
    let sky = &context.buffers.sky;
    let mut radiance = Vec3::splat(sky.bottom);
    if has(N, Features::SKY_GRADIENT) {
        let height = L::splat(0.5).mul_add(direction.y, L::splat(0.5));
        radiance = Vec3::splat(sky.rise).mul_add(height, radiance);
    }
    if has(N, Features::SKY_TEXTURE) && context.buffers.needs.contains(Features::SKY_TEXTURE) {
        let (u, v) = latitude_longitude(direction);
        let mut footprint = L::zero();
        if context.carries_cones::<N>() {
            footprint = ray_cone::footprint(angle, L::one(), ray_cone::sphere_density(direction, L::one()));
        }
        let abilities = Abilities { levels: context.carries_cones::<N>(), ..abilities(N) };
        let clamp_v = L::Mask::splat(true);
        let at = TexturePoint { u: u + L::splat(sky.turn), v, clamp_v, footprint };
        let index = L::Bits::splat(sky.texture);
        radiance = radiance * context.buffers.textures.sample(index, at, mask, abilities, TexelKind::Color);
    }
    radiance
}
