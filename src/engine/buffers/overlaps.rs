//! Lights in the surface of another primitive: the same face twice, panels in a lamp's plane, equal spheres.
//!
//! Elsewhere a shadow ray ends just before its light. Here other surfaces may lie between, within rounding,
//! or take the light's place.

use crate::math::EPSILON;
use crate::scene::{Primitive, Scene, Triangle};
use glam::DVec3;

/// Surfaces closer than this share of the distance from which they are lit count as one: a few times the
/// share of their length by which shadow rays end early.
const CLOSE: f64 = 1e-5;
/// Light from farther away than so many sizes of a light is not asked for.
const FAR: f64 = 1000.0;
/// Pairs that are looked at before an overlap is assumed.
const MAX_PAIRS: usize = 100_000_000;

/// Whether some light shares a piece of surface with another primitive. Edges and corners do not count.
pub(super) fn exist(scene: &Scene, is_light: impl Fn(usize) -> bool) -> bool {
    let count = scene.primitives();
    let (lower, upper) = scene.bounds();
    let diagonal = (upper - lower).length();
    let boxes: Vec<[DVec3; 2]> = scene.all_primitives().map(|one| one.extent()).collect();
    let close = |number: usize| {
        let [lower, upper] = boxes[number];
        let rounding = f64::from(EPSILON) * 16.0 * lower.abs().max(upper.abs()).max_element();
        CLOSE * diagonal.min(FAR * (upper - lower).length()) + rounding
    };
    // Along x, the boxes in the order of their lower ends.
    let mut order: Vec<usize> = (0..count).collect();
    order.sort_by(|&one, &other| boxes[one][0].x.total_cmp(&boxes[other][0].x));
    let mut open: Vec<usize> = Vec::new();
    let mut pairs = 0;
    for &number in &order {
        let [lower, upper] = boxes[number];
        let own = close(number);
        open.retain(|&other| boxes[other][1].x >= lower.x - own.max(close(other)));
        pairs += open.len();
        if pairs > MAX_PAIRS {
            return (0..count).any(&is_light);
        }
        for &other in &open {
            let lights = [is_light(number), is_light(other)];
            let within = own.max(close(other));
            let apart = (boxes[other][0] - upper).max(lower - boxes[other][1]).max_element();
            if lights != [false; 2] && apart <= within && share_surface(scene, [number, other], within) {
                return true;
            }
        }
        open.push(number);
    }
    false
}

/// Whether pieces of two primitives are closer than `within`.
fn share_surface(scene: &Scene, pair: [usize; 2], within: f64) -> bool {
    match pair.map(|number| scene.primitive(number)) {
        [Primitive::Sphere(one), Primitive::Sphere(other)] => {
            let distance = (one.center.as_dvec3() - other.center.as_dvec3()).length();
            (distance - f64::from(one.radius - other.radius).abs()).abs() < within
        }
        [Primitive::Triangle(one), Primitive::Triangle(other)] => covers(one, other, within),
        _ => false,
    }
}

/// Whether a piece of `other` lies over the inside of `one`.
fn covers(one: &Triangle, other: &Triangle, within: f64) -> bool {
    let corners = one.vertices.map(|vertex| vertex.as_dvec3());
    let [a, b, c] = corners;
    let n = (b - a).cross(c - a).normalize();
    // What is left of the other one between two planes, and within the edges moved inwards.
    let mut rest = other.vertices.map(|vertex| vertex.as_dvec3()).to_vec();
    clip(&mut rest, |point| within - (point - a).dot(n));
    clip(&mut rest, |point| within + (point - a).dot(n));
    for edge in 0..3 {
        let [from, to] = [corners[edge], corners[(edge + 1) % 3]];
        let inward = n.cross(to - from).normalize();
        clip(&mut rest, |point| (point - from).dot(inward) - 4.0 * within);
    }
    !rest.is_empty()
}

/// Cuts off the part of a polygon where `height` is below 0.
///
/// Source: Sutherland, Hodgman, "Reentrant Polygon Clipping", CACM 17(1), 1974.
fn clip(polygon: &mut Vec<DVec3>, height: impl Fn(DVec3) -> f64) {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (at, &point) in polygon.iter().enumerate() {
        let next = polygon[(at + 1) % polygon.len()];
        let (from, to) = (height(point), height(next));
        if from >= 0.0 {
            kept.push(point);
        }
        if (from >= 0.0) != (to >= 0.0) {
            kept.push(point.lerp(next, from / (from - to)));
        }
    }
    *polygon = kept;
}
