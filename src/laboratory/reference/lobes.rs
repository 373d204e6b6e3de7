//! How materials scatter: the sampled direction and its weight (BSDF · cosine / pdf).

use super::rough_glass;
use crate::sampling::dimension::{DIRECTION, LOBE};
use crate::scene::{MaterialExtras, MaterialKind};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// A scattering event at a hit, without the material.
#[derive(Clone, Copy)]
pub(super) struct Event<'a> {
    /// The direction of the ray that arrives.
    pub d: DVec3,
    pub normals: &'a Normals,
    /// The random number of a dimension.
    pub number: &'a dyn Fn(u32) -> f64,
    /// A direction to evaluate in place of a sampled one: layered lobes then return the BSDF times the cosine
    /// as the weight.
    pub given: Option<DVec3>,
    pub extras: &'a MaterialExtras,
}

/// The scattered direction, the path's weight, colour included, and whether the lobe is a delta lobe.
pub(super) type Scattered = (DVec3, DVec3, bool);

/// How the light of an event is scattered; `None` where it is absorbed. `rougher` multiplies the material's
/// roughness.
pub(super) fn sample(kind: MaterialKind, rougher: f64, color: DVec3, event: Event) -> Option<Scattered> {
    let Event { d, normals, number, .. } = event;
    let alpha = |roughness: f32| (f64::from(roughness) * rougher).powi(2);
    let Normals { ng, ns_specular: n, ns_diffuse, horizon, outside, .. } = *normals;
    let mut is_delta = false;
    let sample = match kind {
        MaterialKind::Emitter => None,
        MaterialKind::Diffuse => {
            // Lambert's law: the normal plus a point on the unit sphere.
            let towards = (ns_diffuse + on_sphere(number)).normalize();
            normals.fade(towards).map(|weight| (towards, weight))
        }
        MaterialKind::Metal { roughness: 0.0 } => {
            is_delta = true;
            Some((raise(reflect(d, n), ng), 1.0))
        }
        MaterialKind::Metal { roughness } => {
            let alpha = alpha(roughness);
            is_delta = alpha < NARROWEST_ALPHA;
            let out = to_local(-d, n);
            let (wi, weight) = ggx(out, alpha, number(DIRECTION), number(DIRECTION + 1));
            let (white, _) = albedo(out.z, alpha);
            let weight = color * weight / (1.0 - color * (1.0 - white));
            let towards = raise(to_world(wi, n), if is_delta { ng } else { horizon });
            return (wi.z > 0.0).then_some((towards, weight, is_delta));
        }
        MaterialKind::Glass { ior } => {
            // η: index of the incident medium over that of the transmitting one.
            let eta = if outside { 1.0 / f64::from(ior) } else { f64::from(ior) };
            let cosine = |n: DVec3| (-d.dot(n)).clamp(0.0, 1.0);
            let is_total = |n: DVec3| eta * eta * (1.0 - cosine(n).powi(2)) >= 1.0;
            // Of light that shading normals would reflect round for ever.
            let escapes = is_total(n) && (!is_total(ng) || number(LOBE) < 0.125);
            let n = if escapes { ng } else { n };
            let cos_i = cosine(n);
            let cos_t = (1.0 - eta * eta * (1.0 - cos_i * cos_i)).max(0.0).sqrt();
            let reflected = if is_total(n) { 1.0 } else { fresnel(eta, cos_i, cos_t) };
            is_delta = true;
            Some(if number(LOBE) < reflected {
                (raise(reflect(d, n), ng), 1.0)
            } else {
                // Radiance scales by η² when it enters another medium.
                (raise(d * eta + n * (eta * cos_i - cos_t), -ng), eta * eta)
            })
        }
        MaterialKind::ThinGlass { ior } => {
            // Two surfaces with all reflections between them; what is transmitted goes straight on.
            let cos_i = (-d.dot(n)).clamp(0.0, 1.0);
            let cos2_t = 1.0 - (1.0 - cos_i * cos_i) / f64::from(ior).powi(2);
            let once = if cos2_t <= 0.0 { 1.0 } else { reflected(f64::from(ior), cos_i) };
            let reflects = number(LOBE) < 2.0 * once / (1.0 + once);
            let reflection = raise(reflect(d, n), ng);
            return Some(if reflects { (reflection, DVec3::ONE, true) } else { (d, color, true) });
        }
        MaterialKind::RoughGlass { roughness, ior, thin } => {
            return rough_glass::sample(color, ((roughness, rougher), ior, thin), event);
        }
        MaterialKind::FuzzyMirror { roughness } => {
            let roughness = f64::from(roughness) * rougher;
            is_delta = roughness < NARROWEST_CONE;
            let w = reflect(d, n) + on_sphere(number) * roughness;
            let horizon = if is_delta { ng } else { horizon };
            (w.dot(n) > 0.0).then(|| (raise(w.normalize(), horizon), 1.0))
        }
        MaterialKind::Plastic { roughness, ior } => {
            return plastic(color, (alpha(roughness), f64::from(ior)), event);
        }
        MaterialKind::MetalRough { roughness, metallic, ior } => {
            return metal_rough(color, [alpha(roughness), f64::from(ior), f64::from(metallic)], event);
        }
    };
    sample.map(|(towards, weight)| (towards, color * weight, is_delta))
}

