//! Kernels: equations over lanes, from values to (mask, values).
//!
//! Kernels allocate nothing, look nothing up and never panic.

pub mod ray_box;
pub mod ray_sphere;
pub mod ray_triangle;
pub mod sphere_culling;
pub mod surface;
