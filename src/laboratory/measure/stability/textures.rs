//! Texture coordinates: poles and seam of a sphere, coordinates far from the texture's first repeat.

use super::rays::towards;
use super::rng::Rng;
use super::spheres::{Ball, intersect};
use super::test_case::{Bound, EPSILON, FailureCounts, TestCase, compare};
use crate::kernel::surface::{latitude_longitude, remove_shared_repeats};
use crate::kernel::texture::Grid;
use crate::math::Vec3;
use crate::methods::Robust;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

pub(super) fn test_cases() -> Vec<TestCase> {
    vec![
        TestCase {
            name: "textures-poles",
            title: "Latitude near the poles of a sphere",
            axis: "distance from the pole / radius, at most",
            places: &[1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0],
            failure: "latitude is NaN",
            error: Some("|Δ latitude| in radians"),
            source: "numerics of the arccosine, whose slope at 1 is infinite",
            methods: compare(
                poles,
                &[
                    ("acos", |point, ball| cos_latitude(point, ball).acos()),
                    ("acos-clamped", |point, ball| cos_latitude(point, ball).clamp(-1.0, 1.0).acos()),
                    ("arcsine", |point, ball| {
                        latitude_longitude(ball.surface(point).1).1 * std::f32::consts::PI
                    }),
                ],
            ),
            // 3e-7 of a half turn: see `kernel::surface::latitude_longitude`.
            bound: |_| Bound::error(3e-7 * PI),
            ..TestCase::COMMON
        },
        TestCase {
            name: "textures-seam",
            title: "Columns of a texture of 1,024 at the seam of a sphere",
            axis: "turns from the seam",
            places: &[1e-12, 1e-10, 1e-9, 3e-9, 1e-8, 3e-8, 1e-7, 1e-6, 1e-4, 1e-2],
            failure: "column outside the texture, or not the point's",
            source: "−x + 1 rounds to 1 for x below ε / 2",
            inputs: 20_000,
            methods: compare(
                seam,
                &[
                    ("plus-one", |u| (if u < 0.0 { u + 1.0 } else { u } * COLUMNS) as i64),
                    ("minus-floor", |u| ((u - u.floor()) * COLUMNS) as i64),
                    ("below-one", |u| nearest(u, COLUMNS)),
                ],
            ),
            ..TestCase::COMMON
        },
        TestCase {
            name: "textures-far",
            title: "Columns of textures, far from their first repeat",
            axis: "|u| in repeats",
            places: &[1.0, 10.0, 1e3, 1e5, 1e6, 8e6, 1e7, 1e9, 1e12, 1e18, 1e38],
            failure: "column outside the texture, or not the point's",
            source: "products and conversions beyond 24 or 31 bits",
            inputs: 20_000,
            methods: compare(
                far,
                &[
                    // A cast to int; out of range it saturates, which is undefined in C.
                    ("integer", |u, columns| i64::from((u * columns) as i32).rem_euclid(columns as i64)),
                    ("remainder", |u, columns| ((u * columns) % columns) as i64),
                    ("fraction-first", nearest),
                ],
            ),
            ..TestCase::COMMON
        },
        tiled_coordinates(),
    ]
}

/// Returns the test case of coordinates far from their first repeat.
fn tiled_coordinates() -> TestCase {
    TestCase {
        name: "textures-tiled",
        title: "Coordinates between the corners of a triangle, far from their first repeat",
        axis: "|u| in repeats",
        places: &[1.0, 10.0, 1e3, 1e5, 1e6, 1e7, 1e9, 1e18],
        failure: "coordinate is NaN",
        error: Some("|Δu| in repeats"),
        source: "rounding of a + (b − a) u + (c − a) v, relative to a",
        inputs: 50_000,
        methods: compare(
            tiled,
            &[
                ("as-written", |corners| corners),
                ("repeats-taken-away", |corners| remove_shared_repeats(corners.map(f64::from))),
            ],
        ),
        // Corners are at most two repeats apart, or two steps of single precision.
        bound: |u| Bound::error(6.0 * EPSILON * (2.0_f64).max(4.0 * EPSILON * u)),
    }
}

