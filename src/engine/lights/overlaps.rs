//! Finds lights in the surface of another primitive: equal faces, panels in a light's plane, equal spheres.
//!
//! Other shadow rays end just before their light. In an overlap other surfaces may lie between, within
//! rounding, or take the light's place.

use crate::math::EPSILON;
use crate::scene::{Primitive, Scene, Triangle};
use glam::DVec3;

/// Surfaces count as one if their distance is below this share of the distance from which they are lit: a few
/// times the share of their length by which shadow rays end early.
const CLOSE: f64 = 1e-5;
/// Overlaps that matter only from farther away than this number of sizes of the light are ignored.
const FAR: f64 = 1000.0;
/// The number of pairs of boxes, and of close primitives, that are tested before an overlap is assumed.
const MAX_PAIRS: [usize; 2] = [100_000_000, 1_000_000];

/// Tests whether some light shares a piece of surface with another primitive. Edges and corners do not count.
pub(super) fn exist(scene: &Scene, is_light: impl Fn(usize) -> bool) -> bool {
    let boxes: Vec<[DVec3; 2]> = scene.all_primitives().map(|primitive| primitive.shape().extent()).collect();
    let (lower, upper) = scene.bounds();
    let diagonal = (upper - lower).length();
    let rounding =
        |[lower, upper]: [DVec3; 2]| f64::from(EPSILON) * 16.0 * lower.abs().max(upper.abs()).max_element();
    let most = CLOSE * diagonal + 2.0 * rounding([lower, upper]);
    // The lights in the order of their lower ends along x.
    let mut lights: Vec<usize> = (0..boxes.len()).filter(|&number| is_light(number)).collect();
    lights.sort_by(|&one, &other| boxes[one][0].x.total_cmp(&boxes[other][0].x));
    let widest = lights.iter().map(|&light| boxes[light][1].x - boxes[light][0].x).fold(0.0, f64::max);
    let mut pairs = [0; 2];
    for (number, &[lower, upper]) in boxes.iter().enumerate() {
        let first = lights.partition_point(|&light| boxes[light][0].x < lower.x - widest - most);
        let end = lights.partition_point(|&light| boxes[light][0].x <= upper.x + most);
        pairs[0] += end - first;
        for &light in lights[first..end].iter().filter(|&&light| light != number) {
            let [from, to] = boxes[light];
            let close = CLOSE * diagonal.min(FAR * (to - from).length());
            let within = close + rounding([lower, upper]) + rounding([from, to]);
            if (from - upper).max(lower - to).max_element() > within {
                continue;
            }
            pairs[1] += 1;
            if share_surface(scene, [number, light], within) {
                return true;
            }
        }
        if pairs[0] > MAX_PAIRS[0] || pairs[1] > MAX_PAIRS[1] {
            return true;
        }
    }
    false
}

/// Tests whether pieces of two primitives are closer than `within`.
fn share_surface(scene: &Scene, pair: [usize; 2], within: f64) -> bool {
    match pair.map(|number| scene.primitive(number)) {
        [Primitive::Sphere(one), Primitive::Sphere(other)] => {
            let distance = (one.center.as_dvec3() - other.center.as_dvec3()).length();
            (distance - f64::from(one.radius - other.radius).abs()).abs() < within
        }
        [Primitive::Triangle(one), Primitive::Triangle(other)] => {
            covers(one, other, within) || covers(other, one, within)
        }
        // These touch in a curve at most.
        [Primitive::Sphere(_), Primitive::Triangle(_)] | [Primitive::Triangle(_), Primitive::Sphere(_)] => {
            false
        }
    }
}

/// Tests whether a piece of `other` lies over the inside of `one`.
fn covers(one: &Triangle, other: &Triangle, within: f64) -> bool {
    let corners = one.vertices.map(|vertex| vertex.as_dvec3());
    let [a, b, c] = corners;
    let n = (b - a).cross(c - a).normalize();
    let perimeter = (b - a).length() + (c - b).length() + (a - c).length();
    let inradius = (b - a).cross(c - a).length() / perimeter;
    let margin = (4.0 * within).min(0.1 * inradius);
    // The rest of the other triangle between two planes, and within the edges moved inwards.
    let mut rest = other.vertices.map(|vertex| vertex.as_dvec3()).to_vec();
    clip(&mut rest, |point| within - (point - a).dot(n));
    clip(&mut rest, |point| within + (point - a).dot(n));
    for edge in 0..3 {
        let [from, to] = [corners[edge], corners[(edge + 1) % 3]];
        let inward = n.cross(to - from).normalize();
        clip(&mut rest, |point| (point - from).dot(inward) - margin);
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
