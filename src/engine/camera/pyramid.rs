//! The space that the primary rays of a part of the picture can reach.
//!
//! Conservative: a side is moved outwards by [`MARGIN`] of the distances involved, far more than f32 rounding can make a ray or a
//! hit stray (`tests/visible.rs`).

use glam::DVec3;

/// Share of a point's distance by which the pyramid is widened: about 170 roundings.
const MARGIN: f64 = 1e-5;

/// A pyramid with its tip at the origin of the primary rays.
pub struct Pyramid {
    tip: DVec3,
    /// Inward unit normals of the four sides, and the line of sight.
    normals: [DVec3; 5],
}

impl Pyramid {
    /// `corners`: directions through the picture's points at the corners of the tile, in order around it; `forward`: the line of
    /// sight.
    pub fn new(tip: DVec3, corners: [DVec3; 4], forward: DVec3) -> Self {
        let middle: DVec3 = corners.iter().map(|corner| corner.normalize()).sum();
        let side = |i: usize| {
            let normal = corners[i].cross(corners[(i + 1) % 4]).normalize();
            if normal.dot(middle) < 0.0 { -normal } else { normal }
        };
        Self { tip, normals: [side(0), side(1), side(2), side(3), forward.normalize()] }
    }

    /// Is every point within `radius` of every one of `points` outside one and the same side?
    pub fn excludes(&self, points: &[DVec3], radius: f64) -> bool {
        let outside = |normal: &DVec3| {
            points.iter().all(|&point| {
                let from_tip = point - self.tip;
                let scale = from_tip.length() + radius + point.length() + self.tip.length();
                normal.dot(from_tip) < -radius - MARGIN * scale
            })
        };
        self.normals.iter().any(outside)
    }
}
