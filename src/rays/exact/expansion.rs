//! Sums and products of doubles without rounding.
//!
//! An expansion is a sum of doubles that do not overlap, ascending, without zeros. Its sign is that of its
//! last term.
//!
//! Domain: every partial product is a multiple of 2⁻¹⁰⁷⁴ and below 2¹⁰²³: see [`super::DOMAIN`].
//! Source: J. Shewchuk, "Adaptive Precision Floating-Point Arithmetic and Fast Robust Geometric Predicates",
//! Discrete & Computational Geometry 18, 1997: figures 7 (`sum`), 13 (`scaled`) and 15 (`compressed`).

use crate::lane::F64x8;
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Sub};

/// Whether `mul_add` is one instruction; elsewhere it is a slow function.
const HAS_FMA: bool = cfg!(any(target_feature = "fma", target_arch = "aarch64"));

/// One double, or several.
pub trait Doubles:
    Copy + From<f64> + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Returns self · factor + term, rounded once if [`HAS_FMA`].
    fn fused(self, factor: Self, term: Self) -> Self;
}

impl Doubles for f64 {
    #[inline(always)]
    fn fused(self, factor: Self, term: Self) -> Self {
        self.mul_add(factor, term)
    }
}

impl Doubles for F64x8 {
    #[inline(always)]
    fn fused(self, factor: Self, term: Self) -> Self {
        self.mul_add(factor, term)
    }
}

/// Returns a + b, rounded, and the error of the rounding.
#[inline(always)]
pub fn two_sum<T: Doubles>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// Runs [`two_sum`] for |a| ≥ |b|.
#[inline(always)]
pub fn fast_two_sum<T: Doubles>(a: T, b: T) -> (T, T) {
    let sum = a + b;
    (sum, b - (sum - a))
}

/// Returns a · b, rounded, and the error of the rounding.
#[inline(always)]
pub fn two_product<T: Doubles>(a: T, b: T) -> (T, T) {
    let product = a * b;
    if HAS_FMA {
        return (product, a.fused(b, -product));
    }
    let split = |x: T| {
        let big = x * T::from(134_217_729.0);
        let high = big - (big - x);
        (high, x - high)
    };
    let ((a, a_low), (b, b_low)) = (split(a), split(b));
    (product, a_low * b_low - (((product - a * b) - a_low * b) - a * b_low))
}

/// A number as a sum of doubles.
#[derive(Clone, Debug)]
pub struct Expansion(Vec<f64>);

impl Expansion {
    /// Returns a − b.
    pub fn difference(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, -b);
        let mut terms = Vec::with_capacity(2);
        push(&mut terms, low);
        push(&mut terms, high);
        Self(terms)
    }

    /// Returns the sum.
    pub fn plus(&self, other: &Self) -> Self {
        let (mut a, mut b) = (self.0.as_slice(), other.0.as_slice());
        let mut terms = Vec::with_capacity(a.len() + b.len());
        let mut rest = 0.0;
        loop {
            let next = match (a.split_first(), b.split_first()) {
                (None, None) => break,
                (Some((x, others)), Some((y, _))) if x.abs() < y.abs() => (x, a = others).0,
                (Some((x, others)), None) => (x, a = others).0,
                (_, Some((y, others))) => (y, b = others).0,
            };
            let (sum, error) = two_sum(rest, *next);
            rest = sum;
            push(&mut terms, error);
        }
        push(&mut terms, rest);
        Self(terms)
    }

    /// Returns the difference.
    pub fn minus(&self, other: &Self) -> Self {
        self.plus(&other.scaled(-1.0))
    }

    /// Returns the product with one double.
    pub fn scaled(&self, factor: f64) -> Self {
        let mut terms = Vec::with_capacity(2 * self.0.len());
        let mut rest = 0.0;
        for &term in &self.0 {
            let (product, low) = two_product(term, factor);
            let (middle, error) = two_sum(rest, low);
            let (sum, second) = fast_two_sum(product, middle);
            rest = sum;
            push(&mut terms, error);
            push(&mut terms, second);
        }
        push(&mut terms, rest);
        Self(terms)
    }

    /// Returns the product.
    pub fn times(&self, other: &Self) -> Self {
        let mut products = other.0.iter().map(|&term| self.scaled(term));
        let Some(first) = products.next() else { return Self(Vec::new()) };
        products.fold(first, |sum, product| sum.plus(&product))
    }

    /// Returns the same number in as few terms as possible: the last ones alone are accurate.
    pub fn compressed(self) -> Self {
        let mut terms = self.0;
        let mut bottom = terms.len();
        let Some(&last) = terms.last() else { return Self(terms) };
        let mut rest = last;
        for at in (0..terms.len() - 1).rev() {
            let (sum, error) = fast_two_sum(rest, terms[at]);
            rest = sum;
            if error != 0.0 {
                bottom -= 1;
                (terms[bottom], rest) = (sum, error);
            }
        }
        let mut len = 0;
        for at in bottom..terms.len() {
            let (sum, error) = fast_two_sum(terms[at], rest);
            rest = sum;
            if error != 0.0 {
                terms[len] = error;
                len += 1;
            }
        }
        terms.truncate(len);
        terms.push(rest);
        Self(terms)
    }

    /// Returns the sign as the order of the number and 0.
    pub fn sign(&self) -> Ordering {
        sign(self.0.last().copied().unwrap_or(0.0))
    }

    /// Returns the number, compressed, as the sum of two doubles: the relative error is below 2⁻¹⁰⁴.
    pub fn leading(&self) -> (f64, f64) {
        let mut last = self.0.iter().rev().copied();
        (last.next().unwrap_or(0.0), last.next().unwrap_or(0.0))
    }
}

/// Appends a term that is not 0.
#[inline(always)]
fn push(terms: &mut Vec<f64>, term: f64) {
    if term != 0.0 {
        terms.push(term);
    }
}

/// Returns the sign of a double that is not NaN.
pub fn sign(x: f64) -> Ordering {
    x.partial_cmp(&0.0).unwrap_or(Ordering::Equal)
}
