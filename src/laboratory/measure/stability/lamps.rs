//! Lamps to look for: small, near, around the point that they light, seen edge-on.

use super::{Bound, Dice, EPSILON, Method, Recipe, Tally};
use crate::kernel::light::{self, LightSample};
use crate::lane::functions;
use crate::math::Vec3;
use crate::sampling::warp;
use glam::DVec3;
use std::f32::consts::TAU;
use std::f64::consts::PI;

pub const RECIPES: &[Recipe] = &[
    Recipe {
        name: "lamps-spheres",
        title: "Directions towards spheres, from far away to next to them",
        axis: "radius / distance of the centre",
        places: &[1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999, 0.99999],
        failure: "no density, or a direction past the lamp",
        error: Some("|Δ density| / density"),
        source: SHIRLEY,
        cases: 50_000,
        methods: &[
            Method::other("cosine", |dice, x, cases| sphere(dice, x, cases, cosine)),
            Method::other("taylor", |dice, x, cases| sphere(dice, x, cases, taylor)),
            Method::default("sine", |dice, x, cases| sphere(dice, x, cases, sine)),
        ],
        // Close by, the cosine of the rim, √(1 − sin²), magnifies the rounding of sin².
        bound: |ratio| Bound::error(8.0 * EPSILON / (1.0 - ratio * ratio).sqrt()),
    },
    Recipe {
        name: "lamps-around",
        title: "Points inside spheres that shine",
        axis: "distance from the centre / radius",
        places: &[0.0, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999, 0.99999],
        failure: "a density, though the lamp is in every direction, or none that is a number",
        error: None,
        source: SHIRLEY,
        cases: 50_000,
        methods: &[
            Method::other("cosine", |dice, x, cases| around(dice, x, cases, cosine)),
            Method::other("cosine-clamped", |dice, x, cases| around(dice, x, cases, cosine_clamped)),
            Method::default("sine-and-inside", |dice, x, cases| around(dice, x, cases, sine)),
        ],
        bound: |_| Bound::NO_FAILURE,
    },
    Recipe {
        name: "lamps-triangle",
        title: "Directions towards triangles that are small or far away",
        axis: "edge / distance",
        places: &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0],
        failure: "no density",
        error: Some("|Δ density| / density"),
        source: OOSTEROM,
        cases: 50_000,
        methods: &[
            Method::other("angles", |dice, x, cases| triangle(dice, cases, small(x), angles)),
            Method::other("determinant", |dice, x, cases| triangle(dice, cases, small(x), determinant)),
            Method::default("whole-or-area", |dice, x, cases| triangle(dice, cases, small(x), whole_or_area)),
        ],
        // Measured, not derived: 8 ε.
        bound: |_| Bound::error(16.0 * EPSILON),
    },
    Recipe {
        name: "lamps-edge-on",
        title: "Directions towards triangles seen nearly edge-on, about half as large as they are away",
        axis: "distance from the triangle's plane / distance",
        places: &[1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0],
        failure: "a density that is no number, or none",
        error: Some("|Δ density| / density"),
        source: OOSTEROM,
        cases: 50_000,
        methods: &[
            Method::other("angles", |dice, x, cases| triangle(dice, cases, edge_on(x), angles)),
            Method::other("determinant", |dice, x, cases| triangle(dice, cases, edge_on(x), determinant)),
            Method::default("whole-or-area", |dice, x, cases| {
                triangle(dice, cases, edge_on(x), whole_or_area)
            }),
        ],
        // The plane's own distance is rounded by some ε; closer to it, nothing is promised but numbers.
        bound: |height| {
            if height < 1e-5 { Bound::NONE } else { Bound::error(EPSILON * (16.0 + 8.0 / height)) }
        },
    },
];

const SHIRLEY: &str = "Shirley, Wang, Zimmerman, ACM TOG 15(1), 1996; Pharr et al., PBR 4ed §6.2.4";
const OOSTEROM: &str = "Van Oosterom, Strackee, IEEE TBME 30(2), 1983; Arvo, SIGGRAPH 1995";

/// A direction and its density, of a sphere at `center`, from two numbers.
type Drawn = (Vec3<f32>, f32);

