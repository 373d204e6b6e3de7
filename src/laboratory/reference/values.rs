//! The BSDF in a given direction, for lights that no path finds by scattering.

use super::lobes::{self, Event, NARROWEST_ALPHA, NARROWEST_CONE, albedo, facets, reflect, to_local};
use super::rough_glass;
use crate::scene::MaterialKind;
use glam::DVec3;
use std::f64::consts::PI;

/// The BSDF times the cosine for light from the unit vector `w`, colour included; 0 for delta lobes.
/// Arguments as in [`lobes::sample`].
pub(super) fn value(kind: MaterialKind, rougher: f64, color: DVec3, event: Event, w: DVec3) -> DVec3 {
    let Event { d, normals, .. } = event;
    let n = normals.ns_specular;
    let alpha = |roughness: f32| (f64::from(roughness) * rougher).powi(2);
    let event = Event { given: Some(w), ..event };
    let is_below = w.dot(normals.horizon) <= 0.0;
    let sum = |lobe: &dyn Fn(DVec3) -> f64| {
        let images = normals.images(w).into_iter().filter(|image| !is_below && image.dot(n) > 0.0);
        images.map(lobe).sum::<f64>()
    };
    match kind {
        MaterialKind::Diffuse => {
            color * (w.dot(normals.ns_diffuse).max(0.0) / PI * normals.fade(w).unwrap_or(0.0))
        }
        MaterialKind::Metal { roughness } if alpha(roughness) >= NARROWEST_ALPHA => {
            let (alpha, out) = (alpha(roughness), to_local(-d, n));
            let (white, _) = albedo(out.z, alpha);
            color / (1.0 - color * (1.0 - white)) * sum(&|image| facets(out, to_local(image, n), alpha).1)
        }
        MaterialKind::FuzzyMirror { roughness } if f64::from(roughness) * rougher >= NARROWEST_CONE => {
            // The density of normalize(mirrored + radius · u): rays leave the ball's surface, of the density
            // 1 / 4π radius², at the distances t, and at a cosine of root / radius.
            let (mirrored, radius) = (reflect(d, n), f64::from(roughness) * rougher);
            color
                * sum(&|image| {
                    let cosine = image.dot(mirrored);
                    let root = (cosine * cosine - 1.0 + radius * radius).sqrt();
                    let ends = [cosine - root, cosine + root].into_iter().filter(|t| *t > 0.0);
                    ends.map(|t| t * t / (4.0 * PI * radius * root)).sum()
                })
        }
        MaterialKind::Plastic { .. } | MaterialKind::MetalRough { .. } => {
            lobes::sample(kind, rougher, color, event).map_or(DVec3::ZERO, |(_, value, _)| value)
        }
        MaterialKind::RoughGlass { roughness, ior, thin } => {
            rough_glass::value(color, ((roughness, rougher), ior, thin), event, w)
        }
        MaterialKind::Metal { .. } | MaterialKind::FuzzyMirror { .. } => DVec3::ZERO,
        MaterialKind::Glass { .. } | MaterialKind::ThinGlass { .. } | MaterialKind::Emitter => DVec3::ZERO,
    }
}
