//! Random numbers and the directions made from them.
//!
//! For: [`random`], numbers that are a function of (seed, pixel, sample, dimension) and of nothing else, and [`warp`],
//! which bends the unit square into directions. May import: `lane`, `math`. Must never know: scenes, materials.

pub mod random;
pub mod warp;
