//! Light sampling: emitters that are small, near, around the lit point, or seen edge-on.

use super::rng::Rng;
use super::test_case::{Bound, Case, EPSILON, FAILED, FailureCounts, TestCase, compare};
use crate::lane::functions;
use crate::math::Vec3;
use crate::primitives::{FlatLight, LightSample, flat, sphere};
use crate::sampling::warp;
use glam::DVec3;
use std::f32::consts::TAU;
use std::f64::consts::PI;

pub(super) fn test_cases() -> Vec<TestCase> {
    let flat_lights = |case: Case<SampleFlat>| TestCase {
        axis: "edge / distance",
        places: &[1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0, 10.0],
        failure: "pdf is not positive and finite",
        error: Some("|Δ pdf| / pdf"),
        source: OOSTEROM,
        inputs: 50_000,
        methods: compare(
            case,
            &[("angles", angles), ("determinant", determinant), ("whole-or-area", whole_or_area)],
        ),
        ..TestCase::COMMON
    };
    let quad: Case<SampleFlat> = |rng, x, counts, sample| flat(small(rng, x), true, rng, counts, sample);
    vec![
        TestCase {
            name: "lights-spheres",
            title: "Sampling spherical lights, from far away to close by",
            axis: "radius / distance of the centre",
            places: &[1e-6, 1e-5, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999, 0.99999],
            failure: "pdf is not positive and finite, or the direction misses the light",
            error: Some("|Δ pdf| / pdf"),
            source: SHIRLEY,
            inputs: 50_000,
            methods: compare(sphere, &[("cosine", cosine), ("taylor", taylor), ("sine", sine)]),
            // Close by, the cosine of the rim, √(1 − sin²), magnifies the rounding of sin².
            bound: |ratio| Bound::error(8.0 * EPSILON / (1.0 - ratio * ratio).sqrt()),
        },
        TestCase {
            name: "lights-around",
            title: "Lit points inside spherical lights",
            axis: "distance from the centre / radius",
            places: &[0.0, 1e-6, 1e-3, 0.1, 0.5, 0.9, 0.99, 0.999, 0.9999, 0.99999],
            failure: "pdf is not 0, although the light is in every direction",
            source: SHIRLEY,
            inputs: 50_000,
            methods: compare(
                around,
                &[("cosine", cosine), ("cosine-clamped", cosine_clamped), ("sine-and-inside", sine)],
            ),
            ..TestCase::COMMON
        },
        TestCase {
            name: "lights-triangle",
            title: "Sampling triangular lights that are small or far away",
            // Measured, not derived: 8 ε.
            bound: |_| Bound::error(16.0 * EPSILON),
            ..flat_lights(|rng, x, counts, sample| flat(small(rng, x), false, rng, counts, sample))
        },
        TestCase {
            name: "lights-quad",
            title: "Sampling parallelograms that emit and are small or far away",
            methods: compare(quad, &[("determinants", determinants), ("whole-or-area", whole_or_area)]),
            // Measured, not derived: half of it.
            bound: |_| Bound::error(32.0 * EPSILON),
            ..flat_lights(quad)
        },
        TestCase {
            name: "lights-edge-on",
            title: "Sampling triangular lights seen nearly edge-on, about half as large as their distance",
            axis: "distance from the triangle's plane / distance",
            places: &[1e-7, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1, 1.0],
            // The distance of the plane is rounded by some ε; closer to it there is no promise.
            bound: |height| {
                if height < 1e-5 { Bound::NONE } else { Bound::error(EPSILON * (16.0 + 8.0 / height)) }
            },
            ..flat_lights(|rng, x, counts, sample| flat(edge_on(rng, x), false, rng, counts, sample))
        },
    ]
}

const SHIRLEY: &str = "Shirley, Wang, Zimmerman, ACM TOG 15(1), 1996; Pharr et al., PBR 4ed §6.2.4";
const OOSTEROM: &str = "Van Oosterom, Strackee, IEEE TBME 30(2), 1983; Arvo, SIGGRAPH 1995";

/// A direction and its pdf.
type DirectionPdf = (Vec3<f32>, f32);
/// A direction towards a sphere, from its centre, its radius and two random numbers.
type SampleSphere = fn(Vec3<f32>, f32, f32, f32) -> DirectionPdf;
/// A direction towards a triangle or a parallelogram, from two random numbers.
type SampleFlat = fn(FlatLight<f32>, f32, f32) -> DirectionPdf;

