//! From the unit square to directions.

use crate::lane::{Lane, functions::sin_cos_turns};
use crate::math::Vec3;

/// Two unit vectors that make a right-handed orthonormal basis with the unit vector `n`: (tangent, bitangent).
///
/// Error: orthonormal within 4 ε (measured). Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
#[inline(always)]
pub fn basis<L: Lane>(n: Vec3<L>) -> (Vec3<L>, Vec3<L>) {
    let sign = L::one().copysign(n.z);
    let a = -L::one() / (sign + n.z);
    let b = n.x * n.y * a;
    let sign_x = sign * n.x;
    (
        Vec3::new((sign_x * n.x).mul_add(a, L::one()), sign * b, -sign_x),
        Vec3::new(b, (n.y * n.y).mul_add(a, sign), -n.y),
    )
}

/// A unit vector around `n` with density cos θ / π: the direction from the tip of −n to a point on the unit sphere around n's foot.
///
/// Domain: u, v in [0, 1). The sphere is smaller by 4 · 10⁻⁶, which no picture shows: so the sum is never the zero vector, and its
/// cosine with `n` is above rounding error: no direction ever points below the surface.
/// Source: Shirley, Ray Tracing in One Weekend §9.4; Lambert's law by Archimedes' hat-box theorem.
#[inline(always)]
pub fn cosine_hemisphere<L: Lane>(n: Vec3<L>, u: L, v: L) -> Vec3<L> {
    unit_sphere(u, v).mul_add(L::splat(1.0 - 4e-6), n).normalize()
}

/// A point on the unit sphere with density 1 / 4π.
///
/// Domain: u, v in [0, 1).
#[inline(always)]
pub fn unit_sphere<L: Lane>(u: L, v: L) -> Vec3<L> {
    let (sin, cos) = sin_cos_turns(v);
    let z = (L::splat(-2.0)).mul_add(u, L::one());
    // 1 − z² without cancellation: (1 − z)(1 + z) = 2u (2 − 2u)
    let radius = L::splat(2.0) * (u * (L::one() - u)).sqrt();
    Vec3::new(radius * cos, radius * sin, z)
}
