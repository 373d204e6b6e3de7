//! The law of lobes: what *sample* draws is distributed as *evaluate* says, weighs value / pdf, and no lobe
//! makes light.
//!
//! Each lobe is drawn and counted over solid angle, and the counts are held against quadrature of its density
//! in f64. Seeds are fixed; deviations are allowed for at the level of the whole family of tests (1e-4,
//! Bonferroni).

use crate::common::statistics::{allowed, deviation_of, mean_and_error};
use crate::common::*;
use octray::kernel::bsdf::albedo::{Albedo, compensated};
use octray::kernel::bsdf::layered::{Layered, Layers};
use octray::kernel::bsdf::metal_rough::MetalRough;
use octray::kernel::bsdf::plastic::{Plastic, mean_transmittance};
use octray::kernel::bsdf::{
    BsdfEval, BsdfSample, Horizon, LobeEval, LobeNormals, diffuse, fuzzy_mirror, ggx,
};
use std::f64::consts::{PI, TAU};

#[derive(Clone, Copy, Debug)]
enum Lobe {
    Diffuse,
    Ggx { alpha: f32 },
    FuzzyMirror { roughness: f32 },
    Plastic { alpha: f32, ior: f32, color: Vec3, transmitted: f32 },
    MetalRough { alpha: f32, metallic: f32, color: Vec3 },
    Layered { alpha: f32, metallic: f32, color: Vec3, f0: Vec3, f90: f32, coat: [f32; 2] },
}

fn lane(v: Vec3) -> math::Vec3<f32> {
    math::Vec3::splat(v)
}

struct Drawn {
    direction: Vec3,
    weight: Vec3,
    pdf: f32,
    alive: bool,
}

