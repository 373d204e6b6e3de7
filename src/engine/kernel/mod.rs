//! Kernels: equations over lanes, from values to (mask, values).
//!
//! Kernels allocate nothing, look nothing up and never panic.

pub mod bsdf;
pub mod normals;
pub mod ray_cone;
pub mod surface;
pub mod texture;

pub use octray_rays::kernel::{ray_box, ray_sphere, ray_triangle, sphere_culling};
