//! The law of stability: in every test case of `octray stability` the default method keeps its bounds, and
//! others fail at least as much as is said of them. Each test throws a part of what the command throws; seeds
//! are fixed. A share that is expected is lowered by five standard deviations of its count, or raised by as
//! many and three.
//!
//! The figures are those that were measured before this program was written, without FMA. Where a build with
//! FMA differs much, both are given.

use octray::measure::stability::{Bound, Effort, Outcome, Point, test_case, test_cases};

/// Test cases in which no method is much worse than the default, or which show what its certainty costs.
const NOTHING_FAILS: [&str; 3] = ["spheres-inside", "triangles-far", "boxes-beside"];

#[test]
fn default_methods_keep_their_bounds_in_every_test_case_and_others_do_not() {
    // Sums of 10⁸ numbers take seconds, however small the share; `stability_shading` holds the film to a
    // million.
    check_test_cases(Effort(0.01), &["sums-long"]);
}

#[test]
#[ignore = "minutes: run by .ci/run"]
fn default_methods_keep_their_bounds_in_every_test_case_with_more_cases() {
    check_test_cases(Effort(0.05), &[]);
}

fn check_test_cases(effort: Effort, without: &[&str]) {
    for test_case in test_cases().filter(|test_case| !without.contains(&test_case.name)) {
        let outcome = test_case.run(effort, &|| {});
        let faults: Vec<&Point> = outcome.faults().collect();
        assert!(faults.is_empty(), "{}: {faults:?}", test_case.name);
        assert_eq!(others_fail(&outcome), !NOTHING_FAILS.contains(&test_case.name), "{}", test_case.name);
    }
}

/// Would any method but the default break the default's bounds?
fn others_fail(outcome: &Outcome) -> bool {
    let default = outcome.curves.iter().find(|curve| curve.default).expect("one is the default");
    outcome.curves.iter().filter(|curve| !curve.default).any(|curve| {
        let held = curve.points.iter().zip(&default.points);
        held.map(|(point, of)| Point { bound: of.bound, ..point.clone() }).any(|point| !point.holds())
    })
}

/// One method at one place of a test case's axis.
pub fn at(name: &str, method: &str, x: f64, effort: Effort) -> Point {
    let test_case = test_case(name).unwrap_or_else(|| panic!("a test case {name}"));
    let of = test_case.method(method).unwrap_or_else(|| panic!("a method {method} of {name}"));
    let point = test_case.at(of, x, effort);
    println!("{name}, {method} at {x:e}: {:.4} %, p99 {:?}", 100.0 * point.rate(), point.p99);
    point
}

/// Fails for so many per cent at least, and is off by so much.
#[track_caller]
fn at_least(name: &str, method: &str, x: f64, percent: f64, p99: f64) {
    let point = at(name, method, x, Effort(0.5));
    let expected = percent / 100.0 * point.tested as f64;
    let told = format!("{name}, {method} at {x:e}: {point:?}; expected {percent} % and {p99:e}");
    assert!(point.failures as f64 >= expected - 5.0 * expected.sqrt(), "{told}");
    assert!(point.p99.unwrap_or(0.0) >= p99, "{told}");
    assert!(percent == 0.0 || point.failures > 0, "{name}, {method} at {x:e}: too few inputs to tell");
}

/// Fails for so many per cent at most, and is off by no more.
#[track_caller]
fn at_most(name: &str, method: &str, x: f64, percent: f64, p99: f64) {
    let point = at(name, method, x, Effort(0.5));
    let told = format!("{name}, {method} at {x:e}: {point:?}; expected {percent} % and {p99:e} at most");
    let bound = Some(Bound { failures: percent / 100.0, p99: Some(p99) });
    assert!(Point { bound, ..point }.holds(), "{told}");
}

const FMA: bool = cfg!(target_feature = "fma");
/// Where only failures are counted.
const ANY: f64 = f64::INFINITY;