impl Lobe {
    fn plastic(self) -> Plastic<f32> {
        let Lobe::Plastic { alpha, ior, color, transmitted } = self else { unreachable!() };
        Plastic { color: lane(color), alpha, ior, transmitted }
    }
    /// Of the index 1.5.
    fn metal_rough(self) -> MetalRough<f32> {
        let Lobe::MetalRough { alpha, metallic, color } = self else { unreachable!() };
        MetalRough { color: lane(color), alpha, f0: 0.04, metallic }
    }
    /// Under a coat of a share and an alpha.
    fn layered(self) -> Layered<f32> {
        let Lobe::Layered { alpha, metallic, color, f0, f90, coat: [coat, coat_alpha] } = self else {
            unreachable!()
        };
        let base = Lobe::MetalRough { alpha, metallic, color }.metal_rough();
        Layered { base, layers: Layers { f0: lane(f0), f90, coat, coat_alpha } }
    }
    fn sample(self, d: Vec3, normals: &LobeNormals<f32>, [choose, u, v]: [f32; 3]) -> Drawn {
        let (d, n) = (lane(d), normals.specular);
        let grey = |lobe: BsdfSample<f32>| (lobe, math::Vec3::repeat(lobe.weight));
        let pdf = |wi: math::Vec3<f32>| self.evaluate_about(d, n, wi).pdf;
        let (lobe, weight) = match self {
            Lobe::Diffuse => grey(diffuse::sample(normals, u, v)),
            Lobe::Ggx { alpha } => grey(normals.raise_sample(ggx::sample(d, n, alpha, u, v), pdf)),
            Lobe::FuzzyMirror { roughness } => {
                grey(normals.raise_sample(fuzzy_mirror::sample(d, n, roughness, u, v), pdf))
            }
            Lobe::Plastic { .. } => {
                let plastic = self.plastic();
                plastic.sample(&plastic.view(d, n), d, normals, [choose, u, v])
            }
            Lobe::MetalRough { .. } => self.metal_rough().sample(d, normals, choose, (u, v)),
            Lobe::Layered { .. } => self.layered().sample(d, normals, choose, (u, v)),
        };
        Drawn { direction: lobe.wi.get(0), weight: weight.get(0), pdf: lobe.pdf, alive: lobe.alive }
    }
    fn evaluate_about(self, d: math::Vec3<f32>, n: math::Vec3<f32>, wi: math::Vec3<f32>) -> LobeEval<f32> {
        match self {
            Lobe::Ggx { alpha } => ggx::evaluate(d, n, alpha, wi),
            Lobe::FuzzyMirror { roughness } => fuzzy_mirror::evaluate(d, n, roughness, wi),
            _ => unreachable!(),
        }
    }
    /// f · cos θ, and the density.
    fn evaluate(self, d: Vec3, normals: &LobeNormals<f32>, towards: Vec3) -> (Vec3, f32) {
        let (d, towards) = (lane(d), lane(towards));
        let grey = |LobeEval { value, pdf }: LobeEval<f32>| BsdfEval { value: lane(Vec3::splat(value)), pdf };
        let BsdfEval { value, pdf } = match self {
            Lobe::Diffuse => grey(diffuse::evaluate(normals, towards)),
            Lobe::Plastic { .. } => {
                let plastic = self.plastic();
                plastic.evaluate(&plastic.view(d, normals.specular), d, normals, towards)
            }
            Lobe::MetalRough { .. } => self.metal_rough().evaluate(d, normals, towards),
            Lobe::Layered { .. } => self.layered().evaluate(d, normals, towards),
            _ => normals.fold(towards, math::Vec3::zero(), |wi, _| {
                grey(self.evaluate_about(d, normals.specular, wi))
            }),
        };
        (value.get(0), pdf)
    }
    /// The direction at (a, b) of the unit square, a turning away from the mirror direction, b around it, and
    /// the solid angle per area of the square: fine where the lobe is narrow, and regular where the density
    /// of the fuzzy mirror is not.
    fn chart(self, axis: DVec3, a: f64, b: f64) -> (DVec3, f64) {
        let (cos, area) = match self {
            Lobe::FuzzyMirror { roughness } if roughness < 1.0 => {
                let r = f64::from(roughness);
                // sin² γ = ρ² (1 − x): dω = ρ² dx dφ / 2c. Beyond the rim too, where x < 0.
                let x = (1.0 - a).powi(2) - BEYOND;
                let cos = (1.0 - r * r * (1.0 - x)).max(1e-9).sqrt();
                (cos, TAU * r * r * (1.0 - a) / cos)
            }
            _ => {
                let angle = PI * a.powi(3);
                (angle.cos(), TAU * angle.sin() * 3.0 * PI * a * a)
            }
        };
        let sin = (1.0 - cos * cos).sqrt();
        let tangent = axis.any_orthonormal_vector();
        let phi = TAU * b;
        (axis * cos + (tangent * phi.cos() + axis.cross(tangent) * phi.sin()) * sin, area)
    }
    /// The place of a direction in the chart.
    fn place(self, axis: DVec3, w: DVec3) -> (f64, f64) {
        let tangent = axis.any_orthonormal_vector();
        let b = (w.dot(axis.cross(tangent)).atan2(w.dot(tangent)) / TAU).rem_euclid(1.0);
        let sin = w.cross(axis).length();
        let a = match self {
            Lobe::FuzzyMirror { roughness } if roughness < 1.0 => {
                1.0 - (1.0 + BEYOND - (sin / f64::from(roughness)).powi(2)).max(0.0).sqrt()
            }
            _ => (sin.atan2(w.dot(axis)) / PI).cbrt(),
        };
        (a, b)
    }
}

/// How far the charts of narrow cones go on beyond the rim, in sin² γ / ρ².
const BEYOND: f64 = 2.0 / 16_384.0;

const WHITE: Vec3 = Vec3::ONE;

fn plastic(alpha: f32, ior: f32, color: Vec3) -> Lobe {
    Lobe::Plastic { alpha, ior, color, transmitted: mean_transmittance(ior) }
}

fn lobes() -> Vec<Lobe> {
    let mut lobes = vec![Lobe::Diffuse];
    lobes.extend([2e-4, 0.01, 0.09, 0.36, 1.0].map(|alpha| Lobe::Ggx { alpha }));
    lobes.extend([0.02, 0.3, 0.9, 1.0, 1.1, 2.5, 1e3].map(|roughness| Lobe::FuzzyMirror { roughness }));
    let color = vec3(0.8, 0.3, 0.1);
    lobes.extend([0.0, 0.01, 0.2, 1.0].map(|alpha| plastic(alpha, 1.5, color)));
    lobes.extend([plastic(0.3, 2.6, WHITE), plastic(0.2, 1.5, Vec3::ZERO)]);
    let metals = [(0.0, 0.0), (0.01, 0.0), (0.2, 0.5), (0.5, 1.0)];
    lobes.extend(metals.map(|(alpha, metallic)| Lobe::MetalRough { alpha, metallic, color }));
    let coated =
        [(0.3, 0.0, [0.0, 0.0]), (0.4, 0.3, [0.7, 0.05]), (0.0, 0.5, [1.0, 0.3]), (0.3, 0.0, [1.0, 0.0])];
    lobes.extend(coated.map(|(alpha, metallic, coat)| Lobe::Layered {
        alpha,
        metallic,
        color,
        f0: vec3(0.02, 0.05, 0.12),
        f90: 0.7,
        coat,
    }));
    lobes
}

