//! Points, spots and directional lights: their rows of the table of lights, their samples, and the discs of
//! directional lights, which rays that miss everything can see.
//!
//! Source: KHR_lights_punctual, "Range Property" and "Inner and Outer Cone Angles". In place of the
//! recommended `max(0.001, …)`, which darkens cones of less than 2.6°, an edge of a millionth of the cone
//! keeps the falloff finite. The falloff is computed from 1 − cos of angles, which single precision holds for
//! narrow cones too.

use super::LightChoice;
use super::select::Light;
use crate::lane::Lane;
use crate::math::{MISS, Vec3, portable};
use crate::primitives::light::{
    ChosenLight, LightKind, LightRow, LightSample, bounded_importance, importance_everywhere, valid_pdf,
};
use crate::sampling::warp;
use crate::scene::{LightShape, Scene};
use glam::DVec3;
use std::f32::consts::TAU;
use std::f64::consts::PI;

/// The least difference between the cosines of a spot's cones, as a share of 1 − cos of the outer one.
const LEAST_EDGE: f64 = 1e-6;

/// The disc of a directional light.
#[derive(Clone, Copy, Debug)]
pub struct Sun {
    /// The unit vector towards its middle.
    pub towards: glam::Vec3,
    /// 1 − cos of half its diameter.
    pub one_minus_cos: f32,
    /// Its radiance.
    pub radiance: glam::Vec3,
    /// The probability of choosing it times the pdf within the disc, in 1/sr; 0 if it is not sampled.
    pub pdf: f32,
}

/// Computes 1 − cos without cancellation.
fn one_minus_cos(degrees: f32) -> f64 {
    2.0 * portable::sin_cos(f64::from(degrees).to_radians() / 2.0).0.powi(2)
}

fn unit(direction: glam::Vec3) -> glam::Vec3 {
    direction.as_dvec3().normalize().as_vec3()
}

fn mean(color: glam::Vec3) -> f64 {
    f64::from(color.element_sum()) / 3.0
}

/// Returns the row of a light, the row by which it is weighed, and its power. That of a directional light is
/// the power that crosses a sphere around the scene.
fn rows(shape: &LightShape, scene_radius: f64) -> (LightRow, [f32; 8], f64) {
    // A spot's falloff is the square of edges[1].y − edges[1].x (1 − cos), clamped.
    let point = |at, emission, range: f32, edges, share: f64| {
        let row = LightRow { kind: LightKind::Point, at, radius: 1.0 / range, edges, emission, offset: 0.0 };
        (row, bounded_importance(at, 0.0, None, mean(emission)), share * 4.0 * PI * mean(emission))
    };
    match *shape {
        LightShape::Point { position, intensity, range } => {
            point(position, intensity, range, [glam::Vec3::ZERO, glam::Vec3::Y], 1.0)
        }
        LightShape::Spot { position, direction, intensity, range, inner_degrees, outer_degrees } => {
            let [inner, outer] = [inner_degrees, outer_degrees].map(one_minus_cos);
            let edge = (outer - inner).max(LEAST_EDGE * outer);
            let falloff = DVec3::new(1.0 / edge, outer / edge, 0.0).as_vec3();
            point(position, intensity, range, [unit(direction), falloff], 0.25 * (inner + outer))
        }
        LightShape::Directional { direction, irradiance, angular_diameter_degrees } => {
            let half = angular_diameter_degrees / 2.0;
            let row = LightRow {
                kind: LightKind::Distant,
                at: -unit(direction),
                radius: one_minus_cos(half) as f32,
                emission: if half > 0.0 { disc_radiance(irradiance, half) } else { irradiance },
                ..LightRow::default()
            };
            let mean = mean(irradiance);
            (row, importance_everywhere(mean), PI * scene_radius * scene_radius * mean)
        }
    }
}

/// Returns the radiance of a disc that gives surfaces across it this irradiance: ∫ L cos θ dω = π L sin² α
/// over the cone of the half angle α.
fn disc_radiance(irradiance: glam::Vec3, half_degrees: f32) -> glam::Vec3 {
    let sin = portable::sin_cos(f64::from(half_degrees).to_radians()).0;
    (irradiance.as_dvec3() / (PI * sin * sin)).as_vec3()
}

