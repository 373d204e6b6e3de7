//! How materials scatter: where a path goes on, and what of its light goes with it.

use crate::sampling::random::{DIRECTION, LOBE};
use crate::scene::MaterialKind;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// The new direction and what of the light goes there, colour included; nothing where the light is absorbed.
///
/// `d` and `n` are unit vectors, n · d ≤ 0. `outside`: the light comes from where the surface's own normal points.
/// `number` is the event's random number of a dimension.
pub(super) fn scatter(
    kind: MaterialKind,
    color: DVec3,
    d: DVec3,
    n: DVec3,
    outside: bool,
    number: impl Fn(u32) -> f64,
) -> Option<(DVec3, DVec3)> {
    let colored = |(direction, weight): (DVec3, f64)| (direction, color * weight);
    let drawn = match kind {
        MaterialKind::Emitter => None,
        MaterialKind::Diffuse => {
            // Lambert's law: the normal plus a point on the unit sphere.
            Some(((n + on_sphere(number)).normalize(), 1.0))
        }
        MaterialKind::Metal { roughness: 0.0 } => Some((reflect(d, n), 1.0)),
        MaterialKind::Metal { roughness } => {
            let alpha = f64::from(roughness) * f64::from(roughness);
            let (wi, weight) = ggx(to_local(-d, n), alpha, number(DIRECTION), number(DIRECTION + 1));
            (wi.z > 0.0).then(|| (to_world(wi, n), weight))
        }
        MaterialKind::Glass { ior } => {
            // Index of the medium the light is in over that of the one behind the surface.
            let eta = if outside { 1.0 / f64::from(ior) } else { f64::from(ior) };
            let cos_i = (-d.dot(n)).clamp(0.0, 1.0);
            let sin2_t = eta * eta * (1.0 - cos_i * cos_i);
            let cos_t = (1.0 - sin2_t).max(0.0).sqrt();
            let reflected = if sin2_t >= 1.0 { 1.0 } else { fresnel(eta, cos_i, cos_t) };
            if number(LOBE) < reflected {
                Some((reflect(d, n), 1.0))
            } else {
                // Radiance is compressed in the denser medium: η² on each passage.
                Some((d * eta + n * (eta * cos_i - cos_t), eta * eta))
            }
        }
        MaterialKind::Scatter { roughness } => {
            let w = reflect(d, n) + on_sphere(number) * f64::from(roughness);
            (w.dot(n) > 0.0).then(|| (w.normalize(), 1.0))
        }
        MaterialKind::Plastic { roughness, ior } => {
            let alpha = f64::from(roughness) * f64::from(roughness);
            return plastic(color, alpha, f64::from(ior), d, n, number);
        }
    };
    drawn.map(colored)
}

