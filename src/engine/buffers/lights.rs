//! The emitters that paths look for, and how likely each is chosen.

use super::environment_light::EnvironmentLight;
use super::features::Features;
use super::rows::Rows;
use crate::kernel::surface::{sphere_offset, triangle_offset};
use crate::lane::{Bits, Lane};
use crate::math::Vec3;
use crate::scene::{MaterialKind, Scene, Sphere, Triangle};
use std::f32::consts::PI;

/// Which emitters paths look for, besides finding them by chance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum LightChoice {
    /// Those for which it pays: not the spheres that surround the scene, and none where every surface is a mirror or glass.
    #[default]
    Auto,
    /// All that can be looked for.
    On,
    /// None.
    Off,
}

impl LightChoice {
    /// As the command line and reports name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Auto => "auto",
            Self::On => "on",
            Self::Off => "off",
        }
    }
}

/// The emitters that paths look for: two rows of eight each.
///
/// Sphere: centre, radius, emission, chance; 0 (seven times), offset of rays that end there. Triangle: a, 0, emission, chance; ab, ac, 0,
/// offset. Sky, the last one: 0 (three times), `SKY_RADIUS`, 0 (three times), chance; zeros.
/// Chosen in constant time, each by its share of all power, or as `LEAST` says: Walker, "An Efficient Method for Generating Discrete
/// Random Variables with General Distributions", ACM TOMS 3(3), 1977; the table by Vose, IEEE TSE 17(9), 1991.
#[derive(Clone, Debug, Default)]
pub struct Lights {
    rows: Rows,
    /// Bits of the fraction up to which a slot stands for the light of its own number.
    keep: Vec<u32>,
    /// The light that a slot stands for above it.
    other: Vec<u32>,
    /// The chance of each primitive of the scene to be chosen, spheres first, and of the sky; empty without lights.
    pub chances: Vec<f32>,
    /// The sky's picture, if it is one of the lights, and its chance.
    pub sky: Option<(EnvironmentLight, f32)>,
}

/// What stands for a radius where the light is the sky.
const SKY_RADIUS: f32 = -1.0;
/// From this [`EnvironmentLight::contrast`] on it pays to look for the sky's bright places.
const LEAST_CONTRAST: f64 = 2.0;

/// No light is chosen less often than this share of the average. Random numbers have 24 digits: a light that few or none of them choose is
/// drawn more or less often than its chance says, and only at some of its points. A candle beside a lamp 10⁹ times as bright would give 59
/// times its light (`tests/choosing.rs`). Costs no more than this share of all searches.
const LEAST: f64 = 1.0 / 64.0;

/// A light for each lane.
pub struct Chosen<L: Lane> {
    /// Centre of a sphere, first corner of a triangle.
    pub at: Vec3<L>,
    /// 0 for triangles, below for the sky.
    pub radius: L,
    pub emission: Vec3<L>,
    pub ab: Vec3<L>,
    pub ac: Vec3<L>,
    pub offset: L,
    /// The probability of choosing it.
    pub chance: L,
}

impl Lights {
    /// Most lights whose rows fit the register form.
    pub const FEW: usize = Rows::FEW / 2;
    /// Up to here a number that chooses a light has digits enough left for a point on it: 18 on average, and 12 where the light is as
    /// weak as `LEAST` lets it be.
    const SHARED: usize = 64;

