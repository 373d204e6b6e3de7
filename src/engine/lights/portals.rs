//! Portals: parallelograms, such as the openings of windows, through which the sky is sampled.
//!
//! Light passes a portal along its normal only. From its lit side, it is sampled uniformly in solid angle, as
//! a flat light at its place is; what a shadow ray through it brings is the sky's radiance. A portal that is
//! larger or smaller than its opening, or overlaps others, changes the noise and not the mean: the pdf of a
//! direction is that of the mixture of all of the sky's lights ([`super::Lights::sky_pdf`]).
//!
//! Source: C. Ureña, M. Fajardo, A. King, "An Area-Preserving Parametrization for Spherical Rectangles", EGSR
//! 2013, whose §1 describes the use; the map is that of [`flat`], for parallelograms.

use super::EnvironmentLight;
use super::select::Light;
use crate::lane::{Lane, Mask};
use crate::math::Vec3;
use crate::primitives::ChosenLight;
use crate::primitives::flat::{self, Flat, FlatLight};
use crate::primitives::light::{LightKind, LightRow, LightSample};
use crate::scene::{Portal, Scene, Sky};
use std::f64::consts::PI;

/// A portal as a light.
#[derive(Clone, Debug)]
pub struct PortalLight {
    a: glam::Vec3,
    edges: [glam::Vec3; 2],
    /// The power that the unoccluded sky sends through it.
    pub(super) power: f64,
    /// The probability of choosing it by power.
    pub probability: f32,
}

/// Returns the portals of a scene; `sky` is its texture as a light, if there is one.
pub(super) fn lights(scene: &Scene, sky: Option<&EnvironmentLight>) -> Vec<PortalLight> {
    let light = |&Portal { vertices: [a, b, _, d] }: &Portal| {
        let edges = [b - a, d - a];
        let n = edges[0].as_dvec3().cross(edges[1].as_dvec3());
        let mean = |color: glam::Vec3| f64::from(color.element_sum()) / 3.0;
        let radiance = match scene.sky {
            Sky::Color(color) => mean(color),
            // The mean y of directions from the dark side, by their cosines, is −2/3 of that of the normal.
            Sky::Gradient { bottom, top } => {
                mean(bottom) + mean(top - bottom) * (0.5 - n.normalize().y / 3.0)
            }
            Sky::Texture { .. } => sky.map_or(0.0, |sky| sky.mean),
        };
        PortalLight { a, edges, power: PI * n.length() * radiance, probability: 0.0 }
    };
    scene.portals.iter().map(light).filter(|light| light.power > 0.0).collect()
}

/// The distance up to which points are near a portal, relative to its sides.
const NEAR: f32 = 0.01;

impl PortalLight {
    /// Returns the rows of the light.
    pub(super) fn light(&self) -> (LightRow, [f32; 8]) {
        let [ab, ac] = self.edges.map(|edge| edge.as_dvec3());
        // Twice the power, as flat lights emit on both sides.
        let (row, importance) = Flat { a: self.a.as_dvec3(), ab, ac, is_quad: true }.light(2.0 * self.power);
        (LightRow { kind: LightKind::Portal, ..row }, importance)
    }
    /// Returns the lanes with points on the lit side or near the plane, as rays leave a surface above the
    /// point.
    #[inline(always)]
    pub(super) fn is_lit_from<L: Lane>(&self, point: Vec3<L>) -> L::Mask {
        let ([ab, ac], a) = (self.edges, Vec3::splat(self.a));
        let n = ab.cross(ac);
        let slack = n.length() * NEAR * (ab.length() + ac.length());
        L::splat(-slack).lt((point - a).dot(Vec3::splat(n)))
    }
    /// Returns the portal as seen from `origin`.
    #[inline(always)]
    fn quad<L: Lane>(&self, origin: Vec3<L>) -> FlatLight<L> {
        let [ab, ac] = self.edges.map(Vec3::splat);
        FlatLight { a: Vec3::splat(self.a) - origin, ab, ac, is_quad: L::Mask::splat(true) }
    }
}

/// The portals of a scene.
#[derive(Clone, Debug, Default)]
pub struct Portals {
    /// The index of the first one among all lights.
    first: usize,
    all: Vec<PortalLight>,
}

impl Portals {
    /// Finds the portals among the selected lights, which have these probabilities.
    pub(super) fn new(mut all: Vec<PortalLight>, lights: &[Light], shares: &[f64]) -> Self {
        let first = lights.iter().position(|light| matches!(light.row.kind, LightKind::Portal));
        let first = first.unwrap_or(lights.len());
        all.iter_mut().zip(&shares[first..]).for_each(|(light, &share)| light.probability = share as f32);
        Self { first, all }
    }
    /// Returns the number of portals that are sampled.
    pub fn len(&self) -> usize {
        self.all.len()
    }
    /// Tests whether no portal is sampled.
    #[inline(always)]
    pub fn is_empty(&self) -> bool {
        self.all.is_empty()
    }
    /// Returns the portal that is the light of this index.
    #[inline(always)]
    pub(super) fn of_light(&self, light: usize) -> Option<&PortalLight> {
        self.all.get(light.checked_sub(self.first)?)
    }
    /// Returns the sum over all portals of the pdf, in 1/sr, with which a direction from `origin` is sampled
    /// through each, times the probability of choosing it.
    ///
    /// Not inlined, because it is called from three places.
    #[inline(never)]
    pub fn pdf<L: Lane>(&self, origin: &Vec3<L>, direction: &Vec3<L>) -> L {
        let mut sum = L::zero();
        for portal in &self.all {
            let quad = portal.quad(*origin);
            let (passes, t) = passes(&quad, *direction);
            if passes.any() {
                let pdf = flat::pdf(&quad, *direction, t).only(passes);
                sum = pdf.mul_add(L::splat(portal.probability), sum);
            }
        }
        sum
    }
}

/// Returns the lanes whose rays in the direction `wi` pass the quad from its lit side, and the distance to
/// its plane.
///
/// Rounding may put sampled directions just outside. Such a sample counts nothing: the pdf of every direction
/// is that of this test, however it was found, so that weights sum to 1.
#[inline(always)]
fn passes<L: Lane>(&FlatLight { a, ab, ac, .. }: &FlatLight<L>, wi: Vec3<L>) -> (L::Mask, L) {
    let n = ab.cross(ac);
    let (height, toward) = (a.dot(n), wi.dot(n));
    let t = height / toward;
    let from_a = wi * t - a;
    let (along_ab, along_ac) = (from_a.cross(ac).dot(n), ab.cross(from_a).dot(n));
    let (zero, area2) = (L::zero(), n.dot(n));
    let is_within = |along: L| zero.le(along) & along.le(area2);
    let faces = height.lt(zero) & toward.lt(zero);
    (faces & is_within(along_ab) & is_within(along_ac), t)
}

/// Returns the sample of the flat light in the portal's place as one of the sky behind it.
#[inline(always)]
pub(super) fn through_portal<L: Lane>(
    light: &ChosenLight<L>,
    origin: Vec3<L>,
    sample: &LightSample<L>,
) -> LightSample<L> {
    let pdf = sample.pdf.only(passes(&light.flat(origin), sample.wi).0);
    LightSample { wi: sample.wi, t: L::splat(f32::INFINITY), n: Vec3::zero(), pdf }
}
