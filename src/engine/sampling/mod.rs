//! Random numbers and the directions made from them.
//!
//! For: [`random`], numbers that are a function of (seed, pixel, sample, dimension) and of nothing else; [`sobol`], points that are
//! that too, and well spread; [`Sampler`], the choice between them; and [`warp`], which bends the unit square into directions. May import:
//! `lane`, `math`. Must never know: scenes, materials.

pub mod random;
mod sampler;
pub mod sobol;
pub mod warp;

pub use sampler::{Numbers, Sampler};