/// Returns the lights to sample. Those that paths cannot hit are always sampled, as nothing else finds them.
pub(super) fn lights(scene: &Scene, choice: LightChoice) -> Vec<Light> {
    let (lower, upper) = scene.bounds();
    let radius = (upper - lower).length() / 2.0;
    let light = |shape: &LightShape| {
        let (row, importance, power) = rows(shape, radius);
        Light { row, importance, primitives: [MISS; 2], power }
    };
    let lights = scene.lights.iter().map(|one| light(&one.shape));
    lights.filter(|light| light.power > 0.0 && (choice != LightChoice::Off || !is_sun(&light.row))).collect()
}

fn is_sun(row: &LightRow) -> bool {
    matches!(row.kind, LightKind::Distant) && row.radius > 0.0
}

/// Returns the discs of a scene; `sampled` are the probabilities of the lights that are sampled, in the order
/// of the scene.
pub(super) fn suns<'a>(scene: &Scene, sampled: impl Iterator<Item = (&'a LightRow, f64)>) -> Vec<Sun> {
    let all = lights(scene, LightChoice::On);
    let mut probabilities = sampled.filter(|(row, _)| is_sun(row)).map(|(_, probability)| probability);
    let suns = all.iter().map(|light| &light.row).filter(|row| is_sun(row));
    let sun = |row: &LightRow| Sun {
        towards: row.at,
        one_minus_cos: row.radius,
        radiance: row.emission,
        pdf: probabilities.next().unwrap_or(0.0) as f32 * disc_pdf(row.radius),
    };
    suns.map(sun).collect()
}

/// Returns the pdf of directions within a disc, in 1/sr: one over its solid angle.
#[inline(always)]
fn disc_pdf<L: Lane>(one_minus_cos: L) -> L {
    L::splat(1.0 / TAU) / one_minus_cos
}

/// Samples the lights of lanes with points, spots and directional lights, as seen from `origin`: the one
/// direction in which a light lies, or a direction that is uniform in its disc.
#[inline(never)]
pub(super) fn sample<L: Lane>(light: &ChosenLight<L>, origin: Vec3<L>, (u, v): (L, L)) -> LightSample<L> {
    let (zero, one) = (L::zero(), L::one());
    let to = light.at - origin;
    let distance2 = to.dot(to);
    let t = distance2.sqrt();
    let wi = to * (one / t);
    let [axis, falloff] = light.edges;
    // |a − b|² / 2 is 1 − cos of the angle between unit vectors.
    let apart = wi + axis;
    let one_minus_cos = L::splat(0.5) * apart.dot(apart);
    let cone = one_minus_cos.neg_mul_add(falloff.x, falloff.y).max(zero).min(one);
    let share = t * light.radius;
    let within = (share * share).neg_mul_add(share * share, one).max(zero);
    let pdf = valid_pdf(distance2 / (cone * cone * within));
    let point = LightSample { wi, t, n: Vec3::zero(), pdf };

    let (towards, ..) = warp::sample_uniform_cone(light.at, light.radius, u, v);
    let is_delta = light.is_delta();
    let distant = LightSample {
        wi: Vec3::select(is_delta, light.at, towards),
        t: L::splat(f32::INFINITY),
        n: Vec3::zero(),
        pdf: L::select(is_delta, one, valid_pdf(disc_pdf(light.radius))),
    };
    LightSample::select(light.kinds.point, point, distant)
}

/// Returns the radiance of the discs in unit directions with the pdf 1 / `inv_pdf`, times the MIS weight
/// `mis_weight(inv_pdf, pdf)`.
#[inline(never)]
pub fn sun_radiance<L: Lane>(
    suns: &[Sun],
    direction: Vec3<L>,
    inv_pdf: L,
    mis_weight: fn(L, L) -> L,
) -> Vec3<L> {
    suns.iter().fold(Vec3::zero(), |sum, sun| {
        let apart = direction - Vec3::splat(sun.towards);
        let is_inside = apart.dot(apart).lt(L::splat(2.0 * sun.one_minus_cos));
        let weight = mis_weight(inv_pdf, L::splat(sun.pdf)).only(is_inside);
        sum + Vec3::splat(sun.radiance) * weight
    })
}
