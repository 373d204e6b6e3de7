//! Vectors, rays and hits whose components are lanes, and bounds of rounding error.

pub mod portable;
mod precision;
mod ray;
mod vec3;
mod view_frustum;

pub use precision::{BELOW_ONE, EPSILON, gamma};
pub use ray::{Hit, MISS, Ray};
pub use vec3::Vec3;
pub use view_frustum::ViewFrustum;