/// How often the school formula fails depends on where on the sphere of radius D the rays start (the rounding
/// of |o|²); all directions together give 0.057, 4.6, 30 and 40 % without FMA, so 85 % of the figures is
/// required. FMA spares it some roundings (0.050, 3.6, 29 and 38 %): 75 %. The p99 of 10⁵ hits scatters by
/// some percent; a quarter is allowed.
#[test]
fn far_spheres_are_misjudged_by_the_school_formula_and_not_by_the_robust_one() {
    for (distance, (naive, naive_p99), (robust, robust_p99)) in [
        (100.0, (0.066, 5e-3), (0.0001, 1.8e-5)),
        (1000.0, (4.5, 0.33), (0.0011, 1.6e-4)),
        (4096.0, (34.0, 1.7), (0.0015, 6e-4)),
        (1e5, (42.0, 0.0), (0.12, 2e-2)),
        (1e6, (45.0, 0.0), (1.2, 0.2)),
    ] {
        let share = if FMA { 0.75 } else { 0.85 };
        at_least("spheres-far", "naive", distance, share * naive, 0.85 * share * naive_p99);
        at_most("spheres-far", "robust", distance, robust, 1.25 * robust_p99);
        at_most("spheres-far", "robust-any-length", distance, robust, 1.25 * robust_p99);
    }
}

/// What f32 can do: c = |o − c|² − r² is a small difference of large numbers, whose rounding grows with the
/// radius.
#[test]
fn huge_spheres_from_close_by_are_as_inexact_as_documented() {
    for (radius, robust) in [(1e3, 7.6e-5), (1e5, 8.5e-3), (1e6, 0.06)] {
        at_most("spheres-huge", "robust", radius, 0.0, 1.25 * robust);
        at_most("spheres-huge", "robust-any-length", radius, 0.0, 1.25 * robust);
    }
    // The school formula takes the wrong root here.
    at_least("spheres-huge", "naive", 1e7, 2.0, 0.0);
}

#[test]
fn spheres_are_undecided_only_next_to_their_silhouette() {
    for off in [20.0, 100.0] {
        at_least("spheres-tangent", "naive", off, 8.0, 0.0);
        at_most("spheres-tangent", "robust", off, 0.0, ANY);
        at_most("spheres-tangent", "robust-any-length", off, 0.0, ANY);
    }
    at_least("spheres-tangent", "robust", 0.1, 2.0, 0.0);
}

#[test]
fn any_length_holds_for_every_length_of_the_direction_and_robust_for_unit_length() {
    for length in [1e-15, 1e-6, 0.3, 7.0, 1e6, 1e15] {
        at_most("spheres-lengths", "robust-any-length", length, 0.0001, 1.25 * 1.8e-5);
        at_least("spheres-lengths", "robust", length, 60.0, 0.0);
        at_least("spheres-lengths", "naive", length, 0.03, 3e-3);
    }
    at_most("spheres-lengths", "robust", 1.0, 0.0, 1.25 * 1.8e-5);
    at_most("spheres-inside", "naive", 1e-6, 0.0, 1e-6);
    at_least("spheres-scale", "naive", 1e-6, 0.03, 3e-3);
}

/// Measured on another mesh. Without FMA this one gives 10, 8 and 0.3 % as well; with it, Möller–Trumbore's
/// test leaks twice as much: FMA makes the two triangles of an edge round differently.
#[test]
fn closed_meshes_leak_at_edges_and_vertices_but_not_with_woop() {
    for (size, place) in
        [(1.0, "mesh-edges"), (1e3, "mesh-edges"), (1.0, "mesh-offset"), (1e4, "mesh-offset")]
    {
        // Far from the origin, where vertices round to a coarse grid, 8.5 % without FMA.
        at_least(place, "moller-trumbore", size, if size == 1e4 { 8.0 } else { 9.8 }, 0.0);
        at_least(place, "baldwin-weber", size, 5.0, 0.0);
        at_most(place, "plucker", size, 0.0, ANY);
        if FMA {
            at_least(place, "woop-contracted", size, 0.2, 0.0);
        } else {
            at_most(place, "woop-contracted", size, 0.0, ANY);
        }
        at_most(place, "woop", size, 0.0, ANY);
    }
    at_least("mesh-vertices", "moller-trumbore", 1.0, 8.2, 0.0);
    at_least("mesh-vertices", "baldwin-weber", 1.0, 3.0, 0.0);
    at_least("mesh-vertices", "plucker", 1.0, 0.35, 0.0);
    at_most("mesh-vertices", "woop-contracted", 1.0, 0.0, ANY);
    at_most("mesh-vertices", "woop", 1.0, 0.0, ANY);
    // Random rays show nothing.
    for method in ["woop", "woop-contracted", "moller-trumbore", "baldwin-weber", "plucker"] {
        at_most("mesh-random", method, 1.0, 0.0, ANY);
    }
}

