//! Candidates: the primitives that some rays can hit, for tests of a list.

use crate::geometry::{Geometry, Shape};
use crate::math::ViewFrustum;

/// Primitives in ascending order: spheres by their number, triangles counted from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Candidates {
    /// The indices of spheres.
    pub spheres: Vec<u32>,
    /// The indices of triangles.
    pub triangles: Vec<u32>,
}

impl Candidates {
    /// Returns the primitives that are not outside the frustum.
    pub fn in_frustum(geometry: &Geometry, frustum: &ViewFrustum) -> Self {
        let mut candidates = Self::default();
        candidates.find_in_frustum(geometry, frustum);
        candidates
    }

    /// Replaces the candidates by those of [`Candidates::in_frustum`].
    pub fn find_in_frustum(&mut self, geometry: &Geometry, frustum: &ViewFrustum) {
        self.keep(geometry, |_, shape| !frustum.excludes(shape.balls()));
    }

    /// Replaces the candidates by the primitives for which `keep(number, shape)` is true.
    pub(super) fn keep(&mut self, geometry: &Geometry, keep: impl Fn(usize, Shape) -> bool) {
        self.spheres.clear();
        self.triangles.clear();
        for (number, shape) in geometry.shapes().enumerate().filter(|&(number, shape)| keep(number, shape)) {
            match shape {
                Shape::Sphere(_) => self.spheres.push(number as u32),
                Shape::Triangle(_) => self.triangles.push((number - geometry.spheres.len()) as u32),
            }
        }
    }

    /// Returns the number of candidates.
    pub(super) fn len(&self) -> usize {
        self.spheres.len() + self.triangles.len()
    }
}