    pub fn new(scene: &Scene, choice: LightChoice) -> Self {
        let primitives = scene.spheres.len() + scene.triangles.len();
        if choice == LightChoice::Off || !anything_scatters(scene) {
            return Self::default();
        }
        let mut powers: Vec<f64> = (0..primitives).map(|number| power_of(scene, number, choice)).collect();
        let sky = EnvironmentLight::of(scene)
            .filter(|sky| choice == LightChoice::On || sky.contrast >= LEAST_CONTRAST);
        powers.push(sky.as_ref().map_or(0.0, |sky| sky_power(scene, sky)));
        let total: f64 = powers.iter().sum();
        if total <= 0.0 || !total.is_finite() {
            return Self::default();
        }
        let lights: Vec<usize> = (0..=primitives).filter(|&number| powers[number] > 0.0).collect();
        let shares = shares(lights.iter().map(|&number| powers[number] / total).collect());
        let (keep, other) = alias_table(&shares);
        let mut chances = vec![0.0; powers.len()];
        lights.iter().zip(&shares).for_each(|(&number, &share)| chances[number] = share as f32);
        Self {
            rows: Rows::new(
                lights.iter().zip(&shares).flat_map(|(&number, &share)| rows(scene, number, share as f32)),
            ),
            keep: keep.into_iter().map(f32::to_bits).collect(),
            other,
            sky: sky.map(|sky| (sky, chances[primitives])),
            chances,
        }
    }
    /// What searching for them needs of a pipeline.
    pub fn needs(&self) -> Features {
        match self.len() {
            0 => Features::NONE,
            count if count > Self::FEW => Features::LIGHTS.with(Features::MANY_LIGHTS),
            _ => Features::LIGHTS,
        }
    }
    pub fn len(&self) -> usize {
        self.keep.len()
    }
    pub fn is_empty(&self) -> bool {
        self.keep.is_empty()
    }
    pub fn bytes(&self) -> usize {
        self.rows.bytes()
            + size_of_val(self.keep.as_slice()) * 2
            + size_of_val(self.chances.as_slice())
            + self.sky.as_ref().map_or(0, |(sky, _)| sky.bytes())
    }

    /// Chooses by `u`, and returns what is left of it: a number in [0, 1) as well spread over the chosen light as `u` is over all of
    /// them. Among more than 64 lights `number` and `more` choose, and `u` is left whole. `few` promises at most [`Lights::FEW`] lights.
    ///
    /// Domain: there are lights.
    #[inline(always)]
    pub fn choose<L: Lane>(
        &self,
        u: L,
        number: impl Fn() -> L,
        more: impl Fn() -> L,
        few: bool,
    ) -> (Chosen<L>, L) {
        let mut rest = u;
        let light = match self.len() {
            1 => L::Bits::splat(0),
            count => {
                let shared = few || count <= Self::SHARED;
                let scaled = if shared { u } else { number() } * L::splat(count as f32);
                // Rounding up to the length itself is possible.
                let last = L::Bits::splat(count as u32 - 1);
                let slot = scaled.truncate_to_int();
                let slot = L::Bits::select(last.less(slot), last, slot);
                let fraction = if shared { scaled - L::from_int(slot) } else { more() };
                let keep = L::from_bits(L::gather_bits(&self.keep, slot));
                let own = fraction.lt(keep);
                if shared {
                    let above = (fraction - keep) / (L::one() - keep);
                    rest = L::select(own, fraction / keep, above).min(L::splat(1.0 - f32::EPSILON / 2.0));
                }
                L::Bits::select(own, slot, L::gather_bits(&self.other, slot))
            }
        };
        let first = light.shl(1);
        let [x, y, z, radius, r, g, b, chance] = self.rows.fetch::<L>(first, few);
        let [abx, aby, abz, acx, acy, acz, _, offset] = self.rows.fetch::<L>(first | L::Bits::splat(1), few);
        let chosen = Chosen {
            at: Vec3::new(x, y, z),
            radius,
            emission: Vec3::new(r, g, b),
            ab: Vec3::new(abx, aby, abz),
            ac: Vec3::new(acx, acy, acz),
            offset,
            chance,
        };
        (chosen, rest)
    }
}

/// Does some surface scatter light from a lamp into other directions than a lamp's mirror image?
fn anything_scatters(scene: &Scene) -> bool {
    scene.materials.iter().any(|material| match material.kind {
        MaterialKind::Emitter | MaterialKind::Glass { .. } => false,
        MaterialKind::Metal { roughness } => roughness > 0.0,
        _ => true,
    })
}

/// The power that a primitive gives off, 0 if paths shall not look for it.
fn power_of(scene: &Scene, number: usize, choice: LightChoice) -> f64 {
    let shines = |material: u32| {
        let material = &scene.materials[material as usize];
        // A lamp with a picture is found by chance alone: its light at a point is not known here.
        let pictured = material.kind == MaterialKind::Emitter && material.texture.is_some();
        if pictured { 0.0 } else { f64::from(material.emission.element_sum()) / 3.0 }
    };
    match scene.spheres.get(number) {
        Some(sphere) if choice == LightChoice::Auto && surrounds(scene, sphere) => 0.0,
        Some(&Sphere { radius, material, .. }) => {
            let radius = f64::from(radius);
            4.0 * f64::from(PI) * f64::from(PI) * radius * radius * shines(material)
        }
        None => {
            let Triangle { vertices, material } = scene.triangles[number - scene.spheres.len()];
            let [a, b, c] = vertices.map(|vertex| vertex.as_dvec3());
            // Both sides shine.
            f64::from(PI) * (b - a).cross(c - a).length() * shines(material)
        }
    }
}