/// Angles of incidence in degrees.
const ANGLES: [f64; 5] = [0.0, 31.0, 60.0, 80.0, 88.0];
/// Angles of a shading normal: by the last it faces away at grazing incidence.
const TILTS: [f64; 3] = [0.0, 35.0, -40.0];

/// An arriving direction, and a normal that no axis favours.
fn arriving(degrees: f64) -> (DVec3, DVec3) {
    let n = dvec3(0.36, -0.48, 0.8).normalize();
    let t = dvec3(0.7, 0.5, 0.1).cross(n).normalize();
    let (sin, cos) = degrees.to_radians().sin_cos();
    (-(n * cos + t * sin), n)
}

fn flat(n: Vec3) -> LobeNormals<f32> {
    LobeNormals::flat(lane(n))
}

/// With a shading normal that is tilted by so many degrees towards what arrives, and a little across.
fn tilted(d: DVec3, n: DVec3, degrees: f64) -> LobeNormals<f32> {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let t = dvec3(0.7, 0.5, 0.1).cross(n).normalize();
    let ns = n * cos + (t + 0.5 * t.cross(n)).normalize() * sin;
    let [d, ns, ng] = [d, ns, n].map(|v| lane(v.as_vec3()));
    LobeNormals::bent(d, ns, Horizon { bent: degrees != 0.0, normal: ng, ng })
}

/// The mirror direction.
fn axis(d: DVec3, normals: &LobeNormals<f32>) -> DVec3 {
    let n = normals.specular.get(0).as_dvec3();
    normals.raise(lane((d - n * (2.0 * d.dot(n))).as_vec3()), false).get(0).as_dvec3().normalize()
}

const BINS: usize = 20;
/// Points of quadrature along a side of a bin.
const POINTS: usize = 14;
const SAMPLES: usize = 100_000;

