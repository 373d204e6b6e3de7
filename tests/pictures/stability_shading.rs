//! The figures of shading, lamps, sums, cameras and scenes: the naive methods fail as much as is said of
//! them, the default ones as little. (That the default ones keep their bounds in every test case:
//! `stability`.)
//!
//! Each test throws a part of what `octray stability` throws; seeds are fixed. Shares that are a matter of
//! chance are held to a quarter of what was measured, so that another target's roundings do not decide.

use crate::stability;
use octray::measure::stability::{Effort, Point};

/// One method at one place of a test case's axis, with a tenth of the inputs.
fn at(name: &str, method: &str, x: f64) -> Point {
    stability::at(name, method, x, Effort(0.1))
}

/// The naive method fails in at least this share of inputs, the default one never.
#[track_caller]
fn fails_and_holds(name: &str, x: f64, [naive, default]: [&str; 2], least: f64) {
    let [naive, default] = [naive, default].map(|method| at(name, method, x));
    assert!(naive.rate() >= least, "{name} at {x:e}: {}", naive.rate());
    assert_eq!(default.failures, 0, "{name} at {x:e}");
}

fn p99(name: &str, method: &str, x: f64) -> f64 {
    at(name, method, x).p99.expect("an error is measured")
}

#[test]
fn the_arccosine_fails_at_poles_and_the_arcsine_does_not() {
    // The catalogue of methods has 34 % within 1e-3 r. It depends on how far the hit is rounded, and so on
    // where spheres and eyes are: here 41 % within 1e-4 r, and 14 % in the disc of 1e-3 r, most of whose area
    // is at its rim.
    fails_and_holds("textures-poles", 1e-4, ["acos", "arcsine"], 0.3);
    fails_and_holds("textures-poles", 1e-3, ["acos", "arcsine"], 0.1);
    // Clamped it is a number, and the wrong one: √2ε is 3.5e-4.
    fails_and_holds("textures-poles", 1e-4, ["acos", "acos-clamped"], 0.3);
    assert!(p99("textures-poles", "acos-clamped", 1e-4) > 5e-4);
    assert!(p99("textures-poles", "arcsine", 1e-4) < 5e-7);
}

#[test]
fn coordinates_leave_the_picture_at_the_seam_and_far_away() {
    // Every one that lies just before the seam, which is half of them.
    fails_and_holds("textures-seam", 1e-9, ["plus-one", "below-one"], 0.45);
    fails_and_holds("textures-seam", 1e-9, ["minus-floor", "below-one"], 0.45);
    fails_and_holds("textures-far", 1e6, ["integer", "fraction-first"], 0.9);
    fails_and_holds("textures-far", 1e6, ["remainder", "fraction-first"], 0.9);
    fails_and_holds("textures-far", 1e9, ["remainder", "fraction-first"], 0.9);
    let [written, taken] =
        ["as-written", "repeats-taken-away"].map(|method| p99("textures-tiled", method, 1e6));
    assert!(written > 0.05 && taken < 5e-7, "{written:e} {taken:e}");
}

#[test]
fn matt_directions_cancel_unless_the_sphere_is_smaller() {
    // Below the surface, or the zero vector made NaN.
    for apart in [0.0, 1e-7, 1e-5] {
        fails_and_holds("scattering-opposite", apart, ["sum", "smaller-sphere"], 0.2);
    }
}

#[test]
fn normals_for_shading_let_rays_through_or_lose_light_unless_it_is_mirrored() {
    fails_and_holds("scattering-diffuse", 20.0, ["unchecked", "faded"], 0.95);
    fails_and_holds("scattering-diffuse", 3.0, ["absorbed", "faded"], 0.95);
    fails_and_holds("scattering-glossy", 40.0, ["unchecked", "mirrored"], 0.3);
    // The factor of Chiang et al., at the median: 8 % of diffuse light, and the most of many glossy lobes.
    let lost = |name, method, x| at(name, method, x).p50.unwrap();
    assert!(lost("scattering-diffuse", "absorbed-and-shadowed", 20.0) > 0.06);
    assert!(lost("scattering-diffuse", "faded", 20.0).abs() < 0.005);
    for method in ["absorbed", "bent-and-shadowed"] {
        assert!(p99("scattering-glossy", method, 20.0) > 0.5, "{method}");
    }
    assert!(p99("scattering-glossy", "bent", 40.0) > 0.2 && p99("scattering-glossy", "mirrored", 40.0) < 0.1);
}