/// What arrives from the sky at a ball around the scene.
fn sky_power(scene: &Scene, sky: &EnvironmentLight) -> f64 {
    let (lower, upper) = scene.bounds();
    let radius = (upper - lower).length() / 2.0;
    4.0 * f64::from(PI) * f64::from(PI) * radius * radius * sky.mean
}

/// Does the camera stand within this sphere? Then every ray that leaves the other things finds it by itself.
fn surrounds(scene: &Scene, sphere: &Sphere) -> bool {
    let to = scene.camera.position.as_dvec3() - sphere.center.as_dvec3();
    to.length() < f64::from(sphere.radius)
}

fn rows(scene: &Scene, number: usize, chance: f32) -> [[f32; 8]; 2] {
    if number == scene.spheres.len() + scene.triangles.len() {
        return [[0.0, 0.0, 0.0, SKY_RADIUS, 0.0, 0.0, 0.0, chance], [0.0; 8]];
    }
    let emission = |material: u32| scene.materials[material as usize].emission;
    match scene.spheres.get(number) {
        Some(&Sphere { center, radius, material, .. }) => {
            let e = emission(material);
            let offset = sphere_offset(center, radius);
            [
                [center.x, center.y, center.z, radius, e.x, e.y, e.z, chance],
                [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, offset],
            ]
        }
        None => {
            let Triangle { vertices, material } = scene.triangles[number - scene.spheres.len()];
            let [a, b, c] = vertices;
            let (ab, ac, e) = (b - a, c - a, emission(material));
            let offset = triangle_offset(vertices);
            [[a.x, a.y, a.z, 0.0, e.x, e.y, e.z, chance], [ab.x, ab.y, ab.z, ac.x, ac.y, ac.z, 0.0, offset]]
        }
    }
}

/// The chances of lights with these shares of all power: the shares, but none below [`LEAST`] of the average.
fn shares(mut shares: Vec<f64>) -> Vec<f64> {
    let least = LEAST / shares.len() as f64;
    shares.iter_mut().for_each(|share| *share = share.max(least));
    let total: f64 = shares.iter().sum();
    shares.into_iter().map(|share| share / total).collect()
}

/// Slots of equal width: up to the first number of a slot's width it stands for itself, above it for the second.
fn alias_table(shares: &[f64]) -> (Vec<f32>, Vec<u32>) {
    let count = shares.len();
    let mut rest: Vec<f64> = shares.iter().map(|share| share * count as f64).collect();
    let mut keep = vec![1.0; count];
    let mut other: Vec<u32> = (0..count as u32).collect();
    let (mut small, mut large): (Vec<usize>, Vec<usize>) = (0..count).partition(|&slot| rest[slot] < 1.0);
    while let (Some(&short), Some(&long)) = (small.last(), large.last()) {
        small.pop();
        keep[short] = rest[short] as f32;
        other[short] = long as u32;
        rest[long] -= 1.0 - rest[short];
        if rest[long] < 1.0 {
            large.pop();
            small.push(long);
        }
    }
    // What is left over is 1 but for rounding.
    (keep, other)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alias_tables_give_each_its_share() {
        for shares in [vec![1.0], vec![0.5, 0.5], vec![0.7, 0.1, 0.2], vec![0.001, 0.002, 0.003, 0.994]] {
            let (keep, other) = alias_table(&shares);
            let mut given = vec![0.0; shares.len()];
            for slot in 0..shares.len() {
                let width = 1.0 / shares.len() as f64;
                given[slot] += width * f64::from(keep[slot]);
                given[other[slot] as usize] += width * (1.0 - f64::from(keep[slot]));
            }
            for (given, share) in given.iter().zip(&shares) {
                assert!((given - share).abs() < 1e-7, "{given} of {share}");
            }
        }
    }
}
