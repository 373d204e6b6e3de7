//! Lists of primitives for linear traversal, and frustum culling: the primitives that the primary rays of a
//! tile can hit.
//!
//! Culling is only for methods whose hits stay within the view frustum's margin
//! ([`super::Methods::keep_to_their_primitives`]): the naive ones report hits far outside a primitive, and
//! culling would remove those from their picture.

use crate::camera::ViewFrustum;
use crate::scene::{Scene, Sphere, Triangle};

/// Primitives in ascending order: spheres by their number, triangles counted from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PrimitiveList {
    /// Indices of spheres.
    pub spheres: Vec<u32>,
    /// Indices of triangles.
    pub triangles: Vec<u32>,
}

impl PrimitiveList {
    /// The scene's primitives that are not outside the frustum.
    pub fn of(scene: &Scene, frustum: &ViewFrustum) -> Self {
        let mut visible = Self::default();
        visible.find(scene, frustum);
        visible
    }

    /// [`PrimitiveList::of`] in place.
    pub fn find(&mut self, scene: &Scene, frustum: &ViewFrustum) {
        let sphere = |s: &Sphere| !frustum.excludes(&[s.center.as_dvec3()], f64::from(s.radius));
        let triangle = |t: &Triangle| !frustum.excludes(&t.vertices.map(|vertex| vertex.as_dvec3()), 0.0);
        let (spheres, triangles) = ((0u32..).zip(&scene.spheres), (0u32..).zip(&scene.triangles));
        self.spheres.clear();
        self.spheres.extend(spheres.filter(|(_, s)| sphere(s)).map(|(i, _)| i));
        self.triangles.clear();
        self.triangles.extend(triangles.filter(|(_, t)| triangle(t)).map(|(i, _)| i));
    }
}
