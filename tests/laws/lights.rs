//! Looking for lights: directions are drawn as their densities say, what arrives is what closed forms say,
//! and searching changes no expectation.

use crate::common::{Rng, floor, lamp, mean, sphere, triangle};
use glam::{DVec3, Vec3};
use octray::buffers::{EnvironmentLight, LightChoice};
use octray::film::Picture;
use octray::kernel::light::{LightSample, sample_sphere, sample_triangle, sphere_pdf, triangle_pdf};
use octray::kernel::surface::latitude_longitude;
use octray::lane::{F32x8, F32x16, Lane};
use octray::math;
use octray::render::Settings;
use octray::scene::{Filter, Scene, Sky, Texels, Texture, load};
use octray::traverse::Methods;
use std::f64::consts::PI;

fn vector(v: DVec3) -> math::Vec3<f32> {
    math::Vec3::splat(v.as_vec3())
}

fn double(v: math::Vec3<f32>) -> DVec3 {
    v.get(0).as_dvec3()
}

/// Midpoints of `side` × `side` cells of the unit square.
fn square(side: u32) -> impl Iterator<Item = (f32, f32)> {
    let middle = move |i: u32| (i as f32 + 0.5) / side as f32;
    (0..side).flat_map(move |i| (0..side).map(move |j| (middle(i), middle(j))))
}

/// What a Lambertian point would receive from an emitter of radiance 1: the mean of direction / density,
/// whose product with a normal is the irradiance as long as the emitter is above the horizon.
fn vector_irradiance(aim: impl Fn(f32, f32) -> LightSample<f32>, side: u32) -> DVec3 {
    let sum: DVec3 = square(side)
        .map(|(u, v)| {
            let aim = aim(u, v);
            double(aim.wi) / f64::from(aim.pdf)
        })
        .sum();
    sum / f64::from(side * side)
}

