//! Scattered directions: opposite vectors that cancel, shading normals.

use super::methods::Method;
use super::recipe::{Bound, FailureCounts, Recipe};
use super::rng::Rng;
use crate::kernel::bsdf::diffuse;
use crate::kernel::normals;
use crate::math::{BELOW_ONE, Vec3};
use crate::sampling::warp;
use glam::DVec3;
use std::f64::consts::TAU;

pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "scattering-opposite",
        title: "Diffuse directions as normal + point of a sphere, where both nearly cancel",
        axis: "distance of the point and the opposite of the normal",
        places: &[0.0, 1e-8, 3e-8, 1e-7, 3e-7, 1e-6, 1e-5, 1e-4, 1e-3],
        failure: "NaN, or below the surface",
        error: None,
        source: "Shirley, Ray Tracing in One Weekend §9.4",
        cases: 50_000,
        methods: &[
            Method::other("sum", |rng, x, cases| {
                opposite(rng, x, cases, |n, u, v| (warp::sample_uniform_sphere(u, v) + n).normalize())
            }),
            Method::default("smaller-sphere", |rng, x, cases| {
                opposite(rng, x, cases, warp::sample_cosine_hemisphere::<f32>)
            }),
        ],
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "scattering-matt",
        title: "Diffuse surfaces with shading normals: rays below the surface, and lost light",
        axis: "angle of shading and geometric normal in degrees",
        places: &[1.0, 3.0, 10.0, 20.0, 40.0, 60.0, 80.0],
        failure: "one of 256 rays leaves below the surface",
        error: Some("share of the light that is lost"),
        source: CHIANG,
        cases: 2_000,
        methods: &[
            Method::other("unchecked", |rng, x, cases| diffuse_light(rng, x, cases, |_, _, _| Some(1.0))),
            Method::other("absorbed", |rng, x, cases| {
                diffuse_light(rng, x, cases, |w, _, ng| (w.dot(ng) > 0.0).then_some(1.0))
            }),
            Method::default("absorbed-and-shadowed", |rng, x, cases| {
                diffuse_light(rng, x, cases, |w, ns, ng| {
                    (w.dot(ng) > 0.0).then(|| normals::shadow_terminator(w, ns, ng))
                })
            }),
        ],
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "scattering-mirror",
        title: "Mirrors with shading normals",
        axis: "angle of shading and geometric normal in degrees",
        places: &[1.0, 3.0, 10.0, 20.0, 40.0, 60.0, 80.0],
        failure: "reflected below the surface",
        error: None,
        source: "Keller et al., The Iray Light Transport Simulation and Rendering System, 2017, §A.3",
        cases: 100_000,
        methods: &[
            Method::other("unbent", |rng, x, cases| mirror(rng, x, cases, |_, ns, _| ns)),
            Method::default("bent", |rng, x, cases| {
                mirror(rng, x, cases, normals::bend_for_reflection::<f32>)
            }),
        ],
        bound: |_| Bound::NO_FAILURE,
    },
];

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
    cases: usize,
    sample: fn(Vec3<f32>, f32, f32) -> Vec3<f32>,
) -> FailureCounts {
    let mut counts = FailureCounts::default();
    for case in 0..cases {
        let sign = rng.signed().signum();
        let normal = if case % 2 == 0 { DVec3::AXES[rng.index(3)] * sign } else { rng.direction() };
        let normal = normal.as_vec3();
        let n = normal.as_dvec3();
        let (u, v) = numbers((apart * n.cross(rng.direction()).normalize() - n).normalize());
        let direction = sample(Vec3::splat(normal), u, v).get(0);
        counts.record(direction.as_dvec3().dot(n) <= 0.0 || !direction.is_finite());
    }
    counts
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
    cases: usize,
    weight: fn(Vec3<f32>, Vec3<f32>, Vec3<f32>) -> Option<f32>,
) -> FailureCounts {
    const SIDE: usize = 16;
    let mut counts = FailureCounts::default();
    for _ in 0..cases {
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
    counts
}

/// `bend` computes the normal for reflection from the arriving direction, the shading and the geometric
/// normal. Directions arrive from all angles above the surface, from perpendicular to grazing with a cosine
/// of 1e-4: below 2e-6, rounding decides the side, and rays end there.
fn mirror(
    rng: &mut Rng,
    degrees: f64,
    cases: usize,
    bend: fn(Vec3<f32>, Vec3<f32>, Vec3<f32>) -> Vec3<f32>,
) -> FailureCounts {
    let mut counts = FailureCounts::default();
    for _ in 0..cases {
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
    counts
}