#[test]
fn samples_are_distributed_as_their_density_says() {
    let family = lobes().len() * ANGLES.len() * TILTS.len();
    for (number, lobe) in lobes().into_iter().enumerate() {
        for (degrees, tilt) in ANGLES.into_iter().flat_map(|angle| TILTS.map(|tilt| (angle, tilt))) {
            // The chart has no place for what is mirrored of a cone.
            if tilt != 0.0 && matches!(lobe, Lobe::FuzzyMirror { roughness } if roughness < 1.0) {
                continue;
            }
            let (d, n) = arriving(degrees);
            let (d32, normals) = (d.as_vec3(), &tilted(d, n, tilt));
            let axis = axis(d, normals);
            // One more for what is absorbed or drawn from a delta lobe: what the density leaves of 1.
            let mut expected = vec![0.0; BINS * BINS + 1];
            let mut value = 0.0;
            let side = BINS * POINTS;
            for i in 0..side * side {
                let (x, y) = (i % side, i / side);
                let at = |x: usize| (x as f64 + 0.5) / side as f64;
                let (w, area) = lobe.chart(axis, at(y), at(x));
                let (f, pdf) = lobe.evaluate(d32, normals, w.as_vec3());
                let bin = (y / POINTS) * BINS + x / POINTS;
                expected[bin] += f64::from(pdf) * area / (side * side) as f64;
                value += f64::from(f.x) * area / (side * side) as f64;
            }
            let integral: f64 = expected.iter().sum();
            assert!((0.0..1.003).contains(&integral), "{lobe:?} at {degrees}°: the density holds {integral}");
            expected[BINS * BINS] = (1.0 - integral).max(0.0);

            let mut rng = Rng(1000 * number as u64 + degrees as u64 + 7);
            let mut counts = vec![0.0; BINS * BINS + 1];
            let mut weights = Vec::with_capacity(SAMPLES);
            for _ in 0..SAMPLES {
                let numbers = [(); 3].map(|()| (rng.bits() >> 8) as f32 / 16_777_216.0);
                let drawn = lobe.sample(d32, normals, numbers);
                let bin = if drawn.alive && drawn.pdf.is_finite() {
                    let (f, pdf) = lobe.evaluate(d32, normals, drawn.direction);
                    // What rounding put beyond the rim of a cone has a density that says no more than that.
                    let same = (pdf / drawn.pdf - 1.0).abs() < if tilt == 0.0 { 1e-6 } else { 0.02 };
                    assert!(same || drawn.pdf <= f32::MIN_POSITIVE, "{lobe:?}: {pdf}, {}", drawn.pdf);
                    // Metal that two directions reflect has the weight of one.
                    if tilt == 0.0 && drawn.pdf > f32::MIN_POSITIVE {
                        let off = (drawn.weight * pdf - f).abs().max_element() / f.max_element().max(1e-30);
                        // Shadowing of what leaves at a grazing angle has its error, some 2⁻²⁴ in a frame.
                        let most = 5e-4 + 1e-6 / drawn.direction.dot(n.as_vec3()).max(1e-9);
                        assert!(off < most, "{lobe:?}: the weight is off by {off:e} of {most:e}");
                    }
                    let (a, b) = lobe.place(axis, drawn.direction.as_dvec3());
                    let index = |x: f64| ((x * BINS as f64) as usize).min(BINS - 1);
                    index(a) * BINS + index(b)
                } else {
                    BINS * BINS
                };
                counts[bin] += 1.0;
                weights.push(if bin < BINS * BINS { f64::from(drawn.weight.x) } else { 0.0 });
            }
            let (mean, error) = mean_and_error(&weights);
            let off = (mean - value).abs();
            assert!(off < allowed(family) * error + 3e-3, "{lobe:?} at {degrees}°, {tilt}°: {mean}, {value}");
            // Bins that expect too little are one.
            let (mut chi2, mut freedom, mut rest) = (0.0, -1.0, (0.0, 0.0));
            let mut add = |count: f64, expected: f64| {
                chi2 += (count - expected).powi(2) / expected;
                freedom += 1.0;
            };
            for (count, share) in counts.iter().zip(&expected) {
                let expected = share * SAMPLES as f64;
                if expected < 20.0 {
                    rest = (rest.0 + count, rest.1 + expected);
                } else {
                    add(*count, expected);
                }
            }
            if rest.1 > 20.0 {
                add(rest.0, rest.1);
            } else {
                // Quadrature may be off by as much as it rounds.
                assert!(rest.0 <= rest.1 + 8.0 * rest.1.sqrt() + 30.0, "{lobe:?} at {degrees}°: {rest:?}");
            }
            if freedom < 1.0 {
                continue;
            }
            let deviation = deviation_of(chi2, freedom);
            assert!(deviation < allowed(family), "{lobe:?} at {degrees}°: {deviation:.1} standard errors");
        }
    }
}

#[test]
fn smooth_plastic_and_uncompensated_metal_look_the_same_both_ways() {
    let mut rng = Rng(72);
    let reciprocal = |lobe: &Lobe| match *lobe {
        Lobe::FuzzyMirror { .. } | Lobe::MetalRough { .. } | Lobe::Layered { .. } => false,
        Lobe::Plastic { alpha, .. } => alpha < ggx::NARROW,
        _ => true,
    };
    for lobe in lobes().into_iter().filter(reciprocal) {
        for _ in 0..20_000 {
            let n = rng.direction();
            let above = |w: DVec3| if w.dot(n) < 0.0 { -w } else { w };
            let (o, i) = (above(rng.direction()), above(rng.direction()));
            let (cos_o, cos_i) = (o.dot(n), i.dot(n));
            if cos_o.min(cos_i) < 0.02 {
                continue;
            }
            let [n, o, i] = [n, o, i].map(|w| w.as_vec3());
            let there = lobe.evaluate(-o, &flat(n), i).0.as_dvec3() / cos_i;
            let back = lobe.evaluate(-i, &flat(n), o).0.as_dvec3() / cos_o;
            assert!(there.abs_diff_eq(back, 1e-4 * there.max_element() + 1e-12), "{lobe:?}: {there}, {back}");
        }
    }
}

