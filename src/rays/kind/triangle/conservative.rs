//! Finds the triangles of a leaf that a ray in real numbers may hit, by a ray and vertices in f32.

use super::leaf::TriangleLeaf;
use crate::kernel::ray_triangle::{ORDERS, StoredWoopRay};
use crate::lane::{Lane, Mask, Native};
use crate::math::{EPSILON, Vec3};

/// Returns δ, the error of a sheared component, for a ray and vertices whose M is `room`.
///
/// Let M be |o|∞ of the ray plus the largest coordinate of a vertex, and ε one rounding. The ray's origin,
/// its direction and the vertices are those of the real ray and triangle up to ε of each component. A vertex
/// relative to the origin is then off by 2 ε M along each axis, the shear by 4 ε, and it is at most 1. The
/// sheared x and y are off by 8 ε M, and 3 ε M by the roundings of product and sum, 11 ε M in all, less than
/// δ = 16 ε M.
///
/// With sheared components up to r, the edge function p × q is off by 4 r · 11 ε M + 2 (11 ε M)² by these,
/// and 4 ε r² ≤ 8 r ε M by its own roundings: less than 4 δ r + 2 δ², even where that is rounded. A line
/// passes a closed triangle only if the real edge functions have no two signs.
pub fn sheared_error(room: f32) -> f32 {
    16.0 * EPSILON * room
}

impl TriangleLeaf {
    /// Returns the triangles that the ray may hit before `end`, one bit each: all that it does, and few
    /// others. `delta` is the ray's [`sheared_error`].
    ///
    /// The hit is between the depths of the vertices, each z · (1 / d). They are off by √3 (2 + 3) ε M < δ,
    /// for a direction of unit length.
    #[inline(always)]
    pub fn conservative_candidates(&self, woop: StoredWoopRay, delta: &f32, end: f32) -> u32 {
        let [x, y, z] = ORDERS[(woop.z_axis & 3) as usize];
        let (origin, shear): (Vec3<Native>, Vec3<Native>) = (woop.origin.broadcast(), woop.shear.broadcast());
        let vertex = |vertex: usize| {
            let row = |axis: usize| Native::load(&self.vertices[vertex][axis]);
            let z = origin.z - row(z);
            (shear.x.mul_add(z, row(x) - origin.x), shear.y.mul_add(z, row(y) - origin.y), z * shear.z)
        };
        let [a, b, c] = [vertex(0), vertex(1), vertex(2)];
        let (near, far) = (a.2.min(b.2).min(c.2), a.2.max(b.2).max(c.2));
        let edge = |p: (Native, Native, Native), q: (Native, Native, Native)| p.0 * q.1 - p.1 * q.0;
        let [u, v, w] = [edge(c, b), edge(a, c), edge(b, a)];
        let (least, most) = (u.min(v).min(w), u.max(v).max(w));
        let larger = |p: (Native, Native, Native)| p.0.abs().max(p.1.abs());
        let largest = larger(a).max(larger(b)).max(larger(c));
        let delta = Native::broadcast(delta);
        let bound = delta * Native::splat(4.0) * (largest + delta);
        // NaN in unused lanes is no candidate.
        let is_within = (near - delta).le(Native::splat(end)) & (-delta).le(far);
        (is_within & ((-bound).le(least) | most.le(bound))).bitmask()
    }
}
