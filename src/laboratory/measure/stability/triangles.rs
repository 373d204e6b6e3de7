//! Single triangles: slivers, sizes, distances, grazing rays.
//!
//! Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.

use super::methods::all_methods;
use super::rays::{ray, to_f64, towards};
use super::rng::Rng;
use super::test_case::{Bound, Case, EPSILON, FAILED, FailureCounts, TestCase, trials};
use crate::kernel::ray_triangle::TriangleHit;
use crate::math::Ray;
use crate::methods::TriangleMethod;
use glam::{DVec3, Vec3};

pub(super) const WOOP: &str = "Woop, Benthin, Wald, Watertight Ray/Triangle Intersection, JCGT 2(1), 2013";
pub(super) fn test_cases() -> Vec<TestCase> {
    let common = |case: Case<Intersect>| TestCase {
        failure: "a ray through the triangle misses it",
        error: Some("|Δt| / t"),
        source: WOOP,
        methods: trials(case, &all_methods!(triangle, intersect)),
        ..TestCase::COMMON
    };
    vec![
        TestCase {
            name: "triangles-slivers",
            title: "Slivers seen from twice their length",
            axis: "longest edge / height",
            places: &[1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6],
            // Rounding decides rays within the rounding error of an edge, which is most of a sliver.
            bound: |aspect| Bound {
                failures: 4.0 * EPSILON * aspect,
                p99: Some(EPSILON * (24.0 + aspect / 6.0)),
            },
            ..common(slivers)
        },
        TestCase {
            name: "triangles-scale",
            title: "Well-shaped triangles of all sizes",
            axis: "longest edge",
            places: &[1e-15, 1e-12, 1e-8, 1e-4, 1.0, 1e4, 1e8, 1e12, 1e15],
            failure: "hit or miss misjudged, farther from an edge than rounding reaches",
            error: Some("|Δt| / (t + edge)"),
            bound: |size| {
                if (1e-12..=1e12).contains(&size) { Bound::error(10.0 * EPSILON) } else { Bound::NONE }
            },
            ..common(of_size)
        },
        TestCase {
            name: "triangles-far",
            title: "Triangles seen from far away",
            axis: "distance / edge",
            places: &[1.0, 10.0, 100.0, 1e3, 1e4, 1e5],
            bound: |d| Bound { failures: 4.0 * EPSILON * d, p99: Some(10.0 * EPSILON) },
            ..common(from_far)
        },
        TestCase {
            name: "triangles-grazing",
            title: "Rays that graze a triangle, from three times its size",
            axis: "cosine of the ray and the triangle's normal",
            places: &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0],
            error: Some("distance of the point and the plane / edge"),
            bound: |cos| Bound { failures: 4.0 * EPSILON / cos, p99: Some(10.0 * EPSILON) },
            ..common(grazing)
        },
    ]
}

/// Returns the point of these weights.
pub(crate) fn mean(points: [DVec3; 3], weights: [f64; 3]) -> DVec3 {
    points[0] * weights[0] + points[1] * weights[1] + points[2] * weights[2]
}

/// Returns t, u and v in f64 by Cramer's rule, also for rays that pass outside; not finite for a ray in the
/// triangle's plane.
pub fn reference_tuv(triangle: [Vec3; 3], ray: &Ray<f32>) -> [f64; 3] {
    let (o, d) = to_f64(ray);
    let [a, b, c] = triangle.map(|vertex| vertex.as_dvec3());
    let (ab, ac, ao) = (b - a, c - a, o - a);
    // a + u·ab + v·ac = o + t·d
    let determinant = ab.cross(ac).dot(-d);
    [
        ab.cross(ac).dot(ao) / determinant,
        ao.cross(ac).dot(-d) / determinant,
        ab.cross(ao).dot(-d) / determinant,
    ]
}

/// t, u and v by one method.
pub(crate) type Intersect = fn([Vec3; 3], &Ray<f32>, f32) -> Option<[f32; 3]>;

/// Returns t, u and v by method `T`.
pub fn intersect<T: TriangleMethod>(triangle: [Vec3; 3], ray: &Ray<f32>, limit: f32) -> Option<[f32; 3]> {
    let TriangleHit { mask, t, u, v } = T::test(&T::precalculate(ray), &T::store(triangle), limit);
    mask.then_some([t, u, v])
}