/// The share of light that a white lobe returns, by the points of an additive recurrence.
fn albedo(lobe: Lobe, degrees: f64) -> f64 {
    const POINTS: u32 = 1 << 16;
    let (d, n) = arriving(degrees);
    let mut sum = 0.0;
    for point in 0..POINTS {
        // Powers of the root of x⁴ = x + 1: Roberts, "The Unreasonable Effectiveness of Quasirandom
        // Sequences", 2018.
        let steps = [0.819_172_513_396, 0.671_043_606_704, 0.549_700_477_901];
        let numbers = steps.map(|step| ((f64::from(point) * step).fract() as f32).min(1.0 - 6e-8));
        let drawn = lobe.sample(d.as_vec3(), &flat(n.as_vec3()), numbers);
        if drawn.alive {
            sum += f64::from(drawn.weight.x);
        }
    }
    sum / f64::from(POINTS)
}

#[test]
fn white_furnace_loses_what_is_stated_and_gains_nothing() {
    for degrees in ANGLES {
        assert!((albedo(Lobe::Diffuse, degrees) - 1.0).abs() < 1e-6);
    }
    // Single scattering: least of the shares returned, over the angles. At grazing angles the spread of
    // weights is the grid's noise.
    let returns = |lobe: Lobe, least: f64, most: f64| {
        let found = ANGLES.map(|degrees| albedo(lobe, degrees));
        assert!(found.iter().all(|&x| (least - 0.01..most).contains(&x)), "{lobe:?}: {found:?}");
    };
    for (alpha, least) in
        [(0.0, 1.0), (0.01, 0.956), (0.09, 0.905), (0.25, 0.856), (0.49, 0.692), (1.0, 0.307)]
    {
        returns(Lobe::Ggx { alpha }, least, 1.0 + 1e-5);
    }
    // What the fits of a rough coat are off, at the most grazing angles.
    for ior in [1.0, 1.33, 1.5, 3.0] {
        for (roughness, off) in [(0.0_f32, 0.003), (0.1, 0.02), (0.4, 0.03), (0.7, 0.02), (1.0, 0.02)] {
            returns(plastic(roughness * roughness, ior, WHITE), 1.0 - off, 1.0 + off);
        }
    }
}

#[test]
fn white_furnace_keeps_the_light_of_metals_and_dielectrics() {
    for roughness in (0..=10).map(|tenths| tenths as f32 / 10.0) {
        let alpha = roughness * roughness;
        for degrees in ANGLES.into_iter().chain([70.0]) {
            let (d, n) = arriving(degrees);
            let factor = compensated(lane(WHITE), lane(d.as_vec3()), lane(n.as_vec3()), alpha).get(0).x;
            let metal = albedo(Lobe::Ggx { alpha }, degrees) * f64::from(factor);
            let rough = |metallic| albedo(Lobe::MetalRough { alpha, metallic, color: WHITE }, degrees);
            let coated = |metallic, roughness: f32| {
                let coat = [1.0, roughness * roughness];
                let f0 = Vec3::splat(0.04);
                albedo(Lobe::Layered { alpha, metallic, color: WHITE, f0, f90: 1.0, coat }, degrees)
            };
            let found = [metal, rough(1.0), rough(0.0), coated(1.0, 0.0), coated(0.0, 0.3), coated(0.3, 1.0)];
            assert!(found.iter().all(|x| (0.98..1.005).contains(x)), "{roughness} at {degrees}°: {found:?}");
        }
    }
}

/// E and E₅ of `kernel/bsdf/albedo.rs` by the midpoint rule over the slopes of facets.
fn albedo_by_quadrature(cos_o: f64, alpha: f64) -> (f64, f64) {
    let (across, around) = (300, 100);
    let lambda = |cos: f64| 0.5 * ((1.0 + alpha * alpha * (1.0 / (cos * cos) - 1.0)).sqrt() - 1.0);
    let (mut white, mut grazing) = (0.0, 0.0);
    for i in 0..across * around {
        let at = |i: usize, of: usize| (i as f64 + 0.5) / of as f64;
        // A share of t³ of the facets is steeper than this one: their tails are heavy.
        let (t, phi) = (at(i % across, across), PI * at(i / across, around));
        let slope = alpha * (1.0 / (t * t * t) - 1.0).sqrt();
        let facing = (1.0 - cos_o * cos_o).sqrt() * slope * phi.cos() + cos_o;
        let cos_i = 2.0 * facing / (1.0 + slope * slope) - cos_o;
        if facing > 0.0 && cos_i > 0.0 {
            let part = 3.0 * t * t * facing / (cos_o * (1.0 + lambda(cos_o) + lambda(cos_i.min(1.0))));
            white += part;
            grazing += part * (1.0 - facing / (1.0 + slope * slope).sqrt()).max(0.0).powi(5);
        }
    }
    (white / (across * around) as f64, grazing / (across * around) as f64)
}

