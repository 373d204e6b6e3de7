//! Single triangles: slivers, sizes, distances, grazing rays.
//!
//! Source: Woop, Benthin, Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013.

use super::aim::{exactly, ray, towards};
use super::methods::triangle_methods;
use super::{Bound, Dice, EPSILON, Recipe, Tally};
use crate::kernel::ray_triangle::{TriangleHit, TriangleMethod};
use crate::math::Ray;
use glam::{DVec3, Vec3};

pub(super) const WOOP: &str = "Woop, Benthin, Wald, Watertight Ray/Triangle Intersection, JCGT 2(1), 2013";
const MISS: &str = "a ray that passes inside the triangle misses it";
pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "triangles-slivers",
        title: "Slivers seen from twice their length",
        axis: "longest edge / height",
        places: &[1.0, 10.0, 100.0, 1e3, 1e4, 1e5, 1e6],
        failure: MISS,
        error: Some("|Δt| / t"),
        source: WOOP,
        cases: 100_000,
        methods: &triangle_methods!(slivers),
        // A ray that passes within the rounding of an edge is undecided, and a sliver is little else.
        bound: |aspect| Bound {
            failures: 4.0 * EPSILON * aspect,
            p99: Some(EPSILON * (24.0 + aspect / 6.0)),
        },
    },
    Recipe {
        name: "triangles-scale",
        title: "Well-shaped triangles of all sizes",
        axis: "longest edge",
        places: &[1e-15, 1e-12, 1e-8, 1e-4, 1.0, 1e4, 1e8, 1e12, 1e15],
        failure: "hit or miss misjudged, further from an edge than rounding reaches",
        error: Some("|Δt| / (t + edge)"),
        source: WOOP,
        cases: 100_000,
        methods: &triangle_methods!(of_size),
        bound: |size| if (1e-12..=1e12).contains(&size) { Bound::error(10.0 * EPSILON) } else { Bound::NONE },
    },
    Recipe {
        name: "triangles-far",
        title: "Triangles seen from far away",
        axis: "distance / edge",
        places: &[1.0, 10.0, 100.0, 1e3, 1e4, 1e5],
        failure: MISS,
        error: Some("|Δt| / t"),
        source: WOOP,
        cases: 100_000,
        methods: &triangle_methods!(from_far),
        bound: |d| Bound { failures: 4.0 * EPSILON * d, p99: Some(10.0 * EPSILON) },
    },
    Recipe {
        name: "triangles-grazing",
        title: "Rays that graze a triangle, from three times its size",
        axis: "cosine of the ray and the triangle's normal",
        places: &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0],
        failure: MISS,
        error: Some("distance of the point and the plane / edge"),
        source: WOOP,
        cases: 100_000,
        methods: &triangle_methods!(grazing),
        bound: |cos| Bound { failures: 4.0 * EPSILON / cos, p99: Some(10.0 * EPSILON) },
    },
];

/// The point of these weights.
pub fn mean(points: [DVec3; 3], weights: [f64; 3]) -> DVec3 {
    points[0] * weights[0] + points[1] * weights[1] + points[2] * weights[2]
}

/// The judge: t, u and v in f64 by Cramer's rule, whether or not the ray passes inside; not finite for a ray in the triangle's plane.
pub fn truth(triangle: [Vec3; 3], ray: &Ray<f32>) -> [f64; 3] {
    let (o, d) = exactly(ray);
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

/// t, u and v, as the method says.
pub fn answer<T: TriangleMethod>(triangle: [Vec3; 3], ray: &Ray<f32>, limit: f32) -> Option<[f32; 3]> {
    let TriangleHit { mask, t, u, v } = T::test(&T::prepare(ray), &T::store(triangle), limit);
    mask.then_some([t, u, v])
}

/// Counts a ray that truly passes inside: is it missed, and else, how far is t off in the unit that `unit` makes of the true one?
fn inside<T: TriangleMethod>(
    tally: &mut Tally,
    triangle: [Vec3; 3],
    ray: &Ray<f32>,
    unit: impl Fn(f64) -> f64,
) {
    let [exact, u, v] = truth(triangle, ray);
    // Rounding of the ray may put it outside, and of the vertices may leave no area.
    let margin = u.min(v).min(1.0 - u - v);
    if margin > 0.0 && exact > 0.0 {
        match answer::<T>(triangle, ray, f32::INFINITY) {
            Some([t, ..]) => tally.off_by((f64::from(t) - exact).abs() / unit(exact)),
            None => tally.count(true),
        }
    }
}

/// A triangle with a longest edge of 1, or nearly, and a height of 1 / `aspect`, and a ray from the distance 2 through it.
pub fn sliver(dice: &mut Dice, aspect: f64) -> ([Vec3; 3], Ray<f32>) {
    let along = dice.direction();
    let across = along.any_orthonormal_vector();
    let a = dice.in_cube();
    let triangle = [a, a + along, a + along * dice.unit() + across / aspect].map(|v| v.as_vec3());
    let target = mean(triangle.map(|v| v.as_dvec3()), dice.barycentrics());
    let origin = (target + dice.direction() * 2.0).as_vec3();
    (triangle, towards(origin, target))
}

fn slivers<T: TriangleMethod>(dice: &mut Dice, aspect: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let (triangle, ray) = sliver(dice, aspect);
        inside::<T>(&mut tally, triangle, &ray, |t| t);
    }
    tally
}

