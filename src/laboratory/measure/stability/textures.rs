//! Where on a picture: poles and seam of a sphere, coordinates far from the picture's first repeat.

use super::aim::towards;
use super::spheres::Ball;
use super::{Bound, Dice, EPSILON, Method, Recipe, Tally};
use crate::kernel::ray_sphere::{Robust, SphereMethod};
use crate::kernel::surface::{latitude_longitude, remove_shared_repeats, sphere_normal};
use crate::kernel::texture::Grid;
use crate::math::Vec3;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "textures-poles",
        title: "Latitude near the poles of a sphere",
        axis: "distance from the pole / radius, at most",
        places: &[1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0],
        failure: "latitude is no number",
        error: Some("|Δ latitude| in radians"),
        source: "numerics of the arccosine, whose slope at 1 is infinite",
        cases: 100_000,
        methods: &[
            Method::other("acos", |dice, x, cases| {
                poles(dice, x, cases, |point, ball| across(point, ball).acos())
            }),
            Method::other("acos-clamped", |dice, x, cases| {
                poles(dice, x, cases, |point, ball| across(point, ball).clamp(-1.0, 1.0).acos())
            }),
            Method::default("atan2", |dice, x, cases| {
                poles(dice, x, cases, |point, ball| {
                    let normal = sphere_normal(point, Vec3::splat(ball.center));
                    latitude_longitude(normal).1 * std::f32::consts::PI
                })
            }),
        ],
        // 3e-7 of a half turn: `kernel::surface::latitude_longitude`.
        bound: |_| Bound::error(3e-7 * PI),
    },
    Recipe {
        name: "textures-seam",
        title: "Columns of a texture of 1,024 at the seam of a sphere",
        axis: "turns from the seam",
        places: &[1e-12, 1e-10, 1e-9, 3e-9, 1e-8, 3e-8, 1e-7, 1e-6, 1e-4, 1e-2],
        failure: "column outside of the picture, or another than the point's",
        error: None,
        source: "−x + 1 rounds to 1 for x below ε / 2",
        cases: 20_000,
        methods: &[
            Method::other("plus-one", |dice, x, cases| {
                seam(dice, x, cases, |u| whole(if u < 0.0 { u + 1.0 } else { u } * COLUMNS))
            }),
            Method::other("minus-floor", |dice, x, cases| {
                seam(dice, x, cases, |u| whole((u - u.floor()) * COLUMNS))
            }),
            Method::default("below-one", |dice, x, cases| {
                seam(dice, x, cases, |u| i64::from(nearest(u, COLUMNS)))
            }),
        ],
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "textures-far",
        title: "Columns of textures, far from their first repeat",
        axis: "|u| in repeats",
        places: &[1.0, 10.0, 1e3, 1e5, 1e6, 8e6, 1e7, 1e9, 1e12, 1e18, 1e38],
        failure: "column outside of the picture, or another than the point's",
        error: None,
        source: "products and conversions that leave 24 or 31 bits",
        cases: 20_000,
        methods: &[
            // What a cast to int does, but for what is undefined in C.
            Method::other("integer", |dice, x, cases| {
                far(dice, x, cases, |u, columns| i64::from((u * columns) as i32).rem_euclid(columns as i64))
            }),
            Method::other("remainder", |dice, x, cases| {
                far(dice, x, cases, |u, columns| whole((u * columns) % columns))
            }),
            Method::default("fraction-first", |dice, x, cases| {
                far(dice, x, cases, |u, columns| i64::from(nearest(u, columns)))
            }),
        ],
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "textures-tiled",
        title: "Coordinates between the corners of a triangle, far from their first repeat",
        axis: "|u| in repeats",
        places: &[1.0, 10.0, 1e3, 1e5, 1e6, 1e7, 1e9, 1e18],
        failure: "coordinate is no number",
        error: Some("|Δu| in repeats"),
        source: "rounding of a + (b − a) u + (c − a) v, relative to a",
        cases: 50_000,
        methods: &[
            Method::other("as-written", |dice, x, cases| tiled(dice, x, cases, |corners| corners)),
            Method::default("repeats-taken-away", |dice, x, cases| {
                tiled(dice, x, cases, |corners| remove_shared_repeats(corners.map(f64::from)))
            }),
        ],
        // Corners are at most two repeats apart, or two steps of single precision.
        bound: |u| Bound::error(6.0 * EPSILON * (2.0_f64).max(4.0 * EPSILON * u)),
    },
];

