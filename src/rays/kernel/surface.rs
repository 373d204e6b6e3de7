//! Computes points on surfaces: offsets of ray origins, normals, boxes.
//!
//! A hit point is computed from the surface (barycentrics; the sphere itself), not as `origin + t ·
//! direction`, whose error grows with the distance travelled. A ray leaves from that point moved along the
//! normal by its error bound, not by a constant: far enough to avoid hitting the surface again
//! (self-intersection), and no farther, so that nothing close by is missed.
//!
//! Source: Wächter, Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray Tracing Gems ch.
//! 6, 2019; Pharr et al., PBR 4ed §6.8.

use crate::lane::{Lane, Mask};
use crate::math::{EPSILON, Vec3, gamma};

/// Returns the offset along the normal of rays that leave a sphere.
///
/// Units: scene units. Error: the point is off by at most 4.5 ε (|c| + r), see [`sphere_surface`]; testing
/// the same sphere again computes |o − c|² − r² with a relative error of γ(5), which is a distance of γ(5)/2
/// · r, plus the rounding of o − c of ε (|c| + r) in each component, √3 of that along the normal. The three
/// bounds sum to 8.7 ε (|c| + r) but never occur together: 4 ε suffice (measured, `tests/laws/spawn.rs`).
pub fn sphere_offset(center: glam::Vec3, radius: f32) -> f32 {
    gamma(8) * (center.abs().max_element() + radius)
}

/// Returns the offset along the normal of rays that leave a triangle.
///
/// Units: scene units. Error: the point a + u·ab + v·ac is off by at most γ(4) of the largest coordinates
/// involved, and the watertight test computes t of the plane again with an error of about 10 ε times the
/// largest vertex distance: together 16 ε. That test interpolates t between the vertices, with weights that
/// are off by a few ε |a'||b'||c'| / det (a' to c' the vertices as seen along the ray, det twice the area):
/// on a sliver the interpolated point slides along the triangle, and off a ray that meets it aslant. From
/// within the triangle |a'||b'||c'| is at most a fifth of the longest edge cubed, so one ε of longest³ / 2A
/// covers it; for well-shaped triangles that adds little. Measured: half of the sum suffices,
/// `tests/laws/spawn.rs`.
pub fn triangle_offset(vertices: [glam::Vec3; 3]) -> f32 {
    let largest = vertices.iter().map(|v| v.abs().max_element()).fold(0.0, f32::max);
    let (longest, area) = longest_and_area(vertices);
    let sliver = longest * longest * longest / area;
    EPSILON * (16.0 * (largest + longest as f32) + sliver as f32)
}

/// The distance that [`inset`] keeps between a point and the triangle's edges, in offsets.
const INSET: f32 = 8.0;

/// The largest sum of the barycentric coordinates that [`inset`] demands: on slivers, whose height is some
/// thousand offsets or less, points move by at most this share of an edge.
const MAX_INSET: f32 = 1.0 / 16.0;

/// Returns the longest edge of a triangle and twice its area, in f64: slivers lose their area in f32.
fn longest_and_area(vertices: [glam::Vec3; 3]) -> (f64, f64) {
    let [a, b, c] = vertices.map(|vertex| vertex.as_dvec3());
    let longest = (b - a).length().max((c - b).length()).max((a - c).length());
    (longest, (b - a).cross(c - a).length())
}

/// Returns the barycentric coordinate below which [`inset`] may have to move a point.
pub fn near_edge(vertices: [glam::Vec3; 3], offset: f32) -> f32 {
    let (longest, area) = longest_and_area(vertices);
    let margin = f64::from(INSET * offset) * longest / area;
    // A little more than the largest of the three coordinates of `inset` in f32.
    (margin * 1.001).min(f64::from(MAX_INSET)) as f32
}