/// Around the axis towards `center`.
fn cone(center: Vec3<f32>, sin: f32, cos: f32, v: f32) -> Vec3<f32> {
    let axis = center.normalize();
    let (tangent, bitangent) = warp::orthonormal_basis(axis);
    let (sin_around, cos_around) = functions::sin_cos_turns(v);
    tangent.mul_add(sin * cos_around, bitangent.mul_add(sin * sin_around, axis * cos))
}

/// The school's: from the cosine of the rim.
fn cosine(center: Vec3<f32>, radius: f32, u: f32, v: f32) -> Drawn {
    let rim = (1.0 - radius * radius / center.dot(center)).sqrt();
    let cos = 1.0 - u * (1.0 - rim);
    (cone(center, (1.0 - cos * cos).sqrt(), cos, v), 1.0 / (TAU * (1.0 - rim)))
}

/// The same with a cosine that is never NaN.
fn cosine_clamped(center: Vec3<f32>, radius: f32, u: f32, v: f32) -> Drawn {
    let rim = (1.0 - radius * radius / center.dot(center)).max(0.0).sqrt();
    let cos = 1.0 - u * (1.0 - rim);
    (cone(center, (1.0 - cos * cos).sqrt(), cos, v), 1.0 / (TAU * (1.0 - rim)))
}

/// The cosine, and below 1.5° the first term of its series.
fn taylor(center: Vec3<f32>, radius: f32, u: f32, v: f32) -> Drawn {
    let sin2 = radius * radius / center.dot(center);
    if sin2 >= 0.000_685_23 {
        return cosine(center, radius, u, v);
    }
    let drawn2 = sin2 * u;
    (cone(center, drawn2.sqrt(), (1.0 - drawn2).sqrt(), v), 1.0 / (TAU * 0.5 * sin2))
}

/// The renderer's.
fn sine(center: Vec3<f32>, radius: f32, u: f32, v: f32) -> Drawn {
    let LightSample { wi, pdf, .. } = light::sample_sphere(center, radius, u, v);
    (wi, pdf)
}

/// Two numbers in [0, 1).
fn numbers(dice: &mut Dice) -> (f32, f32) {
    ((dice.bits() >> 8) as f32 / 16_777_216.0, (dice.bits() >> 8) as f32 / 16_777_216.0)
}

/// A sphere of some size whose centre is so many radii away.
fn ball(dice: &mut Dice, distance: f64) -> (Vec3<f32>, f32) {
    let radius = dice.scale(1e-3, 1e3);
    (Vec3::splat((dice.direction() * (radius * distance)).as_vec3()), radius as f32)
}

fn sphere(dice: &mut Dice, ratio: f64, cases: usize, draw: fn(Vec3<f32>, f32, f32, f32) -> Drawn) -> Tally {
    let mut tally = Tally::default();
    for _ in 0..cases {
        let (center, radius) = ball(dice, 1.0 / ratio);
        let (u, v) = numbers(dice);
        let (direction, density) = draw(center, radius, u, v);
        let (at, w, radius) = (center.get(0).as_dvec3(), direction.get(0).as_dvec3(), f64::from(radius));
        let past = (at - w * at.dot(w) / w.length_squared()).length();
        // Directions are rounded.
        let meets = past <= radius + 8.0 * EPSILON * at.length();
        let sin2 = radius * radius / at.length_squared();
        let truth = (1.0 + (1.0 - sin2).sqrt()) / (2.0 * PI * sin2);
        let error = (f64::from(density) / truth - 1.0).abs();
        // Half of nothing, or infinitely much, is no density.
        if meets && density > 0.0 && error.is_finite() { tally.off_by(error) } else { tally.count(true) }
    }
    tally
}

fn around(
    dice: &mut Dice,
    from_center: f64,
    cases: usize,
    draw: fn(Vec3<f32>, f32, f32, f32) -> Drawn,
) -> Tally {
    let mut tally = Tally::default();
    for _ in 0..cases {
        let (center, radius) = ball(dice, from_center);
        let (u, v) = numbers(dice);
        tally.count(draw(center, radius, u, v).1 != 0.0);
    }
    tally
}