/// Returns a direction around the axis towards `center`.
fn cone(center: Vec3<f32>, sin: f32, cos: f32, v: f32) -> Vec3<f32> {
    let axis = center.normalize();
    let (tangent, bitangent) = warp::orthonormal_basis(axis);
    let (sin_around, cos_around) = functions::sin_cos_turns(v);
    tangent.mul_add(sin * cos_around, bitangent.mul_add(sin * sin_around, axis * cos))
}

/// Returns the textbook method: from the cosine of the cone's angle.
fn cosine(center: Vec3<f32>, radius: f32, u: f32, v: f32) -> DirectionPdf {
    within_rim(center, (1.0 - radius * radius / center.dot(center)).sqrt(), u, v)
}

/// Variant of [`cosine`] without NaN.
fn cosine_clamped(center: Vec3<f32>, radius: f32, u: f32, v: f32) -> DirectionPdf {
    within_rim(center, (1.0 - radius * radius / center.dot(center)).max(0.0).sqrt(), u, v)
}

/// Samples a direction in a cone whose rim has this cosine.
fn within_rim(center: Vec3<f32>, rim: f32, u: f32, v: f32) -> DirectionPdf {
    let cos = 1.0 - u * (1.0 - rim);
    (cone(center, (1.0 - cos * cos).sqrt(), cos, v), 1.0 / (TAU * (1.0 - rim)))
}

/// Returns the cosine, and below 1.5° the first term of its series.
fn taylor(center: Vec3<f32>, radius: f32, u: f32, v: f32) -> DirectionPdf {
    let sin2 = radius * radius / center.dot(center);
    if sin2 >= 0.000_685_23 {
        return cosine(center, radius, u, v);
    }
    let sampled2 = sin2 * u;
    (cone(center, sampled2.sqrt(), (1.0 - sampled2).sqrt(), v), 1.0 / (TAU * 0.5 * sin2))
}

/// Returns the renderer's method.
fn sine(center: Vec3<f32>, radius: f32, u: f32, v: f32) -> DirectionPdf {
    let LightSample { wi, pdf, .. } = sphere::sample(center, radius, u, v);
    (wi, pdf)
}

/// Returns two random numbers in [0, 1).
fn numbers(rng: &mut Rng) -> (f32, f32) {
    ((rng.bits() >> 8) as f32 / 16_777_216.0, (rng.bits() >> 8) as f32 / 16_777_216.0)
}

/// Returns a sphere of random size, its centre `distance` radii away.
fn ball(rng: &mut Rng, distance: f64) -> (Vec3<f32>, f32) {
    let radius = rng.scale(1e-3, 1e3);
    (Vec3::splat((rng.direction() * (radius * distance)).as_vec3()), radius as f32)
}

fn sphere(rng: &mut Rng, ratio: f64, counts: &mut FailureCounts, sample: SampleSphere) {
    let (center, radius) = ball(rng, 1.0 / ratio);
    let (u, v) = numbers(rng);
    let (direction, pdf) = sample(center, radius, u, v);
    let (at, w, radius) = (center.get(0).as_dvec3(), direction.get(0).as_dvec3(), f64::from(radius));
    let distance = (at - w * at.dot(w) / w.length_squared()).length();
    // Directions are rounded.
    let hits = distance <= radius + 8.0 * EPSILON * at.length();
    let sin2 = radius * radius / at.length_squared();
    let expected = (1.0 + (1.0 - sin2).sqrt()) / (2.0 * PI * sin2);
    let error = (f64::from(pdf) / expected - 1.0).abs();
    counts.record_error(if hits && pdf > 0.0 { error } else { FAILED });
}

fn around(rng: &mut Rng, from_center: f64, counts: &mut FailureCounts, sample: SampleSphere) {
    let (center, radius) = ball(rng, from_center);
    let (u, v) = numbers(rng);
    counts.record(sample(center, radius, u, v).1 != 0.0);
}