/// Whether light goes through it.
pub(super) fn is_glass(kind: MaterialKind) -> bool {
    use MaterialKind::{Glass, RoughGlass, ThinGlass};
    matches!(kind, Glass { .. } | ThinGlass { .. } | RoughGlass { .. })
}

/// The normals at a hit, all on the side from which the ray arrives.
pub(super) struct Normals {
    /// Geometric normal.
    pub ng: DVec3,
    /// Shading normal for all but diffuse lobes: it faces the ray.
    pub ns_specular: DVec3,
    /// Shading normal for diffuse lobes.
    pub ns_diffuse: DVec3,
    /// Reflected light stays above its plane, but for delta lobes: the interpolated normal, or `ng`.
    pub horizon: DVec3,
    /// Whether the shading normals differ from the geometric one.
    pub has_ns: bool,
    /// Whether the ray arrives from the side to which the unflipped geometric normal points.
    pub outside: bool,
}

impl Normals {
    /// Turns `ng`, and the normals on its side, towards the ray of direction `d`: the shading normal `ns`,
    /// and the interpolated one without a normal map.
    pub(super) fn facing(d: DVec3, ng: DVec3, ns: Option<DVec3>, interpolated: Option<DVec3>) -> Self {
        let outside = ng.dot(d) <= 0.0;
        let side = if outside { 1.0 } else { -1.0 };
        let ng = ng * side;
        let ns_diffuse = ns.map_or(ng, |ns| ns * side);
        // It faces the ray by half as much as the geometric normal, or as it faced away, at least.
        let (cosine, least) = (-d.dot(ns_diffuse), -0.5 * d.dot(ng));
        let turned = || (ns_diffuse - d * (cosine.abs().max(least) - cosine)).normalize();
        let ns_specular = if cosine < least { turned() } else { ns_diffuse };
        let horizon = interpolated.map_or(ng, |normal| normal * side);
        Self { ng, ns_specular, ns_diffuse, horizon, has_ns: ns.is_some(), outside }
    }

    /// The directions in which a specular lobe may send light for it to leave along `w`: `w`, and what is
    /// mirrored in the horizon.
    pub fn images(&self, w: DVec3) -> Vec<DVec3> {
        if self.has_ns { vec![w, reflect(w, self.horizon)] } else { vec![w] }
    }

    /// The weight of a diffuse lobe's light from `w`, `None` below the horizon: see "diffuse lobes" at the
    /// head of `kernel/normals.rs`.
    pub fn fade(&self, w: DVec3) -> Option<f64> {
        let height = w.dot(self.horizon);
        let added = w.dot(self.ns_diffuse) - self.ns_diffuse.dot(self.horizon) * height;
        if !self.has_ns {
            return Some(1.0);
        }
        let x = if 2.0 * height < added { 2.0 * height / added } else { 1.0 };
        (height > 0.0).then_some(x * (6.0 - 9.0 * x + 4.0 * x * x))
    }
}

/// `w`, mirrored in the plane of `n` if it is below.
pub(super) fn raise(w: DVec3, n: DVec3) -> DVec3 {
    if w.dot(n) < 0.0 { reflect(w, n) } else { w }
}

