//! The law of the elementary functions: their documented errors and special values are true.
//!
//! Errors are measured against `f64` on every 97th float of the domain and on even steps, at width 1 (width 8
//! has the same bits: `lane_parity`); what is ignored, on every 31st. The bounds hold with FMA and
//! without: see `lane_parity` for the command.

use octray::lane::functions::{approximate_rsqrt, atan2, cos, exp, ln, powf, sin, sin_cos, sin_cos_turns};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};
use std::f64::consts::TAU;
use std::fmt::Debug;

/// The worst of many errors and where it was.
#[derive(Clone, Copy, Debug)]
struct Worst<T> {
    error: f64,
    at: Option<T>,
}

fn worst<T: Copy>(inputs: impl Iterator<Item = T>, error: impl Fn(T) -> f64) -> Worst<T> {
    let mut worst = Worst { error: 0.0, at: None };
    for at in inputs {
        let error = error(at);
        if error > worst.error || error.is_nan() {
            worst = Worst { error, at: Some(at) };
            if error.is_nan() {
                break;
            }
        }
    }
    worst
}

/// The error in units of the distance of neighbouring floats at the exact result.
fn ulps(approximate: f32, exact: f64) -> f64 {
    let exponent = exact.abs().max(f64::from(f32::MIN_POSITIVE)).log2().floor();
    (f64::from(approximate) - exact).abs() / (exponent - 23.0).exp2()
}

/// Every `stride`-th float from `low` to `high`, both positive.
fn floats(low: f32, high: f32, stride: usize) -> impl Iterator<Item = f32> {
    (low.to_bits()..=high.to_bits()).step_by(stride).map(f32::from_bits)
}

/// `count` even steps from `low` to `high`.
fn steps(low: f32, high: f32, count: u32) -> impl Iterator<Item = f32> {
    (0..=count).map(move |i| low + (high - low) * (i as f32 / count as f32))
}

/// Asserts a bound that `lane::functions` documents.
#[track_caller]
fn assert_bound<T: Debug>(name: &str, worst: Worst<T>, bound: f64) {
    println!("{name}: {:.4e} at {:?}", worst.error, worst.at);
    assert!(worst.error <= bound, "{name}: {worst:?}, bound {bound:e}");
    // A bound far above the truth says nothing.
    assert!(worst.error > bound / 2.0, "{name}: {worst:?} is far below the documented {bound:e}");
}

fn check_sin_cos(stride: usize) {
    let even = steps(-8192.0, 8192.0, 4_000_000 / stride as u32 * 97);
    let inputs = floats(1e-30, 8192.0, stride).flat_map(|x| [x, -x]).chain(even);
    let error = |x: f32| {
        let (sin, cos) = sin_cos(x);
        let exact = f64::from(x).sin_cos();
        (f64::from(sin) - exact.0).abs().max((f64::from(cos) - exact.1).abs())
    };
    assert_bound("sin_cos", worst(inputs, error), 1.2e-7);
}

const SIN_COS_TURNS: f64 = 8e-7;

fn check_sin_cos_turns(stride: usize) {
    let inputs = floats(1e-30, 1.0, stride).chain(steps(0.0, 1.0, 1 << 22));
    let error = |u: f32| {
        let (sin, cos) = sin_cos_turns(u);
        let exact = (f64::from(u).fract() * TAU).sin_cos();
        (f64::from(sin) - exact.0).abs().max((f64::from(cos) - exact.1).abs())
    };
    assert_bound("sin_cos_turns", worst(inputs, error), SIN_COS_TURNS);
}

fn check_atan2(stride: usize) {
    // The error depends on the quotient alone, up to rounding: all quotients, in each of the eight octants,
    // at several lengths.
    let quotients = || floats(1e-6, 1.0, stride);
    let inputs = [1.0, 0.37, 1e-15, 2.5e20].into_iter().flat_map(move |length: f32| {
        quotients().flat_map(move |q| {
            let (long, short) = (length, q * length);
            [(short, long), (long, short), (short, -long), (-long, short), (-short, -long), (-long, -short)]
        })
    });
    let error = |(y, x): (f32, f32)| ulps(atan2(y, x), f64::from(y).atan2(f64::from(x)));
    assert_bound("atan2", worst(inputs, error), 3.0);
}

fn check_exp(stride: usize) {
    let inputs = floats(1e-10, 88.722_83, stride)
        .chain(floats(1e-10, 87.336_53, stride).map(|x| -x))
        .chain(steps(-87.3, 88.7, 4_000_000));
    assert_bound("exp", worst(inputs, |x| ulps(exp(x), f64::from(x).exp())), 1.2);
}

fn check_ln(stride: usize) {
    // Near 1, where the logarithm vanishes, all the more densely.
    let inputs = floats(f32::from_bits(1), f32::MAX, stride).chain(floats(0.5, 2.0, stride.div_ceil(16)));
    assert_bound("ln", worst(inputs, |x| ulps(ln(x), f64::from(x).ln())), 0.9);
}

fn check_approximate_rsqrt(stride: usize) {
    let error = |x: f32| (f64::from(approximate_rsqrt(x)) * f64::from(x).sqrt() - 1.0).abs();
    assert_bound("approximate_rsqrt", worst(floats(f32::MIN_POSITIVE, f32::MAX, stride), error), 1.8e-3);
}