/// Corners at a distance of about 1, edges of about `edge`; no slivers, not edge-on.
fn small(rng: &mut Rng, edge: f64) -> [DVec3; 3] {
    loop {
        let middle = rng.direction();
        let corners = [(); 3].map(|()| middle + rng.direction() * edge);
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        let height = corners[0].dot(normal.normalize()).abs();
        if normal.length() > 0.3 * edge * edge && height > 0.2 * (1.0 + edge) {
            return corners;
        }
    }
}

/// Corners in a plane at the distance `height`, about 1 away along the plane.
fn edge_on(rng: &mut Rng, height: f64) -> [DVec3; 3] {
    let up = rng.direction();
    let (x, y) = up.any_orthonormal_pair();
    let turn = rng.unit();
    [0.0, 1.0, 2.0].map(|third: f64| {
        let (sin, cos) = ((turn + third / 3.0 + 0.1 * rng.signed()) * 2.0 * PI).sin_cos();
        x * (1.0 + 0.3 * cos) + y * (0.3 * sin) + up * height
    })
}

/// Computes the solid angle as the sum of the angles less π.
fn angles(light: FlatLight<f32>, _: f32, _: f32) -> DirectionPdf {
    let corners = [light.a, light.a + light.ab, light.a + light.ac].map(Vec3::normalize);
    let sides = [0, 1, 2].map(|i| corners[i].cross(corners[(i + 1) % 3]).normalize());
    let angle = |i: usize| (-sides[i].dot(sides[(i + 1) % 3])).clamp(-1.0, 1.0).acos();
    ((corners[0] + corners[1] + corners[2]).normalize(), 1.0 / (angle(0) + angle(1) + angle(2) - TAU / 2.0))
}

/// Computes the solid angle from the tangent of its half (Van Oosterom, Strackee).
fn determinant(light: FlatLight<f32>, _: f32, _: f32) -> DirectionPdf {
    let [a, b, c] = [light.a, light.a + light.ab, light.a + light.ac].map(Vec3::normalize);
    let volume = a.dot(b.cross(c)).abs();
    let sum = 1.0 + a.dot(b) + b.dot(c) + c.dot(a);
    ((a + b + c).normalize(), 1.0 / (2.0 * volume.atan2(sum)))
}

/// Returns the renderer's method, for triangles and parallelograms.
fn whole_or_area(light: FlatLight<f32>, u: f32, v: f32) -> DirectionPdf {
    let LightSample { wi, pdf, .. } = flat::sample(&light, u, v);
    (wi, pdf)
}

/// Returns the textbook's method for each half of a parallelogram.
fn determinants(light: FlatLight<f32>, u: f32, v: f32) -> DirectionPdf {
    let FlatLight { a, ab, ac, .. } = light;
    let (wi, first) = determinant(light, u, v);
    let other = FlatLight { a: a + ab + ac, ab: ab * -1.0, ac: ac * -1.0, ..light };
    let (_, second) = determinant(other, u, v);
    (wi, 1.0 / (1.0 / first + 1.0 / second))
}

/// Triangles, or parallelograms with the fourth corner opposite the first. The pdf may be that of sampling
/// the solid angle or the area; each method uses area for small solid angles.
fn flat(corners: [DVec3; 3], is_quad: bool, rng: &mut Rng, counts: &mut FailureCounts, sample: SampleFlat) {
    let [a, b, c] = corners.map(|corner| corner.as_vec3());
    let [at, ab, ac] = [a, b - a, c - a].map(Vec3::splat);
    let (u, v) = numbers(rng);
    let (direction, pdf) = sample(FlatLight { a: at, ab, ac, is_quad }, u, v);
    let w = direction.get(0).as_dvec3();
    // The light with rounded edges, as the method gets it.
    let [a, ab, ac] = [a, b - a, c - a].map(|vector| vector.as_dvec3());
    let normal = ab.cross(ac);
    let t = a.dot(normal) / w.dot(normal);
    let by_area = if is_quad { 1.0 } else { 2.0 } * t * t / normal.dot(w).abs();
    let [a, b, c, d] = [a, a + ab, a + ac, a + ab + ac].map(DVec3::normalize);
    let half = |a: DVec3| a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a));
    let by_angle = 0.5 / (half(a) + if is_quad { half(d) } else { 0.0 });
    let [by_angle, by_area] = [by_angle, by_area].map(|expected| (f64::from(pdf) / expected - 1.0).abs());
    counts.record_error(if pdf > 0.0 { by_angle.min(by_area) } else { FAILED });
}
