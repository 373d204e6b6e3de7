//! Scattering events: where paths go on, and how much light a surface would pass on from a given direction.

use super::queue::Path;
use super::surface::{Surface, Worn, needs};
use crate::buffers::{MaterialCode, Needs};
use crate::kernel::bsdf::{self, Scattered};
use crate::lane::{Bits, Lane, Mask};
use crate::math::{Ray, Vec3};
use crate::sampling::random;

/// Paths as they leave a surface.
pub struct Drawn<L: Lane> {
    pub path: Path<L>,
    /// The lanes that go on.
    pub alive: L::Mask,
    /// The density in solid angle with which the direction was drawn; infinite where no other way of drawing could have found it.
    pub pdf: L,
}

/// Draws the next segment of each path in `found`.
#[inline(always)]
pub fn scatter<L: Lane, const N: u32>(
    path: &Path<L>,
    surface: &Surface<L>,
    worn: &Worn<L>,
    bounce: u32,
    found: L::Mask,
) -> Drawn<L> {
    let d = path.ray.direction;
    // The normal of the side from which the ray arrives: n · d ≤ 0.
    let along = d.dot(surface.outward);
    let n = surface.outward.flip_sign(-along);
    let outside = !L::zero().lt(along);
    let dimension = random::bounce(bounce);
    let random = |offset: u32| random::uniform::<L>(path.key, dimension + offset);
    let wears = |kind: u32| found & worn.kind.equals(L::Bits::splat(kind));

    let mut drawn = Scattered::<L> { direction: n, weight: L::one(), alive: L::Mask::splat(false) };
    let mut take = |mask: L::Mask, lobe: Scattered<L>| {
        drawn.direction = Vec3::select(mask, lobe.direction, drawn.direction);
        drawn.weight = L::select(mask, lobe.weight, drawn.weight);
        drawn.alive = drawn.alive | (mask & lobe.alive);
    };
    let two_numbers = || (random(random::DIRECTION), random(random::DIRECTION + 1));
    if needs(N, Needs::DIFFUSE) {
        let mask = wears(MaterialCode::DIFFUSE);
        if mask.any() {
            let (u, v) = two_numbers();
            take(mask, bsdf::diffuse(n, u, v));
        }
    }
    if needs(N, Needs::MIRROR) {
        let mask = wears(MaterialCode::MIRROR);
        if mask.any() {
            take(mask, bsdf::mirror(d, n));
        }
    }
    if needs(N, Needs::GGX) {
        let mask = wears(MaterialCode::GGX);
        if mask.any() {
            let (u, v) = two_numbers();
            take(mask, bsdf::ggx(d, n, worn.parameter, u, v));
        }
    }
    if needs(N, Needs::GLASS) {
        let mask = wears(MaterialCode::GLASS);
        if mask.any() {
            take(mask, bsdf::glass(d, n, outside, worn.parameter, random(random::LOBE)));
        }
    }
    if needs(N, Needs::SCATTER) {
        let mask = wears(MaterialCode::SCATTER);
        if mask.any() {
            let (u, v) = two_numbers();
            take(mask, bsdf::scatter(d, n, worn.parameter, u, v));
        }
    }

    let throughput = path.throughput * (worn.color * drawn.weight);
    // A path that can carry no more light ends here. NaN goes on, to be counted at the film.
    let dark = (throughput.x + throughput.y + throughput.z).eq(L::zero());
    // Only glass is left on the far side: a reflection that rounding points a little below its surface is not, in any pipeline.
    let side = if needs(N, Needs::GLASS) {
        let through = surface.offset.copysign(drawn.direction.dot(n));
        L::select(wears(MaterialCode::GLASS), through, surface.offset)
    } else {
        surface.offset
    };
    let ray = Ray { origin: n.mul_add(side, surface.point), direction: drawn.direction };
    let pdf = drawn.direction.dot(n) * L::splat(std::f32::consts::FRAC_1_PI);
    let pdf = L::select(wears(MaterialCode::DIFFUSE), pdf, L::splat(f32::INFINITY));
    let path = Path { ray, throughput, inverse: L::zero(), key: path.key, slot: path.slot };
    Drawn { path, alive: drawn.alive & !dark, pdf }
}

/// f·cosθ with the colour, and the density in solid angle of drawing the direction.
pub struct Passed<L: Lane> {
    pub value: Vec3<L>,
    pub pdf: L,
}

pub fn evaluate<L: Lane, const N: u32>(
    d: Vec3<L>,
    surface: &Surface<L>,
    worn: &Worn<L>,
    towards: Vec3<L>,
    mask: L::Mask,
) -> Passed<L> {
    let n = surface.outward.flip_sign(-d.dot(surface.outward));
    let cos = towards.dot(n);
    let ok = mask & L::zero().lt(cos) & worn.kind.equals(L::Bits::splat(MaterialCode::DIFFUSE));
    let pdf = L::select(ok, cos * L::splat(std::f32::consts::FRAC_1_PI), L::zero());
    Passed { value: worn.color * pdf, pdf }
}

pub fn samples_lights<L: Lane>(worn: &Worn<L>) -> L::Mask {
    worn.kind.equals(L::Bits::splat(MaterialCode::DIFFUSE))
}
