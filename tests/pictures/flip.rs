//! ꟻLIP is that of its authors' own program.
//!
//! Expected means come from `flip-evaluator` 1.7 (PyPI; NVIDIA's own, in C++ and f32), `evaluate(reference,
//! test, "LDR")` with the pixels per degree of each case, of the same pictures by the same rules as arrays of
//! f32 in [0, 1].

use crate::common::*;
use octray::measure::flip::{Flip, PIXELS_PER_DEGREE};
use octray::scene::srgb_to_linear;

/// A stored value of 0 to 255 at column, row and channel; clamped.
type Rule = fn(i32, i32, usize) -> i32;

/// Numbers without pattern, below 2³².
fn mix(x: i32, y: i32, salt: u32) -> u32 {
    let sum = (x as u32).wrapping_mul(374_761_393).wrapping_add((y as u32).wrapping_mul(668_265_263));
    let h = sum.wrapping_add(salt.wrapping_mul(2_246_822_519));
    let h = (h ^ (h >> 13)).wrapping_mul(1_274_126_177);
    h ^ (h >> 16)
}

fn slopes(x: i32, y: i32, channel: usize) -> i32 {
    [3 * x + y, 40 + 2 * y, 255 - 2 * x][channel]
}
fn noisy(x: i32, y: i32, channel: usize) -> i32 {
    slopes(x, y, channel) + (mix(x, y, channel as u32) % 33) as i32 - 16
}
fn board(x: i32, y: i32, _: usize) -> i32 {
    if (x / 8 + y / 8) % 2 == 0 { 230 } else { 25 }
}
fn disc(x: i32, y: i32, color: i32) -> i32 {
    if (x - 24).pow(2) + (y - 20).pow(2) < 100 { color } else { 120 }
}
fn yellow_disc(x: i32, y: i32, channel: usize) -> i32 {
    disc(x, y, [200, 190, 40][channel])
}
fn blue_disc(x: i32, y: i32, channel: usize) -> i32 {
    disc(x, y, [40, 60, 200][channel])
}
fn night(x: i32, _: i32, channel: usize) -> i32 {
    4 + x / 4 + channel as i32
}

/// The picture that the program shows with these stored values.
fn picture([width, height]: [u32; 2], rule: Rule) -> Picture {
    let radiance = |value: i32| srgb_to_linear(f64::from(value.clamp(0, 255)) / 255.0) as f32;
    let places = (0..height as i32).flat_map(|y| (0..width as i32).map(move |x| (x, y)));
    let pixels = places.map(|(x, y)| [0, 1, 2].map(|channel| radiance(rule(x, y, channel))));
    Picture { width, height, pixels: pixels.collect() }
}

/// Name, size, reference, test, pixels per degree, expected mean.
type Case = (&'static str, [u32; 2], Rule, Rule, f64, f64);

#[test]
fn flip_is_that_of_its_authors_program() {
    let sparks = |x, y, c| if mix(x, y, 7).is_multiple_of(97) { 255 } else { night(x, y, c) };
    let cases: [Case; 11] = [
        ("noise on slopes", [64, 48], slopes, noisy, 67.0, 0.073_251_5),
        ("the same from nearby", [64, 48], slopes, noisy, 30.0, 0.145_323_2),
        ("the same from afar", [64, 48], slopes, noisy, 140.0, 0.046_369_8),
        (
            "a chessboard, a pixel to the left",
            [64, 48],
            board,
            |x, y, c| board(x + 1, y, c),
            67.0,
            0.290_982_9,
        ),
        ("another colour", [48, 40], yellow_disc, blue_disc, 67.0, 0.267_660_2),
        ("the same from nearby", [48, 40], yellow_disc, blue_disc, 20.0, 0.185_585_0),
        ("fireflies at night", [37, 53], night, sparks, 67.0, 0.102_066_7),
        ("less than a filter's width", [3, 2], slopes, noisy, 67.0, 0.110_491_6),
        ("one step of grey", [16, 9], |_, _, _| 128, |_, _, _| 129, 67.0, 0.029_868_8),
        ("black and white", [16, 9], |_, _, _| 0, |_, _, _| 255, 67.0, 0.967_391_8),
        (
            "green and blue",
            [16, 9],
            |_, _, c| i32::from(c == 1) * 255,
            |_, _, c| i32::from(c == 2) * 255,
            67.0,
            1.0,
        ),
    ];
    for (name, size, reference, test, pixels_per_degree, expected) in cases {
        let flip = Flip::with(&picture(size, reference), Tone::default(), pixels_per_degree);
        let seen = flip.against(&picture(size, test));
        println!("{name}: {seen:.7}, expected {expected:.7}, {:.1e} apart", (seen - expected).abs());
        // Both round to f32 at every step; a lightness of 100 has steps of 8e-6.
        assert!((seen - expected).abs() < 2e-5, "{name} at {pixels_per_degree}: {seen} for {expected}");
    }
}

#[test]
fn flip_is_zero_for_the_same_picture_and_the_same_both_ways() {
    let (a, b) = (picture([40, 30], slopes), picture([40, 30], noisy));
    assert_eq!(Flip::of(&a).against(&a), 0.0);
    let there = Flip::of(&a).against(&b);
    assert!((there - Flip::of(&b).against(&a)).abs() < 1e-7);
    assert_eq!(there, Flip::with(&a, Tone::default(), PIXELS_PER_DEGREE).against(&b));
}

#[test]
fn flip_sees_what_the_screen_shows() {
    let dark = picture([16, 16], |_, _, _| 100);
    let mut lamp = dark.clone();
    lamp.pixels.fill([5.0; 3]);
    let mut brighter = lamp.clone();
    brighter.pixels.fill([500.0; 3]);
    assert_eq!(Flip::of(&lamp).against(&brighter), 0.0, "both are white on a screen");
    let darker = Tone { exposure: -4.0, ..Tone::default() };
    assert!(Flip::with(&lamp, darker, PIXELS_PER_DEGREE).against(&brighter) > 0.1);
}
