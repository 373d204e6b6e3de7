//! Elementary functions in f64 with the same bits on every machine.
//!
//! Code that builds scenes uses these functions. Those of the standard library depend on the platform: glibc
//! has other last bits than musl, chooses by the processor, and the compiler evaluates constants with a third
//! library. These are sums and products in a fixed order (the crate `libm`, a translation of musl's). Code
//! that runs per ray has functions over lanes, in [`crate::lane::functions`].

pub use libm::{atan, cos, hypot, log, pow, tan};

/// Returns the sine and cosine of an angle in radians.
pub fn sin_cos(x: f64) -> (f64, f64) {
    libm::sincos(x)
}

/// Returns xⁿ by squaring. `f64::powi` has no fixed order of products.
pub fn powi(mut x: f64, mut n: u32) -> f64 {
    let mut power = 1.0;
    while n > 0 {
        if n & 1 == 1 {
            power *= x;
        }
        x *= x;
        n >>= 1;
    }
    power
}