/// Records a ray if it passes inside the triangle: a miss is a failure; otherwise the error of t over
/// `unit(exact t)`.
fn inside(
    counts: &mut FailureCounts,
    triangle: [Vec3; 3],
    ray: &Ray<f32>,
    unit: &dyn Fn(f64) -> f64,
    intersect: Intersect,
) {
    let [exact, u, v] = reference_tuv(triangle, ray);
    // Rounding may move the ray outside, or leave the triangle without area.
    let margin = u.min(v).min(1.0 - u - v);
    if margin > 0.0 && exact > 0.0 {
        let error = |[t, ..]: [f32; 3]| (f64::from(t) - exact).abs() / unit(exact);
        counts.record_error(intersect(triangle, ray, f32::INFINITY).map_or(FAILED, error));
    }
}

/// Returns a triangle with a longest edge of 1, or nearly, and a height of 1 / `aspect`, and a ray from the
/// distance 2 through it.
pub(crate) fn sliver(rng: &mut Rng, aspect: f64) -> ([Vec3; 3], Ray<f32>) {
    let along = rng.direction();
    let across = along.any_orthonormal_vector();
    let a = rng.in_cube();
    let triangle = [a, a + along, a + along * rng.unit() + across / aspect].map(|v| v.as_vec3());
    let target = mean(triangle.map(|v| v.as_dvec3()), rng.barycentrics());
    let origin = (target + rng.direction() * 2.0).as_vec3();
    (triangle, towards(origin, target))
}

fn slivers(rng: &mut Rng, aspect: f64, counts: &mut FailureCounts, intersect: Intersect) {
    let (triangle, ray) = sliver(rng, aspect);
    inside(counts, triangle, &ray, &|t| t, intersect);
}

/// Returns a triangle of edges about 1 around `center`, all heights above 0.3, its normal, and a direction at
/// most 70° from it.
fn shape(rng: &mut Rng, center: DVec3) -> ([DVec3; 3], DVec3) {
    loop {
        let [a, b, c] = [(); 3].map(|()| center + rng.in_cube());
        let normal = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        if normal.length() / longest >= 0.3 {
            return ([a, b, c], normal.normalize());
        }
    }
}

/// Returns a triangle of edges about `size` around `center` · `size`, without small angles, and a ray from
/// the distance `distance` · `size` towards a point of its plane, near it.
pub fn well_shaped(rng: &mut Rng, center: DVec3, distance: f64, size: f64) -> ([Vec3; 3], Ray<f32>) {
    let (corners, normal) = shape(rng, center);
    let direction = loop {
        let direction = rng.direction();
        if direction.dot(normal).abs() >= 0.35 {
            break direction;
        }
    };
    let triangle = corners.map(|corner| (corner * size).as_vec3());
    let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
    let [u, v] = [0, 1].map(|_| 2.0 * rng.unit() - 0.5);
    let target = a + (b - a) * u + (c - a) * v;
    (triangle, towards((target - direction * (distance * size)).as_vec3(), target))
}

fn of_size(rng: &mut Rng, size: f64, counts: &mut FailureCounts, intersect: Intersect) {
    let (triangle, ray) = well_shaped(rng, DVec3::ZERO, 3.0, size);
    let [exact, u, v] = reference_tuv(triangle, &ray);
    let margin = u.min(v).min(1.0 - u - v);
    // Some ten roundings, which heights above 0.3 and angles below 70° magnify.
    if margin.abs() > 100.0 * EPSILON {
        match intersect(triangle, &ray, f32::INFINITY) {
            Some([t, ..]) if margin > 0.0 => {
                counts.record_error((f64::from(t) - exact).abs() / (exact + size))
            }
            found => counts.record(found.is_some() == (margin < 0.0)),
        }
    }
}

/// Returns a triangle, its normal, and a point of it.
fn with_target(rng: &mut Rng) -> ([Vec3; 3], DVec3, DVec3) {
    let (corners, normal) = shape(rng, DVec3::ZERO);
    let triangle = corners.map(|corner| corner.as_vec3());
    let target = mean(triangle.map(|corner| corner.as_dvec3()), rng.barycentrics());
    (triangle, normal, target)
}

fn from_far(rng: &mut Rng, distance: f64, counts: &mut FailureCounts, intersect: Intersect) {
    let (triangle, normal, target) = with_target(rng);
    let direction = rng.direction();
    if direction.dot(normal).abs() >= 0.35 {
        let ray = towards((target - direction * distance).as_vec3(), target);
        inside(counts, triangle, &ray, &|t| t, intersect);
    }
}

fn grazing(rng: &mut Rng, cos: f64, counts: &mut FailureCounts, intersect: Intersect) {
    let (triangle, normal, target) = with_target(rng);
    let along = normal.cross(rng.direction()).normalize_or(normal.any_orthonormal_vector());
    let direction = along * (1.0 - cos * cos).max(0.0).sqrt() + normal * cos;
    let ray = ray((target - direction * 3.0).as_vec3(), direction.as_vec3());
    inside(counts, triangle, &ray, &|_| 1.0 / cos, intersect);
}