/// Lambert's formula for a polygon seen from the origin: half the sum of the edges' angles, each along the
/// normal of its plane.
fn polygon_irradiance(corners: [DVec3; 3]) -> DVec3 {
    let edge = |i: usize| {
        let (a, b) = (corners[i].normalize(), corners[(i + 1) % 3].normalize());
        let normal = a.cross(b);
        normal * (normal.length().atan2(a.dot(b)) / normal.length())
    };
    (edge(0) + edge(1) + edge(2)) * 0.5
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
        let aim = |u, v| sample_sphere(vector(center), radius as f32, u, v);
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

fn aim_at(corners: [DVec3; 3], u: f32, v: f32) -> LightSample<f32> {
    let [a, b, c] = corners;
    sample_triangle(vector(a), vector(b - a), vector(c - a), u, v)
}

#[test]
fn a_triangle_gives_the_irradiance_of_lamberts_formula() {
    let mut rng = Rng(2);
    let (mut whole, mut by_area) = (0, 0);
    for _ in 0..1000 {
        let corners = corners(&mut rng);
        let omega = solid_angle(corners);
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize();
        let height = a.dot(normal).abs() / a.length().max(b.length()).max(c.length());
        // Nearly edge-on its single-precision corners are another triangle's.
        if height < 0.02 {
            continue;
        }
        if omega < 1e-3 {
            by_area += 1
        } else {
            whole += 1
        }
        let mine = vector_irradiance(|u, v| aim_at(corners, u, v), 96);
        let truth = polygon_irradiance(corners);
        // The order of the corners decides the sign of Lambert's vector.
        let error = (mine - truth).length().min((mine + truth).length()) / truth.length();
        assert!(error < 2e-3, "{corners:?}, {omega:e} sr: {error:e}");
    }
    assert!(whole > 200 && by_area > 200, "{whole} {by_area}");
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
        let draws = 64 * 64 * 4;
        for _ in 0..draws {
            let aim = aim_at(corners, rng.unit() as f32, rng.unit() as f32);
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
        let chi_squared: f64 = cells
            .iter()
            .zip(&counts)
            .map(|(&cell, count)| {
                let expected = f64::from(draws) * solid_angle(cell) / total;
                (count - expected).powi(2) / expected.max(1.0)
            })
            .sum();
        // Wilson and Hilferty: the cube root is nearly normal.
        let freedom = cells.len() as f64 - 1.0;
        let spread = 2.0 / (9.0 * freedom);
        worst = worst.max(((chi_squared / freedom).cbrt() - (1.0 - spread)) / spread.sqrt());
    }
    assert!(worst < 4.5, "{worst} standard deviations");
}

#[test]
fn a_direction_has_the_density_it_was_drawn_with() {
    let mut rng = Rng(4);
    for _ in 0..20_000 {
        let (u, v) = (rng.unit() as f32, rng.unit() as f32);
        let corners @ [a, b, c] = corners(&mut rng);
        let aim = aim_at(corners, u, v);
        let again = triangle_pdf(vector(a), vector(b - a), vector(c - a), aim.wi, aim.t);
        assert!(aim.pdf == again || aim.pdf == 0.0, "{} {again}", aim.pdf);
        let radius = rng.scale(1e-3, 1e3);
        let center = rng.direction() * radius * rng.scale(0.1, 1e4);
        let aim = sample_sphere(vector(center), radius as f32, u, v);
        assert_eq!(aim.pdf, sphere_pdf(vector(center), radius as f32));
        assert_eq!(aim.pdf > 0.0, center.as_vec3().length() > radius as f32, "{center} {radius}");
        if aim.pdf > 0.0 {
            assert!(double(aim.n).dot(double(aim.wi)) < 1e-3 && aim.t > 0.0);
        }
    }
}

#[test]
fn aims_are_the_same_at_every_width() {
    fn check<L: Lane>() {
        let mut rng = Rng(5);
        for _ in 0..1_000 {
            let all: [([DVec3; 3], f32, f32, f32); 16] = std::array::from_fn(|_| {
                (corners(&mut rng), rng.scale(1e-3, 1e3) as f32, rng.unit() as f32, rng.unit() as f32)
            });
            let wide = |of: &dyn Fn(usize) -> DVec3| {
                let at = |axis: usize| L::from_fn(|lane| of(lane).as_vec3()[axis]);
                math::Vec3::new(at(0), at(1), at(2))
            };
            let [a, ab, ac] = [
                wide(&|lane| all[lane].0[0]),
                wide(&|lane| all[lane].0[1] - all[lane].0[0]),
                wide(&|lane| all[lane].0[2] - all[lane].0[0]),
            ];
            let radius = L::from_fn(|lane| all[lane].1);
            let (u, v) = (L::from_fn(|lane| all[lane].2), L::from_fn(|lane| all[lane].3));
            let (triangles, spheres) = (sample_triangle(a, ab, ac, u, v), sample_sphere(a, radius, u, v));
            for (lane, &(corners, radius, u, v)) in all.iter().enumerate().take(L::WIDTH) {
                let one = aim_at(corners, u, v);
                let bits = |v: Vec3| v.to_array().map(f32::to_bits);
                assert_eq!(bits(triangles.wi.get(lane)), bits(one.wi.get(0)));
                assert_eq!(triangles.pdf.get(lane).to_bits(), one.pdf.to_bits());
                let one = sample_sphere(vector(corners[0]), radius, u, v);
                if one.pdf > 0.0 {
                    assert_eq!(bits(spheres.wi.get(lane)), bits(one.wi.get(0)));
                    assert_eq!(spheres.pdf.get(lane).to_bits(), one.pdf.to_bits());
                }
            }
        }
    }
    check::<F32x8>();
    check::<F32x16>();
}

fn render(scene: &Scene, lights: LightChoice, samples: u32, seed: u32) -> Picture {
    let methods = Methods { lights, ..Methods::default() };
    crate::common::render(scene, Settings { methods, seed, ..Settings::of(scene) }, samples)
}

#[test]
fn a_lamp_lights_the_floor_as_the_closed_form_says_at_every_scale() {
    // A lamp in its own way, or a density that is not what was drawn, would show.
    for scale in [1e-3, 1.0, 1e3] {
        for away in [Vec3::ZERO, Vec3::new(30.0, -20.0, 50.0)] {
            let foot = away * scale;
            let mut scene = floor(foot, 2.0 * scale);
            let center = foot + Vec3::new(0.6, 0.8, 0.0) * scale;
            scene.spheres = vec![sphere(center, 0.1 * scale, 1)];
            scene.materials.push(lamp(50.0));
            // Radiance 50, sin² = 0.01, cos = 0.8, of π / π.
            let truth = 50.0 * 0.01 * 0.8;
            let got = mean(&render(&scene, LightChoice::Auto, 64, 1));
            assert!((got / truth - 1.0).abs() < 2e-3, "sphere, {scale} {away}: {got} of {truth}");

            let corners = [Vec3::new(0.5, 0.7, 0.0), Vec3::new(0.7, 0.8, 0.1), Vec3::new(0.6, 0.9, -0.2)];
            scene.spheres.clear();
            scene.triangles.push(triangle(corners.map(|corner| foot + corner * scale), 1));
            let seen = corners.map(|corner| corner.as_dvec3());
            let truth = 50.0 / PI * polygon_irradiance(seen).y.abs();
            let got = mean(&render(&scene, LightChoice::Auto, 64, 1));
            assert!((got / truth - 1.0).abs() < 4e-3, "triangle, {scale} {away}: {got} of {truth}");
        }
    }
}

/// Standard errors between the means of two ways of rendering, from independent runs of each, and the ratio
/// of their variances.
fn compare(scene: &Scene, ways: [LightChoice; 2], samples: [u32; 2], runs: u32) -> (f64, f64) {
    let of = |way: usize| {
        let seeds = (1..=runs).map(|run| run + 1000 * way as u32);
        let means: Vec<f64> = seeds.map(|seed| mean(&render(scene, ways[way], samples[way], seed))).collect();
        let average = means.iter().sum::<f64>() / f64::from(runs);
        let variance = means.iter().map(|m| (m - average).powi(2)).sum::<f64>() / f64::from(runs - 1);
        (average, variance / f64::from(runs))
    };
    let ((a, of_a), (b, of_b)) = (of(0), of(1));
    println!("{}: {a} ± {} against {b} ± {}", scene.name, of_a.sqrt(), of_b.sqrt());
    ((a - b) / (of_a + of_b).sqrt(), of_b / of_a)
}

/// Lamps of both shapes and of all sizes over a floor that shines too: light found on the way from one of its
/// points to itself would show.
fn many_lamps() -> Scene {
    let mut scene = Scene { name: "many lamps".into(), max_bounces: 3, ..floor(Vec3::ZERO, 2.0) };
    let mut rng = Rng(7);
    for _ in 0..40 {
        scene.materials.push(lamp(rng.scale(0.1, 10.0) as f32));
        let number = scene.materials.len() as u32 - 1;
        let at = (rng.in_cube() + DVec3::Y * 1.2).as_vec3();
        if rng.unit() < 0.5 {
            scene.spheres.push(sphere(at, rng.scale(0.05, 0.3) as f32, number));
        } else {
            let corners = [(); 3].map(|()| at + (rng.in_cube() * 0.3).as_vec3());
            scene.triangles.push(triangle(corners, number));
        }
    }
    scene.materials[0].emission = Vec3::splat(1e-3);
    scene.camera.vertical_fov = 30.0;
    scene
}

/// Holds what is found with and without search, and with other random numbers, against each other.
fn search_against_chance(samples: u32, runs: u32) {
    let small = |name: &str| Scene { resolution: [24, 16], ..load(name).unwrap() };
    for scene in [small("builtin:cornell"), small("builtin:cornell-spheres"), many_lamps()] {
        let ways = [LightChoice::On, LightChoice::Off];
        let (z, ratio) = compare(&scene, ways, [samples, 4 * samples], runs);
        println!("{}: {z:.2} standard errors, variance {ratio:.2}", scene.name);
        assert!(z.abs() < 3.5, "{}: {z} standard errors", scene.name);
    }
}

#[test]
fn searching_changes_no_expectation() {
    search_against_chance(32, 24);
}

#[test]
#[ignore = "minutes: run by .ci/run"]
fn searching_changes_no_expectation_at_a_third_of_the_noise() {
    search_against_chance(256, 24);
}

/// A dim sky with a sun of one texel, and dark rows below.
fn sunny(filter: Filter) -> Texture {
    let (width, height) = (37, 20);
    let mut texels: Vec<[f32; 4]> = (0..width * height)
        .map(|i| if i / width < 14 { [0.2 + 0.01 * (i % 7) as f32; 4] } else { [0.0; 4] })
        .collect();
    texels[(5 * width + 9) as usize] = [300.0, 250.0, 200.0, 0.0];
    Texture { name: "sun".into(), width, height, filter, texels: Texels::Float32(texels) }
}

fn under_the_sun(filter: Filter) -> Scene {
    Scene {
        textures: vec![sunny(filter)],
        sky: Sky::Texture { texture: 0, color: Vec3::ONE },
        ..floor(Vec3::ZERO, 2.0)
    }
}

#[test]
fn directions_to_a_sky_have_the_density_of_their_cell() {
    let sky = EnvironmentLight::of(&under_the_sun(Filter::Nearest)).unwrap();
    assert!(sky.contrast > 50.0, "{}", sky.contrast);
    let (side, mut other, mut solid_angle, mut sun) = (512, 0, 0.0, 0.0);
    for (u, v) in square(side) {
        let aim = sky.sample::<f32>(u, v);
        let again: f32 = sky.pdf(latitude_longitude(aim.wi));
        other += usize::from(aim.pdf != again);
        solid_angle += 1.0 / f64::from(aim.pdf);
        sun += f64::from(u8::from(aim.pdf > 1.0));
        assert!(aim.pdf > 0.0 && aim.wi.y > (PI * 14.0 / 20.0).cos() as f32 - 1e-5);
    }
    let draws = f64::from(side * side);
    // Rounding at the edges of cells; and nothing is drawn where the sky is black.
    assert!((other as f64) < 1e-3 * draws, "{other} of {draws}");
    let seen = 2.0 * PI * (1.0 - (PI * 14.0 / 20.0).cos());
    assert!((solid_angle / draws / seen - 1.0).abs() < 0.02, "{} of {seen}", solid_angle / draws);
    // The sun has 250 of 250 + the rest's mean of 0.23 times its number of texels, by solid angle.
    let share = sun / draws;
    assert!((0.5..0.9).contains(&share), "{share}");
}

#[test]
fn searching_a_sky_changes_no_expectation_and_takes_its_noise_away() {
    // Where cells are even, much; where light falls off within them, less. Other seeds gave 3.2 to 11 for the
    // second: a ratio of variances of 24 runs each, with heavy tails.
    for (filter, least) in [(Filter::Nearest, 500.0), (Filter::Bilinear, 2.0)] {
        let scene = under_the_sun(filter);
        let (z, ratio) = compare(&scene, [LightChoice::Auto, LightChoice::Off], [64, 1024], 24);
        // Per sample, sixteen times that.
        println!("{filter:?}: {z:.2} standard errors, variance {ratio:.1}");
        assert!(z.abs() < 3.5, "{filter:?}: {z} standard errors");
        assert!(16.0 * ratio > least, "{filter:?}: {ratio}");
    }
}

#[test]
fn a_small_light_is_ten_times_less_noisy_for_being_looked_for() {
    let mut scene = floor(Vec3::ZERO, 2.0);
    scene.camera.vertical_fov = 40.0;
    scene.resolution = [32, 18];
    scene.spheres =
        vec![sphere(Vec3::new(0.5, 1.5, 0.2), 0.05, 1), sphere(Vec3::new(0.1, 0.3, 0.1), 0.25, 0)];
    scene.materials.push(lamp(200.0));
    scene.max_bounces = 4;
    let truth = render(&scene, LightChoice::Auto, 16_384, 99);
    let error = |lights| {
        let picture = render(&scene, lights, 16, 1);
        let pixels = picture.pixels.iter().zip(&truth.pixels);
        // What sees the lamp itself is as noisy either way.
        let squares: Vec<f64> = pixels
            .filter(|(_, truth)| truth[0] < 20.0)
            .map(|(pixel, truth)| f64::from(pixel[0] - truth[0]).powi(2))
            .collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let (with, without) = (error(LightChoice::Auto), error(LightChoice::Off));
    println!("error at 16 samples: {with} with, {without} without search");
    assert!(with * 10.0 < without, "{with} {without}");
}
