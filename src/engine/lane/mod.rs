//! Width as a type: one number or eight, behind the same arithmetic.
//!
//! For: the [`Lane`] trait (`f32` and [`F32x8`]), its integers [`Bits`] (`u32` and [`U32x8`]), its masks
//! [`Mask`] (`bool` and [`Mask8`]) with their [`set_bits`], and the elementary functions in [`functions`].
//! May import: `wide` and `bytemuck`; it is the only importer of `wide`.
//! Must never know: vectors, rays, scenes.
//!
//! # The law
//! Every operation gives the same bits at every width. Therefore no operation is an approximation that only
//! one width has (no `recip`, no `rsqrt`), no function comes from libm, and `min`, `max` and the polynomials
//! are defined once. One thing is not promised: *which* NaN an operation returns (Rust does not promise it
//! either). *That* it returns a NaN is promised.
//!
//! [`Lane::mul_add`] is fused where the target has FMA and rounds twice where it has not, at every width
//! alike: one build always agrees with itself, two builds may differ in the last bit.
//!
//! A wider machine gets a new type that implements these traits, not a new tree of code.

pub mod functions;
mod scalar;
mod traits;
mod wide8;

pub use traits::{Bits, Lane, Mask, lane_indices, set_bits};
pub use wide8::{F32x8, Mask8, U32x8};
