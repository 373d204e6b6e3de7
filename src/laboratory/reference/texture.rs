//! How pictures are read: at a point of the unit square, columns from the left, rows from the top.

use super::Reference;
use crate::scene::{Filter, Side};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Where a sphere, or the sky, shows its picture in the direction of the unit vector `n`: v = acos(y) / π from the top; u, in
/// [0, 1), grows to the right for an eye on the side from which the picture reads right, that is clockwise seen from above for
/// one inside.
pub(super) fn on_sphere(n: DVec3, turn: f64, picture_from: Side) -> DVec2 {
    let clockwise = n.z.atan2(n.x) / TAU + turn;
    let u = match picture_from {
        Side::Inside => clockwise,
        Side::Outside => 1.0 - clockwise,
    };
    DVec2::new(fraction(u), n.y.clamp(-1.0, 1.0).acos() / PI)
}

/// x without its whole part, in [0, 1). (Of −10⁻¹⁷ the subtraction makes 1.)
fn fraction(x: f64) -> f64 {
    let fraction = x - x.floor();
    if fraction < 1.0 { fraction } else { 0.0 }
}

impl Reference {
    /// The colour of texture `texture` at `uv` (v from the top); white if there is none. Columns always wrap, rows wrap or
    /// stop at the edge.
    pub(super) fn lookup(&self, texture: Option<u32>, uv: DVec2, wraps: bool) -> DVec3 {
        let Some(texture) = texture.map(|index| &self.textures[index as usize]) else {
            return DVec3::ONE;
        };
        let (width, height) = (i64::from(texture.width), i64::from(texture.height));
        let texel = |column: i64, row: i64| {
            let row = if wraps { row.rem_euclid(height) } else { row.clamp(0, height - 1) };
            DVec3::from_array(texture.texels.linear((row * width + column.rem_euclid(width)) as usize))
        };
        let u = fraction(uv.x);
        let v = if wraps { fraction(uv.y) } else { uv.y.clamp(0.0, 1.0) };
        let (x, y) = (u * width as f64, v * height as f64);
        match texture.filter {
            Filter::Nearest => texel((x as i64).min(width - 1), (y as i64).min(height - 1)),
            Filter::Bilinear => {
                let (x, y) = (x - 0.5, y - 0.5);
                let (column, row) = (x.floor() as i64, y.floor() as i64);
                let (right, down) = (x - x.floor(), y - y.floor());
                let upper = texel(column, row).lerp(texel(column + 1, row), right);
                let lower = texel(column, row + 1).lerp(texel(column + 1, row + 1), right);
                upper.lerp(lower, down)
            }
        }
    }
}
