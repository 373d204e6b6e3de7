//! Laws of stopping early: decisions are the same whoever computes them, pixels are those of a plain
//! rendering with as many samples, and the error that is promised is the one that is there.

use crate::common::statistics::mean_and_error;
use crate::common::*;
use octray::adaptive::{BLACK_SAMPLES, ErrorEstimate, MAX_BLOCK_ERROR, MAX_SAMPLE_RATIO, Round, Target};
use octray::film::noise::luminance;

/// Sky above a few balls on a chessboard: easy and hard parts.
fn settings(scene: &Scene) -> Settings {
    Settings { resolution: [96, 54], seed: 4, ..Settings::of(scene) }
}

/// Renders to a target, at most `chunk` samples of a tile at a time.
fn film_to(scene: &Scene, settings: Settings, target: Target, chunk: u32) -> Film {
    let renderer = Renderer::new(scene, settings);
    let mut film = renderer.film_with_noise();
    while let Some(round) = target.next(&film) {
        while round.missing(&film).0 > 0 {
            let goal = |tile: usize, had: u32| round.goals[tile].min(had.saturating_add(chunk));
            renderer.sample_tiles_to(&mut film, goal, &());
        }
    }
    film
}

fn bright(pixel: &[f32; 3]) -> f64 {
    luminance(pixel.map(f64::from))
}

const TARGET: Target = Target { error: 0.1, least: 16, most: 4096 };

#[test]
fn decisions_and_bits_are_the_same_for_all_lanes_threads_and_chunks() {
    let scene = load("builtin:chess").unwrap();
    let expected = film_to(&scene, settings(&scene), TARGET, u32::MAX);
    assert!(expected.samples() == 16 && expected.most_samples() >= 64, "some parts stop early");
    for (lanes, threads, chunk) in [(1, 1, u32::MAX), (1, 2, 7), (8, 2, u32::MAX), (8, 3, 1), (8, 1, 5)] {
        let film = film_to(&scene, Settings { lanes, threads, ..settings(&scene) }, TARGET, chunk);
        assert_eq!(film.counts(), expected.counts(), "{lanes} lanes, {threads} threads, chunks of {chunk}");
        assert!(film.picture() == expected.picture() && film.rays() == expected.rays());
    }
    let other = film_to(&scene, Settings { seed: 5, ..settings(&scene) }, TARGET, u32::MAX);
    assert!(other.picture() != expected.picture());
}

#[test]
fn each_pixel_is_that_of_a_plain_rendering_with_its_number_of_samples() {
    let scene = load("builtin:chess").unwrap();
    let film = film_to(&scene, settings(&scene), TARGET, u32::MAX);
    let (pixels, counts) = (film.picture().pixels, film.counts().pixels);
    let mut seen = 0;
    let mut samples = TARGET.least;
    while samples <= TARGET.most && seen < pixels.len() {
        let plain = render(&scene, settings(&scene), samples).pixels;
        let own = (0..pixels.len()).filter(|&at| counts[at] == [samples as f32; 3]);
        seen += own.inspect(|&at| assert_eq!(pixels[at], plain[at], "pixel {at}, {samples} samples")).count();
        samples *= 2;
    }
    assert_eq!(seen, pixels.len(), "counts double from {} on", TARGET.least);
}

#[test]
fn picture_is_a_plain_one_where_nothing_may_stop_early() {
    let scene = load("builtin:spheres").unwrap();
    for samples in [1, 16, 40] {
        let target = Target { error: 1e-4, least: 16, most: samples };
        let film = film_to(&scene, settings(&scene), target, u32::MAX);
        assert_eq!((film.samples(), film.most_samples()), (samples, samples));
        assert_eq!(film.picture(), render(&scene, settings(&scene), samples));
        let reached = ErrorEstimate::of(&film);
        assert!(!target.met(&reached) && reached.rms.is_infinite() == (samples < 4), "{reached:?}");
    }
}

/// The true errors of blocks, as `adaptive` defines its estimate of them, given the truth.
fn true_errors(film: &Film, truth: &Picture) -> Vec<(f64, f64)> {
    let (width, height) = (truth.width as usize, truth.height as usize);
    let picture = film.picture().pixels;
    let mut blocks = Vec::new();
    for (y, x) in (0..height).step_by(16).flat_map(|y| (0..width).step_by(16).map(move |x| (y, x))) {
        let rows = y..(y + 16).min(height);
        let at: Vec<usize> =
            rows.flat_map(|y| (x..(x + 16).min(width)).map(move |x| y * width + x)).collect();
        let mean = at.iter().map(|&at| bright(&truth.pixels[at])).sum::<f64>() / at.len() as f64;
        blocks.push((at, mean));
    }
    let pixels = (width * height) as f64;
    let roots = blocks.iter().map(|(at, mean)| at.len() as f64 * mean.sqrt()).sum::<f64>();
    let floor = octray::adaptive::LUMINANCE_FLOOR * (roots / pixels).powi(2);
    let error = |(at, mean): &(Vec<usize>, f64)| {
        let square = |&at: &usize| {
            let truth = bright(&truth.pixels[at]);
            ((bright(&picture[at]) - truth) / truth.min(*mean).max(floor)).powi(2)
        };
        (at.len() as f64, (at.iter().map(square).sum::<f64>() / at.len() as f64).sqrt())
    };
    blocks.iter().map(error).collect()
}

/// With 2,048 samples the truth's own error is a third of the smaller one that is judged, which it lets
/// appear larger by a twentieth.
#[test]
fn promised_error_is_the_true_one_and_easy_parts_stop_early() {
    check_promised_errors(2_048);
}

