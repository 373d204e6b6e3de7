//! Triangles.

mod compact;
mod conservative;
mod leaf;
mod list;

pub(crate) use compact::MIN_LEAVES_PER_THREAD;
pub use compact::{Layout, TriangleLeaves};
pub use conservative::{Candidate, sheared_error};
pub use leaf::{TriangleLeaf, box_of, intersect_one};
pub use list::List;

use crate::kernel::surface::triangle_normal;
use crate::math::Vec3;

/// Returns the point with the barycentric weights `u` and `v`, and the geometric unit normal.
pub fn surface([a, b, c]: [glam::Vec3; 3], [u, v]: [f32; 2]) -> (Vec3<f32>, Vec3<f32>) {
    let [first, ab, ac] = [a, b - a, c - a].map(Vec3::splat);
    (ab.mul_add(u, ac.mul_add(v, first)), Vec3::splat(triangle_normal([a, b, c])))
}

/// Returns the first vertex, and the unit normal of the triangle's plane.
pub fn plane(vertices: [glam::Vec3; 3]) -> (glam::DVec3, glam::DVec3) {
    let [a, b, c] = vertices.map(|vertex| vertex.as_dvec3());
    (a, (b - a).cross(c - a).normalize())
}

/// Returns the distance of a point from a triangle's plane.
pub fn distance(vertices: [glam::Vec3; 3], point: glam::DVec3) -> f64 {
    let (a, normal) = plane(vertices);
    (point - a).dot(normal).abs()
}
