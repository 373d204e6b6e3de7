//! Generates sample values, and directions from them.

pub mod blue_noise;
pub mod dimension;
pub mod random;
mod sampler;
pub mod sobol;
pub mod warp;

pub use blue_noise::PixelCoordinates;
pub use sampler::{PacketValues, SampleTable, SampleValues, Sampler};
