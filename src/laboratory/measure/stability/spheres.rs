//! Spheres: far, tiny, huge, tangent rays, origins inside.
//!
//! Source: Haines, Günther, Akenine-Möller, "Precision Improvements for Ray/Sphere Intersection", Ray Tracing
//! Gems ch. 7, 2019.

use super::methods::all_methods;
use super::rays::{ray, to_f64};
use super::rng::Rng;
use super::test_case::{Bound, Case, EPSILON, FAILED, FailureCounts, TestCase, trials};
use crate::math::{self, Ray};
use crate::methods::SphereMethod;
pub use crate::rays::Sphere as Ball;
use crate::reference::hit_sphere;
use glam::Vec3;
use std::f64::consts::TAU;

const HAINES: &str = "Haines, Günther, Akenine-Möller, Ray Tracing Gems ch. 7, 2019";

/// Bounds hold where the default method makes a promise; `kernel::ray_sphere` has the measured figures.
pub(super) fn test_cases() -> Vec<TestCase> {
    let common = |case: Case<Intersect>| TestCase {
        failure: "hit or miss misjudged",
        source: HAINES,
        methods: trials(case, &all_methods!(sphere, intersect)),
        ..TestCase::COMMON
    };
    vec![
        TestCase {
            name: "spheres-far",
            title: "Spheres seen from far away",
            axis: "distance / radius",
            places: &[10.0, 30.0, 100.0, 300.0, 1e3, 4096.0, 1e4, 1e5, 1e6],
            error: Some("|Δt| / radius"),
            inputs: 400_000,
            // Within about ε D / 16 of the silhouette, rounding decides: 0.2 ε D of the disc at which rays
            // aim.
            bound: |d| Bound { failures: 0.25 * EPSILON * d, p99: Some(4.0 * EPSILON * (d + 1.0)) },
            ..common(|rng, d, counts, intersect| misjudged(counts, rng, UNIT, d, 1.0, intersect))
        },
        TestCase {
            name: "spheres-scale",
            title: "Spheres of all sizes, 100 radii away",
            axis: "radius",
            places: &[1e-15, 1e-10, 1e-6, 1e-3, 1.0, 1e3, 1e6, 1e10, 1e15],
            error: Some("|Δt| / radius"),
            inputs: 200_000,
            bound: |_| Bound { failures: 0.25 * EPSILON * 100.0, p99: Some(4.0 * EPSILON * 101.0) },
            ..common(of_radius)
        },
        TestCase {
            name: "spheres-huge",
            title: "Spheres seen from 1 above their surface",
            axis: "radius",
            places: &[1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6, 1e7],
            failure: "missed, or t off by more than half",
            error: Some("|Δt| / t"),
            // c = |o − c|² − r² is a small difference of large numbers.
            bound: |r| Bound { failures: 1.5 * EPSILON * r, p99: Some((2.0 * r + 10.0) * EPSILON) },
            ..common(from_close_by)
        },
        TestCase {
            name: "spheres-tangent",
            title: "Rays that barely hit or miss a sphere, from 1.5 to 1,000 radii",
            axis: "distance of ray and silhouette / (ε distance of the origin)",
            places: &[0.1, 0.3, 1.0, 3.0, 10.0, 20.0, 100.0, 1e3, 1e4, 1e5],
            bound: |off| if off < 20.0 { Bound::NONE } else { Bound::NO_FAILURE },
            ..common(tangent)
        },
        TestCase {
            name: "spheres-inside",
            title: "Rays from inside spheres",
            axis: "depth of the origin below the surface / radius",
            places: &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 0.5, 1.0],
            failure: "a miss, or a point off the sphere by more than the rounding bound",
            error: Some("distance of the point and the sphere / radius"),
            bound: |_| Bound::error(8.0 * EPSILON),
            ..common(from_inside)
        },
        TestCase {
            name: "spheres-lengths",
            title: "Directions that are not of unit length, 100 radii away",
            axis: "length of the direction",
            places: &[1e-15, 1e-6, 0.5, 0.999, 0.99999, 1.0, 1.00001, 1.001, 1e6, 1e15],
            error: Some("|Δt| · length / radius"),
            // The default assumes unit length, which the renderer maintains.
            bound: |length| if length == 1.0 { Bound::error(4.0 * EPSILON * 101.0) } else { Bound::NONE },
            ..common(|rng, length, counts, intersect| misjudged(counts, rng, UNIT, 100.0, length, intersect))
        },
    ]
}

/// The unit sphere around the origin.
pub const UNIT: Ball = Ball { center: Vec3::ZERO, radius: 1.0 };

/// The nearest t in (0, `limit`) of one method.
pub(crate) type Intersect = fn(Ball, &Ray<f32>, f32) -> Option<f32>;

/// Returns the nearest t in (0, `limit`) by method `S`.
pub fn intersect<S: SphereMethod>(ball: Ball, ray: &Ray<f32>, limit: f32) -> Option<f32> {
    let center = math::Vec3::splat(ball.center);
    let (hit, t) = S::test(&S::precalculate(ray), center, ball.radius * ball.radius, limit);
    hit.then_some(t)
}

