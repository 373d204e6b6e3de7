//! What the program says about itself in figures, and the machine they were taken on.
//!
//! For: [`mod@bench`] (speed of frames), [`rays`] (speed of rays by kind: [`ray_sets`], [`ways`]; for other programs: [`ray_dump`]),
//! [`stats`] (time by stage, tests a ray), [`compare`] (SIMD against scalar, and both against the judge), [`mod@errors`] and [`mod@flip`]
//! (how far a picture is from the true one, in numbers and to the eye), [`Machine`] (what every report of figures
//! carries), [`stability`] (where methods fail), [`features`] (vector instructions: compiled for, and present). May import: everything
//! above it, the judge included.
//! Must never know: command lines, terminals.

pub mod bench;
pub mod compare;
pub mod errors;
pub mod features;
pub mod flip;
pub mod machine;
pub mod ray_dump;
pub mod ray_sets;
pub mod rays;
pub mod stability;
pub mod statistics;
pub mod stats;
pub mod turns;
pub mod ways;

pub use machine::Machine;