fn check_powf(stride: usize) {
    let bases = || floats(f32::from_bits(1), f32::MAX, stride * 10_007);
    let inputs = bases().flat_map(|x| {
        let ln = f64::from(x).ln();
        // Exponents whose results cover the range of normal numbers.
        (-170..=170).map(move |i| (x, (0.513 * f64::from(i) / ln) as f32))
    });
    let error = |(x, y): (f32, f32)| {
        let exponent = f64::from(y) * f64::from(x).ln();
        let exact = exponent.exp();
        if !(y.is_finite() && (-87.3..88.7).contains(&exponent)) {
            return 0.0;
        }
        (f64::from(powf(x, y)) / exact - 1.0).abs() / (1.0 + exponent.abs())
    };
    assert_bound("powf", worst(inputs, error), 1.5e-7);
}

/// With a stride of inputs for each function.
fn check_all([sin_cos, sin_cos_turns, atan2, exp, ln, powf, rsqrt]: [usize; 7]) {
    check_sin_cos(sin_cos);
    check_sin_cos_turns(sin_cos_turns);
    check_atan2(atan2);
    check_exp(exp);
    check_ln(ln);
    check_powf(powf);
    check_approximate_rsqrt(rsqrt);
}

#[test]
fn functions_are_as_accurate_as_documented() {
    check_all([97, 97, 97 * 16, 97, 97 * 8, 97, 97]);
    assert!((1e19..1e20).contains(&approximate_rsqrt(0.0)), "finite");
}

#[test]
#[ignore = "minutes: run by .ci/run"]
fn functions_are_as_accurate_as_documented_on_a_dense_sweep() {
    check_all([31, 31, 97, 31, 31, 31, 31]);
}

fn same(a: f32, b: f32) -> bool {
    a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan())
}

#[test]
fn sin_and_cos_are_the_two_halves_of_sin_cos_and_nan_of_what_is_no_angle() {
    for x in steps(-30.0, 30.0, 1000) {
        assert_eq!((sin(x), cos(x)), sin_cos(x));
    }
    for x in [f32::INFINITY, f32::NEG_INFINITY, f32::NAN] {
        assert!(sin(x).is_nan() && cos(x).is_nan(), "{x}");
    }
    assert_eq!((sin(0.0), cos(0.0)), (0.0, 1.0));
}

#[test]
fn quarter_turns_have_the_right_signs() {
    for (turns, expected) in [(0.0, [0.0, 1.0]), (0.25, [1.0, 0.0]), (0.5, [0.0, -1.0]), (0.75, [-1.0, 0.0])]
    {
        let ((sin, cos), [of_sin, of_cos]): (_, [f32; 2]) = (sin_cos_turns(turns), expected);
        let error = (sin - of_sin).abs().max((cos - of_cos).abs());
        assert!(error < SIN_COS_TURNS as f32, "{turns}: {sin}, {cos}");
    }
}

#[test]
fn atan2_of_zeros_and_infinities_is_as_ieee_says() {
    let (inf, least) = (f32::INFINITY, f32::from_bits(1));
    for (angle, inputs) in [
        (0.0, &[(0.0, 0.0), (0.0, 1.0), (1.0, inf)][..]),
        (PI, &[(0.0, -0.0), (0.0, -1.0), (1.0, -inf)]),
        (FRAC_PI_2, &[(1.0, 0.0), (1.0, -0.0), (inf, 1.0), (f32::MAX, f32::MIN_POSITIVE)]),
        (FRAC_PI_4, &[(inf, inf), (least, least)]),
        (3.0 * FRAC_PI_4, &[(inf, -inf)]),
        (1e-40, &[(1e-40, 1.0)]),
    ] {
        for &(y, x) in inputs {
            let found = [atan2(y, x), atan2(-y, x)];
            assert!(same(found[0], angle) && same(found[1], -angle), "atan2(±{y:?}, {x:?}) = {found:?}");
        }
    }
}

#[test]
fn atan2_never_leaves_half_a_turn() {
    for q in floats(1e-20, 1e20, 100_003) {
        assert!(atan2(q, -1.0) <= PI && atan2(-q, -1.0) >= -PI);
    }
}

/// Asserts results of special values.
#[track_caller]
fn assert_special<T: Copy + Debug>(of: impl Fn(T) -> f32, results: &[(f32, &[T])]) {
    for &(result, inputs) in results {
        inputs.iter().for_each(|&x| assert!(same(of(x), result), "{:?} of {x:?}, not {result:?}", of(x)));
    }
}

#[test]
fn exp_ln_and_powf_of_special_values_are_as_documented() {
    let (inf, nan) = (f32::INFINITY, f32::NAN);
    assert_special(
        exp,
        &[
            (1.0, &[0.0, -0.0, 1e-40]),
            (inf, &[88.722_9, 89.0, 1e30, inf]),
            (0.0, &[-87.4, -104.0, -1e30, -inf]),
            (nan, &[nan]),
        ],
    );
    assert!(exp(88.722_83).is_finite() && exp(-87.336_53) >= f32::MIN_POSITIVE);
    let of_ln: [(f32, &[f32]); 4] =
        [(-inf, &[0.0, -0.0]), (0.0, &[1.0]), (inf, &[inf]), (nan, &[-1.0, -1e-40, -inf, nan])];
    assert_special(ln, &of_ln);
    assert_special(
        |(x, y)| powf(x, y),
        &[
            (1.0, &[(2.0, 0.0), (0.0, 0.0), (inf, 0.0), (nan, 0.0), (-3.0, 0.0), (1.0, 1e30)]),
            (0.0, &[(0.0, 2.0), (inf, -2.0), (2.0, -inf), (0.5, inf), (2.0, -200.0)]),
            (inf, &[(0.0, -2.0), (inf, 2.0), (2.0, inf), (2.0, 200.0)]),
            (nan, &[(-2.0, 2.0), (2.0, nan), (nan, 1.0)]),
        ],
    );
}
