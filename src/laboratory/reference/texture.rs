//! Texture lookup: at a point of the unit square, columns from the left, rows from the top.

use crate::scene::{Filter, Side, Texture};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Texture coordinates of a sphere, or of the sky, in the direction of the unit vector `n`: v = acos(y) / π
/// from the top; u, in [0, 1), grows to the right as seen from the side `picture_from`, which is clockwise
/// seen from above for the inside.
pub(super) fn on_sphere(n: DVec3, turn: f64, picture_from: Side) -> DVec2 {
    let clockwise = n.z.atan2(n.x) / TAU + turn;
    let u = match picture_from {
        Side::Inside => clockwise,
        Side::Outside => 1.0 - clockwise,
    };
    DVec2::new(fraction(u), n.y.clamp(-1.0, 1.0).acos() / PI)
}

/// The fractional part of x, in [0, 1). (For −10⁻¹⁷ the subtraction rounds to 1.)
fn fraction(x: f64) -> f64 {
    let fraction = x - x.floor();
    if fraction < 1.0 { fraction } else { 0.0 }
}

/// The colour of a texture at `uv` (v from the top). Columns always wrap; rows wrap, or are clamped to the
/// edge.
pub(super) fn lookup(texture: &Texture, uv: DVec2, wraps: bool) -> DVec3 {
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
