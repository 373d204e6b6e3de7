//! Rough glass: facets that reflect or refract, and the light that is lost between them.
//!
//! Source: Walter, Marschner, Li, Torrance, "Microfacet Models for Refraction through Rough Surfaces", EGSR
//! 2007; the compensation as in the model, at the head of `kernel/bsdf/rough_glass.rs`.

use super::lobes::{
    self, Event, NARROWEST_ALPHA, Normals, Scattered, facets, fresnel, lambda, raise, to_local,
    visible_normal,
};
use crate::sampling::dimension::{DIRECTION, LOBE};
use crate::scene::{Attenuation, MaterialExtras, MaterialKind};
use glam::DVec3;
use std::collections::HashMap;
use std::f64::consts::PI;
use std::sync::Mutex;

/// The part of a partly transmitting surface that scatters a path, by a number in [0, 1): its kind and
/// colour, and the rest of the number.
pub(super) fn part(
    kind: MaterialKind,
    extras: &MaterialExtras,
    color: DVec3,
    number: f64,
) -> (MaterialKind, DVec3, f64) {
    let MaterialKind::MetalRough { roughness, metallic, ior } = kind else { return (kind, color, number) };
    let share = f64::from(extras.transmission) * (1.0 - f64::from(metallic));
    if number < share {
        let color = if extras.thin { color } else { color.powf(0.5) };
        (MaterialKind::RoughGlass { roughness, ior, thin: extras.thin }, color, number / share)
    } else {
        let metallic = (f64::from(metallic) / (1.0 - share)) as f32;
        (MaterialKind::MetalRough { roughness, metallic, ior }, color, (number - share) / (1.0 - share))
    }
}

/// The light that is left of white after a distance inside.
pub(super) fn left_after(distance: f64, extras: &MaterialExtras) -> DVec3 {
    let Some(Attenuation { color, distance: stated }) = extras.attenuation else { return DVec3::ONE };
    color.as_dvec3().max(DVec3::splat(1e-6)).powf(distance / f64::from(stated))
}

/// The direction of a facet's light, the weight and whether the lobe counts as a delta lobe.
pub(super) fn sample(
    color: DVec3,
    ((roughness, rougher), ior, thin): ((f32, f64), f32, bool),
    Event { d, normals, number, .. }: Event,
) -> Option<Scattered> {
    let Normals { ng, ns_specular: n, outside, .. } = *normals;
    let alpha = (f64::from(roughness) * rougher).powi(2);
    let index = f64::from(ior);
    // η: index of the incident medium over that of the transmitting one.
    let eta = if outside || thin { 1.0 / index } else { index };
    let out = to_local(-d, n);
    let m = visible_normal(out, alpha, number(DIRECTION), number(DIRECTION + 1));
    let cos = out.dot(m);
    let (once, cos_t) = interface(eta, cos);
    let reflects = number(LOBE) < if thin { 2.0 * once / (1.0 + once) } else { once };
    let reflected = m * (2.0 * cos) - out;
    let local = match (reflects, thin) {
        (true, _) => reflected,
        (false, true) => DVec3::new(reflected.x, reflected.y, -reflected.z),
        (false, false) => m * (eta * cos - cos_t) - out * eta,
    };
    if (local.z > 0.0) != reflects {
        return None;
    }
    let kept = g2_over_g1(out, local, alpha);
    let all =
        if thin { lobes::albedo(out.z, alpha).0 } else { albedo(out.z, (roughness, rougher), ior, outside) };
    let scale = if reflects || thin { 1.0 } else { eta * eta };
    let color = if reflects && thin { DVec3::ONE } else { color };
    let bend = if thin { 1.0 } else { (index - 1.0).abs().min(1.0) };
    let towards = raise(lobes::to_world(local, n), if reflects { ng } else { -ng });
    Some((towards, color * (kept * scale / all), alpha * bend < NARROWEST_ALPHA))
}

/// The BSDF times the cosine for light from `w` on either side, colour included; 0 for delta lobes.
pub(super) fn value(
    color: DVec3,
    ((roughness, rougher), ior, thin): ((f32, f64), f32, bool),
    Event { d, normals, .. }: Event,
    w: DVec3,
) -> DVec3 {
    let Normals { ng, ns_specular: n, outside, .. } = *normals;
    let (alpha, index) = ((f64::from(roughness) * rougher).powi(2), f64::from(ior));
    let bend = if thin { 1.0 } else { (index - 1.0).abs().min(1.0) };
    if alpha * bend < NARROWEST_ALPHA {
        return DVec3::ZERO;
    }
    let eta = if outside || thin { 1.0 / index } else { index };
    let (out, near) = (to_local(-d, n), w.dot(ng) > 0.0);
    let share = |cos: f64| {
        let (once, _) = interface(eta, cos);
        if thin { 2.0 * once / (1.0 + once) } else { once }
    };
    let lobe = |i: DVec3| {
        let i = if thin && !near { DVec3::new(i.x, i.y, -i.z) } else { i };
        if near || thin {
            let reflected = share((i + out).normalize().dot(out));
            let part = if near { reflected } else { 1.0 - reflected };
            return if i.z > 0.0 { part * facets(out, i, alpha).1 } else { 0.0 };
        }
        let h = -(out * eta + i).normalize();
        let h = if h.z < 0.0 { -h } else { h };
        let (towards, away) = (out.dot(h), -i.dot(h));
        if i.z >= 0.0 || towards <= 0.0 || away <= 0.0 {
            return 0.0;
        }
        let slope = h.z * h.z * (alpha * alpha - 1.0) + 1.0;
        let distribution = alpha * alpha / (PI * slope * slope);
        let g2 = 1.0 / (1.0 + lambda(out, alpha) + lambda(i, alpha));
        let jacobian = (eta * towards - away).powi(2);
        (1.0 - share(towards)) * distribution * g2 * eta * eta * towards * away / (out.z * jacobian)
    };
    let images = if normals.has_ns { vec![w, w - ng * (2.0 * w.dot(ng))] } else { vec![w] };
    let sum: f64 = images.into_iter().map(|image| lobe(to_local(image, n))).sum();
    let all =
        if thin { lobes::albedo(out.z, alpha).0 } else { albedo(out.z, (roughness, rougher), ior, outside) };
    let color = if near && thin { DVec3::ONE } else { color };
    color * (sum / all)
}

