//! Spheres that are far, tiny, huge, touched, and left from inside.
//!
//! Source: Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing Gems ch. 7, 2019.

use super::aim::{exactly, ray};
use super::methods::sphere_methods;
use super::{Bound, Dice, EPSILON, Recipe, Tally};
use crate::kernel::ray_sphere::SphereMethod;
use crate::math::{self, Ray};
use glam::Vec3;
use std::f64::consts::TAU;

const HAINES: &str = "Haines, Günther, Akenine-Möller, Ray Tracing Gems ch. 7, 2019";

/// Errors are bounded where the default method promises something; measured figures stand in `kernel::ray_sphere`.
pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "spheres-far",
        title: "Spheres seen from far away",
        axis: "distance / radius",
        places: &[10.0, 30.0, 100.0, 300.0, 1e3, 4096.0, 1e4, 1e5, 1e6],
        failure: "hit or miss misjudged",
        error: Some("|Δt| / radius"),
        source: HAINES,
        cases: 400_000,
        methods: &sphere_methods!(far),
        // The silhouette is undecided within about a sixteenth of ε D: as a share of the disc that rays are aimed at, 0.2 ε D.
        bound: |d| Bound { failures: 0.25 * EPSILON * d, p99: Some(4.0 * EPSILON * (d + 1.0)) },
    },
    Recipe {
        name: "spheres-scale",
        title: "Spheres of all sizes, 100 radii away",
        axis: "radius",
        places: &[1e-15, 1e-10, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e10, 1e15],
        failure: "hit or miss misjudged",
        error: Some("|Δt| / radius"),
        source: HAINES,
        cases: 200_000,
        methods: &sphere_methods!(of_radius),
        bound: |_| Bound { failures: 0.25 * EPSILON * 100.0, p99: Some(4.0 * EPSILON * 101.0) },
    },
    Recipe {
        name: "spheres-huge",
        title: "Spheres seen from 1 above their surface",
        axis: "radius",
        places: &[1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7],
        failure: "missed, or t off by more than half",
        error: Some("|Δt| / t"),
        source: HAINES,
        cases: 100_000,
        methods: &sphere_methods!(from_close_by),
        // c = |o − c|² − r² is a small difference of large numbers.
        bound: |r| Bound { failures: 1.5 * EPSILON * r, p99: Some((2.0 * r + 10.0) * EPSILON) },
    },
    Recipe {
        name: "spheres-tangent",
        title: "Rays that just touch a sphere, or just do not, from 1.5 to 1,000 radii",
        axis: "distance of ray and silhouette / (ε distance of the origin)",
        places: &[0.1, 0.3, 1.0, 3.0, 10.0, 20.0, 100.0, 1e3, 1e4, 1e5],
        failure: "hit or miss misjudged",
        error: None,
        source: HAINES,
        cases: 100_000,
        methods: &sphere_methods!(tangent),
        bound: |off| if off < 20.0 { Bound::NONE } else { Bound::NO_FAILURE },
    },
    Recipe {
        name: "spheres-inside",
        title: "Rays from inside spheres",
        axis: "depth of the origin below the surface / radius",
        places: &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0],
        failure: "nothing hit, or a point off the sphere by more than rounding may put it",
        error: Some("distance of the point and the sphere / radius"),
        source: HAINES,
        cases: 100_000,
        methods: &sphere_methods!(from_inside),
        bound: |_| Bound::error(8.0 * EPSILON),
    },
    Recipe {
        name: "spheres-lengths",
        title: "Directions that are not of unit length, 100 radii away",
        axis: "length of the direction",
        places: &[1e-15, 1e-6, 0.5, 0.999, 0.99999, 1.0, 1.00001, 1.001, 1e6, 1e15],
        failure: "hit or miss misjudged",
        error: Some("|Δt| · length / radius"),
        source: HAINES,
        cases: 100_000,
        methods: &sphere_methods!(of_length),
        // The default takes unit length for granted, as the tracer makes and keeps it.
        bound: |length| if length == 1.0 { Bound::error(4.0 * EPSILON * 101.0) } else { Bound::NONE },
    },
];

/// A sphere of single precision.
#[derive(Clone, Copy, Debug)]
pub struct Ball {
    pub center: Vec3,
    pub radius: f32,
}

/// Around the origin.
pub const UNIT: Ball = Ball { center: Vec3::ZERO, radius: 1.0 };

/// The nearest t in (0, `limit`), as the method says.
pub fn answer<S: SphereMethod>(ball: Ball, ray: &Ray<f32>, limit: f32) -> Option<f32> {
    let center = math::Vec3::splat(ball.center);
    let (hit, t) = S::test(&S::prepare(ray), center, ball.radius * ball.radius, limit);
    hit.then_some(t)
}

/// The judge: the nearest t > 0, by the perpendicular in f64, where nothing cancels that f32 could see.
pub fn truth(ball: Ball, ray: &Ray<f32>) -> Option<f64> {
    let (origin, direction) = exactly(ray);
    let from_center = origin - ball.center.as_dvec3();
    let radius2 = f64::from(ball.radius) * f64::from(ball.radius);
    let a = direction.length_squared();
    let b = -from_center.dot(direction);
    let discriminant = radius2 - (from_center + direction * (b / a)).length_squared();
    if discriminant < 0.0 || discriminant.is_nan() {
        return None;
    }
    let q = b + (a * discriminant).sqrt().copysign(b);
    let (t0, t1) = (q / a, (from_center.length_squared() - radius2) / q);
    [t0.min(t1), t0.max(t1)].into_iter().find(|&t| t > 0.0)
}

