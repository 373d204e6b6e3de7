//! Elementary functions as polynomials over the lane type: the same bits at every width, no libm.
//!
//! Errors are measured against `f64` by `tests/laws/lane_functions.rs`, over dense sweeps of the stated
//! domain; they hold with and without FMA. One ulp is the distance between neighbouring floats at the result.
//!
//! Source of the polynomials: S. Moshier, Cephes Mathematical Library, single precision (sinf, cosf, atanf,
//! expf, logf).

use super::traits::{Bits, Lane};
use std::f32::consts::{FRAC_PI_2, FRAC_PI_4, LOG2_E, PI};

/// ln 2 in two parts. The first has few bits, so that its product with an exponent is exact (Cody & Waite
/// 1980).
const LN_2_HIGH: f32 = 355.0 / 512.0;
const LN_2_LOW: f32 = -2.121_944_4e-4;

/// Evaluates a polynomial by Horner's rule, the highest coefficient first.
#[inline(always)]
pub fn polynomial<L: Lane, const N: usize>(x: L, coefficients: [f32; N]) -> L {
    let mut sum = L::splat(coefficients[0]);
    for &coefficient in &coefficients[1..] {
        sum = sum.mul_add(x, L::splat(coefficient));
    }
    sum
}

/// Returns about 1 / √x, in a sixth of the time of the exact one.
///
/// Domain: 0 and normal floats. At 0 it is 2e19.
/// Error: relative, ≤ 1.8e-3 (measured).
/// Source: C. Lomont, "Fast Inverse Square Root", 2003: half the exponent from a shift, then one step of
/// Newton's method.
#[inline(always)]
pub fn approximate_rsqrt<L: Lane>(x: L) -> L {
    // magic − half = magic + ¬half + 1
    let half = x.to_bits().shr(1);
    let y = L::from_bits((!half).wrapping_add(L::Bits::splat(0x5f37_5a86 + 1)));
    y * (L::splat(-0.5) * x * y).mul_add(y, L::splat(1.5))
}

/// Returns the sine and cosine of an angle in `[−π/4, π/4]`, without reduction.
#[inline(always)]
fn sin_cos_octant<L: Lane>(r: L) -> (L, L) {
    let r2 = r * r;
    let sin = polynomial(r2, [-1.951_529_6e-4, 8.332_161e-3, -1.666_665_5e-1]);
    let sin = (sin * r2).mul_add(r, r);
    let cos = polynomial(r2, [2.443_315_7e-5, -1.388_731_6e-3, 4.166_664_6e-2]);
    let cos = (cos * r2).mul_add(r2, L::splat(-0.5).mul_add(r2, L::one()));
    (sin, cos)
}

/// Returns the sine and cosine of an angle plus `quadrant` · π/2, from those of the angle.
#[inline(always)]
fn rotate_quadrants<L: Lane>(quadrant: L::Bits, sin: L, cos: L) -> (L, L) {
    let one = L::Bits::splat(1);
    let swap = (quadrant & one).equals(one);
    let sin_sign = L::from_bits((quadrant & L::Bits::splat(2)).shl(30));
    let cos_sign = L::from_bits((quadrant.wrapping_add(one) & L::Bits::splat(2)).shl(30));
    (L::select(swap, cos, sin).flip_sign(sin_sign), L::select(swap, sin, cos).flip_sign(cos_sign))
}

/// Returns the sine and cosine of an angle.
///
/// Units: radians.
/// Domain: |x| ≤ 8192; beyond it the error grows; infinite and NaN give NaN.
/// Error: absolute, ≤ 1.2e-7 (measured).
#[inline(always)]
pub fn sin_cos<L: Lane>(x: L) -> (L, L) {
    // π/2 in three parts; the first two have so few bits that their product with k < 2¹³ is exact (Cody &
    // Waite 1980).
    const PARTS: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];
    let k = (x * L::splat(1.0 / FRAC_PI_2) + L::splat(0.5)).floor();
    let mut r = x;
    for part in PARTS {
        r = k.neg_mul_add(L::splat(part), r);
    }
    let (sin, cos) = sin_cos_octant(r);
    rotate_quadrants(k.truncate_to_int(), sin, cos)
}

/// Returns the sine of an angle in radians; domain and error as in [`sin_cos`].
#[inline(always)]
pub fn sin<L: Lane>(x: L) -> L {
    sin_cos(x).0
}

/// Returns the cosine of an angle in radians; domain and error as in [`sin_cos`].
#[inline(always)]
pub fn cos<L: Lane>(x: L) -> L {
    sin_cos(x).1
}

