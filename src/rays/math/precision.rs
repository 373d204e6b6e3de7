//! Bounds of rounding error.

/// Half the distance from 1 to the next float: the largest relative error of one rounding, 2⁻²⁴.
pub const EPSILON: f32 = f32::EPSILON / 2.0;

/// The largest float below 1.
pub const BELOW_ONE: f32 = 1.0 - EPSILON;

/// Returns the largest relative error of `n` successive roundings, n·ε / (1 − n·ε).
///
/// Source: Higham, Accuracy and Stability of Numerical Algorithms, 2002, lemma 3.1; Pharr et al., PBR 4ed
/// §6.8.1.
pub const fn gamma(n: u32) -> f32 {
    let n_epsilon = n as f32 * EPSILON;
    n_epsilon / (1.0 - n_epsilon)
}
