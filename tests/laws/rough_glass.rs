//! The laws of rough glass: samples are distributed as *evaluate* says, and no light is lost between facets.

use crate::common::statistics::mean_and_error;
use crate::common::*;
use octray::kernel::bsdf::albedo::Albedo;
use octray::kernel::bsdf::rough_glass::RoughGlass;
use octray::kernel::bsdf::{Horizon, LobeNormals, ggx, glass_albedo};
use std::f64::consts::{PI, TAU};

fn lane(v: DVec3) -> math::Vec3<f32> {
    math::Vec3::splat(v.as_vec3())
}

/// An arriving direction at an angle in degrees to the normal.
fn arriving(degrees: f64) -> (DVec3, DVec3) {
    let n = dvec3(0.36, -0.48, 0.8).normalize();
    let t = dvec3(0.7, 0.5, 0.1).cross(n).normalize();
    let (sin, cos) = degrees.to_radians().sin_cos();
    (-(n * cos + t * sin), n)
}

/// The factor 1 / E of a direction by tables. With a map they are those of roughness 1.
fn compensation(cos: f64, roughness: f32, (ior, outside): (f32, bool), is_mapped: bool) -> f32 {
    let (alpha, cos) = (roughness * roughness, cos as f32);
    if ior < 0.0 {
        return 1.0 / Albedo::of(cos, alpha).white;
    }
    let stated = if is_mapped { 1.0 } else { roughness };
    let table = glass_albedo::table(ior, stated, is_mapped);
    let cell = glass_albedo::Cell::of(cos, alpha, stated * stated);
    1.0 / cell.interpolate(table[cell.row as usize], outside)
}

/// Interfaces of every roughness and index, with their factors: from outside and from inside, and thin.
fn interfaces(iors: &[f32], roughnesses: &[f32], degrees: f64, is_mapped: bool) -> Vec<RoughGlass<f32>> {
    let mut all = Vec::new();
    let (d, n) = arriving(degrees);
    for (ior, &roughness) in iors.iter().flat_map(|&ior| roughnesses.iter().map(move |it| (ior, it))) {
        for outside in if ior < 0.0 { vec![true] } else { vec![true, false] } {
            let compensation = compensation(-d.dot(n), roughness, (ior, outside), is_mapped);
            all.push(RoughGlass { alpha: roughness * roughness, ior, compensation, outside, ng: lane(n) });
        }
    }
    all
}

const ANGLES: [f64; 6] = [0.0, 31.0, 43.0, 60.0, 80.0, 88.0];

/// The share of light that is kept, by the points of an additive recurrence; radiance is scaled back.
fn kept(glass: &RoughGlass<f32>, degrees: f64) -> f64 {
    const POINTS: u32 = 1 << 15;
    let (d, n) = arriving(degrees);
    let eta2 = f64::from(glass.ior).powi(if glass.outside { -2 } else { 2 });
    let sum = (0..POINTS).map(|point| {
        let steps = [0.819_172_513_396, 0.671_043_606_704, 0.549_700_477_901];
        let numbers = steps.map(|step| ((f64::from(point) * step).fract() as f32).min(1.0 - 6e-8));
        let sample = glass.sample(lane(d), &LobeNormals::flat(lane(n)), numbers);
        let refracts = glass.ior > 0.0 && sample.wi.get(0).as_dvec3().dot(n) < 0.0;
        let weight = if sample.alive { f64::from(sample.weight) } else { 0.0 };
        if refracts { weight / eta2 } else { weight }
    });
    sum.sum::<f64>() / f64::from(POINTS)
}

#[test]
fn rough_glass_keeps_all_light_at_every_roughness_and_index() {
    let roughnesses = [0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0];
    for is_mapped in [false, true] {
        let allowed = if is_mapped { 0.985..1.012 } else { 0.99..1.01 };
        for degrees in ANGLES {
            for glass in interfaces(&[1.1, 1.33, 1.5, 2.4, 0.7, 1.0, -1.5], &roughnesses, degrees, is_mapped)
            {
                let kept = kept(&glass, degrees);
                let is_kept = allowed.contains(&kept);
                assert!(is_kept, "{glass:?} at {degrees}°, {is_mapped}, keeps {kept:.4} of the light");
            }
        }
    }
}

/// A direction of a grid of equal solid angles.
fn direction(index: usize, side: usize) -> DVec3 {
    let z = 1.0 - 2.0 * ((index / side) as f64 + 0.5) / side as f64;
    let phi = TAU * ((index % side) as f64 + 0.5) / side as f64;
    let radius = (1.0 - z * z).sqrt();
    dvec3(radius * phi.cos(), radius * phi.sin(), z)
}

