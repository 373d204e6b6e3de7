//! Lists of primitives for linear traversal, and frustum culling: the primitives that the primary rays of a
//! tile can hit.
//!
//! Culling is only for methods whose hits stay within the view frustum's margin
//! ([`super::Methods::keep_to_their_primitives`]): the naive ones report hits far outside a primitive, and
//! culling would remove those from their picture.

use crate::camera::ViewFrustum;
use crate::scene::{Primitive, Scene};

/// Primitives in ascending order: quadrics by their number, triangles counted from 0.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PrimitiveList {
    /// Indices of quadrics.
    pub quadrics: Vec<u32>,
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
        self.keep(scene, |_, primitive| !frustum.excludes(primitive.balls()));
    }

    /// The primitives for which `keep` holds, by their numbers.
    pub fn keep(&mut self, scene: &Scene, keep: impl Fn(usize, Primitive) -> bool) {
        self.quadrics.clear();
        self.triangles.clear();
        let kept = scene.all_primitives().enumerate().filter(|(number, primitive)| keep(*number, *primitive));
        kept.for_each(|(number, _)| match number.checked_sub(scene.first_triangle()) {
            None => self.quadrics.push(number as u32),
            Some(index) => self.triangles.push(index as u32),
        });
    }
}