/// Returns the sine and cosine of an angle in turns, without range reduction or choice of quadrant.
///
/// The angle less half a turn, divided by 4, lies in an octant. Two double-angle steps multiply it by 4; the
/// signs of the second add the half turn again.
///
/// Units: turns (1 = 2π).
/// Domain: 0 ≤ u ≤ 1.
/// Error: absolute, ≤ 8e-7 (measured).
#[inline(always)]
pub fn sin_cos_turns<L: Lane>(u: L) -> (L, L) {
    let (sin, cos) = sin_cos_octant((u - L::splat(0.5)) * L::splat(FRAC_PI_2));
    let twice = sin + sin;
    let (sin, cos) = (twice * cos, twice.neg_mul_add(sin, L::one()));
    let twice = sin * L::splat(-2.0);
    (twice * cos, twice.neg_mul_add(sin, -L::one()))
}

/// Returns the arctangent of |q| ≤ tan(π/8), in radians, without reduction.
#[inline(always)]
fn atan_octant<L: Lane>(q: L) -> L {
    let q2 = q * q;
    let p = polynomial(q2, [8.053_744_5e-2, -1.387_768_6e-1, 1.997_771_1e-1, -3.333_295e-1]);
    (p * q2).mul_add(q, q)
}

/// Reduces the range of atan(low / high): returns (numerator, denominator, reduced) with
/// |numerator / denominator| ≤ tan(π/8).
///
/// If `reduced`, π/4 is missing from the arctangent of the quotient: atan(q) = π/4 + atan((q − 1) / (q + 1)).
/// The caller divides, so that one division serves both cases.
///
/// Domain: 0 ≤ low ≤ high.
#[inline(always)]
fn reduce_atan<L: Lane>(low: L, high: L) -> (L, L, L::Mask) {
    const TAN_EIGHTH_PI: f32 = 0.414_213_56;
    let reduced = (high * L::splat(TAN_EIGHTH_PI)).lt(low);
    (L::select(reduced, low - high, low), L::select(reduced, low + high, high), reduced)
}

/// Returns the angle of the point (x, y), as in `f32::atan2`.
///
/// Units: radians, in [−π, π].
/// Domain: all but NaN; zeros and infinities give what IEEE 754 says.
/// Error: ≤ 3 ulp (measured).
#[inline(always)]
pub fn atan2<L: Lane>(y: L, x: L) -> L {
    let (ax, ay) = (x.abs(), y.abs());
    let (low, high) = (ax.min(ay), ax.max(ay));
    let (numerator, denominator, reduced) = reduce_atan(low, high);
    // 0/0 and ∞/∞: both components are equal, and the angle in the octant is 0 or π/4.
    let corner = low.eq(high) & !(low.is_finite() & low.gt(L::zero()));
    let q = L::select(corner, L::zero(), numerator / denominator);
    let reduced = reduced | (corner & low.gt(L::zero()));
    let atan = atan_octant(q);
    let atan = L::select(reduced, atan + L::splat(FRAC_PI_4), atan);
    let atan = L::select(ay.gt(ax), L::splat(FRAC_PI_2) - atan, atan);
    L::select(x.is_sign_negative(), L::splat(PI) - atan, atan).copysign(y)
}

/// Returns the angle of the point (x, y) in turns, without the special cases of [`atan2`].
///
/// Units: turns (1 = 2π), in [−½, ½].
/// Domain: finite, the larger component at least 1e-30; (0, 0) gives 0.
/// Error: see `kernel::surface::latitude_longitude`.
/// Source of the polynomial: Lawson's algorithm, minimax over quotients of up to 1.
#[inline(always)]
pub fn atan2_turns<L: Lane>(y: L, x: L) -> L {
    const CURVE: [f32; 7] = [
        0.001_084_129_6,
        -0.005_348_275,
        0.012_672_498,
        -0.021_061_515,
        0.031_525_116,
        -0.053_026_237,
        0.159_154_33,
    ];
    let (ax, ay) = (x.abs(), y.abs());
    let (low, high) = (ax.min(ay), ax.max(ay));
    let q = low / high.max(L::splat(f32::MIN_POSITIVE));
    let angle = polynomial(q * q, CURVE) * q;
    let angle = L::select(ax.lt(ay), L::splat(0.25) - angle, angle);
    let angle = L::select(x.lt(L::zero()), L::splat(0.5) - angle, angle);
    angle.flip_sign(y)
}

