//! Finds the triangles of a leaf that a ray in real numbers may hit, by a ray and vertices in f32.

use super::leaf::TriangleLeaf;
use crate::kernel::ray_triangle::{ORDERS, StoredWoopRay};
use crate::kind::LEAF;
use crate::lane::{Lane, Mask, Native, set_bits};
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

/// A triangle that a ray may hit.
#[derive(Clone, Copy, Debug)]
pub struct Candidate {
    /// The number of the triangle.
    pub primitive: u32,
    /// Bounds of t if the ray's line certainly passes inside the triangle, not at an edge.
    pub t: Option<[f32; 2]>,
}

/// Triangles as a ray sees them.
pub struct Sheared {
    /// The edge functions of the opposite edges, and the bound of their errors.
    edges: [Native; 3],
    bound: Native,
    /// The depths of the vertices, z · (1 / d), and the least and the greatest.
    depths: [Native; 3],
    near: Native,
    far: Native,
}

impl Sheared {
    /// Returns the triangles that the ray may hit before `end`, one bit each: all that it does, and few
    /// others. `delta` is the ray's [`sheared_error`].
    ///
    /// The hit is between the depths of the vertices, which are off by √3 (2 + 3) ε M < δ, for a direction of
    /// unit length.
    #[inline(always)]
    pub fn candidates(&self, delta: &f32, end: f32) -> u32 {
        let Self { edges: [u, v, w], bound, near, far, .. } = *self;
        let (least, most) = (u.min(v).min(w), u.max(v).max(w));
        let delta = Native::broadcast(delta);
        // NaN in unused lanes is no candidate.
        let is_within = (near - delta).le(Native::splat(end)) & (-delta).le(far);
        (is_within & ((-bound).le(least) | most.le(bound))).bitmask()
    }
}

impl TriangleLeaf {
    /// Returns the triangles as a ray sees them.
    #[inline(always)]
    pub fn conservative(&self, woop: StoredWoopRay, delta: &f32) -> Sheared {
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
        let edges = [edge(c, b), edge(a, c), edge(b, a)];
        let larger = |p: (Native, Native, Native)| p.0.abs().max(p.1.abs());
        let largest = larger(a).max(larger(b)).max(larger(c));
        let delta = Native::broadcast(delta);
        let bound = delta * Native::splat(4.0) * (largest + delta);
        Sheared { edges, bound, depths: [a.2, b.2, c.2], near, far }
    }

    /// Calls `visit` with candidates that the ray may hit.
    ///
    /// Where the edge functions are certain, t is that of the triangle's plane at sheared x = y = 0. With g
    /// the gradient of the plane through the computed vertices, and λ the real weights, which are in [0, 1],
    /// the real t differs by g · Σ λ Δ, where Δ are the errors of the sheared x and y, up to 11 ε M: by at
    /// most 11 ε M |g|₁ ≤ 44 ε M r Δz / |D|, for depths that differ by Δz and edge functions of the sum D.
    /// Their roundings change the weights by 36 ε r² / |D| ≤ 72 ε M r / |D| in all. Together this is below
    /// 8 δ r Δz / |D|, twice the bound of the edge functions' errors; the errors of depths and of their mean,
    /// 9 ε M each, are below 2 δ.
    #[inline(always)]
    pub fn visit_candidates(
        &self,
        candidates: u32,
        sheared: &Sheared,
        delta: &f32,
        visit: &mut impl FnMut(Candidate),
    ) {
        let &Sheared { edges: [u, v, w], bound, depths: [a, b, c], near, far } = sheared;
        let delta = Native::broadcast(delta);
        let (least, most) = (u.min(v).min(w), u.max(v).max(w));
        let is_certain = (bound.lt(least) | most.lt(-bound)).bitmask();
        let inverse = Native::one() / (u + v + w);
        let t = u.mul_add(a, v.mul_add(b, w * c)) * inverse;
        let error = (bound * inverse.abs() * (far - near)).mul_add(Native::splat(2.0), delta + delta);
        let (lo, hi) = ((t - error).max(near - delta), (t + error).min(far + delta));
        for lane in set_bits(candidates) {
            let t = (is_certain >> lane & 1 != 0).then(|| [lo.get(lane), hi.get(lane)]);
            visit(Candidate { primitive: self.primitives.primitives[lane & (LEAF - 1)], t });
        }
    }
}
