#![forbid(unsafe_code)]
pub mod film;
pub mod lane;
pub mod math;
pub mod reference;
pub mod render;
pub mod sampling;
pub mod scene;