/// A coat of GGX over a matt base: the equations at the head of `kernel/bsdf/plastic.rs`, weighed by the density with which the
/// estimator draws.
fn plastic(
    color: DVec3,
    alpha: f64,
    ior: f64,
    d: DVec3,
    n: DVec3,
    number: impl Fn(u32) -> f64,
) -> Option<(DVec3, DVec3)> {
    let reflected = |cos: f64| {
        let cos_t = (1.0 - (1.0 - cos * cos) / (ior * ior)).sqrt();
        fresnel(1.0 / ior, cos, cos_t)
    };
    let let_in = |cos: f64| 1.0 - reflected(cos + (1.0 - cos) * 0.43 * alpha.powf(1.5));
    // 2 ∫ T(c) c dc by Simpson's rule.
    let steps = 2000;
    let transmitted = (0..=steps).map(|i| {
        let c = f64::from(i) / f64::from(steps);
        let weight = if i == 0 || i == steps { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        weight * 2.0 * let_in(c) * c
    });
    let transmitted = transmitted.sum::<f64>() / (3.0 * f64::from(steps));
    let base = color / ((DVec3::ONE - color) * ior * ior + color * transmitted);

    let out = to_local(-d, n);
    let entered = let_in(out.z);
    let brightest = base.max_element() * transmitted * entered;
    let on_coat = (1.0 - entered) / (1.0 - entered + brightest);
    let smooth = alpha < 1.0 / 8192.0;
    let towards = if number(LOBE) < on_coat {
        let (towards, weight) = ggx(out, alpha, number(DIRECTION), number(DIRECTION + 1));
        if smooth {
            let facet = (towards + out).normalize().dot(out);
            let weight = DVec3::splat(weight * reflected(facet) / on_coat);
            return (towards.z > 0.0).then(|| (to_world(towards, n), weight));
        }
        towards
    } else {
        to_local((n + on_sphere(number)).normalize(), n)
    };
    if towards.z <= 0.0 {
        return None;
    }
    let lambert = towards.z / PI;
    let mut value = base * entered * let_in(towards.z) * lambert;
    let mut density = (1.0 - on_coat) * lambert;
    if !smooth {
        let half = (towards + out).normalize();
        let [lambda_out, lambda_in] = [out, towards].map(|w| lambda(w, alpha));
        let slope = half.z * half.z * (alpha * alpha - 1.0) + 1.0;
        let distribution = alpha * alpha / (PI * slope * slope);
        let visible = distribution / (4.0 * out.z * (1.0 + lambda_out));
        value += visible * (1.0 + lambda_out) / (1.0 + lambda_out + lambda_in) * reflected(half.dot(out));
        density += on_coat * visible;
    }
    Some((to_world(towards, n), value / density))
}

/// A point on the unit sphere, uniformly.
fn on_sphere(number: impl Fn(u32) -> f64) -> DVec3 {
    let (u, phi) = (number(DIRECTION), TAU * number(DIRECTION + 1));
    let radius = 2.0 * (u * (1.0 - u)).sqrt();
    DVec3::new(radius * phi.cos(), radius * phi.sin(), 1.0 - 2.0 * u)
}

fn reflect(d: DVec3, n: DVec3) -> DVec3 {
    d - n * (2.0 * d.dot(n))
}

/// Part of unpolarised light that a smooth dielectric reflects; `eta` = n_incident / n_transmitted.
fn fresnel(eta: f64, cos_i: f64, cos_t: f64) -> f64 {
    let perpendicular = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let parallel = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    0.5 * (perpendicular * perpendicular + parallel * parallel)
}

/// The direction that a visible microfacet of GGX reflects `wo` into, and shadowing of both over that of `wo` alone;
/// both directions in the frame of the normal.
///
/// Source: Dupuy, Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023. Weight: Heitz, "Sampling the GGX
/// Distribution of Visible Normals", JCGT 2018, eq. 19, with height-correlated masking.
fn ggx(wo: DVec3, alpha: f64, u: f64, v: f64) -> (DVec3, f64) {
    let stretched = DVec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    let phi = TAU * v;
    let z = (1.0 - u) * (1.0 + stretched.z) - stretched.z;
    let sin = (1.0 - z * z).max(0.0).sqrt();
    let h = DVec3::new(sin * phi.cos(), sin * phi.sin(), z) + stretched;
    let m = DVec3::new(alpha * h.x, alpha * h.y, h.z).normalize();
    let wi = m * (2.0 * wo.dot(m)) - wo;
    // (1 + Λo) / (1 + Λo + Λi), which is 1 where wo lies in the surface and Λo is infinite.
    (wi, 1.0 / (1.0 + lambda(wi, alpha) / (1.0 + lambda(wo, alpha))))
}

/// Smith's Λ of GGX.
fn lambda(w: DVec3, alpha: f64) -> f64 {
    let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// Tangent and bitangent of the unit vector `n`.
///
/// Any pair would do for the expected value; to follow the same paths it must be the estimator's own.
/// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
fn basis(n: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y))
}

fn to_world(local: DVec3, n: DVec3) -> DVec3 {
    let (tangent, bitangent) = basis(n);
    tangent * local.x + bitangent * local.y + n * local.z
}

fn to_local(world: DVec3, n: DVec3) -> DVec3 {
    let (tangent, bitangent) = basis(n);
    DVec3::new(world.dot(tangent), world.dot(bitangent), world.dot(n))
}
