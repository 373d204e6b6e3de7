//! Finds parallelograms among emissive triangles: two triangles that share an edge, as rectangular lights are
//! modelled.

use crate::rays::Kind;
use crate::scene::{Scene, Triangle};
use glam::DVec3;
use std::collections::HashMap;

/// One of the two triangles of a light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Half {
    /// The other triangle, as a primitive's number.
    pub partner: usize,
    /// The vertex opposite the shared edge.
    pub corner: usize,
}

/// The distance, relative to the largest coordinate, by which the fourth corner may miss its place by the
/// other three. Rounded corners of an exact parallelogram are off by up to 4 · 2⁻²⁴.
const TOLERANCE: f64 = 8.0 / 16_777_216.0;
/// The least length of edges in tolerances, so that areas and normals of both triangles agree.
const MIN_EDGE: f64 = 1e4;

/// The largest number of triangles at one edge that are tested as the other half.
const MAX_CANDIDATES: usize = 16;

/// Returns, for each triangle with `power`, the other half of its parallelogram, if it has one. Triangles
/// have the numbers of primitives. No triangle is a half of two.
pub(super) fn find(scene: &Scene, power: impl Fn(usize) -> f64) -> HashMap<usize, Half> {
    let mut halves = HashMap::new();
    let mut with_edge: HashMap<[[u32; 3]; 2], Vec<(usize, usize)>> = HashMap::new();
    let first = scene.counts().first(Kind::Triangle);
    for (number, triangle) in (first..).zip(&scene.triangles) {
        if power(number) <= 0.0 {
            continue;
        }
        let match_at = |corner: usize| {
            let others = with_edge.get(&edge(triangle, corner))?;
            let fits = |&&(other, opposite): &&(usize, usize)| {
                let candidate = &scene.triangles[other - first];
                !halves.contains_key(&other)
                    && candidate.material == triangle.material
                    && is_parallelogram(triangle, corner, candidate, opposite)
            };
            others.iter().take(MAX_CANDIDATES).find(fits).map(|&(other, opposite)| (corner, other, opposite))
        };
        let found = (0..3).find_map(match_at);
        if let Some((corner, other, opposite)) = found {
            halves.insert(number, Half { partner: other, corner });
            halves.insert(other, Half { partner: number, corner: opposite });
        } else {
            for corner in 0..3 {
                with_edge.entry(edge(triangle, corner)).or_default().push((number, corner));
            }
        }
    }
    halves
}

/// Returns the edge opposite a corner, as the bits of its ends in order.
fn edge(triangle: &Triangle, corner: usize) -> [[u32; 3]; 2] {
    // Adding 0 turns −0 into 0.
    let bits = |vertex: usize| triangle.vertices[vertex % 3].to_array().map(|x| (x + 0.0).to_bits());
    let mut ends = [bits(corner + 1), bits(corner + 2)];
    ends.sort_unstable();
    ends
}

/// Tests whether two triangles that share the edges opposite these corners make a parallelogram.
fn is_parallelogram(one: &Triangle, corner: usize, other: &Triangle, opposite: usize) -> bool {
    let at = |vertex: usize| one.vertices[vertex % 3].as_dvec3();
    let [a, b, c] = [at(corner), at(corner + 1), at(corner + 2)];
    let d = other.vertices[opposite].as_dvec3();
    let largest = [a, b, c, d].into_iter().map(|v| v.abs().max_element()).fold(0.0, f64::max);
    let tolerance = TOLERANCE * largest;
    let height = |edge: DVec3, to: DVec3| edge.cross(to).length() / edge.length();
    (b + c - a - d).length() <= tolerance
        && height(b - a, c - a).min(height(c - a, b - a)) >= MIN_EDGE * tolerance
}
