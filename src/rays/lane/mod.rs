//! Width as a type: one number, eight or sixteen, behind the same arithmetic.
//!
//! # The law
//! Every operation gives the same bits at every width. Therefore no operation is an approximation that only
//! one width has (no `recip`, no `rsqrt`), no function comes from libm, and `min`, `max` and the polynomials
//! are defined once. One thing is not promised: *which* NaN an operation returns (Rust does not promise it
//! either). *That* it returns a NaN is promised.
//!
//! [`Lane::mul_add`] is fused if the target has FMA and rounds twice if it has not, at every width alike
//! ([`FUSED`]). Builds that fuse agree with each other in every bit, and so do builds that do not.
//!
//! A machine with wider vectors gets a new type that implements these traits, and no other new code.

pub mod compaction;
pub mod functions;
mod instructions;
mod packet;
mod permute;
mod scalar;
mod traits;

pub use instructions::prefetch;
pub use packet::{F32x8, F32x16, Mask8, Mask16, U32x8, U32x16};
pub use traits::{Bits, Lane, Mask, lane_indices, set_bits};
/// Eight numbers in double precision: for queries, which have no other width.
pub use wide::f64x8 as F64x8;

/// Whether [`Lane::mul_add`] is fused, because the target has FMA. Films of fused builds differ from those of
/// other builds in their last bits; nothing else about a build changes a film.
pub const FUSED: bool = cfg!(target_feature = "fma");

/// The vector instructions of this build: see the package's first page.
pub const INSTRUCTIONS: &str = match (NATIVE_WIDTH, cfg!(target_feature = "avx2") && FUSED) {
    (16, _) => "AVX-512",
    (_, true) => "AVX2 with FMA",
    (_, false) => "the least that its target has: slow",
};

/// The widths that pictures are rendered with, in ascending order: up to one vector of the build's
/// instruction set.
#[cfg(target_feature = "avx512f")]
pub const WIDTHS: [usize; 3] = [1, 8, 16];
/// The widths that pictures are rendered with, in ascending order: up to one vector of the build's
/// instruction set.
#[cfg(not(target_feature = "avx512f"))]
pub const WIDTHS: [usize; 2] = [1, 8];

/// The widest packet that is one vector of the build's instruction set.
#[cfg(target_feature = "avx512f")]
pub type Native = F32x16;
/// The widest packet that is one vector of the build's instruction set.
#[cfg(not(target_feature = "avx512f"))]
pub type Native = F32x8;

/// The integers of [`Native`].
pub type NativeBits = <Native as Lane>::Bits;
/// The masks of [`Native`].
pub type NativeMask = <Native as Lane>::Mask;

/// The number of lanes of [`Native`].
pub const NATIVE_WIDTH: usize = <Native as Lane>::WIDTH;
