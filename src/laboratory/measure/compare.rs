//! SIMD against scalar, bit for bit; and both against the judge.

use super::turns::{Ratio, Timed};
use crate::buffers::{Features, LightChoice};
use crate::film::Picture;
use crate::reference::{PathSettings, Reference, Verdict};
use crate::render::{PrimaryHit, Renderer, Settings};
use crate::scene::Scene;
use crate::traverse::Methods;
use rayon::prelude::*;
use serde::Serialize;
use std::time::{Duration, Instant};

/// What a comparison found on one scene.
#[derive(Clone, Debug, Serialize)]
pub struct Comparison {
    pub scene: String,
    pub pixels: usize,
    pub samples: u32,
    /// Pixels of which any bit differs between SIMD and scalar. 0 expected.
    pub mismatched_pixels: usize,
    pub first_mismatch: Option<Mismatch>,
    /// Samples of both that were not finite and were left out. 0 expected.
    pub discarded_samples: u64,
    /// How many times as fast SIMD was as scalar on the same threads; the middle of the rounds.
    pub speedup: f64,
    /// 10 % of the rounds say less than the first, and 10 % more than the second; and how many rounds there were.
    pub speedup_spread: [f64; 2],
    pub speedup_rounds: usize,
    pub reference: Judgement,
}

impl Comparison {
    /// Did a check fail? Pixels must not differ, no sample be left out, and no primary hit be wrong, unless a method was asked for that
    /// promises no such thing.
    pub fn failed(&self, methods: Methods) -> bool {
        let differ = self.mismatched_pixels > 0 && methods.lose_no_hit();
        let wrong_hits =
            self.reference.mismatched_hits > 0 && methods.keep_to_their_primitives() && methods.lose_no_hit();
        differ || self.discarded_samples > 0 || wrong_hits
    }
}

/// A pixel that SIMD and scalar see differently: linear RGB.
#[derive(Clone, Debug, Serialize)]
pub struct Mismatch {
    pub x: u32,
    pub y: u32,
    pub simd: [f32; 3],
    pub scalar: [f32; 3],
}

/// What the judge says, in f64, of the same random numbers.
#[derive(Clone, Debug, Serialize)]
pub struct Judgement {
    /// Root of the mean squared difference of the pixels' channels.
    pub rmse: f64,
    /// Largest difference of a channel. One path that turns off differently (at an edge, after several bounces) can make it large.
    pub max_abs: f64,
    /// Primary hits beyond the documented bounds. 0 expected.
    pub mismatched_hits: usize,
    /// How many of the picture's pixels were judged, and with how many samples: on large meshes not all.
    pub pixels: usize,
    pub samples: u32,
}

/// Memory that a pixel takes in a comparison: two films, their pictures and the judge's, and primary hits. Measured at 4000×4000; no more
/// in a bench of three engines.
pub const BYTES_PER_PIXEL: usize = 155;

/// Samples that take so long together, and as long as a turn each, are rounds enough for the speed-up; otherwise so many rounds of turns follow, until
/// twice the time has passed.
const ENOUGH: Duration = Duration::from_millis(500);
const AGAIN: usize = 15;
const TURN: Duration = Duration::from_millis(10);

/// Most object tests that judging a scene may take, and most samples of a pixel: the judge is naive.
const MOST_TESTS: usize = 2_000_000_000;
const MOST_SAMPLES: u32 = 16;

/// Renders `samples` samples with the scalar path and with packets and compares the pictures and the judge. `settings` holds for
/// all but lanes.
pub fn compare(scene: &Scene, settings: Settings, samples: u32) -> Comparison {
    let at = |lanes| Timed::new(Renderer::new(scene, Settings { lanes, ..settings }));
    let (mut simd, mut scalar) = (at(8), at(1));
    let share = Share::of(scene, &settings, samples);
    let searches = simd.renderer.needs().contains(Features::LIGHTS);
    let mut to_judge = None;
    let start = Instant::now();
    for sample in 1..=samples {
        simd.turn(1, Duration::ZERO);
        scalar.turn(1, Duration::ZERO);
        if sample == share.samples && !searches {
            to_judge = Some(simd.film.picture());
        }
    }
    let (simd_picture, scalar_picture) = (simd.film.picture(), scalar.film.picture());
    let discarded_samples = simd.film.discarded() + scalar.film.discarded();
    if start.elapsed() < ENOUGH || start.elapsed() / samples < TURN {
        time_again(&mut simd, &mut scalar);
    }
    let speedup = Ratio::of(&simd, &scalar).expect("there was a sample, so there was a round");
    let mismatches = mismatches(&simd_picture, &scalar_picture);
    let to_judge = to_judge.unwrap_or_else(|| by_chance(scene, settings, share.samples));
    Comparison {
        scene: scene.name.clone(),
        pixels: simd_picture.pixels.len(),
        samples,
        mismatched_pixels: mismatches.len(),
        first_mismatch: mismatches.first().map(|&index| Mismatch {
            x: index as u32 % simd_picture.width,
            y: index as u32 / simd_picture.width,
            simd: simd_picture.pixels[index],
            scalar: scalar_picture.pixels[index],
        }),
        discarded_samples,
        speedup: speedup.median,
        speedup_spread: speedup.spread,
        speedup_rounds: speedup.rounds,
        reference: judge(scene, &simd.renderer, &to_judge, share),
    }
}

