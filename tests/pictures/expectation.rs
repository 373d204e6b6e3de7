//! The law of all ways to find light: they differ in noise and not in what they expect. Every material, on a
//! sphere, on a smooth mesh and under maps, is lit by lamps of both shapes and a sky, and rendered with and
//! without search, with well spread and with independent numbers; Welch's t holds the means of independent
//! runs against each other, over the picture and in parts of it.

use crate::common::statistics::{allowed, mean_and_error};
use crate::common::*;

const KINDS: [MaterialKind; 11] = [
    Diffuse,
    Metal { roughness: 0.2 },
    Metal { roughness: 0.7 },
    Plastic { roughness: 0.0, ior: 1.5 },
    Plastic { roughness: 0.5, ior: 1.5 },
    MetalRough { roughness: 0.5, metallic: 0.5, ior: 1.5 },
    FuzzyMirror { roughness: 0.4 },
    FuzzyMirror { roughness: 2.0 },
    Glass { ior: 1.5 },
    RoughGlass { roughness: 0.5, ior: 1.5, thin: false },
    RoughGlass { roughness: 0.4, ior: 1.5, thin: true },
];

/// What is lit: a ball, as a sphere or as triangles with smooth normals.
fn balls(kind: MaterialKind) -> [Scene; 4] {
    let [round, smooth] = [round_ball(kind), smooth_ball(kind)];
    let mapped = |scene: &Scene| {
        let mut scene = scene.clone();
        let mut rng = Rng(71);
        scene.textures =
            vec![noise(&mut rng, 8, 6, Filter::Bilinear), noise(&mut rng, 7, 5, Filter::Nearest)];
        scene.materials[0].roughness_map = kind.has_roughness().then_some(0);
        scene.materials[0].normal_map = Some(1);
        let at = |v: Vec3| vec2(0.5 + 0.4 * v.x, 0.5 + 0.3 * v.y + 0.1 * v.z);
        scene.uvs = scene.triangles.iter().map(|triangle| triangle.vertices.map(at)).collect();
        scene
    };
    let [mapped_round, mapped_smooth] = [mapped(&round), mapped(&smooth)];
    [round, smooth, mapped_round, mapped_smooth]
}

/// Under a dim sky, between a round lamp and one of a triangle that is half below the ball's horizon, over a
/// floor that throws light back.
fn lit(mut scene: Scene) -> Scene {
    let first = scene.materials.len() as u32;
    scene.materials.extend([
        emitter(vec3(9.0, 6.0, 3.0)),
        emitter(vec3(2.0, 4.0, 8.0)),
        Material { color: Vec3::splat(0.5), ..material(Diffuse) },
    ]);
    scene.spheres.push(sphere(vec3(-1.5, 1.6, 1.2), 0.4, first));
    let corners = [vec3(1.6, -0.6, 0.9), vec3(1.5, 1.1, 1.6), vec3(1.9, 0.4, -0.5)];
    for (corners, material) in [(corners, first + 1), (ground(9.0, -1.4), first + 2)] {
        scene.triangles.push(triangle(corners, material));
        if !scene.normals.is_empty() {
            scene.normals.push([Vec3::ZERO; 3]);
        }
        if !scene.uvs.is_empty() {
            scene.uvs.push([glam::Vec2::ZERO; 3]);
        }
    }
    Scene {
        resolution: [24, 16],
        max_bounces: 3,
        sky: Sky::Gradient { bottom: Vec3::splat(0.1), top: Vec3::splat(0.3) },
        ..scene
    }
}

const RUNS: u32 = 24;
/// Parts of the picture: columns and rows.
const PARTS: [usize; 2] = [3, 2];

/// Means of the whole picture and of its parts.
fn means(picture: &Picture) -> Vec<f64> {
    let (width, height) = (picture.width as usize, picture.height as usize);
    let mut sums = vec![(0.0, 0.0); 1 + PARTS[0] * PARTS[1]];
    for (at, pixel) in picture.pixels.iter().enumerate() {
        let part = at / width * PARTS[1] / height * PARTS[0] + at % width * PARTS[0] / width;
        // Nothing here is brighter than the lamps, but what meets them by chance alone is noise that says
        // nothing.
        let value = f64::from(pixel[0] + pixel[1] + pixel[2]);
        for of in [0, 1 + part] {
            sums[of].0 += value;
            sums[of].1 += 1.0;
        }
    }
    sums.into_iter().map(|(sum, count)| sum / count).collect()
}

