//! What the program says about itself in figures, and the machine they were taken on.
//!
//! For: [`mod@bench`] (speed of frames), [`rays`] (speed of rays by kind: [`ray_sets`], [`ways`]),
//! [`stats`] (time by stage, tests a ray), [`compare`] (SIMD against scalar, and both against the judge), [`mod@errors`] and [`mod@flip`]
//! (how far a picture is from the true one, in numbers and to the eye), [`stability`] (where methods fail). May import: everything
//! above it, the judge included.
//! Must never know: command lines, terminals.

pub mod bench;
pub mod chart;
pub mod compare;
pub mod errors;
pub mod flip;
pub mod kernel_set;
pub mod ray_sets;
pub mod rays;
pub mod stability;
pub mod statistics;
pub mod stats;
pub mod turns;
pub mod ways;