#[test]
fn albedos_are_the_integrals_that_they_fit() {
    for roughness in (1..=20).map(|part| f64::from(part) / 20.0) {
        let alpha = roughness * roughness;
        for part in 1..=40 {
            // Even steps of the cosine, and of that of the stretched direction.
            let c = (f64::from(part / 2) + 0.5) / 20.5;
            let stretched = c * alpha / (1.0 - c * c + c * c * alpha * alpha).sqrt();
            let cos = if part % 2 == 0 { c } else { stretched };
            let (white, grazing) = albedo_by_quadrature(cos, alpha);
            let fit = Albedo::of(cos as f32, alpha as f32);
            let off = [f64::from(fit.white) / white - 1.0, f64::from(fit.grazing()) - grazing];
            assert!(off[0].abs() < 0.005 && off[1].abs() < 0.008, "{roughness}, {cos}: {off:?}");
        }
    }
}

#[test]
fn nothing_is_nan_at_the_edges_of_the_domain() {
    let mut lobes = lobes();
    lobes.extend([0.0, 1e-30, 1e-12, 1e-6, ggx::NARROW, 1.0].map(|alpha| Lobe::Ggx { alpha }));
    let cones = [0.0, 1e-30, 1e-6, fuzzy_mirror::NARROW, 1.0 - 6e-8, 1.0 + 1.2e-7, 1e9, 1e18];
    lobes.extend(cones.map(|roughness| Lobe::FuzzyMirror { roughness }));
    for ior in [1.0, 1.0001, 3.0] {
        for alpha in [0.0, 1e-30, 1e-6, ggx::NARROW, 1.0] {
            lobes.extend([Vec3::ZERO, WHITE, Vec3::X].map(|color| plastic(alpha, ior, color)));
        }
    }
    let ends = [0.0, 1e-7, 0.25, 0.5, 0.75, 1.0 - 6e-8];
    for lobe in lobes {
        for n in [Vec3::Z, -Vec3::Z, Vec3::Y, vec3(0.6, 0.0, 0.8)] {
            let t = n.any_orthonormal_vector();
            // 1e-7 below the horizon too: rounding puts rays there.
            for cos in [1.0, 1e-3, 1e-6, 1e-10, 0.0, -1e-7] {
                let d = -(n * cos + t * (1.0_f32 - cos * cos).sqrt());
                let mut directions = vec![n, -n, t, -t, d, -d, d - n * (2.0 * d.dot(n))];
                for numbers in (0..216).map(|i| [ends[i % 6], ends[i / 6 % 6], ends[i / 36]]) {
                    let drawn = lobe.sample(d, &flat(n), numbers);
                    if drawn.alive {
                        let unit = (drawn.direction.length() - 1.0).abs() < 1e-5;
                        assert!(unit, "{lobe:?}, {d}, {n}, {numbers:?}: {}", drawn.direction);
                        let weight = drawn.weight;
                        let fine = weight.is_finite() && weight.min_element() >= 0.0 && drawn.pdf > 0.0;
                        assert!(fine, "{lobe:?}, {d}, {n}, {numbers:?}: {weight}, {}", drawn.pdf);
                        directions.push(drawn.direction);
                    }
                }
                for towards in directions {
                    let (value, pdf) = lobe.evaluate(d, &flat(n), towards);
                    let fine =
                        value.is_finite() && value.min_element() >= 0.0 && pdf.is_finite() && pdf >= 0.0;
                    assert!(fine, "{lobe:?}, {d}, {n}, {towards}: {value}, {pdf}");
                    assert!(pdf == 0.0 || towards.dot(n) > 0.0, "{lobe:?}: {pdf} below the surface");
                }
            }
        }
    }
}