#[test]
fn an_epsilon_on_the_determinant_makes_small_meshes_vanish() {
    for name in ["mesh-edges", "mesh-vertices", "mesh-random"] {
        let point = at(name, "moller-trumbore-epsilon", 1e-3, Effort(0.5));
        assert_eq!(point.failures, point.tested, "{name}");
        at_most(name, "woop", 1e-3, 0.0, ANY);
    }
}

/// FMA helps Möller–Trumbore a little.
#[test]
fn slivers_and_grazing_rays_cost_woop_less_than_moller_trumbore() {
    for (aspect, woop, moller_trumbore) in [(1e4, 1e-4, 6e-3), (1e6, 5e-3, 0.18)] {
        at_most("triangles-slivers", "woop", aspect, 25e-6 * aspect, woop);
        at_least(
            "triangles-slivers",
            "moller-trumbore",
            aspect,
            20e-6 * aspect.min(1e5),
            0.7 * moller_trumbore,
        );
    }
    at_least("triangles-grazing", "moller-trumbore", 1e-6, 7.0, 2e-7);
    at_most("triangles-grazing", "woop", 1e-6, 7.0, 2e-7);
    at_least("triangles-far", "moller-trumbore", 1e5, 0.6, 0.0);
    at_most("triangles-far", "woop", 1e5, 0.8, 4e-7);
}

/// Three lengths are multiplied: see the domain of `Woop`.
#[test]
fn triangles_beyond_the_domain_are_missed() {
    for size in [1e-12, 1e12] {
        at_most("triangles-scale", "woop", size, 0.0, 3e-7);
    }
    at_least("triangles-scale", "woop", 1e-15, 1.0, 0.1);
    at_least("triangles-scale", "woop", 1e15, 10.0, 0.0);
    at_most("triangles-scale", "baldwin-weber", 1e15, 0.0, 3e-7);
}

/// The rays start elsewhere than those of the figures, 9.3, 5.7, 9.0 and 33.7 %: 85 % of these is required.
/// The last one is FMA's: where it is two roundings, it is 25 %.
#[test]
fn boxes_are_missed_at_corners_but_not_with_padding() {
    for (offset, by_sign, fma) in [(1.0, 9.3, 9.0), (1e5, 5.7, if FMA { 33.7 } else { 25.0 })] {
        at_least("boxes-corners", "by-sign", offset, 0.85 * by_sign, 0.0);
        at_least("boxes-corners", "x86-min-max", offset, 0.85 * by_sign, 0.0);
        at_least("boxes-corners", "ieee-min-max", offset, 0.85 * by_sign, 0.0);
        at_least("boxes-corners", "fma", offset, 0.85 * fma, 0.0);
        at_most("boxes-corners", "by-sign-2-ulp", offset, 0.0, 2e-7);
        at_most("boxes-corners", "padded-fma", offset, 0.0, ANY);
        at_least("boxes-scale", "by-sign", 1.0, 2.0, 0.0);
        at_most("boxes-scale", "by-sign-2-ulp", 1.0, 0.0, ANY);
    }
}

