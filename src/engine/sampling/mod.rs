//! Sample values and the directions made from them.
//!
//! For: [`random`], values that are a function of (seed, pixel, sample, dimension) and of nothing else;
//! [`sobol`], Owen-scrambled Sobol points, which are that too; [`Sampler`], the choice between both;
//! [`dimension`], the dimensions of a path; and [`warp`], which maps the unit square to directions.
//! May import: `lane`, `math`.
//! Must never know: scenes, materials.

pub mod dimension;
pub mod random;
mod sampler;
pub mod sobol;
pub mod warp;

pub use sampler::{SampleTable, SampleValues, Sampler};