#[test]
fn lamps_vanish_by_the_cosine_below_a_thousandth() {
    for ratio in [1e-6, 1e-4] {
        fails_and_holds("lights-spheres", ratio, ["cosine", "sine"], 1.0);
    }
    // At 1e-3, 1 − cos θ has three bits, all of them shared by all lamps.
    assert!(p99("lights-spheres", "cosine", 1e-3) > 0.03);
    // A Taylor step cures what is small and leaves a seam at its threshold.
    assert_eq!(at("lights-spheres", "taylor", 1e-6).failures, 0);
    assert!(p99("lights-spheres", "taylor", 1e-2) > 1e-5);
    assert!(p99("lights-spheres", "sine", 1e-2) < 5e-7);
    fails_and_holds("lights-around", 0.5, ["cosine", "sine-and-inside"], 1.0);
    fails_and_holds("lights-around", 0.5, ["cosine-clamped", "sine-and-inside"], 1.0);
    fails_and_holds("lights-triangle", 1e-4, ["angles", "whole-or-area"], 0.2);
    assert!(p99("lights-triangle", "determinant", 1e-4) > 1.0);
    assert!(p99("lights-triangle", "whole-or-area", 1e-4) < 1e-6);
    assert!(p99("lights-quad", "determinants", 1e-4) > 0.1);
    assert!(p99("lights-quad", "whole-or-area", 1e-4) < 1e-6);
    fails_and_holds("lights-edge-on", 1e-5, ["angles", "whole-or-area"], 0.2);
}

#[test]
fn numbers_reach_one_unless_they_are_cut_off() {
    // The 128 largest of 2³² round to 1.
    for naive in ["divided", "divided-in-f64"] {
        fails_and_holds("uniform-largest", 128.0, [naive, "upper-24-bits"], 1.0);
        fails_and_holds("uniform-largest", 256.0, [naive, "upper-24-bits"], 0.45);
    }
}

#[test]
fn plain_sums_drift_and_stall_and_the_film_does_not() {
    // Five parts in a million after a million, at random; the sum stalls at 2²⁴, which is two thirds short of
    // 10⁸ / 2.
    let plain = p99("sums-long", "f32", 1e6);
    assert!((5e-7..5e-5).contains(&plain), "{plain:e}");
    assert!(p99("sums-long", "kahan", 1e6) <= 6e-8);
    assert!(p99("sums-long", "film", 1e6) <= 1e-9);
    let stalled = at("sums-long", "f32", 1e8);
    assert_eq!(stalled.failures, stalled.tested);
    // Beyond single precision the film fails as well: scenes stay below 1e18.
    fails_and_holds("sums-large", 1e30, ["f64", "film"], 0.0);
    assert_eq!(at("sums-large", "film", 1e36).rate(), 1.0);
    for naive in ["f32", "f64"] {
        fails_and_holds("sums-nan", 1e-2, [naive, "film"], 0.99);
    }
}

#[test]
fn thousands_of_reflections_stay_in_the_room_and_keep_their_length() {
    fails_and_holds("mirrors-room", 100.0, ["point-along-ray", "mended-each-eighth"], 0.5);
    fails_and_holds("mirrors-room", 1e4, ["never-mended", "mended-each-eighth"], 0.5);
}

#[test]
fn cameras_far_from_the_origin_and_close_to_walls_see_what_is_there() {
    fails_and_holds("cameras-fov", 0.1, ["corner-in-the-world", "corner-in-f64"], 0.5);
    fails_and_holds("cameras-inside", 1e-5, ["least-t-1e-4", "renderer"], 0.2);
}

#[test]
fn what_is_huge_hides_what_is_small_only_beyond_single_precision() {
    // The naive equation loses the small ball itself, as it does at 1,000 radii of any ball.
    fails_and_holds("scenes-mixed", 1.0, ["naive", "robust"], 0.002);
    fails_and_holds("scenes-mixed", 1e5, ["naive", "robust"], 0.002);
    assert!(at("scenes-mixed", "robust", 1e8).rate() > 0.05, "out of its depth");
}

#[test]
fn surfaces_that_coincide_have_one_winner() {
    for copies in [2.0, 16.0] {
        // All but one of them would be met first as often.
        fails_and_holds(
            "scenes-coplanar",
            copies,
            ["first-met", "lower-index"],
            0.9 * (1.0 - 1.0 / copies) - 0.1,
        );
    }
}
