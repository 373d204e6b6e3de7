//! Spots: how their light falls off towards the rim of narrow cones.

use super::rng::Rng;
use super::scenes::{empty, sphere};
use super::test_case::{Bound, EPSILON, FailureCounts, TestCase, compare};
use crate::buffers::Features;
use crate::lights::{LightChoice, Lights};
use crate::math;
use crate::primitives::LightSample;
use crate::reference::lights::{angle, falloff};
use crate::scene::{LightShape, Scene};
use glam::Vec3;

pub(super) fn test_cases() -> Vec<TestCase> {
    vec![TestCase {
        name: "lights-spots",
        title: "Spots with narrow cones, whose light falls off between half their angle and the rim",
        axis: "angle of the rim in degrees",
        places: &[1e-3, 1e-2, 0.1, 1.0, 3.0, 10.0, 30.0, 60.0, 90.0],
        failure: "share of the light is NaN",
        error: Some("|Δ share of the light|"),
        source: "KHR_lights_punctual, Inner and Outer Cone Angles",
        inputs: 50_000,
        methods: compare(
            spot,
            &[("cosines", cosines), ("cosines-limited", cosines_limited), ("one-minus-cos", one_minus_cos)],
        ),
        // Unit vectors are rounded by some ε of an angle, which is compared with the rim's. Measured, not
        // derived: a third of it.
        bound: |degrees| Bound::error(4.0 * EPSILON * (1.0 + 1.0 / degrees.to_radians())),
    }]
}

/// The share of a spot's light at a point from it, for the spot's direction and the angles of its cones.
type SpotShare = fn(Vec3, Vec3, [f32; 2]) -> f32;

/// Returns the share that the specification's example computes, without the limit on its divisor.
fn cosines(direction: Vec3, to: Vec3, degrees: [f32; 2]) -> f32 {
    share_of_cosines(direction, to, degrees, 0.0)
}

/// Returns the share of the specification's example.
fn cosines_limited(direction: Vec3, to: Vec3, degrees: [f32; 2]) -> f32 {
    share_of_cosines(direction, to, degrees, 0.001)
}

fn share_of_cosines(direction: Vec3, to: Vec3, degrees: [f32; 2], least: f32) -> f32 {
    let [inner, outer] = degrees.map(|angle| angle.to_radians().cos());
    let scale = 1.0 / (inner - outer).max(least);
    let share = (direction.normalize().dot(to.normalize()) * scale - outer * scale).clamp(0.0, 1.0);
    share * share
}

/// Returns the share of the renderer's spot, from its pdf: the emission over the irradiance.
fn one_minus_cos(direction: Vec3, to: Vec3, [inner_degrees, outer_degrees]: [f32; 2]) -> f32 {
    const ALL: u64 = Features::ALL.0;
    let (position, intensity, range) = (Vec3::ZERO, Vec3::ONE, f32::INFINITY);
    let spot = LightShape::Spot { position, direction, intensity, range, inner_degrees, outer_degrees };
    let lights = Lights::new(
        &Scene { lights: vec![spot.into()], spheres: vec![sphere(to, 1.0)], ..empty() },
        LightChoice::On,
    );
    let (light, _) = lights.choose_by_power::<f32>(0.0, || 0.0, || 0.0, false);
    let LightSample { t, pdf, .. } =
        lights.sample::<f32, ALL>(&light, math::Vec3::splat(to), (0.0, 0.0), true);
    if pdf > 0.0 { t * t / pdf } else { 0.0 }
}

fn spot(rng: &mut Rng, degrees: f64, counts: &mut FailureCounts, share: SpotShare) {
    let direction = rng.direction().as_vec3();
    let cones = [degrees / 2.0, degrees].map(|angle| angle as f32);
    let axis = direction.as_dvec3().normalize();
    let (sin, cos) = (degrees.to_radians() * 1.1 * rng.unit()).sin_cos();
    let beside = axis.cross(rng.direction()).normalize();
    let to = ((axis * cos + beside * sin) * rng.scale(1e-3, 1e3)).as_vec3();
    let expected = falloff(angle(axis, to.as_dvec3()), cones[0], cones[1]);
    counts.record_error((f64::from(share(direction, to, cones)) - expected).abs());
}
