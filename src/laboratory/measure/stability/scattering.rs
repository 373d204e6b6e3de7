//! Scattered directions: opposite vectors that cancel, shading normals.

use super::rng::Rng;
use super::test_case::{Bound, FailureCounts, TestCase, compare};
use crate::kernel::bsdf::albedo::Albedo;
use crate::kernel::bsdf::{BsdfSample, Horizon, LobeNormals, diffuse, ggx};
use crate::kernel::normals;
use crate::math::{BELOW_ONE, Vec3};
use crate::sampling::warp;
use glam::DVec3;
use std::f64::consts::TAU;

pub(super) fn test_cases() -> Vec<TestCase> {
    vec![
        TestCase {
            name: "scattering-opposite",
            title: "Diffuse directions as normal + point of a sphere, where both nearly cancel",
            axis: "distance of the point and the opposite of the normal",
            places: &[0.0, 1e-8, 3e-8, 1e-7, 3e-7, 1e-6, 1e-5, 1e-4, 1e-3],
            failure: "NaN, or below the surface",
            source: "Shirley, Ray Tracing in One Weekend §9.4",
            inputs: 50_000,
            methods: compare(
                opposite,
                &[
                    ("sum", |n, u, v| (warp::sample_uniform_sphere(u, v) + n).normalize()),
                    ("smaller-sphere", warp::sample_cosine_hemisphere::<f32>),
                ],
            ),
            ..TestCase::COMMON
        },
        TestCase {
            name: "scattering-diffuse",
            title: "Diffuse surfaces with shading normals: rays below the surface, edges, and lost light",
            axis: "angle of shading and geometric normal in degrees",
            places: &[1.0, 3.0, 10.0, 20.0, 40.0, 60.0, 80.0],
            failure: "one of 256 rays leaves below the surface, or a light is as bright on the horizon as above",
            error: Some("share of the light above the horizon that is lost"),
            source: "Chiang, Li, Burley, Taming the Shadow Terminator, SIGGRAPH Talks 2019",
            inputs: 2_000,
            methods: compare(
                diffuse_light,
                &[
                    ("unchecked", |_, _, _| Some(1.0)),
                    ("absorbed", |w, _, ng| (w.dot(ng) > 0.0).then_some(1.0)),
                    ("absorbed-and-shadowed", |w, ns, ng| (w.dot(ng) > 0.0).then(|| chiang(w, ns, ng))),
                    ("faded", |w, ns, ng| (w.dot(ng) > 0.0).then(|| normals::shadow_terminator(w, ns, ng))),
                ],
            ),
            ..TestCase::COMMON
        },
        TestCase {
            name: "scattering-glossy",
            title: "Metal, smooth to rough, with shading normals: rays below the surface, and lost light",
            axis: "angle of shading and geometric normal in degrees",
            places: &[1.0, 3.0, 10.0, 20.0, 40.0, 60.0, 80.0],
            failure: "one of 256 rays leaves below the surface",
            error: Some("share of the light that is lost, but for that of the lobe without a shading normal"),
            source: "Keller et al., The Iray Light Transport Simulation and Rendering System, 2017, §A.3",
            inputs: 2_000,
            methods: compare(
                glossy_light,
                &[
                    ("unchecked", |d, [ns, ng], sample| sample(normals::facing(d, ns, ng))),
                    ("absorbed", |d, [ns, ng], sample| absorbed(sample(normals::facing(d, ns, ng)), ng)),
                    ("bent", |d, [ns, ng], sample| absorbed(sample(bend(d, ns, ng)), ng)),
                    ("bent-and-shadowed", |d, [ns, ng], sample| {
                        let n = bend(d, ns, ng);
                        let sample = absorbed(sample(n), ng);
                        BsdfSample { weight: sample.weight * chiang(sample.wi, n, ng), ..sample }
                    }),
                    ("mirrored", |d, [ns, ng], sample| {
                        let normals = LobeNormals::bent(d, ns, Horizon { bent: true, normal: ng, ng });
                        normals.raise_sample(sample(normals.specular), |_| 0.0)
                    }),
                ],
            ),
            // The difference between renderers that is accepted.
            bound: |_| Bound::error(0.03),
        },
    ]
}

/// Returns the numbers u and v from which [`warp::sample_uniform_sphere`] computes this unit vector, up to
/// rounding.
fn numbers(v: DVec3) -> (f32, f32) {
    let below_one = |x: f64| (x as f32).min(BELOW_ONE);
    (below_one(0.5 - 0.5 * v.z), below_one((v.y.atan2(v.x) / TAU).rem_euclid(1.0)))
}

/// Tries normals of which half are axis-aligned, where cancellation is exact.
fn opposite(
    rng: &mut Rng,
    apart: f64,
    counts: &mut FailureCounts,
    sample: fn(Vec3<f32>, f32, f32) -> Vec3<f32>,
) {
    let sign = rng.signed().signum();
    let normal = if rng.index(2) == 0 { DVec3::AXES[rng.index(3)] * sign } else { rng.direction() };
    let normal = normal.as_vec3();
    let n = normal.as_dvec3();
    let (u, v) = numbers((apart * n.cross(rng.direction()).normalize() - n).normalize());
    let direction = sample(Vec3::splat(normal), u, v).get(0);
    counts.record(direction.as_dvec3().dot(n) <= 0.0 || !direction.is_finite());
}