/// The cosine of the latitude as schools have it.
fn across(point: Vec3<f32>, ball: Ball) -> f32 {
    (point.y - ball.center.y) / ball.radius
}

/// Points as rays find them, from about five radii away.
fn poles(dice: &mut Dice, most: f64, cases: usize, latitude: fn(Vec3<f32>, Ball) -> f32) -> Tally {
    let mut tally = Tally::default();
    while tally.tested < cases {
        let ball = Ball { center: dice.in_cube().as_vec3(), radius: dice.scale(0.1, 10.0) as f32 };
        let (off, phi) = (most * dice.unit().sqrt(), TAU * dice.unit());
        let side = dice.signed().signum();
        let normal = DVec3::new(off * phi.cos(), side * (1.0 - off * off).sqrt(), off * phi.sin());
        let (center, radius) = (ball.center.as_dvec3(), f64::from(ball.radius));
        let origin = (center + (normal * 2.0 + dice.direction()) * (2.0 * radius)).as_vec3();
        let ray = towards(origin, center + normal * radius);
        let (hit, t) = Robust::test::<f32>(
            &Robust::prepare(&ray),
            Vec3::splat(ball.center),
            ball.radius * ball.radius,
            f32::INFINITY,
        );
        if !hit {
            continue;
        }
        let point = ray.at(t);
        let n = point.get(0).as_dvec3() - center;
        let truth = n.x.hypot(n.z).atan2(n.y);
        match f64::from(latitude(point, ball)) {
            latitude if latitude.is_nan() => tally.count(true),
            latitude => tally.off_by((latitude - truth).abs()),
        }
    }
    tally
}

const COLUMNS: f32 = 1024.0;

/// Towards zero.
fn whole(x: f32) -> i64 {
    x as i64
}

/// The default's column.
fn nearest(u: f32, columns: f32) -> u32 {
    Grid { width: columns, height: 1.0, first: 0_u32 }.nearest(u, 0.0, false)
}

/// Does this column hold u, give or take a thousandth of it, in a picture that repeats?
fn holds(column: i64, u: f64, columns: f64) -> bool {
    let at = (u - u.floor()) * columns;
    let middle = column as f64 + 0.5;
    let apart = (at - middle).abs();
    (0..columns as i64).contains(&column) && apart.min(columns - apart) <= 0.5 + 1e-3
}

/// By turns on both sides of the seam.
fn seam(dice: &mut Dice, turns: f64, cases: usize, column: fn(f32) -> i64) -> Tally {
    let mut tally = Tally::default();
    for case in 0..cases {
        let angle = TAU * turns * [1.0, -1.0][case % 2];
        let y = 0.9 * dice.signed();
        let around = (1.0 - y * y).sqrt();
        let normal = DVec3::new(around * angle.cos(), y, around * angle.sin()).as_vec3();
        let (u, _) = latitude_longitude(Vec3::<f32>::splat(normal));
        let truth = f64::from(normal.z).atan2(f64::from(normal.x)) / TAU;
        tally.count(!holds(column(u), truth, f64::from(COLUMNS)));
    }
    tally
}

fn far(dice: &mut Dice, u: f64, cases: usize, column: fn(f32, f32) -> i64) -> Tally {
    let mut tally = Tally::default();
    for _ in 0..cases {
        let u = (u * (1.0 + dice.unit()) * dice.signed().signum()) as f32;
        let columns = (1 + dice.index(4096)) as f32;
        tally.count(!holds(column(u, columns), f64::from(u), f64::from(columns)));
    }
    tally
}

/// Corners within a repeat of each other.
fn tiled(dice: &mut Dice, u: f64, cases: usize, stored: fn([f32; 3]) -> [f32; 3]) -> Tally {
    let mut tally = Tally::default();
    for _ in 0..cases {
        let start = u * dice.signed().signum() * (1.0 + dice.unit());
        let corners = [(); 3].map(|()| (start + dice.unit()) as f32);
        let [_, q, r] = dice.barycentrics().map(|weight| weight as f32);
        let [a, b, c] = stored(corners);
        // As `integrate::surface` blends them.
        let blended = f64::from((b - a).mul_add(q, (c - a).mul_add(r, a)));
        let [a, b, c] = corners.map(f64::from);
        let truth = a + (b - a) * f64::from(q) + (c - a) * f64::from(r);
        let apart = (blended - truth).rem_euclid(1.0);
        match apart.min(1.0 - apart) {
            apart if apart.is_nan() => tally.count(true),
            apart => tally.off_by(apart),
        }
    }
    tally
}