/// For each of [`means`], the runs' average and its standard error.
fn runs(scene: &Scene, methods: Methods, samples: u32, first_seed: u32) -> Vec<(f64, f64)> {
    let of_runs: Vec<Vec<f64>> = (0..RUNS)
        .map(|run| {
            let settings = Settings { methods, seed: first_seed + run, ..Settings::of(scene) };
            means(&render(scene, settings, samples))
        })
        .collect();
    let of = |of: usize| mean_and_error(&of_runs.iter().map(|run| run[of]).collect::<Vec<_>>());
    (0..of_runs[0].len()).map(of).collect()
}

/// How much is rendered: samples with the search (eight times as many without), and the noise that is too
/// much to tell anything, as a share of the mean.
#[derive(Clone, Copy)]
struct Effort {
    samples: u32,
    most_noise: f64,
    shapes: &'static [&'static str],
}

/// Finds what changes a part's mean by some seven standard errors. One of the whole picture is 3 % of its
/// mean at most, and 1 % in most pictures: enough for a missing weight, a pdf of the wrong measure, a light
/// counted twice.
const QUICK: Effort = Effort { samples: 4, most_noise: 0.03, shapes: &["sphere", "mapped smooth"] };
/// As [`QUICK`] in every shape; a standard error is 1.2 % of the mean at most.
const THOROUGH: Effort = Effort { samples: 16, most_noise: 0.012, shapes: &SHAPES };
const SHAPES: [&str; 4] = ["sphere", "smooth", "mapped sphere", "mapped smooth"];

#[test]
fn search_and_spread_change_no_expectation_on_matt_things_and_metal() {
    check(&KINDS[..3], QUICK);
}

#[test]
fn search_and_spread_change_no_expectation_on_coats_lobes_and_glass() {
    check(&KINDS[3..], QUICK);
}

#[test]
#[ignore = "minutes: run by .ci/run"]
fn search_and_spread_change_no_expectation_on_anything() {
    check(&KINDS, THOROUGH);
}

fn check(kinds: &[MaterialKind], effort: Effort) {
    let with = |lights, sampler| Methods { lights, sampler, ..Methods::default() };
    let Effort { samples, most_noise, shapes } = effort;
    let mut deviations = Vec::new();
    for &kind in kinds {
        let all = balls(kind).into_iter().map(lit).zip(SHAPES);
        for (scene, shape) in all.filter(|(_, shape)| shapes.contains(shape)) {
            let sought = runs(&scene, with(LightChoice::On, Sampler::Sobol), samples, 1);
            let by_chance = runs(&scene, with(LightChoice::Off, Sampler::Sobol), 8 * samples, 1001);
            let independent = runs(&scene, with(LightChoice::On, Sampler::Random), samples, 2001);
            for (other, what) in [(by_chance, "by chance"), (independent, "independent numbers")] {
                // Welch's t of each mean, and the relative standard error of the whole.
                let pairs = sought.iter().zip(&other);
                let t: Vec<f64> = pairs.map(|(a, b)| (a.0 - b.0) / a.1.hypot(b.1)).collect();
                let error = sought[0].1.hypot(other[0].1) / sought[0].0;
                println!("{kind:?}, {shape}, {what}: t {:.2}, error {:.2} %", t[0], 100.0 * error);
                let told = format!("{kind:?}, {shape}, {what}");
                assert!(error < most_noise, "{told}: noise that hides everything, {error}");
                deviations.extend(t.into_iter().map(|t| (t, told.clone())));
            }
        }
    }
    // Of 23 and 23 degrees of freedom: tails a little heavier than the normal's.
    let most = 1.15 * allowed(deviations.len());
    for (t, what) in deviations {
        assert!(t.abs() < most, "{what}: {t:.1} standard errors of {most:.1}");
    }
}
