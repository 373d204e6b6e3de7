//! Directions that leave a surface: opposite vectors that cancel, normals for shading that are not the surface's own.

use super::{Bound, Dice, Method, Recipe, Tally};
use crate::kernel::bsdf::diffuse;
use crate::kernel::normals;
use crate::math::Vec3;
use crate::sampling::warp;
use glam::DVec3;
use std::f64::consts::TAU;

pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "scattering-opposite",
        title: "A matt surface's direction as normal + point of a sphere, where both nearly cancel",
        axis: "distance of the point and the normal's opposite",
        places: &[0.0, 1e-8, 3e-8, 1e-7, 3e-7, 1e-6, 1e-5, 1e-4, 1e-3],
        failure: "no number, or below the surface",
        error: None,
        source: "Shirley, Ray Tracing in One Weekend §9.4",
        cases: 50_000,
        methods: &[
            Method::other("sum", |dice, x, cases| {
                opposite(dice, x, cases, |n, u, v| (warp::sample_uniform_sphere(u, v) + n).normalize())
            }),
            Method::default("smaller-sphere", |dice, x, cases| {
                opposite(dice, x, cases, warp::sample_cosine_hemisphere::<f32>)
            }),
        ],
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "scattering-matt",
        title: "Matt surfaces with normals for shading: what leaves below the surface, and what light that costs",
        axis: "angle of both normals in degrees",
        places: &[1.0, 3.0, 10.0, 20.0, 40.0, 60.0, 80.0],
        failure: "one of 256 rays goes on below the surface",
        error: Some("share of the light that is lost"),
        source: CHIANG,
        cases: 2_000,
        methods: &[
            Method::other("unchecked", |dice, x, cases| matt(dice, x, cases, |_, _, _| Some(1.0))),
            Method::other("absorbed", |dice, x, cases| {
                matt(dice, x, cases, |w, _, own| (w.dot(own) > 0.0).then_some(1.0))
            }),
            Method::default("absorbed-and-shadowed", |dice, x, cases| {
                matt(dice, x, cases, |w, normal, own| {
                    (w.dot(own) > 0.0).then(|| normals::shadow_terminator(w, normal, own))
                })
            }),
        ],
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "scattering-mirror",
        title: "Mirrors with normals for shading",
        axis: "angle of both normals in degrees",
        places: &[1.0, 3.0, 10.0, 20.0, 40.0, 60.0, 80.0],
        failure: "reflected below the surface",
        error: None,
        source: "Keller et al., The Iray Light Transport Simulation and Rendering System, 2017, §A.3",
        cases: 100_000,
        methods: &[
            Method::other("unbent", |dice, x, cases| mirror(dice, x, cases, |_, normal, _| normal)),
            Method::default("bent", |dice, x, cases| {
                mirror(dice, x, cases, normals::bend_for_reflection::<f32>)
            }),
        ],
        bound: |_| Bound::NO_FAILURE,
    },
];

const CHIANG: &str = "Chiang, Li, Burley, Taming the Shadow Terminator, SIGGRAPH Talks 2019";

/// The numbers u and v from which [`warp::sample_uniform_sphere`] makes this unit vector, but for rounding.
fn numbers(v: DVec3) -> (f32, f32) {
    let below_one = |x: f64| (x as f32).min(1.0 - f32::EPSILON / 2.0);
    (below_one(0.5 - 0.5 * v.z), below_one((v.y.atan2(v.x) / TAU).rem_euclid(1.0)))
}

/// Half of the normals are those of floors and walls, where cancellation is most complete.
fn opposite(
    dice: &mut Dice,
    apart: f64,
    cases: usize,
    sample: fn(Vec3<f32>, f32, f32) -> Vec3<f32>,
) -> Tally {
    let mut tally = Tally::default();
    for case in 0..cases {
        let sign = dice.signed().signum();
        let normal = if case % 2 == 0 { DVec3::AXES[dice.index(3)] * sign } else { dice.direction() };
        let normal = normal.as_vec3();
        let n = normal.as_dvec3();
        let (u, v) = numbers((apart * n.cross(dice.direction()).normalize() - n).normalize());
        let direction = sample(Vec3::splat(normal), u, v).get(0);
        tally.count(direction.as_dvec3().dot(n) <= 0.0 || !direction.is_finite());
    }
    tally
}

/// The surface's own normal and one for shading.
fn tilted(dice: &mut Dice, degrees: f64) -> [Vec3<f32>; 2] {
    let own = dice.direction();
    let across = own.cross(dice.direction()).normalize();
    let (sin, cos) = degrees.to_radians().sin_cos();
    [own, own * cos + across * sin].map(|normal| Vec3::splat(normal.as_vec3()))
}

/// `passes` says how much goes on into a direction, given the normal for shading and the own one; `None` where it is absorbed.
fn matt(
    dice: &mut Dice,
    degrees: f64,
    cases: usize,
    passes: fn(Vec3<f32>, Vec3<f32>, Vec3<f32>) -> Option<f32>,
) -> Tally {
    const SIDE: usize = 16;
    let mut tally = Tally::default();
    for _ in 0..cases {
        let [own, normal] = tilted(dice, degrees);
        let (mut passed, mut below) = (0.0, false);
        for cell in 0..SIDE * SIDE {
            let within = |at: usize, dice: &mut Dice| ((at as f64 + dice.unit()) / SIDE as f64) as f32;
            let (u, v) = (within(cell % SIDE, dice), within(cell / SIDE, dice));
            let w = diffuse::sample(normal, u.min(1.0 - f32::EPSILON), v.min(1.0 - f32::EPSILON)).wi;
            if let Some(weight) = passes(w, normal, own) {
                passed += f64::from(weight);
                below |= w.get(0).as_dvec3().dot(own.get(0).as_dvec3()) <= 0.0;
            }
        }
        if below { tally.count(true) } else { tally.off_by(1.0 - passed / (SIDE * SIDE) as f64) }
    }
    tally
}

/// `straighten` makes the normal to reflect at from the arriving direction, the normal for shading and the own one. Directions arrive from
/// everywhere above the surface, as many along it: closer than 2e-6 to it, rounding decides sides, and rays end there.
fn mirror(
    dice: &mut Dice,
    degrees: f64,
    cases: usize,
    straighten: fn(Vec3<f32>, Vec3<f32>, Vec3<f32>) -> Vec3<f32>,
) -> Tally {
    let mut tally = Tally::default();
    for _ in 0..cases {
        let [own, normal] = tilted(dice, degrees);
        let n = own.get(0).as_dvec3();
        let along = n.cross(dice.direction()).normalize();
        let d = (along - n * dice.scale(1e-4, 1e2)).normalize();
        let d = Vec3::splat(d.as_vec3());
        let reflected = d.reflect(straighten(d, normal, own)).get(0);
        // A NaN is not above.
        let above = reflected.as_dvec3().dot(n) > 0.0;
        tally.count(!above);
    }
    tally
}
