//! Scattered directions: opposite vectors that cancel, shading normals.

use super::rng::Rng;
use super::test_case::{FailureCounts, TestCase, compare};
use crate::kernel::bsdf::diffuse;
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
            title: "Diffuse surfaces with shading normals: rays below the surface, and lost light",
            axis: "angle of shading and geometric normal in degrees",
            places: &[1.0, 3.0, 10.0, 20.0, 40.0, 60.0, 80.0],
            failure: "one of 256 rays leaves below the surface",
            error: Some("share of the light that is lost"),
            source: CHIANG,
            inputs: 2_000,
            methods: compare(
                diffuse_light,
                &[
                    ("unchecked", |_, _, _| Some(1.0)),
                    ("absorbed", |w, _, ng| (w.dot(ng) > 0.0).then_some(1.0)),
                    ("absorbed-and-shadowed", |w, ns, ng| {
                        (w.dot(ng) > 0.0).then(|| normals::shadow_terminator(w, ns, ng))
                    }),
                ],
            ),
            ..TestCase::COMMON
        },
        TestCase {
            name: "scattering-mirror",
            title: "Mirrors with shading normals",
            axis: "angle of shading and geometric normal in degrees",
            places: &[1.0, 3.0, 10.0, 20.0, 40.0, 60.0, 80.0],
            failure: "reflected below the surface",
            source: "Keller et al., The Iray Light Transport Simulation and Rendering System, 2017, §A.3",
            methods: compare(
                mirror,
                &[("unbent", |_, ns, _| ns), ("bent", normals::bend_for_reflection::<f32>)],
            ),
            ..TestCase::COMMON
        },
    ]
}

const CHIANG: &str = "Chiang, Li, Burley, Taming the Shadow Terminator, SIGGRAPH Talks 2019";

/// The numbers u and v from which [`warp::sample_uniform_sphere`] computes this unit vector, up to rounding.
fn numbers(v: DVec3) -> (f32, f32) {
    let below_one = |x: f64| (x as f32).min(BELOW_ONE);
    (below_one(0.5 - 0.5 * v.z), below_one((v.y.atan2(v.x) / TAU).rem_euclid(1.0)))
}

/// Half of the normals are axis-aligned, where cancellation is exact.
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

/// The geometric normal and a shading normal.
fn tilted(rng: &mut Rng, degrees: f64) -> [Vec3<f32>; 2] {
    let ng = rng.direction();
    let across = ng.cross(rng.direction()).normalize();
    let (sin, cos) = degrees.to_radians().sin_cos();
    [ng, ng * cos + across * sin].map(|normal| Vec3::splat(normal.as_vec3()))
}

/// `weight` is the weight of a direction, given the shading and the geometric normal; `None` where it is
/// absorbed.
fn diffuse_light(
    rng: &mut Rng,
    degrees: f64,
    counts: &mut FailureCounts,
    weight: fn(Vec3<f32>, Vec3<f32>, Vec3<f32>) -> Option<f32>,
) {
    const SIDE: usize = 16;
    let [ng, ns] = tilted(rng, degrees);
    let (mut passed, mut below) = (0.0, false);
    for cell in 0..SIDE * SIDE {
        let within = |at: usize, rng: &mut Rng| ((at as f64 + rng.unit()) / SIDE as f64) as f32;
        let (u, v) = (within(cell % SIDE, rng), within(cell / SIDE, rng));
        let w = diffuse::sample(ns, u.min(1.0 - f32::EPSILON), v.min(1.0 - f32::EPSILON)).wi;
        if let Some(weight) = weight(w, ns, ng) {
            passed += f64::from(weight);
            below |= w.get(0).as_dvec3().dot(ng.get(0).as_dvec3()) <= 0.0;
        }
    }
    if below { counts.record(true) } else { counts.record_error(1.0 - passed / (SIDE * SIDE) as f64) }
}

/// `bend` computes the normal for reflection from the arriving direction, the shading and the geometric
/// normal. Directions arrive from all angles above the surface, from perpendicular to grazing with a cosine
/// of 1e-4: below 2e-6, rounding decides the side, and rays end there.
fn mirror(
    rng: &mut Rng,
    degrees: f64,
    counts: &mut FailureCounts,
    bend: fn(Vec3<f32>, Vec3<f32>, Vec3<f32>) -> Vec3<f32>,
) {
    let [ng, ns] = tilted(rng, degrees);
    let n = ng.get(0).as_dvec3();
    let along = n.cross(rng.direction()).normalize();
    let d = (along - n * rng.scale(1e-4, 1e2)).normalize();
    let d = Vec3::splat(d.as_vec3());
    let reflected = d.reflect(bend(d, ns, ng)).get(0);
    // NaN is not above.
    let above = reflected.as_dvec3().dot(n) > 0.0;
    counts.record(!above);
}
