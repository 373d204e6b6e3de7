//! Maps the unit square to directions, a disc, and regular polygons.

use crate::lane::Lane;
use crate::lane::functions::{sin_cos, sin_cos_turns};
use crate::math::Vec3;
use std::f32::consts::FRAC_PI_4;

/// Returns the tangent and bitangent that make a right-handed orthonormal basis with the unit vector `n`.
///
/// Error: orthonormal within 4 ε (measured). Source: Duff et al., "Building an Orthonormal Basis, Revisited",
/// JCGT 2017.
#[inline(always)]
pub fn orthonormal_basis<L: Lane>(n: Vec3<L>) -> (Vec3<L>, Vec3<L>) {
    let sign = L::one().copysign(n.z);
    let a = -L::one() / (sign + n.z);
    let b = n.x * n.y * a;
    let sign_x = sign * n.x;
    (
        Vec3::new((sign_x * n.x).mul_add(a, L::one()), sign * b, -sign_x),
        Vec3::new(b, (n.y * n.y).mul_add(a, sign), -n.y),
    )
}

/// Returns a unit vector in the hemisphere of `n` with pdf cos θ / π: the normalised sum of `n` and a uniform
/// point on the unit sphere.
///
/// The sphere is smaller by 4 · 10⁻⁶, which no image shows. The sum is therefore never the zero vector, and
/// its cosine with `n` is above rounding error: no direction points below the surface.
///
/// Domain: u, v in [0, 1).
/// Source: Shirley, Ray Tracing in One Weekend §9.4; Lambert's law by Archimedes' hat-box theorem.
#[inline(always)]
pub fn sample_cosine_hemisphere<L: Lane>(n: Vec3<L>, u: L, v: L) -> Vec3<L> {
    sample_uniform_sphere(u, v).mul_add(L::splat(1.0 - 4e-6), n).normalize()
}

/// Returns a point on the unit sphere with pdf 1 / 4π.
///
/// Domain: u, v in [0, 1).
#[inline(always)]
pub fn sample_uniform_sphere<L: Lane>(u: L, v: L) -> Vec3<L> {
    let (sin, cos) = sin_cos_turns(v);
    let z = (L::splat(-2.0)).mul_add(u, L::one());
    // 1 − z² without cancellation: (1 − z)(1 + z) = 2u (2 − 2u)
    let radius = L::splat(2.0) * (u * (L::one() - u)).sqrt();
    Vec3::new(radius * cos, radius * sin, z)
}

/// Returns a direction with pdf 1 / (2π (1 − cos α)) within the angle α of a unit vector, and cos θ and sin²
/// θ of the direction's angle θ.
///
/// Domain: u, v in [0, 1).
/// Source: Shirley, Wang, Zimmerman, "Monte Carlo Techniques for Direct Lighting Calculations", ACM TOG
/// 15(1), 1996.
#[inline(always)]
pub fn sample_uniform_cone<L: Lane>(axis: Vec3<L>, one_minus_cos: L, u: L, v: L) -> (Vec3<L>, L, L) {
    let (tangent, bitangent) = orthonormal_basis(axis);
    let drop = u * one_minus_cos;
    let cos = L::one() - drop;
    let sin2 = drop * (L::splat(2.0) - drop);
    let sin = sin2.sqrt();
    let (sin_phi, cos_phi) = sin_cos_turns(v);
    (tangent.mul_add(sin * cos_phi, bitangent.mul_add(sin * sin_phi, axis * cos)), cos, sin2)
}

/// Returns a uniform point of the unit disc.
///
/// Domain: u, v in [0, 1).
/// Error: 2e-7 (derived: that of the sine).
/// Source: Shirley, Chiu, "A Low Distortion Map Between Disk and Square", Journal of Graphics Tools 2(3),
/// 1997.
#[inline(always)]
pub fn sample_concentric_disc<L: Lane>(u: L, v: L) -> (L, L) {
    let (a, b) = (u + u - L::one(), v + v - L::one());
    let wide = b.abs().lt(a.abs());
    let (radius, other) = (L::select(wide, a, b), L::select(wide, b, a));
    let ratio = L::select(radius.eq(L::zero()), L::zero(), other / radius);
    let (sin, cos) = sin_cos(ratio * L::splat(FRAC_PI_4));
    let (along, across) = (radius * cos, radius * sin);
    (L::select(wide, along, across), L::select(wide, across, along))
}

/// Returns a uniform point of the regular polygon in the unit circle with a corner at (0, 1). `next` is the
/// corner to its right, (sin, cos) of 2π / `corners`.
///
/// Domain: u, v in [0, 1).
/// Error: 2e-6 (derived: that of the turn, and of the digits of u that choose no side).
#[inline(always)]
pub fn sample_polygon<L: Lane>(corners: u32, next: [f32; 2], u: L, v: L) -> (L, L) {
    let count = L::splat(corners as f32);
    let side = (u * count).floor();
    // The triangle of the middle, the top and the next corner, turned to the side.
    let from_middle = (u * count - side).sqrt();
    let (x, y) = (L::splat(next[0]) * v, L::splat(next[1] - 1.0).mul_add(v, L::one()));
    let (x, y) = (from_middle * x, from_middle * y);
    let (sin, cos) = sin_cos_turns(side / count);
    (cos.mul_add(x, sin * y), cos.mul_add(y, -sin * x))
}
