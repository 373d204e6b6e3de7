//! Measurements of the engine: speed, image error, agreement of its paths, failures of its methods.

pub mod bench;
pub mod chart;
pub mod compare;
pub mod cores;
mod errors;
pub mod flip;
pub mod kernel_set;
pub mod quantiles;
pub mod ray_sets;
pub mod rays;
pub mod stability;
pub mod stats;
pub mod timed;
pub mod trace;