/// How wide the narrowest lobe is that is no delta lobe, from 0 to 1; arguments as in [`sample`].
pub(super) fn width(kind: MaterialKind, rougher: f64) -> f64 {
    let alpha = |roughness: f32| (f64::from(roughness) * rougher).powi(2);
    match kind {
        MaterialKind::Diffuse => 1.0,
        MaterialKind::Metal { roughness } | MaterialKind::RoughGlass { roughness, .. } => alpha(roughness),
        MaterialKind::FuzzyMirror { roughness } => (f64::from(roughness) * rougher).min(1.0),
        // Under a smooth coat it is the base.
        MaterialKind::Plastic { roughness, .. } | MaterialKind::MetalRough { roughness, .. } => {
            if alpha(roughness) < NARROWEST_ALPHA { 1.0 } else { alpha(roughness) }
        }
        MaterialKind::Glass { .. } | MaterialKind::ThinGlass { .. } | MaterialKind::Emitter => 0.0,
    }
}

/// Narrower lobes count as delta lobes; the reason stands in `kernel::bsdf`.
pub(super) const NARROWEST_ALPHA: f64 = 1.0 / 8192.0;
pub(super) const NARROWEST_CONE: f64 = 1.0 / 64.0;

/// Fresnel reflectance from outside at a cosine, without total reflection.
fn reflected(ior: f64, cos: f64) -> f64 {
    let cos_t = (1.0 - (1.0 - cos * cos) / (ior * ior)).sqrt();
    fresnel(1.0 / ior, cos, cos_t)
}

/// The share of uniform light that a smooth coat lets through: 2 ∫ (1 − F(c)) c dc by Simpson's rule.
fn transmitted(ior: f64) -> f64 {
    let steps = 200;
    let terms = (0..=steps).map(|i| {
        let c = f64::from(i) / f64::from(steps);
        let weight = if i == 0 || i == steps { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
        weight * 2.0 * (1.0 - reflected(ior, c)) * c
    });
    terms.sum::<f64>() / (3.0 * f64::from(steps))
}

/// A GGX coat over a Lambert base: the equations at the head of `kernel/bsdf/plastic.rs`.
fn plastic(color: DVec3, (alpha, ior): (f64, f64), event: Event) -> Option<Scattered> {
    let transmitted = transmitted(ior);
    let base = color / ((DVec3::ONE - color) * ior * ior + color * transmitted);
    let cos_o = -event.d.dot(event.normals.ns_specular);
    let (white, facet_cosine) = if alpha < NARROWEST_ALPHA { (1.0, cos_o) } else { albedo(cos_o, alpha) };
    let entered = 1.0 - white * reflected(ior, facet_cosine);
    let brightest = base.max_element() * transmitted * entered;
    let on_coat = (1.0 - entered) / (1.0 - entered + brightest);
    let fresnel = |cos: f64| DVec3::splat(reflected(ior, cos));
    let lambert = |cos: f64| base * entered * (1.0 - reflected(ior, cos));
    gloss_over_lambert(event, &[Gloss { alpha, probability: on_coat, fresnel: &fresnel }], lambert)
}

/// glTF's metallic-roughness model: the equations at the head of `kernel/bsdf/metal_rough.rs` and
/// `kernel/bsdf/layered.rs`.
fn metal_rough(color: DVec3, [alpha, ior, metallic]: [f64; 3], event: Event) -> Option<Scattered> {
    let MaterialExtras { specular, specular_color, clearcoat, clearcoat_roughness, .. } = *event.extras;
    let (f90, share) = (f64::from(specular), f64::from(clearcoat));
    let f0 = (specular_color.as_dvec3() * ((ior - 1.0) / (ior + 1.0)).powi(2)).min(DVec3::ONE) * f90;
    let cos_o = -event.d.dot(event.normals.ns_specular);
    let fifth = |cos: f64| (1.0 - cos).max(0.0).powi(5);
    let (white, facet_cosine) = albedo(cos_o, alpha);
    let grazing = white * fifth(facet_cosine);
    let reflected = |f0: f64, f90: f64| (f0 * (white - grazing) + f90 * grazing) / (1.0 - f0 * (1.0 - white));
    let coat_alpha = f64::from(clearcoat_roughness).powi(2);
    let (coat_white, coat_cosine) =
        if coat_alpha < NARROWEST_ALPHA { (1.0, cos_o) } else { albedo(cos_o, coat_alpha) };
    let series = share / (1.0 - 0.04 * (1.0 - coat_white));
    let on_coat = series * coat_white * (0.04 + 0.96 * fifth(coat_cosine));
    let coat = |cos: f64| DVec3::splat(series * (0.04 + 0.96 * fifth(cos)));
    let passed = 1.0 - on_coat;
    let fresnel = |cos: f64| {
        let schlick =
            |f0: DVec3, f90: f64| f0.lerp(DVec3::splat(f90), fifth(cos)) / (1.0 - f0 * (1.0 - white));
        (schlick(f0, f90) * (1.0 - metallic) + schlick(color, 1.0) * metallic) * passed
    };
    let base = color * (1.0 - metallic) * (1.0 - reflected(f0.max_element(), f90)).max(0.0);
    let normal = (f0 * (1.0 - metallic) + color * metallic).max_element();
    let specular = reflected(normal, f90 * (1.0 - metallic) + metallic);
    let below = specular + base.max_element();
    let probability = on_coat / (on_coat + passed * below).max(1e-300);
    let coat = Gloss { alpha: coat_alpha, probability, fresnel: &coat };
    let probability = (1.0 - probability) * specular / below.max(1e-300);
    gloss_over_lambert(event, &[coat, Gloss { alpha, probability, fresnel: &fresnel }], |_| base * passed)
}

/// E of white GGX at a cosine and the mean cosine at its facets: the fits of the model, at the head of
/// `kernel/bsdf/albedo.rs`.
pub(super) fn albedo(cos: f64, a: f64) -> (f64, f64) {
    let mu = cos.clamp(1e-6, 1.0);
    let s = (mu * mu + a * a * (1.0 - mu * mu)).sqrt();
    let (c, sigma) = (mu / s, a * (1.0 - mu * mu).sqrt() / s);
    let narrow = c * (0.2543 - 0.1997 * sigma) + a * a * (0.6057 * sigma - 0.7164);
    let loss = c * ((1.0 - c) * narrow + 0.2037 * a * a);
    let divisor = 1.0
        + a * (0.2614 * a - 1.8421)
        + c * (1.7093 * a - 0.8341)
        + sigma * (1.8491 * a - 0.2676 * a * a - 0.9814)
        + c * sigma * (0.8844 - 1.5914 * a + 0.1059 * a * a);
    let white = 1.0 - loss / divisor;
    let above = s * (3.910 + 149.98 * s) - mu * (3.019 + 114.20 * s) + 1.198 * a;
    let below = 1.0 + s * (84.49 + 248.7 * s) + mu * (141.07 * mu - 386.2 * s + 16.95 * a - 50.08);
    (white, above / below)
}

/// A GGX lobe: its reflectance at the cosine of the microfacet, and the probability of sampling it.
struct Gloss<'a> {
    alpha: f64,
    probability: f64,
    fresnel: &'a dyn Fn(f64) -> DVec3,
}

