//! Every width of SIMD against scalar, bit for bit; and both against the f64 reference.

use super::quantiles::Rounds;
use super::timed::{Ratio, TimedRenderer, Times};
use crate::film::{Film, Picture};
use crate::lane::WIDTHS;
use crate::lights::LightChoice;
use crate::methods;
use crate::reference::{PathSettings, Reference, Verdict};
use crate::render::{LaneChoice, Methods, PrimaryHit, Renderer, Settings};
use crate::scene::Scene;
use rayon::prelude::*;
use serde::Serialize;
use std::collections::BTreeSet;
use std::time::{Duration, Instant};

/// The comparison of one scene.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Comparison {
    /// Its name.
    pub scene: String,
    /// Pixels of the picture.
    pub pixels: usize,
    /// Samples per pixel.
    pub samples: u32,
    /// The widths that were compared with scalar; the first one is timed.
    pub lanes: Vec<usize>,
    /// Pixels with any bit that differs between scalar and a width of SIMD. 0 expected.
    pub mismatched_pixels: usize,
    /// The first in row order, of the first width that differs.
    pub first_mismatch: Option<Mismatch>,
    /// Samples of all widths that are not finite and so discarded. 0 expected.
    pub discarded_samples: u64,
    /// Speed of the first width over that of scalar on the same threads, if it was timed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speedup: Option<Ratio>,
    /// The traversal of the first width: `linear` where every primitive is tested.
    pub traversal: &'static str,
    /// The first width against the f64 reference.
    pub reference: ReferenceCheck,
}

impl Comparison {
    /// Tests whether a check failed. Pixels must not differ, no sample be discarded, and no primary hit be
    /// wrong unless a chosen method does not promise it.
    pub fn failed(&self, methods: Methods) -> bool {
        let wrong_hits = self.reference.mismatched_hits > 0 && methods.are_robust();
        self.mismatched_pixels > 0 || self.discarded_samples > 0 || wrong_hits
    }
}

/// A pixel that differs between SIMD and scalar, in linear RGB.
#[derive(Clone, Debug, Serialize)]
pub struct Mismatch {
    /// The width of SIMD.
    pub lanes: usize,
    /// Column, from the left.
    pub x: u32,
    /// Row, from the top.
    pub y: u32,
    /// Its mean in packets.
    pub simd: [f32; 3],
    /// Its mean in the scalar renderer.
    pub scalar: [f32; 3],
}

/// The difference from the f64 reference with the same random numbers.
#[derive(Clone, Debug, Default, Serialize)]
pub struct ReferenceCheck {
    /// Root of the mean squared difference of the pixels' channels.
    pub rmse: f64,
    /// Largest difference of a channel. One path that diverges (at an edge, after several bounces) can make
    /// it large.
    pub max_abs: f64,
    /// Primary hits beyond the documented bounds. 0 expected.
    pub mismatched_hits: usize,
    /// Compared pixels: on large meshes not all.
    pub pixels: usize,
    /// Samples of each compared pixel.
    pub samples: u32,
}

/// Memory of a pixel in a comparison: three films, their pictures and the reference's, and primary hits; and
/// in a bench of four engines, which takes more. Measured at 1600×1600: 190, 204.
pub const BYTES_PER_PIXEL: usize = 205;

/// The compared samples also give the speed-up if they take this time together and a turn's time each.
/// Otherwise up to `MOST_ROUNDS` rounds of turns follow, for at most twice this time.
const ENOUGH: Duration = Duration::from_millis(500);
const MOST_ROUNDS: usize = 15;
const TURN: Duration = Duration::from_millis(10);

/// Most tests of the reference, which tests every primitive, on a scene, and most samples of a pixel.
const MOST_TESTS: usize = 2_000_000_000;
const MOST_SAMPLES: u32 = 16;

/// Renders `samples` samples with the scalar renderer and with packets of every width, and compares the
/// pictures with each other and with the reference. `settings` holds for all but lanes. With `timed`, the
/// default width is timed beside scalar.
pub fn compare(scene: &Scene, settings: Settings, samples: u32, timed: bool) -> Comparison {
    let of = |lanes| Settings { lanes, ..settings };
    let default = LaneChoice::Auto.lanes();
    let [mut simd, mut scalar] =
        [default, 1].map(|lanes| TimedRenderer::new(methods::renderer(scene, of(lanes))));
    let start = Instant::now();
    for _ in 0..samples {
        simd.turn(1, Duration::ZERO);
        scalar.turn(1, Duration::ZERO);
    }
    let took = start.elapsed();
    let scalar_picture = scalar.film.picture();
    let mut lanes = vec![default];
    lanes.extend(WIDTHS.into_iter().filter(|&other| other > 1 && other != default));
    let mut mismatches = Mismatches::default();
    let mut discarded_samples = scalar.film.discarded();
    for &lanes in &lanes {
        let other = (lanes != default).then(|| rendered(scene, of(lanes), samples));
        let film = other.as_ref().unwrap_or(&simd.film);
        mismatches.add(lanes, &film.picture(), &scalar_picture);
        discarded_samples += film.discarded();
    }
    if timed && (took < ENOUGH || took / samples < TURN) {
        // Longer turns, in place of those before.
        [&mut simd.times, &mut scalar.times].into_iter().for_each(|times| *times = Times::default());
        for _ in Rounds::until(Instant::now() + ENOUGH * 2, 1, MOST_ROUNDS) {
            simd.turn(usize::MAX, TURN);
            scalar.turn(usize::MAX, TURN);
        }
    }
    // The reference has no next event estimation, so it can only follow paths without.
    let share = share(scene, &settings, samples);
    let methods = Methods { lights: LightChoice::Off, ..settings.methods };
    let to_check = rendered(scene, Settings { methods, ..settings }, share.0).picture();
    Comparison {
        scene: scene.name.clone(),
        pixels: scalar_picture.pixels.len(),
        samples,
        lanes,
        mismatched_pixels: mismatches.pixels.len(),
        first_mismatch: mismatches.first,
        discarded_samples,
        speedup: if timed { Ratio::of(&simd.times, &scalar.times) } else { None },
        traversal: settings.methods.traversal_name(scene, default),
        reference: check_against_reference(scene, &simd.renderer, &to_check, share),
    }
}

