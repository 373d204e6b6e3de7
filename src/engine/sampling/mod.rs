//! Sample values and the directions made from them.
//!
//! For: [`random`], values that are a function of (seed, pixel, sample, dimension) and of nothing else;
//! [`sobol`], Owen-scrambled Sobol points, which are that too; [`blue_noise`], which spreads the errors of
//! neighbouring pixels; [`Sampler`], the choice among the sources; [`dimension`], the dimensions of a path;
//! and [`warp`], which maps the unit square to directions.

pub mod blue_noise;
pub mod dimension;
pub mod random;
mod sampler;
pub mod sobol;
pub mod warp;

pub use blue_noise::PixelCoordinates;
pub use sampler::{PacketValues, SampleTable, SampleValues, Sampler};