/// Returns the nearest t > 0 in f64, where cancellation stays below the resolution of f32.
pub fn reference_t(ball: Ball, ray: &Ray<f32>) -> Option<f64> {
    let (origin, direction) = to_f64(ray);
    hit_sphere(ball.center.as_dvec3(), f64::from(ball.radius), origin, direction)
}

/// Returns the distance of the point at t from the sphere, and its bound for a good kernel, 40 ε (|o − c| +
/// r): see `reference::verdict`.
pub fn off(ball: Ball, ray: &Ray<f32>, t: f32) -> (f64, f64) {
    let (origin, direction) = to_f64(ray);
    let (center, radius) = (ball.center.as_dvec3(), f64::from(ball.radius));
    let off = ((origin + direction * f64::from(t) - center).length() - radius).abs();
    (off, 40.0 * EPSILON * ((origin - center).length() + radius))
}

/// Returns a ray from this distance of a ball's centre, aimed uniformly at a disc of 1.2 times its radius
/// around it.
pub fn aimed(rng: &mut Rng, ball: Ball, distance: f64, length: f64) -> Ray<f32> {
    let (center, radius) = (ball.center.as_dvec3(), f64::from(ball.radius));
    let axis = rng.direction();
    let origin = (center + axis * distance).as_vec3();
    let (across, along) = axis.any_orthonormal_pair();
    let (r, phi) = (1.2 * radius * rng.unit().sqrt(), TAU * rng.unit());
    let target = center + across * (r * phi.cos()) + along * (r * phi.sin());
    ray(origin, ((target - origin.as_dvec3()).normalize() * length).as_vec3())
}

/// Returns a ray that passes the unit ball's centre at the distance `from_center`, from `distance` away.
pub fn passing(rng: &mut Rng, from_center: f64, distance: f64) -> Ray<f32> {
    let axis = rng.direction();
    let across = axis.any_orthonormal_vector();
    // Sine of the angle between ray and axis.
    let sin = from_center / distance;
    let direction = across * sin - axis * (1.0 - sin * sin).sqrt();
    ray((axis * distance).as_vec3(), direction.as_vec3())
}

/// Records one aimed ray: whether hit or miss is right, and the error of t in radii.
fn misjudged(
    counts: &mut FailureCounts,
    rng: &mut Rng,
    ball: Ball,
    distance: f64,
    length: f64,
    intersect: Intersect,
) {
    let ray = aimed(rng, ball, distance, length);
    match (intersect(ball, &ray, f32::INFINITY), reference_t(ball, &ray)) {
        (Some(t), Some(exact)) => {
            counts.record_error((f64::from(t) - exact).abs() * length / f64::from(ball.radius));
        }
        (t, exact) => counts.record(t.is_some() != exact.is_some()),
    }
}

/// Tries spheres around the origin and elsewhere, where o − c is rounded.
fn of_radius(rng: &mut Rng, radius: f64, counts: &mut FailureCounts, intersect: Intersect) {
    let place = [Vec3::ZERO, Vec3::new(0.3, -0.7, 0.6)][rng.index(2)];
    let ball = Ball { center: place * radius as f32, radius: radius as f32 };
    misjudged(counts, rng, ball, 100.0 * radius, 1.0, intersect);
}

/// Tries downward rays in all directions; those near the horizon miss a small sphere.
fn from_close_by(rng: &mut Rng, radius: f64, counts: &mut FailureCounts, intersect: Intersect) {
    let ball = Ball { center: Vec3::ZERO, radius: radius as f32 };
    let up = rng.direction();
    let direction = rng.direction();
    let ray = ray((up * (radius + 1.0)).as_vec3(), (direction * -direction.dot(up).signum()).as_vec3());
    if let Some(exact) = reference_t(ball, &ray) {
        let error = intersect(ball, &ray, f32::INFINITY).map(|t| (f64::from(t) / exact - 1.0).abs());
        counts.record_error(error.filter(|&error| error <= 0.5).unwrap_or(FAILED));
    }
}

/// Tries rays of which half pass the silhouette inside and half outside, by `off` · ε · distance.
fn tangent(rng: &mut Rng, off: f64, counts: &mut FailureCounts, intersect: Intersect) {
    let distance = rng.scale(1.5, 1e3);
    let margin = off * EPSILON * distance;
    let from_center = [1.0 - margin, 1.0 + margin][rng.index(2)];
    let ray = passing(rng, from_center, distance);
    // Near the silhouette, the rounding of the direction decides.
    let hits = reference_t(UNIT, &ray).is_some();
    counts.record(intersect(UNIT, &ray, f32::INFINITY).is_some() != hits);
}

/// Tests that the point of the hit is on the sphere.
fn from_inside(rng: &mut Rng, depth: f64, counts: &mut FailureCounts, intersect: Intersect) {
    let radius = rng.scale(1e-6, 1e6) as f32;
    let ball = Ball { center: rng.in_cube().as_vec3() * radius, radius };
    let inside = rng.direction() * ((1.0 - depth) * f64::from(radius));
    let ray = ray((ball.center.as_dvec3() + inside).as_vec3(), rng.direction().as_vec3());
    match intersect(ball, &ray, f32::INFINITY).map(|t| off(ball, &ray, t)) {
        Some((off, allowed)) if off <= allowed => counts.record_error(off / f64::from(radius)),
        _ => counts.record(true),
    }
}