/// The picture without search for lights: the judge finds light by chance alone, and can only follow paths that do so too.
fn by_chance(scene: &Scene, settings: Settings, samples: u32) -> Picture {
    let methods = Methods { lights: LightChoice::Off, ..settings.methods };
    let renderer = Renderer::new(scene, Settings { methods, lanes: 8, ..settings });
    let mut film = renderer.film();
    renderer.add_samples(&mut film, samples);
    film.picture()
}

/// Times rounds of turns that are long enough to mean something, in place of those before.
fn time_again(simd: &mut Timed, scalar: &mut Timed) {
    let start = Instant::now();
    simd.forget_times();
    scalar.forget_times();
    for round in 0..AGAIN {
        if round > 0 && start.elapsed() >= ENOUGH * 2 {
            break;
        }
        simd.turn(usize::MAX, TURN);
        scalar.turn(usize::MAX, TURN);
    }
}

/// Indices of the pixels that differ in any bit.
fn mismatches(a: &Picture, b: &Picture) -> Vec<usize> {
    let bits = |pixel: &[f32; 3]| pixel.map(f32::to_bits);
    let pairs = a.pixels.iter().zip(&b.pixels).enumerate();
    pairs.filter(|(_, (a, b))| bits(a) != bits(b)).map(|(index, _)| index).collect()
}

/// How much of a picture is judged.
#[derive(Clone, Copy)]
struct Share {
    samples: u32,
    /// Every so many-th pixel.
    stride: usize,
}

impl Share {
    fn of(scene: &Scene, settings: &Settings, samples: u32) -> Self {
        let pixels = settings.resolution[0] as usize * settings.resolution[1] as usize;
        // A sample of every pixel costs about this many tests: the primary hit, and a path of some segments.
        let tests = (pixels * (scene.spheres.len() + scene.triangles.len()) * 4).max(1);
        let affordable = u32::try_from(MOST_TESTS / tests).unwrap_or(u32::MAX).max(1);
        // Without a common factor with the width, so that no column is left out.
        let mut stride = tests.div_ceil(MOST_TESTS);
        while common_factor(stride, settings.resolution[0] as usize) > 1 {
            stride += 1;
        }
        Self { samples: samples.min(MOST_SAMPLES).min(affordable), stride }
    }
}

/// The greatest one (Euclid).
fn common_factor(a: usize, b: usize) -> usize {
    if b == 0 { a } else { common_factor(b, a % b) }
}

/// Judges a share of a renderer's picture, and its primary hits.
fn judge(
    scene: &Scene,
    renderer: &Renderer,
    picture: &Picture,
    Share { samples, stride }: Share,
) -> Judgement {
    let reference = Reference::new(scene);
    let Settings { resolution, max_bounces, seed, methods, .. } = *renderer.settings();
    let settings = PathSettings { resolution, max_bounces, seed, sampler: methods.sampler };
    let mut hits: Vec<PrimaryHit> = renderer.primary_hits(0);
    hits.sort_by_key(|hit| (hit.y, hit.x));
    let judged: Vec<(f64, f64, bool)> = hits
        .par_iter()
        .step_by(stride)
        .map(|hit| {
            let verdicts = [
                reference.check_primary(hit.origin, hit.direction, hit.t, hit.primitive),
                reference.check_weights(hit.origin, hit.direction, hit.primitive, hit.weights),
            ];
            let truth = reference.pixel(settings, hit.x, hit.y, samples);
            let seen = picture.pixels[(hit.y * picture.width + hit.x) as usize];
            let errors = std::array::from_fn::<f64, 3, _>(|c| f64::from(seen[c]) - truth[c]);
            let squares = errors.iter().map(|error| error * error).sum::<f64>();
            let largest = errors.iter().fold(0.0, |largest: f64, error| largest.max(error.abs()));
            (squares, largest, verdicts != [Verdict::Right; 2])
        })
        .collect();
    Judgement {
        rmse: (judged.iter().map(|(squares, ..)| squares).sum::<f64>() / (3 * judged.len()) as f64).sqrt(),
        max_abs: judged.iter().map(|(_, largest, _)| *largest).fold(0.0, f64::max),
        mismatched_hits: judged.iter().filter(|(.., wrong)| *wrong).count(),
        pixels: judged.len(),
        samples,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::traverse::{BoxChoice, SphereChoice};

    #[test]
    fn comparison_fails_for_pixels_samples_and_hits_but_not_for_naive_hits() {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let good = compare(&scene, Settings { resolution: [8, 8], ..Settings::of(&scene) }, 1);
        let (default, naive) =
            (Methods::default(), Methods { sphere: SphereChoice::Naive, ..Methods::default() });
        assert!(!good.failed(default));
        assert!(Comparison { mismatched_pixels: 1, ..good.clone() }.failed(naive));
        let unpadded = Methods { boxes: BoxChoice::Fma, ..default };
        assert!(
            !Comparison { mismatched_pixels: 1, ..good.clone() }.failed(unpadded),
            "each way loses its own"
        );
        assert!(Comparison { discarded_samples: 1, ..good.clone() }.failed(naive));
        let hits = Judgement { mismatched_hits: 1, ..good.reference.clone() };
        let wrong = Comparison { reference: hits, ..good };
        assert!(wrong.failed(default) && !wrong.failed(naive));
    }
}