/// How far the point at t lies off the sphere, and how far the rounding of a good kernel may put it, 40 ε (|o − c| + r): see
/// `reference::verdict`.
pub fn off(ball: Ball, ray: &Ray<f32>, t: f32) -> (f64, f64) {
    let (origin, direction) = exactly(ray);
    let (center, radius) = (ball.center.as_dvec3(), f64::from(ball.radius));
    let off = ((origin + direction * f64::from(t) - center).length() - radius).abs();
    (off, 40.0 * EPSILON * ((origin - center).length() + radius))
}

/// A ray from this distance of a ball's centre, aimed uniformly in a disc of 1.2 times its radius around it.
pub fn aimed(dice: &mut Dice, ball: Ball, distance: f64, length: f64) -> Ray<f32> {
    let (center, radius) = (ball.center.as_dvec3(), f64::from(ball.radius));
    let axis = dice.direction();
    let origin = (center + axis * distance).as_vec3();
    let (across, along) = axis.any_orthonormal_pair();
    let (r, phi) = (1.2 * radius * dice.unit().sqrt(), TAU * dice.unit());
    let target = center + across * (r * phi.cos()) + along * (r * phi.sin());
    ray(origin, ((target - origin.as_dvec3()).normalize() * length).as_vec3())
}

/// A ray that passes the unit ball's centre at the distance `from_center`, from `distance` away.
pub fn passing(dice: &mut Dice, from_center: f64, distance: f64) -> Ray<f32> {
    let axis = dice.direction();
    let across = axis.any_orthonormal_vector();
    // The angle whose sine is this.
    let sin = from_center / distance;
    let direction = across * sin - axis * (1.0 - sin * sin).sqrt();
    ray((axis * distance).as_vec3(), direction.as_vec3())
}

/// Is the method right about hitting, and how far off is t, in radii, along aimed rays?
fn misjudged<S: SphereMethod>(tally: &mut Tally, dice: &mut Dice, ball: Ball, distance: f64, length: f64) {
    let ray = aimed(dice, ball, distance, length);
    match (answer::<S>(ball, &ray, f32::INFINITY), truth(ball, &ray)) {
        (Some(t), Some(exact)) => {
            tally.off_by((f64::from(t) - exact).abs() * length / f64::from(ball.radius));
        }
        (None, None) => tally.count(false),
        _ => tally.count(true),
    }
}

fn far<S: SphereMethod>(dice: &mut Dice, distance: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    (0..cases).for_each(|_| misjudged::<S>(&mut tally, dice, UNIT, distance, 1.0));
    tally
}

/// Around the origin and elsewhere, so that o − c is rounded.
fn of_radius<S: SphereMethod>(dice: &mut Dice, radius: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    for case in 0..cases {
        let place = [Vec3::ZERO, Vec3::new(0.3, -0.7, 0.6)][case % 2];
        let ball = Ball { center: place * radius as f32, radius: radius as f32 };
        misjudged::<S>(&mut tally, dice, ball, 100.0 * radius, 1.0);
    }
    tally
}

fn of_length<S: SphereMethod>(dice: &mut Dice, length: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    (0..cases).for_each(|_| misjudged::<S>(&mut tally, dice, UNIT, 100.0, length));
    tally
}

/// Downwards in all directions, of which those towards the horizon miss a small sphere.
fn from_close_by<S: SphereMethod>(dice: &mut Dice, radius: f64, cases: usize) -> Tally {
    let ball = Ball { center: Vec3::ZERO, radius: radius as f32 };
    let mut tally = Tally::default();
    while tally.tested < cases {
        let up = dice.direction();
        let direction = dice.direction();
        let ray = ray((up * (radius + 1.0)).as_vec3(), (direction * -direction.dot(up).signum()).as_vec3());
        if let Some(exact) = truth(ball, &ray) {
            match answer::<S>(ball, &ray, f32::INFINITY).map(|t| (f64::from(t) / exact - 1.0).abs()) {
                Some(error) if error <= 0.5 => tally.off_by(error),
                _ => tally.count(true),
            }
        }
    }
    tally
}

/// Half of them pass the silhouette inside and half outside, by as many ε times the distance.
fn tangent<S: SphereMethod>(dice: &mut Dice, off: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    for case in 0..cases {
        let hits = case % 2 == 0;
        let distance = dice.scale(1.5, 1e3);
        let margin = off * EPSILON * distance;
        let from_center = if hits { 1.0 - margin } else { 1.0 + margin };
        let ray = passing(dice, from_center, distance);
        // Next to the silhouette the direction's own rounding decides.
        let hits = truth(UNIT, &ray).is_some();
        tally.count(answer::<S>(UNIT, &ray, f32::INFINITY).is_some() != hits);
    }
    tally
}

/// Counts whether something is hit there that is on the sphere.
fn lands<S: SphereMethod>(tally: &mut Tally, ball: Ball, ray: &Ray<f32>) {
    match answer::<S>(ball, ray, f32::INFINITY).map(|t| off(ball, ray, t)) {
        Some((off, allowed)) if off <= allowed => tally.off_by(off / f64::from(ball.radius)),
        _ => tally.count(true),
    }
}

fn from_inside<S: SphereMethod>(dice: &mut Dice, depth: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    for _ in 0..cases {
        let radius = dice.scale(1e-6, 1e6) as f32;
        let ball = Ball { center: dice.in_cube().as_vec3() * radius, radius };
        let inside = dice.direction() * ((1.0 - depth) * f64::from(radius));
        let origin = (ball.center.as_dvec3() + inside).as_vec3();
        lands::<S>(&mut tally, ball, &ray(origin, dice.direction().as_vec3()));
    }
    tally
}
