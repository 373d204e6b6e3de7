//! The engine: a scene as structure-of-arrays buffers, and all that turns it into a film.

#![forbid(unsafe_code)]

pub mod adaptive;
pub mod buffers;
pub mod bvh;
pub mod camera;
pub mod display;
pub mod film;
pub mod integrate;
pub mod kernel;
pub mod lane;
pub mod light_sampling;
pub mod math;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod threads;
pub mod tone;
pub mod traverse;