/// Returns the textbook cosine of the latitude.
fn cos_latitude(point: Vec3<f32>, ball: Ball) -> f32 {
    (point.y - ball.center.y) / ball.radius
}

/// Tries hit points of rays from about five radii away.
fn poles(rng: &mut Rng, most: f64, counts: &mut FailureCounts, latitude: fn(Vec3<f32>, Ball) -> f32) {
    let ball = Ball { center: rng.in_cube().as_vec3(), radius: rng.scale(0.1, 10.0) as f32 };
    let (off, phi) = (most * rng.unit().sqrt(), TAU * rng.unit());
    let side = rng.signed().signum();
    let normal = DVec3::new(off * phi.cos(), side * (1.0 - off * off).sqrt(), off * phi.sin());
    let (center, radius) = (ball.center.as_dvec3(), f64::from(ball.radius));
    let origin = (center + (normal * 2.0 + rng.direction()) * (2.0 * radius)).as_vec3();
    let ray = towards(origin, center + normal * radius);
    let Some(t) = intersect::<Robust>(ball, &ray, f32::INFINITY) else { return };
    let point = ray.at(t);
    let n = point.get(0).as_dvec3() - center;
    let expected = n.x.hypot(n.z).atan2(n.y);
    counts.record_error((f64::from(latitude(point, ball)) - expected).abs());
}

const COLUMNS: f32 = 1024.0;

/// Returns the default's column.
fn nearest(u: f32, columns: f32) -> i64 {
    i64::from(Grid { width: columns, height: 1.0, first: 0_u32 }.nearest(u, 0.0, false))
}

/// Tests whether this column of a repeating texture contains u, with a tolerance of a thousandth of a column.
fn holds(column: i64, u: f64, columns: f64) -> bool {
    let at = (u - u.floor()) * columns;
    let middle = column as f64 + 0.5;
    let apart = (at - middle).abs();
    (0..columns as i64).contains(&column) && apart.min(columns - apart) <= 0.5 + 1e-3
}

/// Tries points on both sides of the seam.
fn seam(rng: &mut Rng, turns: f64, counts: &mut FailureCounts, column: fn(f32) -> i64) {
    let angle = TAU * turns * [1.0, -1.0][rng.index(2)];
    let y = 0.9 * rng.signed();
    let around = (1.0 - y * y).sqrt();
    let normal = DVec3::new(around * angle.cos(), y, around * angle.sin()).as_vec3();
    let (u, _) = latitude_longitude(Vec3::<f32>::splat(normal));
    let expected = f64::from(normal.z).atan2(f64::from(normal.x)) / TAU;
    counts.record(!holds(column(u), expected, f64::from(COLUMNS)));
}

fn far(rng: &mut Rng, u: f64, counts: &mut FailureCounts, column: fn(f32, f32) -> i64) {
    let u = (u * (1.0 + rng.unit()) * rng.signed().signum()) as f32;
    let columns = (1 + rng.index(4096)) as f32;
    counts.record(!holds(column(u, columns), f64::from(u), f64::from(columns)));
}

/// Corners within a repeat of each other.
fn tiled(rng: &mut Rng, u: f64, counts: &mut FailureCounts, stored: fn([f32; 3]) -> [f32; 3]) {
    let start = u * rng.signed().signum() * (1.0 + rng.unit());
    let corners = [(); 3].map(|()| (start + rng.unit()) as f32);
    let [_, q, r] = rng.barycentrics().map(|weight| weight as f32);
    let [a, b, c] = stored(corners);
    // The interpolation of `integrate::surface`.
    let blended = f64::from((b - a).mul_add(q, (c - a).mul_add(r, a)));
    let [a, b, c] = corners.map(f64::from);
    let expected = a + (b - a) * f64::from(q) + (c - a) * f64::from(r);
    let apart = (blended - expected).rem_euclid(1.0);
    counts.record_error(if apart > 0.5 { 1.0 - apart } else { apart });
}
