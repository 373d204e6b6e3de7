//! Maps the unit square to directions.

use crate::lane::{Lane, functions::sin_cos_turns};
use crate::math::Vec3;

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
