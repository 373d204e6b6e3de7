#![forbid(unsafe_code)]
pub mod buffers;
pub mod camera;
pub mod cli;
pub mod film;
pub mod integrate;
pub mod kernel;
pub mod lane;
pub mod math;
pub mod measure;
pub mod output;
pub mod reference;
pub mod render;
pub mod sampling;
pub mod scene;
pub mod traverse;
