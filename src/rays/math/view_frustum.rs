//! The part of space that the primary rays through a part of the image can reach.
//!
//! The frustum is conservative: its sides are moved outwards by `MARGIN` times the distances involved, far
//! more than the error of a ray or a hit in f32 (`tests/laws/visible.rs`).

use glam::DVec3;

/// The margin relative to the distances involved: about 170 roundings.
const MARGIN: f64 = 1e-5;

/// A frustum without near and far plane; its apex is the origin of the primary rays.
pub struct ViewFrustum {
    apex: DVec3,
    /// The inward unit normals of the four sides, and the line of sight.
    normals: [DVec3; 5],
}

impl ViewFrustum {
    /// Builds the frustum of a part of the image from the directions through its `corners`, in order around
    /// it, and the line of sight `forward`.
    pub fn new(apex: DVec3, corners: [DVec3; 4], forward: DVec3) -> Self {
        let middle: DVec3 = corners.iter().map(|corner| corner.normalize()).sum();
        let side = |i: usize| {
            let normal = corners[i].cross(corners[(i + 1) % 4]).normalize();
            if normal.dot(middle) < 0.0 { -normal } else { normal }
        };
        Self { apex, normals: [side(0), side(1), side(2), side(3), forward.normalize()] }
    }

    /// Tests whether one side excludes all balls, each given by its centre and radius.
    pub fn excludes(&self, balls: impl Iterator<Item = (DVec3, f64)> + Clone) -> bool {
        let outside = |normal: &DVec3| {
            balls.clone().all(|(point, radius)| {
                let from_apex = point - self.apex;
                let scale = from_apex.length() + radius + point.length() + self.apex.length();
                normal.dot(from_apex) < -radius - MARGIN * scale
            })
        };
        self.normals.iter().any(outside)
    }
}
