//! Frames with and without light sampling have the same expectation, under lamps and under a sky; with it
//! they have less noise.

use super::{many_lamps, render, square};
use crate::common::statistics::mean_and_error;
use crate::common::*;
use octray::kernel::surface::latitude_longitude;
use octray::lights::EnvironmentLight;
use std::f64::consts::PI;

/// Standard errors between the means of two ways of rendering, from independent runs of each, and the ratio
/// of their variances.
fn compare(scene: &Scene, ways: [LightChoice; 2], samples: [u32; 2], runs: u32) -> (f64, f64) {
    let of = |way: usize| {
        let seeds = (1..=runs).map(|run| run + 1000 * way as u32);
        let means: Vec<f64> = seeds.map(|seed| mean(&render(scene, ways[way], samples[way], seed))).collect();
        mean_and_error(&means)
    };
    let ((a, of_a), (b, of_b)) = (of(0), of(1));
    ((a - b) / of_a.hypot(of_b), (of_b / of_a).powi(2))
}

/// Holds frames with and without light sampling, of different seeds, against each other.
fn compare_with_and_without(samples: u32, runs: u32) {
    let small = |name: &str| Scene { resolution: [24, 16], ..load(name).unwrap() };
    for scene in [
        small("builtin:cornell"),
        small("builtin:cornell-spheres"),
        many_lamps(2),
        many_lamps(7),
        many_lamps(40),
        many_lamps(100),
    ] {
        let ways = [LightChoice::On, LightChoice::Off];
        let (z, _) = compare(&scene, ways, [samples, 4 * samples], runs);
        assert!(z.abs() < 3.5, "{}: {z} standard errors", scene.name);
    }
}

#[test]
fn light_sampling_changes_no_expectation() {
    compare_with_and_without(32, 24);
}

#[test]
#[ignore = "minutes: run by .ci/run"]
fn light_sampling_changes_no_expectation_at_a_third_of_the_noise() {
    compare_with_and_without(256, 24);
}

/// A floor under a dim sky with a sun of one texel, and dark rows below.
fn under_the_sun(filter: Filter) -> Scene {
    let (width, height) = (37, 20);
    let mut texels: Vec<[f32; 4]> = (0..width * height)
        .map(|i| if i / width < 14 { [0.2 + 0.01 * (i % 7) as f32; 4] } else { [0.0; 4] })
        .collect();
    texels[(5 * width + 9) as usize] = [300.0, 250.0, 200.0, 0.0];
    Scene {
        textures: vec![texture([width, height], filter, Texels::Float32(texels))],
        sky: Sky::Texture { texture: 0, color: Vec3::ONE, turn: 0.3 },
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
fn sampling_of_a_sky_changes_no_expectation_and_takes_its_noise_away() {
    // Where cells are even, much; where light falls off within them, less. Other seeds gave 3.2 to 11 for the
    // second: a ratio of variances of 24 runs each, with heavy tails. What is met by chance is blurred by
    // levels of detail, and as free of noise.
    let rough = Metal { roughness: 0.6 };
    for (kind, filter, least) in [
        (Diffuse, Filter::Nearest, 500.0),
        (Diffuse, Filter::Bilinear, 2.0),
        (Diffuse, Filter::Trilinear, 0.0),
        (rough, Filter::Trilinear, 0.0),
    ] {
        let scene = Scene { materials: vec![material(kind)], ..under_the_sun(filter) };
        let (z, ratio) = compare(&scene, [LightChoice::Auto, LightChoice::Off], [64, 1024], 24);
        // Per sample, sixteen times that.
        assert!(z.abs() < 3.5, "{filter:?}: {z} standard errors");
        assert!(16.0 * ratio > least, "{filter:?}: {ratio}");
    }
}

#[test]
fn a_small_light_is_ten_times_less_noisy_where_it_is_sampled() {
    let mut scene = floor(Vec3::ZERO, 2.0);
    scene.camera.vertical_fov = 40.0;
    scene.resolution = [32, 18];
    scene.spheres = vec![sphere(vec3(0.5, 1.5, 0.2), 0.05, 1), sphere(vec3(0.1, 0.3, 0.1), 0.25, 0)];
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
    assert!(with * 10.0 < without, "{with} {without}");
}