/// A triangle as seen from the lit point: a corner, and from it the others.
#[derive(Clone, Copy)]
struct Lamp {
    a: Vec3<f32>,
    ab: Vec3<f32>,
    ac: Vec3<f32>,
}

/// Corners about the distance 1 away, edges about `edge` long, no sliver and not seen edge-on.
fn small(edge: f64) -> impl Fn(&mut Dice) -> [DVec3; 3] {
    move |dice| loop {
        let middle = dice.direction();
        let corners = [(); 3].map(|()| middle + dice.direction() * edge);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let height = corners[0].dot(normal.normalize()).abs();
        if normal.length() > 0.3 * edge * edge && height > 0.2 * (1.0 + edge) {
            return corners;
        }
    }
}

/// Corners in a plane at the distance `height`, about 1 away along it.
fn edge_on(height: f64) -> impl Fn(&mut Dice) -> [DVec3; 3] {
    move |dice| {
        let up = dice.direction();
        let (x, y) = up.any_orthonormal_pair();
        let turn = dice.unit();
        [0.0, 1.0, 2.0].map(|third: f64| {
            let (sin, cos) = ((turn + third / 3.0 + 0.1 * dice.signed()) * 2.0 * PI).sin_cos();
            x * (1.0 + 0.3 * cos) + y * (0.3 * sin) + up * height
        })
    }
}

/// The sum of the angles less π.
fn angles(lamp: Lamp, _: f32, _: f32) -> Drawn {
    let corners = [lamp.a, lamp.a + lamp.ab, lamp.a + lamp.ac].map(Vec3::normalize);
    let sides = [0, 1, 2].map(|i| corners[i].cross(corners[(i + 1) % 3]).normalize());
    let angle = |i: usize| (-sides[i].dot(sides[(i + 1) % 3])).clamp(-1.0, 1.0).acos();
    ((corners[0] + corners[1] + corners[2]).normalize(), 1.0 / (angle(0) + angle(1) + angle(2) - TAU / 2.0))
}

/// The tangent of half the solid angle, from the corners' unit vectors alone.
fn determinant(lamp: Lamp, _: f32, _: f32) -> Drawn {
    let [a, b, c] = [lamp.a, lamp.a + lamp.ab, lamp.a + lamp.ac].map(Vec3::normalize);
    let volume = a.dot(b.cross(c)).abs();
    let sum = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
    ((a + b + c).normalize(), 1.0 / (2.0 * volume.atan2(sum)))
}

/// The renderer's.
fn whole_or_area(lamp: Lamp, u: f32, v: f32) -> Drawn {
    let LightSample { wi, pdf, .. } = light::sample_triangle(lamp.a, lamp.ab, lamp.ac, u, v);
    (wi, pdf)
}

/// Methods answer by solid angle, or by area where little of it is seen: either is right.
fn triangle(
    dice: &mut Dice,
    cases: usize,
    corners: impl Fn(&mut Dice) -> [DVec3; 3],
    draw: fn(Lamp, f32, f32) -> Drawn,
) -> Tally {
    let mut tally = Tally::default();
    for _ in 0..cases {
        let [a, b, c] = corners(dice).map(|corner| corner.as_vec3());
        let lamp = Lamp { a: Vec3::splat(a), ab: Vec3::splat(b - a), ac: Vec3::splat(c - a) };
        let (u, v) = numbers(dice);
        let (direction, density) = draw(lamp, u, v);
        let w = direction.get(0).as_dvec3();
        // The lamp as it was given, edges rounded.
        let [a, ab, ac] = [a, b - a, c - a].map(|vector| vector.as_dvec3());
        let normal = ab.cross(ac);
        let t = a.dot(normal) / w.dot(normal);
        let by_area = 2.0 * t * t / normal.dot(w).abs();
        let [a, b, c] = [a, a + ab, a + ac].map(DVec3::normalize);
        let by_angle = 0.5 / a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
        let density = f64::from(density);
        let error = [by_angle, by_area].map(|truth| (density / truth - 1.0).abs());
        let error = error[0].min(error[1]);
        if density > 0.0 && error.is_finite() { tally.off_by(error) } else { tally.count(true) }
    }
    tally
}
