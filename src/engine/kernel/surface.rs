//! Texture coordinates and tangents of surfaces.

use crate::lane::Lane;
use crate::lane::functions::{asin_half_turns, atan2_turns};
use crate::math::Vec3;

pub use octray_rays::kernel::surface::*;

/// Returns a triangle's tangent for these texture coordinates, the unit vector along growing u, and +1 if v
/// grows along normal × tangent, −1 if against it. Both are zero if the texture coordinates have no area.
///
/// The computation is in f64, like that of the normal.
pub fn triangle_tangent(vertices: [glam::Vec3; 3], uvs: [glam::Vec2; 3]) -> (glam::Vec3, f32) {
    let [a, b, c] = vertices.map(|vertex| vertex.as_dvec3());
    let [p, q, r] = uvs.map(|uv| uv.as_dvec2());
    let (ab, ac, pq, pr) = (b - a, c - a, q - p, r - p);
    let area = pq.perp_dot(pr);
    if area == 0.0 {
        return (glam::Vec3::ZERO, 0.0);
    }
    // Scaled only by the sign of the area, because only the direction matters.
    let tangent = ((ab * pr.y - ac * pq.y) * area.signum()).normalize_or_zero().as_vec3();
    (tangent, area.signum() as f32)
}

/// Returns the area of a triangle in texture coordinates over its area in space, in 1 / (scene units)².
///
/// The computation is in f64, like that of the normal.
pub fn texture_density(vertices: [glam::Vec3; 3], uvs: [glam::Vec2; 3]) -> f32 {
    let [a, b, c] = vertices.map(|vertex| vertex.as_dvec3());
    let [p, q, r] = uvs.map(|uv| uv.as_dvec2());
    ((q - p).perp_dot(r - p).abs() / (b - a).cross(c - a).length()) as f32
}

/// Returns one texture coordinate of a triangle's corners, less the whole repeats that all three share:
/// interpolation would round away the position within a repeat, by 0.06 repeats near 10⁶. Coordinates
/// in [0, 1) stay unchanged. Confirmed by the test case `textures-tiled`.
pub fn remove_shared_repeats(corners: [f64; 3]) -> [f32; 3] {
    let whole = corners.into_iter().fold(f64::INFINITY, f64::min).floor();
    corners.map(|corner| (corner - whole) as f32)
}

/// Returns longitude and latitude of a unit vector as texture coordinates (equirectangular): u = atan2(z, x)
/// / 2π, unwrapped, in [−½, ½]; v = acos(y) / π from the top, in [0, 1].
///
/// v comes from the arcsine of the smaller of y and the distance from the axis: without a division, defined
/// where rounding makes y exceed 1, and as accurate at the poles as the arctangent.
///
/// Error: ≤ 3e-7 (measured, `tests/laws/kernel_texture.rs`); in v at most a third of that of the length.
#[inline(always)]
pub fn latitude_longitude<L: Lane>(n: Vec3<L>) -> (L, L) {
    let around = n.x.mul_add(n.x, n.z * n.z).sqrt();
    let height = n.y.abs();
    let near_pole = around.lt(height);
    let angle = asin_half_turns(L::select(near_pole, around, height));
    let from_pole = L::select(near_pole, angle, L::splat(0.5) - angle);
    let v = L::select(n.y.lt(L::zero()), L::one() - from_pole, from_pole);
    (atan2_turns(n.z, n.x), v)
}