/// GGX lobes over a Lambert base of the reflectance `base` at the cosine of the sampled direction: the sum,
/// divided by the pdf with which the estimator samples.
fn gloss_over_lambert(
    Event { d, normals, number, given, .. }: Event,
    gloss: &[Gloss],
    base: impl Fn(f64) -> DVec3,
) -> Option<Scattered> {
    let Normals { ng, ns_specular: n, ns_diffuse, horizon, .. } = *normals;
    let out = to_local(-d, n);
    let mut left = number(LOBE);
    let chosen = gloss.iter().find(|lobe| {
        left -= lobe.probability;
        left < 0.0
    });
    let towards = if let Some(given) = given {
        given
    } else if let Some(&Gloss { alpha, probability, fresnel }) = chosen {
        let (local, weight) = ggx(out, alpha, number(DIRECTION), number(DIRECTION + 1));
        if local.z <= 0.0 {
            return None;
        }
        if alpha < NARROWEST_ALPHA {
            let facet = (local + out).normalize().dot(out);
            let weight = fresnel(facet) * (weight / probability);
            return Some((raise(to_world(local, n), ng), weight, true));
        }
        raise(to_world(local, n), horizon)
    } else {
        (ns_diffuse + on_sphere(number)).normalize()
    };
    let fade = normals.fade(towards)?;
    let cosine = towards.dot(ns_diffuse).max(0.0);
    let mut value = base(cosine) * (cosine / PI * fade);
    let mut pdf = (1.0 - gloss.iter().map(|lobe| lobe.probability).sum::<f64>()) * cosine / PI;
    for image in normals.images(towards).into_iter().map(|image| to_local(image, n)) {
        for &Gloss { alpha, probability, fresnel } in
            gloss.iter().filter(|lobe| lobe.alpha >= NARROWEST_ALPHA)
        {
            if image.z > 0.0 {
                let (visible, reflected) = facets(out, image, alpha);
                value += fresnel((image + out).normalize().dot(out)) * reflected;
                pdf += probability * visible;
            }
        }
    }
    if given.is_some() {
        return Some((towards, value, false));
    }
    (pdf > 0.0).then(|| (towards, value / pdf, false))
}