/// Returns the geometric normal and a shading normal.
fn tilted(rng: &mut Rng, degrees: f64) -> [Vec3<f32>; 2] {
    let ng = rng.direction();
    let across = ng.cross(rng.direction()).normalize();
    let (sin, cos) = degrees.to_radians().sin_cos();
    [ng, ng * cos + across * sin].map(|normal| Vec3::splat(normal.as_vec3()))
}

/// Returns the factor that darkens lights where the normals differ, down to 0 at the horizon.
fn chiang(w: Vec3<f32>, ns: Vec3<f32>, ng: Vec3<f32>) -> f32 {
    let g = (w.dot(ng).max(0.0) / (w.dot(ns) * ns.dot(ng)).max(1e-12)).min(1.0);
    ((1.0 - g) * g + 1.0) * g
}

/// Bends `ns` towards `ng` until the mirror direction of `d` is above the surface: by half the sine at which
/// d arrives, at most 0.01.
fn bend(d: Vec3<f32>, ns: Vec3<f32>, ng: Vec3<f32>) -> Vec3<f32> {
    let mirrored = d.reflect(ns);
    let (sine, least) = (mirrored.dot(ng), (-0.5 * d.dot(ng)).clamp(1e-6, 0.01));
    if sine < least { (ng.mul_add(least - sine, mirrored).normalize() - d).normalize() } else { ns }
}

fn absorbed(sample: BsdfSample<f32>, ng: Vec3<f32>) -> BsdfSample<f32> {
    BsdfSample { alive: sample.alive && sample.wi.dot(ng) > 0.0, ..sample }
}

/// Returns random numbers in the cells of a grid.
fn stratified(rng: &mut Rng) -> Vec<(f32, f32)> {
    const SIDE: usize = 16;
    let mut within = |at: usize| (((at as f64 + rng.unit()) / SIDE as f64) as f32).min(BELOW_ONE);
    (0..SIDE * SIDE).map(|cell| (within(cell % SIDE), within(cell / SIDE))).collect()
}

/// Measures the light of a diffuse surface. `weight` is the weight of a direction, given the shading and the
/// geometric normal; `None` where it is absorbed.
fn diffuse_light(
    rng: &mut Rng,
    degrees: f64,
    counts: &mut FailureCounts,
    weight: fn(Vec3<f32>, Vec3<f32>, Vec3<f32>) -> Option<f32>,
) {
    let [ng, ns] = tilted(rng, degrees);
    let cos = ns.dot(ng);
    let horizon = (ns - ng * cos).normalize() + ng * (1e-3 * (1.0 - cos * cos).sqrt());
    let (mut passed, mut failed) = (0.0, weight(horizon, ns, ng).is_some_and(|weight| weight > 0.1));
    let numbers = stratified(rng);
    for &(u, v) in &numbers {
        let w = diffuse::sample(&LobeNormals::flat(ns), u, v).wi;
        if let Some(weight) = weight(w, ns, ng) {
            passed += f64::from(weight);
            failed |= w.get(0).as_dvec3().dot(ng.get(0).as_dvec3()) <= 0.0;
        }
    }
    let share = numbers.len() as f64 * f64::midpoint(1.0, f64::from(cos));
    if failed { counts.record(true) } else { counts.record_error(1.0 - passed / share) }
}

/// A treatment of the arriving direction and the shading and the geometric normal, given what samples the
/// lobe about a normal.
type Glossy = fn(Vec3<f32>, [Vec3<f32>; 2], &dyn Fn(Vec3<f32>) -> BsdfSample<f32>) -> BsdfSample<f32>;

/// Directions arrive from all angles above the surface, down to grazing ones.
fn glossy_light(rng: &mut Rng, degrees: f64, counts: &mut FailureCounts, treat: Glossy) {
    let [ng, ns] = tilted(rng, degrees);
    let n = ng.get(0).as_dvec3();
    let along = n.cross(rng.direction()).normalize();
    let d = Vec3::splat((along - n * rng.scale(1e-2, 1e2)).normalize().as_vec3());
    let alpha = rng.scale(1e-3, 0.3) as f32;
    let (mut passed, mut expected, mut below) = (0.0, 0.0, false);
    for (u, v) in stratified(rng) {
        let sample = treat(d, [ns, ng], &|n| ggx::sample(d, n, alpha, u, v));
        expected += f64::from(Albedo::of(-d.dot(normals::facing(d, ns, ng)), alpha).white);
        if sample.alive {
            passed += f64::from(sample.weight);
            // 2⁻²⁰: rounding.
            below |= sample.wi.get(0).as_dvec3().dot(n) <= -1e-6;
        }
    }
    if below { counts.record(true) } else { counts.record_error(1.0 - passed / expected) }
}