/// The truth's own error is a tenth of what is judged.
#[test]
#[ignore = "minutes: run by .ci/run"]
fn promised_error_is_the_true_one_by_a_better_truth() {
    check_promised_errors(16_384);
}

fn check_promised_errors(samples_of_truth: u32) {
    for (name, factor) in [("chess", 1.25), ("spheres", 1.4)] {
        let scene = load(&format!("builtin:{name}")).unwrap();
        let settings = Settings { threads: 2, ..settings(&scene) };
        let truth = render(&scene, Settings { seed: 77, ..settings }, samples_of_truth);
        for error in [0.2, 0.07] {
            let target = Target { error, least: 16, most: 1 << 14 };
            let film = film_to(&scene, settings, target, u32::MAX);
            let reached = ErrorEstimate::of(&film);
            assert!(target.met(&reached), "{name}: {reached:?}");
            let errors = true_errors(&film, &truth);
            let pixels: f64 = errors.iter().map(|(pixels, _)| pixels).sum();
            let rms = (errors.iter().map(|(n, e)| n * e * e).sum::<f64>() / pixels).sqrt();
            let largest = errors.iter().map(|&(_, error)| error).fold(0.0, f64::max);
            // Well spread points have less error than the differences of their samples say.
            let least = reached.rms / (factor * 1.5);
            assert!(rms < factor * reached.rms && rms > least, "{name}: {rms} for {reached:?}");
            assert!(largest < factor * MAX_BLOCK_ERROR * error, "{name}: {largest} in the worst block");
            if name == "chess" && error == 0.07 {
                assert!(film.samples() == 16 && film.most_samples() == 512 && film.mean_samples() < 300.0);
            }
        }
    }
}

#[test]
fn black_blocks_end_but_look_for_light_first() {
    let black = Scene { sky: Sky::Color(Vec3::ZERO), ..empty() };
    for (most, samples) in [(1 << 14, BLACK_SAMPLES), (64, 64)] {
        let target = Target { error: 0.5, least: 16, most };
        let settings = Settings { resolution: [40, 24], ..Settings::of(&black) };
        let film = film_to(&black, settings, target, u32::MAX);
        assert_eq!((film.samples(), film.most_samples()), (samples, samples));
        assert_eq!(ErrorEstimate::of(&film), ErrorEstimate { rms: 0.0, largest: 0.0 });
    }
}

/// A bright speck, far smaller than a pixel, under a calm sky.
fn speck() -> Scene {
    Scene { materials: vec![lamp(3_000.0)], spheres: vec![sphere(Vec3::ZERO, 0.005, 0)], ..empty() }
}

#[test]
fn neighbours_of_noisy_blocks_get_at_least_their_share() {
    let scene = speck();
    let settings = Settings { resolution: [144, 144], ..Settings::of(&scene) };
    let film = film_to(&scene, settings, Target { error: 0.02, least: 16, most: 1 << 12 }, u32::MAX);
    let counts: Vec<u32> = film.counts().pixels.iter().map(|count| count[0] as u32).collect();
    let block = |x: usize, y: usize| counts[16 * y * 144 + 16 * x];
    assert_eq!((block(0, 0), block(4, 4)), (16, 1 << 12), "an easy corner, a hard middle");
    for (x, y) in (0..9).flat_map(|y| (0..9).map(move |x| (x, y))) {
        for (dx, dy) in [(0, 1), (1, 0), (1, 1)] {
            let (x2, y2) = ((x + dx).min(8), (y + dy).min(8));
            let (a, b) = (block(x, y), block(x2, y2));
            assert!(a.max(b) <= MAX_SAMPLE_RATIO * a.min(b), "{a} samples beside {b} at {x}, {y}");
        }
    }
}

/// A scene without rare bright paths. Glass, whose noise has them, is in the version of many seeds.
#[test]
fn stopping_early_darkens_by_less_than_a_hundredth_of_the_target() {
    check_darkening("chess", 0.2, 8);
}

#[test]
#[ignore = "minutes: run by .ci/run"]
fn stopping_early_darkens_by_less_than_a_hundredth_of_the_target_over_many_seeds() {
    check_darkening("chess", 0.2, 24);
    check_darkening("spheres", 0.3, 24);
}

/// Holds the mean luminance over some seeds against that of all pixels having the same number of samples.
fn check_darkening(name: &str, error: f64, seeds: u32) {
    let scene = load(&format!("builtin:{name}")).unwrap();
    let mean = |picture: &Picture| picture.pixels.iter().map(bright).sum::<f64>() / 5184.0;
    let of_seed = |seed| {
        let settings = Settings { seed, threads: 2, ..settings(&scene) };
        let film = film_to(&scene, settings, Target { error, least: 16, most: 4096 }, u32::MAX);
        let unbiased = mean(&render(&scene, settings, 256));
        mean(&film.picture()) / unbiased - 1.0
    };
    let (bias, spread) = mean_and_error(&(0..seeds).map(of_seed).collect::<Vec<_>>());
    assert!(spread < error / 300.0, "{name}: {spread} is too uncertain to tell");
    assert!(bias.abs() < error / 100.0, "{name}: {bias} ± {spread}");
}

#[test]
fn rounds_of_equal_samples_end() {
    let scene = empty();
    let renderer = Renderer::new(&scene, Settings::of(&scene));
    let mut film = renderer.film();
    let round = Round::equal(&film, 3).unwrap();
    assert_eq!((round.missing(&film), round.forecast), ((3, 24 * 16), 3 * 24 * 16));
    renderer.add_samples(&mut film, 3);
    assert_eq!((Round::equal(&film, 3), round.missing(&film)), (None, (0, 0)));
}
