//! Sampling of spheres, triangles, and quads: irradiance, densities, normals, and equal bits at every width.

use super::{double, polygon_irradiance, square, vector};
use crate::common::statistics::deviation_of;
use crate::common::*;
use octray::primitives::{self, FlatLight, LightSample};
use std::f64::consts::PI;

/// What a Lambertian point would receive from an emitter of radiance 1: the mean of direction / density,
/// whose product with a normal is the irradiance as long as the emitter is above the horizon.
fn vector_irradiance(aim: impl Fn(f32, f32) -> LightSample<f32>, side: u32) -> DVec3 {
    let per_pdf = |aim: LightSample<f32>| double(aim.wi) / f64::from(aim.pdf);
    square(side).map(|(u, v)| per_pdf(aim(u, v))).sum::<DVec3>() / f64::from(side * side)
}

fn solid_angle([a, b, c]: [DVec3; 3]) -> f64 {
    let [a, b, c] = [a, b, c].map(DVec3::normalize);
    2.0 * a.dot(b.cross(c)).abs().atan2(1.0 + a.dot(b) + b.dot(c) + c.dot(a))
}

#[test]
fn a_sphere_gives_the_irradiance_of_the_closed_form() {
    let mut rng = Rng(1);
    for _ in 0..300 {
        let radius = rng.scale(1e-4, 1e4);
        let distance = radius * rng.scale(1.001, 1e5);
        let center = rng.direction() * distance;
        let aim = |u, v| primitives::sphere::sample(vector(center), radius as f32, u, v);
        // π sin² of half its angle, towards its centre.
        let truth = center.normalize() * PI * (radius / distance).powi(2);
        let error = (vector_irradiance(aim, 64) - truth).length() / truth.length();
        assert!(error < 5e-4, "radius {radius:e} at {distance:e}: {error:e}");
    }
}

/// Corners that a point at the origin sees from far to near, blunt to sharp.
fn corners(rng: &mut Rng) -> [DVec3; 3] {
    let size = rng.scale(1e-3, 1e3);
    let middle = rng.direction() * size * rng.scale(1e-2, 1e3);
    [(); 3].map(|()| middle + rng.direction() * size)
}

fn flat([a, b, c]: [DVec3; 3], is_quad: bool) -> FlatLight<f32> {
    FlatLight { a: vector(a), ab: vector(b - a), ac: vector(c - a), is_quad }
}

/// Slivers are not asked for of parallelograms: in single precision they are others.
fn flat_lights_give_lamberts_irradiance(
    rng: &mut Rng,
    is_quad: bool,
    count: usize,
    least: [usize; 2],
    most: f64,
) {
    // Sampled by solid angle, and by area.
    let mut sampled = [0; 2];
    for _ in 0..count {
        let [a, b, c] = corners(rng);
        let d = if is_quad { b + c - a } else { a };
        let normal = (b - a).cross(c - a);
        let [longest, farthest] = [[b - a, c - a, b - a, c - a], [a, b, c, d]]
            .map(|of| of.map(DVec3::length).into_iter().fold(0.0, f64::max));
        // Nearly edge-on, its corners are another light's in single precision.
        let edge_on = a.dot(normal.normalize()).abs() < 0.02 * farthest;
        if edge_on || (is_quad && normal.length() < 0.02 * longest * longest) {
            continue;
        }
        let (omega, outline) = match is_quad {
            true => (solid_angle([a, b, c]) + solid_angle([d, b, c]), vec![a, b, d, c]),
            false => (solid_angle([a, b, c]), vec![a, b, c]),
        };
        sampled[usize::from(omega < 1e-3)] += 1;
        let light = flat([a, b, c], is_quad);
        let mine = vector_irradiance(|u, v| primitives::flat::sample(&light, u, v), 96);
        let truth = polygon_irradiance(&outline);
        // The order of the corners decides the sign of Lambert's vector.
        let error = (mine - truth).length().min((mine + truth).length()) / truth.length();
        assert!(error < most, "{a} {b} {c}, quad {is_quad}, {omega:e} sr: {error:e}");
    }
    assert!(sampled[0] > least[0] && sampled[1] > least[1], "{sampled:?}");
}

#[test]
fn triangles_and_parallelograms_give_the_irradiance_of_lamberts_formula() {
    flat_lights_give_lamberts_irradiance(&mut Rng(2), false, 1000, [200, 200], 2e-3);
    flat_lights_give_lamberts_irradiance(&mut Rng(12), true, 500, [100, 50], 3e-3);
}