/// The reflected share at a facet, and the cosine of the refracted direction.
fn interface(eta: f64, cos: f64) -> (f64, f64) {
    let cos2_t = 1.0 - eta * eta * (1.0 - cos * cos);
    if cos2_t <= 0.0 { (1.0, 0.0) } else { (fresnel(eta, cos, cos2_t.sqrt()), cos2_t.sqrt()) }
}

/// The tables of the model, at the head of `kernel/bsdf/glass_albedo.rs`: their points along the factor of
/// the roughness, and along the cosine and that of the stretched direction; and those of quadrature.
const FACTORS: usize = 16;
const COSINES: usize = 64;
const QUADRATURE: [u32; 2] = [1597, 987];

/// A line of a table: the index of refraction, the roughness, the point along its factor, the side.
type Line = ([u32; 2], usize, bool);

/// The light that facets return after one bounce, from one side: interpolated between points of quadrature.
fn albedo(cos: f64, (roughness, rougher): (f32, f64), ior: f32, outside: bool) -> f64 {
    static LINES: Mutex<Option<HashMap<Line, Vec<f64>>>> = Mutex::new(None);
    let between = |x: f64, count: usize| {
        let x = x.clamp(0.0, 1.0) * (count - 1) as f64;
        let first = (x as usize).min(count - 2);
        (first, x - first as f64)
    };
    let (line, part) = between(rougher, FACTORS);
    let (point, share) =
        between(0.5 * (cos + stretched(cos, (f64::from(roughness) * rougher).powi(2))), COSINES);
    let at = |line: usize, part: f64| {
        if part == 0.0 {
            return 0.0;
        }
        let mut lines = LINES.lock().expect("no quadrature panics");
        let lines = lines.get_or_insert_default();
        let points = lines.entry(([ior, roughness].map(f32::to_bits), line, outside));
        let factor = line as f64 / (FACTORS - 1) as f64;
        let alpha = (f64::from(roughness) * factor).powi(2);
        let points = points.or_insert_with(|| line_of_albedo(alpha, ior, outside));
        part * (points[point] * (1.0 - share) + points[point + 1] * share)
    };
    at(line, 1.0 - part) + at(line + 1, part)
}

/// The cosine of the direction in which the facets are those of roughness 1.
fn stretched(cos: f64, alpha: f64) -> f64 {
    cos / (cos * cos + alpha * alpha * (1.0 - cos * cos)).sqrt().max(1e-300)
}

fn line_of_albedo(alpha: f64, ior: f32, outside: bool) -> Vec<f64> {
    let eta = if outside { 1.0 / f64::from(ior) } else { f64::from(ior) };
    let point = |point: usize| {
        let place = point as f64 / (COSINES - 1) as f64;
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let cos = 0.5 * (low + high);
            if 0.5 * (cos + stretched(cos, alpha)) < place { low = cos } else { high = cos }
        }
        if alpha == 0.0 { 1.0 } else { kept(0.5 * (low + high), alpha, eta) }
    };
    (0..COSINES).map(point).collect()
}

/// The mean of G2/G1 over what is sampled.
fn kept(cos_o: f64, alpha: f64, eta: f64) -> f64 {
    let [points, step] = QUADRATURE;
    let out = DVec3::new((1.0 - cos_o * cos_o).max(0.0).sqrt(), 0.0, cos_o);
    let mut sum = 0.0;
    for point in 0..points {
        let u = (f64::from(point) + 0.5) / f64::from(points);
        let v = f64::from(point * step % points) / f64::from(2 * points);
        let m = visible_normal(out, alpha, u, v);
        let (reflected, cos_t) = interface(eta, m.dot(out));
        let up = m * (2.0 * m.dot(out)) - out;
        let down = m * (eta * m.dot(out) - cos_t) - out * eta;
        for (share, height) in [(reflected, up.z), (1.0 - reflected, -down.z)] {
            if height > 0.0 {
                let w = DVec3::new((1.0 - height * height).max(0.0).sqrt(), 0.0, height);
                sum += share * g2_over_g1(out, w, alpha);
            }
        }
    }
    sum / f64::from(points)
}

/// (1 + Λo) / (1 + Λo + Λi), which is 1 where `out` lies in the surface and Λo is infinite.
fn g2_over_g1(out: DVec3, w: DVec3, alpha: f64) -> f64 {
    1.0 / (1.0 + lambda(w, alpha) / (1.0 + lambda(out, alpha)))
}