/// A triangle of edges about 1 around `center`, all heights above 0.3, its normal, and a direction at most 70° from it.
fn shape(dice: &mut Dice, center: DVec3) -> ([DVec3; 3], DVec3) {
    loop {
        let [a, b, c] = [(); 3].map(|()| center + dice.in_cube());
        let normal = (b - a).cross(c - a);
        let longest = (b - a).length().max((c - b).length()).max((a - c).length());
        if normal.length() / longest >= 0.3 {
            return ([a, b, c], normal.normalize());
        }
    }
}

/// Such a triangle `size` times as large, and a ray from the distance `distance` towards a point of its plane, near it.
pub fn well_shaped(dice: &mut Dice, center: DVec3, distance: f64, size: f64) -> ([Vec3; 3], Ray<f32>) {
    let (corners, normal) = shape(dice, center);
    let direction = loop {
        let direction = dice.direction();
        if direction.dot(normal).abs() >= 0.35 {
            break direction;
        }
    };
    let triangle = corners.map(|corner| (corner * size).as_vec3());
    let [a, b, c] = triangle.map(|corner| corner.as_dvec3());
    let [u, v] = [0, 1].map(|_| 2.0 * dice.unit() - 0.5);
    let target = a + (b - a) * u + (c - a) * v;
    (triangle, towards((target - direction * (distance * size)).as_vec3(), target))
}

fn of_size<T: TriangleMethod>(dice: &mut Dice, size: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let (triangle, ray) = well_shaped(dice, DVec3::ZERO, 3.0, size);
        let [exact, u, v] = truth(triangle, &ray);
        let margin = u.min(v).min(1.0 - u - v);
        // Some ten roundings, which heights above 0.3 and angles below 70° magnify.
        if margin.abs() > 100.0 * EPSILON {
            match answer::<T>(triangle, &ray, f32::INFINITY) {
                Some([t, ..]) if margin > 0.0 => tally.off_by((f64::from(t) - exact).abs() / (exact + size)),
                found => tally.count(found.is_some() == (margin < 0.0)),
            }
        }
    }
    tally
}

/// A triangle, its normal, and a point of it.
fn with_target(dice: &mut Dice) -> ([Vec3; 3], DVec3, DVec3) {
    let (corners, normal) = shape(dice, DVec3::ZERO);
    let triangle = corners.map(|corner| corner.as_vec3());
    let target = mean(triangle.map(|corner| corner.as_dvec3()), dice.barycentrics());
    (triangle, normal, target)
}

fn from_far<T: TriangleMethod>(dice: &mut Dice, distance: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let (triangle, normal, target) = with_target(dice);
        let direction = dice.direction();
        if direction.dot(normal).abs() >= 0.35 {
            let ray = towards((target - direction * distance).as_vec3(), target);
            inside::<T>(&mut tally, triangle, &ray, |t| t);
        }
    }
    tally
}

fn grazing<T: TriangleMethod>(dice: &mut Dice, cos: f64, cases: usize) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let (triangle, normal, target) = with_target(dice);
        let along = normal.cross(dice.direction()).normalize_or(normal.any_orthonormal_vector());
        let direction = along * (1.0 - cos * cos).max(0.0).sqrt() + normal * cos;
        let ray = ray((target - direction * 3.0).as_vec3(), direction.as_vec3());
        inside::<T>(&mut tally, triangle, &ray, |_| 1.0 / cos);
    }
    tally
}
