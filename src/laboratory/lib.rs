//! The laboratory: the f64 reference, and what measures the engine's speed, accuracy and stability.

#![forbid(unsafe_code)]

use octray_engine::*;

pub mod measure;
pub mod reference;