/// Returns the arcsine, in half turns (1 = π).
///
/// Domain: |x| ≤ 0.7071.
/// Error: see `kernel::surface::latitude_longitude`.
/// Source of the polynomial: Lawson's algorithm, minimax over the domain.
#[inline(always)]
pub fn asin_half_turns<L: Lane>(x: L) -> L {
    const CURVE: [f32; 7] = [
        0.037_641_007,
        -0.026_440_024,
        0.024_943_812,
        0.010_700_693,
        0.024_275_774,
        0.053_031_58,
        0.318_310_17,
    ];
    polynomial(x * x, CURVE) * x
}

/// Returns eˣ.
///
/// Domain: all. Results below the smallest normal number are 0; above the largest, +∞. Error: ≤ 1.2 ulp
/// (measured).
#[inline(always)]
pub fn exp<L: Lane>(x: L) -> L {
    const OVERFLOW: f32 = 88.722_84;
    const UNDERFLOW: f32 = -87.336_54;
    let inside = L::select(x.lt(L::splat(UNDERFLOW)), L::splat(UNDERFLOW), x);
    let inside = L::select(inside.gt(L::splat(OVERFLOW)), L::splat(OVERFLOW), inside);
    let k = (inside * L::splat(LOG2_E) + L::splat(0.5)).floor();
    let r = k.neg_mul_add(L::splat(LN_2_HIGH), inside);
    let r = k.neg_mul_add(L::splat(LN_2_LOW), r);
    let p =
        polynomial(r, [1.987_569_1e-4, 1.398_199_9e-3, 8.333_452e-3, 4.166_579_6e-2, 1.666_666_5e-1, 0.5]);
    let p = (p * r).mul_add(r, r) + L::one();
    // 2ᵏ as two factors of about 2^(k/2): k reaches 128, and the largest exponent is 127. 254 is twice the
    // bias; it keeps the sum positive, so that a shift halves it.
    let k = k.truncate_to_int().wrapping_add(L::Bits::splat(254));
    let half = k.shr(1);
    let rest = k.wrapping_add(L::Bits::splat(1)).shr(1);
    let result = p * L::from_bits(half.shl(23)) * L::from_bits(rest.shl(23));
    let result = L::select(x.lt(L::splat(UNDERFLOW)), L::zero(), result);
    let result = L::select(x.gt(L::splat(OVERFLOW)), L::splat(f32::INFINITY), result);
    L::select(x.eq(x), result, x)
}

/// Returns the natural logarithm.
///
/// Domain: all; 0 gives −∞, negative numbers NaN. Error: ≤ 0.9 ulp, near 1 too (measured).
#[inline(always)]
pub fn ln<L: Lane>(x: L) -> L {
    const SCALE: f32 = 8_388_608.0; // 2²³ moves denormals into the normal range.
    let denormal = x.lt(L::splat(f32::MIN_POSITIVE));
    let scaled = L::select(denormal, x * L::splat(SCALE), x);
    let bits = scaled.to_bits();
    // x = m · 2ᵉ with m in [√½, √2)
    let exponent = L::from_int(bits.shr(23)) - L::splat(126.0);
    let exponent = L::select(denormal, exponent - L::splat(23.0), exponent);
    let mantissa = L::from_bits((bits & L::Bits::splat(0x007f_ffff)) | L::Bits::splat(0x3f00_0000));
    let low = mantissa.lt(L::splat(std::f32::consts::FRAC_1_SQRT_2));
    let e = L::select(low, exponent - L::one(), exponent);
    let f = L::select(low, mantissa + mantissa, mantissa) - L::one();
    let f2 = f * f;
    let p = polynomial(
        f,
        [
            7.037_683_6e-2,
            -1.151_461e-1,
            1.167_699_9e-1,
            -1.242_014_1e-1,
            1.424_932_3e-1,
            -1.666_805_8e-1,
            2.000_071_5e-1,
            -2.499_999_4e-1,
            3.333_333e-1,
        ],
    );
    let y = (p * f) * f2;
    let y = e.mul_add(L::splat(LN_2_LOW), y);
    let y = L::splat(-0.5).mul_add(f2, y);
    let result = e.mul_add(L::splat(LN_2_HIGH), f + y);
    let result = L::select(x.eq(L::zero()), L::splat(f32::NEG_INFINITY), result);
    let result = L::select(x.eq(L::splat(f32::INFINITY)), x, result);
    L::select(x.ge(L::zero()), result, L::splat(f32::NAN))
}

/// Returns xʸ as exp(y · ln x).
///
/// Domain: x ≥ 0 (negative x gives NaN); y = 0 gives 1. Error: relative, ≤ 1.5e-7 · (1 + |y · ln x|)
/// (measured).
#[inline(always)]
pub fn powf<L: Lane>(x: L, y: L) -> L {
    let power = exp(y * ln(x));
    L::select(y.eq(L::zero()), L::one(), power)
}