/// The density of the directions `image` in which visible GGX facets reflect `out`, both in the frame of the
/// normal, and the BSDF times the cosine at a reflectance of 1.
pub(super) fn facets(out: DVec3, image: DVec3, alpha: f64) -> (f64, f64) {
    let half = (image + out).normalize();
    let [lambda_out, lambda_in] = [out, image].map(|w| lambda(w, alpha));
    let slope = half.z * half.z * (alpha * alpha - 1.0) + 1.0;
    let distribution = alpha * alpha / (PI * slope * slope);
    let visible = distribution / (4.0 * out.z * (1.0 + lambda_out));
    (visible, visible * (1.0 + lambda_out) / (1.0 + lambda_out + lambda_in))
}

/// A point on the unit sphere, uniformly.
fn on_sphere(number: impl Fn(u32) -> f64) -> DVec3 {
    let (u, phi) = (number(DIRECTION), TAU * number(DIRECTION + 1));
    let radius = 2.0 * (u * (1.0 - u)).sqrt();
    DVec3::new(radius * phi.cos(), radius * phi.sin(), 1.0 - 2.0 * u)
}

pub(super) fn reflect(d: DVec3, n: DVec3) -> DVec3 {
    d - n * (2.0 * d.dot(n))
}

/// The part of unpolarised light that a smooth dielectric reflects; `eta` = n_incident / n_transmitted.
pub(super) fn fresnel(eta: f64, cos_i: f64, cos_t: f64) -> f64 {
    let perpendicular = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    let parallel = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    0.5 * (perpendicular * perpendicular + parallel * parallel)
}

/// The direction into which a sampled visible GGX microfacet reflects `wo`, and G2/G1, its weight; both
/// directions in the frame of the normal.
///
/// Source: Dupuy, Benyoub, "Sampling Visible GGX Normals with Spherical Caps", HPG 2023. Weight: Heitz,
/// "Sampling the GGX Distribution of Visible Normals", JCGT 2018, eq. 19, with height-correlated masking.
fn ggx(wo: DVec3, alpha: f64, u: f64, v: f64) -> (DVec3, f64) {
    let m = visible_normal(wo, alpha, u, v);
    let wi = m * (2.0 * wo.dot(m)) - wo;
    // (1 + Λo) / (1 + Λo + Λi), which is 1 where wo lies in the surface and Λo is infinite.
    (wi, 1.0 / (1.0 + lambda(wi, alpha) / (1.0 + lambda(wo, alpha))))
}

/// A visible normal of GGX, in the frame of the normal.
pub(super) fn visible_normal(wo: DVec3, alpha: f64, u: f64, v: f64) -> DVec3 {
    let stretched = DVec3::new(alpha * wo.x, alpha * wo.y, wo.z).normalize();
    let phi = TAU * v;
    let z = (1.0 - u) * (1.0 + stretched.z) - stretched.z;
    let sin = (1.0 - z * z).max(0.0).sqrt();
    let h = DVec3::new(sin * phi.cos(), sin * phi.sin(), z) + stretched;
    DVec3::new(alpha * h.x, alpha * h.y, h.z).normalize()
}

/// Smith's Λ of GGX.
pub(super) fn lambda(w: DVec3, alpha: f64) -> f64 {
    let tan2 = (w.x * w.x + w.y * w.y) / (w.z * w.z);
    0.5 * ((1.0 + alpha * alpha * tan2).sqrt() - 1.0)
}

/// Tangent and bitangent of the unit vector `n`.
///
/// Any pair gives the same expected value; the estimator's own pair gives the same paths.
/// Source: Duff et al., "Building an Orthonormal Basis, Revisited", JCGT 2017.
fn basis(n: DVec3) -> (DVec3, DVec3) {
    let sign = 1.0_f64.copysign(n.z);
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    (DVec3::new(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), DVec3::new(b, sign + n.y * n.y * a, -n.y))
}

pub(super) fn to_world(local: DVec3, n: DVec3) -> DVec3 {
    let (tangent, bitangent) = basis(n);
    tangent * local.x + bitangent * local.y + n * local.z
}

pub(super) fn to_local(world: DVec3, n: DVec3) -> DVec3 {
    let (tangent, bitangent) = basis(n);
    DVec3::new(world.dot(tangent), world.dot(bitangent), world.dot(n))
}