#[test]
fn boxes_are_missed_along_their_faces_by_minima_of_nan_and_by_plain_fma() {
    at_least("boxes-faces", "x86-min-max", 0.0, 50.0, 0.0);
    at_least("boxes-faces", "ieee-min-max", 0.0, 100.0, 0.0);
    for method in ["by-sign", "by-sign-2-ulp", "fma", "padded-fma"] {
        at_most("boxes-faces", method, 0.0, 0.0, ANY);
    }
    // Nothing is infinite, but nearly: p / d less the rounded o / d is the rounding of that, t being much
    // less. Where FMA is two roundings, p / d is rounded like o / d, and nothing is left.
    for across in [1e-30, 1e-17, 1e-12] {
        if FMA {
            at_least("boxes-faces", "fma", across, 45.0, 0.0);
        } else {
            at_most("boxes-faces", "fma", across, 0.0, ANY);
        }
        at_most("boxes-faces", "padded-fma", across, 0.0, ANY);
    }
    // The price of certainty, and its end.
    at_least("boxes-beside", "padded-fma", 0.3, 30.0, 0.0);
    at_most("boxes-beside", "padded-fma", 2.0, 0.0, ANY);
    at_most("boxes-beside", "by-sign", 0.3, 0.1, ANY);
}

const PIPELINE: &str = "exact point, error bound";
const NAIVE: &str = "o + t d, no offset";
const LEAST_T: &str = "o + t d, t > 1e-4";
const CONSTANT: &str = "exact point, 1e-4";
const INEXACT: &str = "o + t d, error bound";

/// Half of the rays leave at cosines down to 1e-6. That makes a least t of 1e-4 fail for 10 % where evenly
/// spread directions make it fail for 0.001 %, and rays that start far below a small triangle pass beyond its
/// edge: 33 % instead of 50 and 46.
#[test]
fn triangles_are_hit_again_without_an_error_bound() {
    for (name, x, naive, least_t) in
        [("spawn-place", 1.0, 49.0, 0.001), ("spawn-place", 1e5, 30.0, 30.0), ("spawn-size", 1e3, 49.0, 28.0)]
    {
        at_least(name, NAIVE, x, naive, 0.0);
        at_least(name, LEAST_T, x, least_t, 0.0);
        at_most(name, PIPELINE, x, 0.0, ANY);
    }
    at_least("spawn-slivers", NAIVE, 1e4, 20.0, 0.0);
    at_most("spawn-slivers", PIPELINE, 1e4, 0.0, ANY);
    // A constant that does for a room does not for a landscape.
    at_most("spawn-place", CONSTANT, 1.0, 0.0, ANY);
    at_least("spawn-place", CONSTANT, 1e5, 30.0, 0.0);
}

/// The figures, 0.0013 and 0.046 %, are those of some way; it is the way travelled that counts.
#[test]
fn a_point_along_the_ray_is_the_further_off_the_further_it_came() {
    at_most("spawn-travelled", INEXACT, 1.0, 0.0013, ANY);
    at_least("spawn-travelled", INEXACT, 10.0, 0.02, 0.0);
    at_least("spawn-travelled", INEXACT, 1e3, 30.0, 0.0);
    at_most("spawn-travelled", PIPELINE, 1e3, 0.0, ANY);
}

#[test]
fn spheres_are_hit_again_without_an_error_bound_and_shells_lost_with_a_constant() {
    for name in ["spawn-spheres", "spawn-inwards"] {
        at_least(name, NAIVE, 1.0, 30.0, 0.0);
        at_least(name, CONSTANT, 1e4, 30.0, 0.0);
        for place in [0.0, 1.0, 1e4] {
            at_most(name, PIPELINE, place, 0.0, ANY);
        }
    }
    at_least("spawn-shells", CONSTANT, 3e-5, 99.0, 0.0);
    at_least("spawn-shells", LEAST_T, 3e-5, 70.0, 0.0);
    at_most("spawn-shells", PIPELINE, 3e-5, 0.0, ANY);
    // Half an offset: the test can see the fault of ours too.
    at_least("spawn-shells", PIPELINE, 1e-6, 90.0, 0.0);
}
