//! How surfaces scatter: each function draws a direction and returns it with the weight f · cos θ / pdf.
//!
//! Shapes: `WIDTH` scattering events, one per lane. Directions are unit vectors within a few ε; `d` arrives at the surface;
//! `n` is the unit normal on the side from which it arrives (n · d < 0); u and v are uniform in [0, 1).

use crate::lane::{Lane, Mask};
use crate::math::Vec3;
use crate::sampling::warp;

/// A drawn direction. `alive` is false where the surface absorbed the light.
#[derive(Clone, Copy, Debug)]
pub struct Scattered<L: Lane> {
    pub direction: Vec3<L>,
    /// Multiplies the material's colour.
    pub weight: L,
    pub alive: L::Mask,
}

impl<L: Lane> Scattered<L> {
    #[inline(always)]
    fn whole(direction: Vec3<L>) -> Self {
        Self { direction, weight: L::one(), alive: L::Mask::splat(true) }
    }
}

/// Lambert's law: density cos θ / π, weight 1. Never absorbs, never points below the surface.
#[inline(always)]
pub fn diffuse<L: Lane>(n: Vec3<L>, u: L, v: L) -> Scattered<L> {
    Scattered::whole(warp::cosine_hemisphere(n, u, v))
}

/// A perfect mirror.
#[inline(always)]
pub fn mirror<L: Lane>(d: Vec3<L>, n: Vec3<L>) -> Scattered<L> {
    Scattered::whole(d.reflect(n))
}

/// The thesis's lobe: normalize(reflected + roughness · s), s uniform on the unit sphere; absorbed where that points below the
/// surface, or nowhere.
#[inline(always)]
pub fn scatter<L: Lane>(d: Vec3<L>, n: Vec3<L>, roughness: L, u: L, v: L) -> Scattered<L> {
    let towards = warp::unit_sphere(u, v).mul_add(roughness, d.reflect(n));
    // A vector so short that its direction is rounding noise is absorbed with the zero vector: 2⁻²⁰ is far above the noise.
    let alive = L::splat(1e-12).lt(towards.dot(towards)) & L::zero().lt(towards.dot(n));
    let direction = Vec3::select(alive, towards, n).normalize();
    Scattered { direction, weight: L::one(), alive }
}

/// GGX reflection with visible normals: weight G₂/G₁, absorbed below the surface. `alpha` in (0, 1].
///
/// Source: Dupuy, Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023; Heitz, "Understanding the
/// Masking-Shadowing Function in Microfacet-Based BRDFs", JCGT 2014, eq. 72 and 99 (height-correlated Smith).
#[inline(always)]
pub fn ggx<L: Lane>(d: Vec3<L>, n: Vec3<L>, alpha: L, u: L, v: L) -> Scattered<L> {
    let (tangent, bitangent) = warp::basis(n);
    // Rounding may put a grazing ray on or below the horizon; the lobe needs it above.
    let cos_out = (-d.dot(n)).max(L::splat(1e-6));
    let out = Vec3::new(-d.dot(tangent), -d.dot(bitangent), cos_out);
    let stretched = Vec3::new(alpha * out.x, alpha * out.y, out.z).normalize();
    let (sin, cos) = crate::lane::functions::sin_cos_turns(v);
    let z = (L::one() - u).mul_add(L::one() + stretched.z, -stretched.z);
    let radius = z.neg_mul_add(z, L::one()).max(L::zero()).sqrt();
    let half = Vec3::new(radius * cos, radius * sin, z) + stretched;
    let normal = Vec3::new(alpha * half.x, alpha * half.y, half.z).normalize();
    let incident = normal * (L::splat(2.0) * out.dot(normal)) - out;
    let alive = L::zero().lt(incident.z);
    let lambda = |w: Vec3<L>| {
        let tan2 = w.x.mul_add(w.x, w.y * w.y) / (w.z * w.z);
        L::splat(0.5) * ((alpha * alpha).mul_add(tan2, L::one()).sqrt() - L::one())
    };
    let lambda_out = L::one() + lambda(out);
    let weight = lambda_out / (lambda_out + lambda(incident));
    let direction = tangent.mul_add(incident.x, bitangent.mul_add(incident.y, n * incident.z));
    Scattered { direction, weight: L::select(alive, weight, L::zero()), alive }
}

/// A smooth dielectric: reflects with probability F (Fresnel), else refracts.
///
/// `outside`: d arrives from the vacuum side. `choose` uniform in [0, 1). The weight of refracted radiance is η² (radiance is
/// denser in a denser medium); it cancels when the path leaves.
/// Source: Born, Wolf, Principles of Optics, §1.5; Pharr et al., PBR 4ed §9.5.
#[inline(always)]
pub fn glass<L: Lane>(d: Vec3<L>, n: Vec3<L>, outside: L::Mask, ior: L, choose: L) -> Scattered<L> {
    let eta = L::select(outside, L::one() / ior, ior);
    let cos_i = (-d.dot(n)).min(L::one()).max(L::zero());
    let sin2_t = eta * eta * (cos_i.neg_mul_add(cos_i, L::one()));
    let total = L::one().le(sin2_t);
    let cos_t = (L::one() - sin2_t).max(L::zero()).sqrt();
    let parallel = (cos_i - eta * cos_t) / eta.mul_add(cos_t, cos_i);
    let perpendicular = eta.mul_add(cos_i, -cos_t) / eta.mul_add(cos_i, cos_t);
    let fresnel = L::splat(0.5) * perpendicular.mul_add(perpendicular, parallel * parallel);
    let reflects = total | choose.lt(fresnel);
    let refracted = d * eta + n * eta.mul_add(cos_i, -cos_t);
    let direction = Vec3::select(reflects, d.reflect(n), refracted);
    let weight = L::select(reflects, L::one(), eta * eta);
    Scattered { direction, weight, alive: L::Mask::splat(true) }
}