#[test]
fn directions_within_a_triangle_are_spread_as_their_density_says() {
    let mut rng = Rng(3);
    let (mut worst, mut tried) = (0.0_f64, 0);
    while tried < 60 {
        let corners = corners(&mut rng);
        if solid_angle(corners) < 2e-3 {
            continue;
        }
        tried += 1;
        // Three times each triangle in four, each with its own share of the solid angle.
        let split = |[a, b, c]: [DVec3; 3]| {
            let (ab, bc, ca) = ((a + b) * 0.5, (b + c) * 0.5, (c + a) * 0.5);
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        // The planes through the origin and a cell's edges, towards its inside.
        let planes = |cell: [DVec3; 3]| {
            let [a, b, c] = cell.map(DVec3::normalize);
            let sign = a.cross(b).dot(c).signum();
            [a.cross(b), b.cross(c), c.cross(a)].map(|edge| sign * edge.normalize())
        };
        let mut cells = vec![corners];
        let mut levels = Vec::new();
        for _ in 0..3 {
            cells = cells.into_iter().flat_map(split).collect();
            levels.push(cells.iter().copied().map(planes).collect::<Vec<_>>());
        }
        let total: f64 = cells.iter().map(|&cell| solid_angle(cell)).sum();
        let mut counts = vec![0.0; cells.len()];
        let (draws, light) = (64 * 64 * 4, flat(corners, false));
        for _ in 0..draws {
            let aim = primitives::flat::sample(&light, rng.unit() as f32, rng.unit() as f32);
            let direction = double(aim.wi);
            // Down from quarter to quarter: the nearest is where the smallest of the three volumes is
            // largest.
            let inside =
                |planes: &[DVec3; 3]| planes.map(|n| n.dot(direction)).into_iter().fold(f64::MAX, f64::min);
            let cell = levels.iter().fold(0, |cell, level| {
                let quarters = 4 * cell..4 * cell + 4;
                quarters.max_by(|&i, &j| inside(&level[i]).total_cmp(&inside(&level[j]))).expect("four")
            });
            counts[cell] += 1.0;
        }
        let square = |(&cell, count): (&[DVec3; 3], &f64)| {
            let expected = f64::from(draws) * solid_angle(cell) / total;
            (count - expected).powi(2) / expected.max(1.0)
        };
        let chi2 = cells.iter().zip(&counts).map(square).sum();
        worst = worst.max(deviation_of(chi2, cells.len() as f64 - 1.0));
    }
    assert!(worst < 4.5, "{worst} standard deviations");
}

/// Shadow rays end a little before a light, along its normal.
#[test]
fn normals_of_sphere_lights_are_no_longer_than_one_at_any_distance() {
    let mut rng = Rng(41);
    for _ in 0..20_000 {
        let (u, v) = (rng.unit() as f32, rng.unit() as f32);
        let distance = rng.scale(1e-3, 1e3);
        let ratio = rng.scale(1.01, 1e12);
        let aim =
            primitives::sphere::sample(vector(rng.direction() * distance), (distance / ratio) as f32, u, v);
        let length = double(aim.n).length();
        assert!(length <= 1.5, "|n| = {length} from {ratio} radii");
        assert!(ratio > 1e4 || (length - 1.0).abs() < 1e-2, "|n| = {length} from {ratio} radii");
    }
}

#[test]
fn a_direction_has_the_density_it_was_drawn_with() {
    let mut rng = Rng(4);
    for _ in 0..20_000 {
        let (u, v) = (rng.unit() as f32, rng.unit() as f32);
        let [a, b, c] = corners(&mut rng);
        for is_quad in [false, true] {
            let light = flat([a, b, c], is_quad);
            let aim = primitives::flat::sample(&light, u, v);
            let again = primitives::flat::pdf(&light, aim.wi, aim.t);
            assert!(aim.pdf == again || aim.pdf == 0.0, "{} {again}", aim.pdf);
        }
        let radius = rng.scale(1e-3, 1e3);
        let center = rng.direction() * radius * rng.scale(0.1, 1e4);
        let aim = primitives::sphere::sample(vector(center), radius as f32, u, v);
        assert_eq!(aim.pdf, primitives::sphere::pdf(vector(center), radius as f32));
        assert_eq!(aim.pdf > 0.0, center.as_vec3().length() > radius as f32, "{center} {radius}");
        if aim.pdf > 0.0 {
            assert!(double(aim.n).dot(double(aim.wi)) < 1e-3 && aim.t > 0.0);
        }
    }
}