#[test]
fn samples_of_rough_glass_are_distributed_as_their_density_says() {
    const SIDE: usize = 10;
    const FINE: usize = 40;
    const SAMPLES: usize = 60_000;
    for (degrees, tilt) in [(0.0, 0.0), (43.0, 0.0), (80.0, 0.0), (31.0, 25.0), (60.0, -30.0)] {
        let (d, n) = arriving(degrees);
        let (sin, cos) = f64::to_radians(tilt).sin_cos();
        let ns = n * cos + dvec3(0.7, 0.5, 0.1).cross(n).normalize() * sin;
        let horizon = Horizon { bent: tilt != 0.0, normal: lane(n), ng: lane(n) };
        let normals = LobeNormals::bent(lane(d), lane(ns), horizon);
        for glass in interfaces(&[1.5, 0.7, 2.4, -1.5], &[0.5, 0.8, 1.0], degrees, false) {
            let bin = |w: DVec3| {
                let row = ((1.0 - w.z) * 0.5 * SIDE as f64) as usize;
                let column = ((w.y.atan2(w.x) / TAU).rem_euclid(1.0) * SIDE as f64) as usize;
                row.min(SIDE - 1) * SIDE + column.min(SIDE - 1)
            };
            let fine = SIDE * FINE;
            let (mut expected, mut value) = (vec![0.0; SIDE * SIDE], 0.0);
            for w in (0..fine * fine).map(|index| direction(index, fine)) {
                let eval = glass.evaluate(lane(d), &normals, lane(w));
                let area = 4.0 * PI / (fine * fine) as f64;
                expected[bin(w)] += f64::from(eval.pdf) * area;
                value += f64::from(eval.value) * area;
            }
            let integral: f64 = expected.iter().sum();
            assert!(integral < 1.005, "{glass:?} at {degrees}°: the density holds {integral}");
            let mut rng = Rng(17 + degrees as u64);
            let (mut counts, mut weights) = (vec![0.0; SIDE * SIDE], Vec::new());
            for _ in 0..SAMPLES {
                let numbers = [(); 3].map(|()| (rng.bits() >> 8) as f32 / 16_777_216.0);
                let sample = glass.sample(lane(d), &normals, numbers);
                weights.push(if sample.alive { f64::from(sample.weight) } else { 0.0 });
                if sample.alive {
                    let w = sample.wi.get(0);
                    counts[bin(w.as_dvec3())] += 1.0;
                    let eval = glass.evaluate(lane(d), &normals, sample.wi);
                    assert!((eval.pdf / sample.pdf - 1.0).abs() < 1e-5, "{glass:?}: {eval:?}, {sample:?}");
                    if tilt == 0.0 {
                        let off = (eval.value / eval.pdf / sample.weight - 1.0).abs();
                        let height = sample.wi.get(0).as_dvec3().dot(n).abs();
                        assert!(
                            f64::from(off) < 1e-3 + 1e-6 / height,
                            "{glass:?}: the weight is off by {off}"
                        );
                    }
                }
            }
            let (mean, error) = mean_and_error(&weights);
            assert!(
                (mean - value).abs() < 5.0 * error + 0.005 * value,
                "{glass:?}, {degrees}°, {tilt}°: {mean}, {value}"
            );
            for (count, share) in counts.iter().zip(&expected) {
                let expected: f64 = share * SAMPLES as f64;
                let most = 6.0 * expected.sqrt() + 0.02 * expected + 90.0;
                assert!(
                    (count - expected).abs() < most,
                    "{glass:?}, {degrees}°, {tilt}°: {count}, {expected}"
                );
            }
        }
    }
}

/// Light takes the same way back, but for the factor and the square of the index: Walter et al., 2007, §4.
#[test]
fn rough_glass_without_its_factor_looks_the_same_both_ways() {
    let mut rng = Rng(5);
    for ior in [1.3, 1.5, 2.4] {
        for alpha in [0.1, 0.5, 1.0] {
            for _ in 0..5_000 {
                let (n, o, i) = (rng.direction(), rng.direction(), rng.direction());
                let from = |w: DVec3| {
                    let ng = if w.dot(n) < 0.0 { -n } else { n };
                    let outside = w.dot(n) > 0.0;
                    (ng, RoughGlass { alpha, ior, compensation: 1.0, outside, ng: lane(ng) })
                };
                let value = |o: DVec3, i: DVec3| {
                    let (ng, glass) = from(o);
                    let value = glass.evaluate(lane(-o), &LobeNormals::flat(lane(ng)), lane(i)).value;
                    // Radiance in units of the squared index of its medium.
                    let index2 = |w: DVec3| if w.dot(n) > 0.0 { 1.0 } else { f64::from(ior).powi(2) };
                    f64::from(value) / i.dot(n).abs() * index2(i)
                };
                let cosines = [o.dot(n).abs(), i.dot(n).abs()];
                let (there, back) = (value(o, i), value(i, o));
                if cosines[0].min(cosines[1]) > 0.05 {
                    assert!((there - back).abs() < 0.01 * there + 1e-6, "{ior}, {alpha}: {there}, {back}");
                }
            }
        }
    }
}

#[test]
fn rough_glass_is_not_nan_at_the_edges_of_the_domain() {
    let ends = [0.0, 1e-7, 0.25, 0.5, 0.75, 1.0 - 6e-8];
    let iors = [1.0, 1.0 + 1e-6, 1.001, 0.999, 1.5, 0.7, 1e6, -1.0, -1.5];
    for cos in [1.0, 1e-3, 1e-6, 0.0, -1e-7_f64] {
        let (_, n) = arriving(0.0);
        let d = -(n * cos + n.any_orthonormal_vector() * (1.0 - cos * cos).sqrt());
        for glass in interfaces(&iors, &[0.0, 1e-9, 0.011, 0.02, 0.3, 1.0], 88.0, false) {
            let normals = LobeNormals::flat(lane(n));
            for numbers in (0..216).map(|i| [ends[i % 6], ends[i / 6 % 6], ends[i / 36]]) {
                let sample = glass.sample(lane(d), &normals, numbers);
                let wi = sample.wi.get(0);
                let eval = glass.evaluate(lane(d), &normals, sample.wi);
                if sample.alive {
                    assert!((wi.length() - 1.0).abs() < 1e-5, "{glass:?}, {d}: {wi}");
                    assert!(
                        sample.weight.is_finite() && sample.weight >= 0.0 && sample.pdf > 0.0,
                        "{glass:?}"
                    );
                }
                assert!(
                    eval.value.is_finite() && eval.pdf.is_finite() && eval.pdf >= 0.0,
                    "{glass:?}: {eval:?}"
                );
            }
        }
    }
    assert!(ggx::is_narrow(0.0_f32));
}