fn rendered(scene: &Scene, settings: Settings, samples: u32) -> Film {
    let renderer = methods::renderer(scene, settings);
    let mut film = renderer.film();
    renderer.add_samples(&mut film, samples);
    film
}

/// The pixels in which any width differs from scalar in any bit.
#[derive(Debug, Default)]
pub struct Mismatches {
    /// Indices of the pixels.
    pub pixels: BTreeSet<usize>,
    /// The first mismatch, as in [`Comparison`].
    pub first: Option<Mismatch>,
}

impl Mismatches {
    /// Adds the differences between the pictures of a width and of scalar.
    pub fn add(&mut self, lanes: usize, simd: &Picture, scalar: &Picture) {
        let bits = |pixel: &[f32; 3]| pixel.map(f32::to_bits);
        let pairs = simd.pixels.iter().zip(&scalar.pixels).enumerate();
        for (index, (simd_pixel, scalar_pixel)) in pairs.filter(|(_, (a, b))| bits(a) != bits(b)) {
            let (x, y) = (index as u32 % simd.width, index as u32 / simd.width);
            self.first.get_or_insert(Mismatch { lanes, x, y, simd: *simd_pixel, scalar: *scalar_pixel });
            self.pixels.insert(index);
        }
    }
}

/// Returns how much of a picture is compared with the reference: the samples of a pixel, and every how many
/// pixels one is compared.
fn share(scene: &Scene, settings: &Settings, samples: u32) -> (u32, usize) {
    let [width, height] = settings.resolution.map(|side| side as usize);
    // A sample of every pixel costs about this many tests: the primary hit, and a path of some segments.
    let tests = (width * height * scene.primitives() * 4).max(1);
    let affordable = u32::try_from(MOST_TESTS / tests).unwrap_or(u32::MAX).max(1);
    // Coprime to the width, so that no column is left out.
    let mut stride = tests.div_ceil(MOST_TESTS);
    while gcd(stride, width) > 1 {
        stride += 1;
    }
    (samples.min(MOST_SAMPLES).min(affordable), stride)
}

/// Returns the greatest common divisor (Euclid).
fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Compares a share of a renderer's picture, and its primary hits, with the reference.
fn check_against_reference(
    scene: &Scene,
    renderer: &Renderer,
    picture: &Picture,
    (samples, stride): (u32, usize),
) -> ReferenceCheck {
    let reference = Reference::new(scene);
    let Settings { resolution, max_bounces, seed, methods, .. } = *renderer.settings();
    let settings = PathSettings { resolution, max_bounces, seed, sampler: methods.sampler };
    let mut hits: Vec<PrimaryHit> = renderer.primary_hits(0);
    hits.sort_by_key(|hit| (hit.y, hit.x));
    let checked: Vec<(f64, f64, bool)> = hits
        .par_iter()
        .step_by(stride)
        .map(|hit| {
            let verdicts = [
                reference.check_primary(hit.origin, hit.direction, hit.t, hit.primitive),
                reference.check_weights(hit.origin, hit.direction, hit.primitive, hit.weights),
            ];
            let expected = reference.pixel(settings, hit.x, hit.y, samples);
            let seen = picture.pixels[(hit.y * picture.width + hit.x) as usize];
            let errors = std::array::from_fn::<f64, 3, _>(|c| f64::from(seen[c]) - expected[c]);
            let squares = errors.iter().map(|error| error * error).sum::<f64>();
            let largest = errors.iter().fold(0.0, |largest: f64, error| largest.max(error.abs()));
            (squares, largest, verdicts != [Verdict::Right; 2])
        })
        .collect();
    ReferenceCheck {
        rmse: (checked.iter().map(|(squares, ..)| squares).sum::<f64>() / (3 * checked.len()) as f64).sqrt(),
        max_abs: checked.iter().map(|(_, largest, _)| *largest).fold(0.0, f64::max),
        mismatched_hits: checked.iter().filter(|(.., wrong)| *wrong).count(),
        pixels: checked.len(),
        samples,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::SphereChoice;

    #[test]
    fn comparison_fails_for_pixels_samples_and_hits_but_not_for_naive_hits() {
        let scene = octray_formats::scene::load("builtin:three").unwrap();
        let good = compare(&scene, Settings { resolution: [8, 8], ..Settings::of(&scene) }, 1, false);
        let (default, naive) =
            (Methods::default(), Methods { sphere: SphereChoice::Naive, ..Methods::default() });
        assert!(!good.failed(default));
        assert!(Comparison { mismatched_pixels: 1, ..good.clone() }.failed(naive));
        assert!(Comparison { discarded_samples: 1, ..good.clone() }.failed(naive));
        let hits = ReferenceCheck { mismatched_hits: 1, ..good.reference.clone() };
        let wrong = Comparison { reference: hits, ..good };
        assert!(wrong.failed(default) && !wrong.failed(naive));
    }
}
