//! Self-intersection on spheres, on both sides; and the opposite failure: with too large an offset, a ray
//! that leaves one of two close shells misses the other.
//!
//! Source: Wächter, Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems ch.
//! 6, 2019.

use super::rays::{ray, to_f64, towards};
use super::rng::Rng;
use super::spawn::{ARRIVING, SpawnMethod, common, spawned};
use super::spheres::{Ball, intersect};
use super::test_case::{Bound, FailureCounts, TestCase};
use crate::math::Ray;
use crate::methods::Robust;
use glam::Vec3;

pub(super) fn test_cases() -> Vec<TestCase> {
    vec![
        TestCase {
            name: "spawn-spheres",
            title: "Rays spawned outwards on spheres of radius 1",
            axis: "distance of the centre from the origin",
            places: &[0.0, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4],
            ..common(|rng, x, counts, method| leave_spheres(rng, x, counts, Side::Outside, method))
        },
        TestCase {
            name: "spawn-inwards",
            title: "Rays spawned inwards on spheres of radius 1",
            axis: "distance of the centre from the origin",
            places: &[0.0, 0.1, 1.0, 10.0, 100.0, 1e3, 1e4],
            failure: "the ray misses the far side, or hits the near one",
            ..common(|rng, x, counts, method| leave_spheres(rng, x, counts, Side::Inside, method))
        },
        TestCase {
            name: "spawn-shells",
            title: "Rays spawned on one of two concentric shells of radius 1, some distance from the origin, towards the other",
            axis: "gap between the shells",
            places: &[1e-6, 3e-6, 1e-5, 3e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2],
            failure: "the ray misses the other shell, or hits its own",
            inputs: 50_000,
            // 1e-5 is two offsets of shells at this distance from the origin.
            bound: |gap| if gap > 1e-5 { Bound::NO_FAILURE } else { Bound::NONE },
            ..common(between_shells)
        },
    ]
}

/// The side to which rays leave a sphere.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Side {
    /// Along the outward normal.
    Outside,
    /// Against the outward normal.
    Inside,
}

/// Counts rays that leave a sphere and hit it again, or, inwards, miss its far side. They arrive from `near`
/// to `far` radii above the surface, one in three from inside.
pub fn leave_sphere(
    counts: &mut FailureCounts,
    rng: &mut Rng,
    ball: Ball,
    [near, far]: [f64; 2],
    side: Side,
    method: SpawnMethod,
) {
    let radius = f64::from(ball.radius);
    let distance = radius * rng.scale(near, far);
    let away = if rng.index(3) == 0 { radius * 0.9 * rng.unit() } else { radius + distance };
    let from = (ball.center.as_dvec3() + rng.direction() * away).as_vec3();
    let arriving = towards(from, ball.center.as_dvec3() + rng.in_cube() * radius);
    let Some((start, n)) = spawn(ball, &arriving, side, method) else { return };
    let next = ray(start, spawned(rng, n));
    let again = intersect::<Robust>(ball, &next, f32::INFINITY).filter(|&t| t > method.t_min);
    counts.record(match side {
        Side::Outside => again.is_some(),
        Side::Inside => !far_side(ball, &next, again),
    });
}

/// Returns the origin of a ray that leaves a sphere where `arriving` hits it, and the unit normal on its
/// side.
fn spawn(ball: Ball, arriving: &Ray<f32>, side: Side, method: SpawnMethod) -> Option<(Vec3, Vec3)> {
    let along = arriving.at(intersect::<Robust>(ball, arriving, f32::INFINITY)?);
    let (exact, normal) = ball.surface(along);
    let n = if side == Side::Outside { normal } else { -normal }.get(0);
    Some((method.start(exact.get(0), along.get(0), n, ball.offset()), n))
}

/// Tests whether the hit lies beyond the middle of the ray's chord, computed from its actual origin.
fn far_side(ball: Ball, ray: &Ray<f32>, found: Option<f32>) -> bool {
    let (origin, d) = to_f64(ray);
    let f = origin - ball.center.as_dvec3();
    let (b, c) = (-f.dot(d), f.length_squared() - f64::from(ball.radius).powi(2));
    let chord = b + (b * b - d.length_squared() * c).sqrt();
    found.is_some_and(|t| f64::from(t) > 0.5 * chord)
}

fn leave_spheres(rng: &mut Rng, place: f64, counts: &mut FailureCounts, side: Side, method: SpawnMethod) {
    let ball = Ball { center: (rng.direction() * place).as_vec3(), radius: 1.0 };
    leave_sphere(counts, rng, ball, ARRIVING, side, method);
}

/// Counts rays that leave one of two concentric shells towards the other, with a cosine of at least 0.2, and
/// do not hit it next. The outer shell has the radius 1. `Side::Inside` leaves the outer shell inwards,
/// `Side::Outside` the inner one outwards.
pub fn leave_shell(
    counts: &mut FailureCounts,
    rng: &mut Rng,
    center: Vec3,
    gap: f64,
    side: Side,
    method: SpawnMethod,
) {
    let outer = Ball { center, radius: 1.0 };
    let inner = Ball { center, radius: (1.0 - gap) as f32 };
    let (own, other) = if side == Side::Inside { (outer, inner) } else { (inner, outer) };
    // An arriving ray gives the point, so that its rounding is part of the method under test.
    let normal = rng.direction();
    let from = if side == Side::Inside { 0.3 } else { 3.0 };
    let center = center.as_dvec3();
    let arriving = towards((center + normal * from).as_vec3(), center + normal * f64::from(own.radius));
    let Some((start, n)) = spawn(own, &arriving, side, method) else { return counts.record(true) };
    let direction = loop {
        let direction = rng.direction().as_vec3();
        // Inwards, a ray with this cosine meets the inner shell while the gap is small.
        if direction.dot(n) > 0.2 {
            break direction;
        }
    };
    let next = ray(start, direction);
    let hit = |ball| {
        let t = intersect::<Robust>(ball, &next, f32::INFINITY).filter(|&t| t > method.t_min);
        t.unwrap_or(f32::INFINITY)
    };
    let (own, other) = (hit(own), hit(other));
    counts.record(!(other < own && f64::from(other) < 6.0 * gap));
}

fn between_shells(rng: &mut Rng, gap: f64, counts: &mut FailureCounts, method: SpawnMethod) {
    let center = rng.direction().as_vec3() * 3.0;
    let side = [Side::Inside, Side::Outside][rng.index(2)];
    leave_shell(counts, rng, center, gap, side, method);
}
