//! Lights that are no primitives, by KHR_lights_punctual.

use super::geometry::Reference;
use super::lobes;
use crate::scene::{LightShape, MaterialKind};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Returns the angle between two vectors, in radians.
pub(crate) fn angle(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b))
}

/// How much of a point's light is left at a distance: 1 − (d / range)⁴.
fn within(distance: f64, range: f32) -> f64 {
    (1.0 - (distance / f64::from(range)).powi(4)).clamp(0.0, 1.0)
}

/// Returns how much of a spot's light is left at an angle: the share of the way from the outer cone's cosine
/// to the inner one's, squared.
pub(crate) fn falloff(angle: f64, inner_degrees: f32, outer_degrees: f32) -> f64 {
    let [inner, outer] = [inner_degrees, outer_degrees].map(|degrees| f64::from(degrees).to_radians());
    if angle <= inner {
        return 1.0;
    }
    // cos a − cos b = 2 sin((b + a) / 2) sin((b − a) / 2).
    let apart = |a: f64, b: f64| ((b + a) / 2.0).sin() * ((b - a) / 2.0).sin();
    if angle >= outer { 0.0 } else { (apart(angle, outer) / apart(inner, outer)).powi(2) }
}

impl Reference {
    /// Returns the light of lights that no ray hits, times the BSDF `value`; `from` gives the origin of rays
    /// on a side of the surface. Glass has light from both sides.
    pub(super) fn direct_light(
        &self,
        kind: MaterialKind,
        ng: DVec3,
        from: impl Fn(f64) -> DVec3,
        value: impl Fn(DVec3) -> DVec3,
    ) -> DVec3 {
        if !lobes::is_glass(kind) {
            return self.direct(from(1.0), value);
        }
        let through = |side: f64| {
            self.direct(from(side), |w| if w.dot(ng) * side > 0.0 { value(w) } else { DVec3::ZERO })
        };
        through(1.0) + through(-1.0)
    }

    /// The light that arrives at a point from all lights that no ray can hit, times `value` of its direction.
    fn direct(&self, from: DVec3, value: impl Fn(DVec3) -> DVec3) -> DVec3 {
        let left = |w: DVec3, distance: f64| self.left(from, w, distance);
        let point = |position: Vec3, intensity: Vec3, share: &dyn Fn(DVec3, f64) -> f64| {
            let to = position.as_dvec3() - from;
            let (w, distance) = (to.normalize_or_zero(), to.length());
            let arriving = intensity.as_dvec3() * (share(w, distance) / (distance * distance));
            value(w) * arriving * left(w, distance)
        };
        let light = |light: &LightShape| match *light {
            LightShape::Point { position, intensity, range } => {
                point(position, intensity, &|_, distance| within(distance, range))
            }
            LightShape::Spot { position, direction, intensity, range, inner_degrees, outer_degrees } => {
                point(position, intensity, &|w, distance| {
                    let off_axis = angle(-w, direction.as_dvec3());
                    within(distance, range) * falloff(off_axis, inner_degrees, outer_degrees)
                })
            }
            LightShape::Directional { direction, irradiance, angular_diameter_degrees } => {
                let w = -direction.as_dvec3().normalize();
                match angular_diameter_degrees == 0.0 {
                    true => value(w) * irradiance.as_dvec3() * left(w, f64::INFINITY),
                    false => DVec3::ZERO,
                }
            }
        };
        self.lights.iter().map(light).sum()
    }

    /// The radiance of the discs of directional lights in a direction: ∫ L cos θ dω = π L sin² α over a cone.
    pub(super) fn suns(&self, d: DVec3) -> DVec3 {
        let sun = |light: &LightShape| match *light {
            LightShape::Directional { direction, irradiance, angular_diameter_degrees } => {
                let half = f64::from(angular_diameter_degrees).to_radians() / 2.0;
                let is_inside = angle(d, -direction.as_dvec3()) < half;
                if is_inside { irradiance.as_dvec3() / (PI * half.sin().powi(2)) } else { DVec3::ZERO }
            }
            LightShape::Point { .. } | LightShape::Spot { .. } => DVec3::ZERO,
        };
        self.lights.iter().map(sun).sum()
    }
}