/// Moves barycentric coordinates away from a triangle's edges, so that rays that leave the point by `offset`
/// stay on their side of the triangles that share those edges: a closed mesh does not leak.
///
/// At an edge, the offset along one wall's normal, or rounding, leads behind the next wall. From a distance d
/// to the edge, an offset h along the normal is on the inner side of a wall at the angle θ where d sin θ > h
/// cos θ: eight offsets are enough for angles of 8° and more.
///
/// Error: the point moves by at most eight offsets, on slivers by a sixteenth of an edge.
///
/// Inlined: a call takes registers, which costs scenes without a triangle 2 to 5 % of their frames.
#[inline(always)]
pub fn inset<L: Lane>((u, v): (L, L), [ab, ac]: [Vec3<L>; 2], offset: L) -> (L, L) {
    let length = |v: Vec3<L>| v.dot(v).sqrt();
    let per_length = offset * L::splat(INSET) / length(ab.cross(ac));
    let least = [ac - ab, ac, ab].map(|edge| length(edge) * per_length);
    let sum = least[0] + least[1] + least[2];
    let most = L::splat(MAX_INSET);
    let scale = L::select(most.lt(sum), most / sum, L::one());
    let w = L::one() - u - v;
    let inside = |coordinate: L, least: L| coordinate.max(least * scale);
    let (u, v, w) = (inside(u, least[1]), inside(v, least[2]), inside(w, least[0]));
    let norm = L::one() / (u + v + w);
    (u * norm, v * norm)
}

/// Returns a triangle's geometric unit normal, on the side from which its vertices are counter-clockwise.
///
/// The computation is in f64, differences too: slivers and triangles far from the origin need it.
///
/// Domain: triangles with an area.
pub fn triangle_normal(vertices: [glam::Vec3; 3]) -> glam::Vec3 {
    let [a, b, c] = vertices.map(|vertex| vertex.as_dvec3());
    (b - a).cross(c - a).normalize().as_vec3()
}

/// Returns the exact lower and upper corner of a triangle's axis-aligned box.
#[inline(always)]
pub fn triangle_bounds([a, b, c]: [glam::Vec3; 3]) -> [glam::Vec3; 2] {
    [a.min(b).min(c), a.max(b).max(c)]
}

/// Returns the point of a sphere next to `near`, a point close to its surface, and the outward unit normal
/// there, in the lanes of `used`; the other lanes are unspecified.
///
/// A point p of a sphere is moved onto it by 1 / |u|, u = (p − c) / r, and |u|² = 1 + δ. A hit's δ is some ε
/// times the distance over the radius, so that 1 − δ / 2 is 1 / |u| less 3/8 δ², without a root or a
/// division. Both are computed only where |δ| is above 2⁻¹², for spheres some thousand radii away from the
/// ray's origin or from that of space.
///
/// Error: the point is off by at most 4.5 ε (|c| + r), the normal's length by 3 ε (measured, with and without
/// FMA, `tests/laws/spawn.rs`).
#[inline(always)]
pub fn sphere_surface<L: Lane>(
    near: Vec3<L>,
    center: Vec3<L>,
    inverse_radius: L,
    used: L::Mask,
) -> (Vec3<L>, Vec3<L>) {
    let from_center = near - center;
    let unit = from_center * inverse_radius;
    let delta = unit.dot(unit) - L::one();
    let scale = delta.mul_add(L::splat(-0.5), L::one());
    let (point, normal) = (from_center.mul_add(scale, center), unit * scale);
    // The negated comparison is true for NaN, too.
    let far = used & !delta.abs().le(L::splat(f32::powi(0.5, 12)));
    if !far.any() {
        return (point, normal);
    }
    let exact = sphere_normal(from_center);
    let exact_point = exact.mul_add(L::one() / inverse_radius, center);
    (Vec3::select(far, exact_point, point), Vec3::select(far, exact, normal))
}

/// Returns the direction from a sphere's centre as a unit vector.
///
/// On a sphere smaller than one step of its coordinates the point may round to the centre: the result is then
/// the normal of the top, and not NaN.
#[inline(always)]
fn sphere_normal<L: Lane>(mut from_center: Vec3<L>) -> Vec3<L> {
    let squared = from_center.dot(from_center);
    let none = squared.eq(L::zero());
    from_center.y = L::select(none, L::one(), from_center.y);
    from_center * (L::one() / L::select(none, L::one(), squared).sqrt())
}
