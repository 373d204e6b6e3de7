//! Texture lookup at a point of the unit square, columns from the left, rows from the top; levels of detail.

use crate::scene::{Filter, Side, Texels, Texture, Wrap};
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

/// A texture and, where it is trilinear, its levels of detail, the texture itself first.
pub(super) struct Levels(Vec<Texture>);

impl Levels {
    pub(super) fn new(texture: &Texture) -> Self {
        let mut levels = vec![texture.clone()];
        if texture.filter != Filter::Trilinear {
            return Self(levels);
        }
        // Linear; bytes of data in 255ths.
        let is_data = matches!(texture.texels, Texels::Unorm8(_));
        let scale = if is_data { 255.0 } else { 1.0 };
        let mut means: Vec<DVec3> = (0..texture.texels.len())
            .map(|index| DVec3::from_array(texture.texels.linear(index)) * scale)
            .map(|texel| if is_data { texel.round() } else { texel })
            .collect();
        let mut size = [texture.width as usize, texture.height as usize];
        while size != [1, 1] {
            let [width, height] = size;
            let [columns, rows] = [(width / 2).max(1), (height / 2).max(1)];
            let texel = |index: usize| {
                let mut mean = DVec3::ZERO;
                for (y, part_of_rows) in overlaps(height, rows, index / columns) {
                    for (x, part_of_columns) in overlaps(width, columns, index % columns) {
                        mean += means[y * width + x] * (part_of_rows * part_of_columns);
                    }
                }
                mean
            };
            means = (0..columns * rows).map(texel).collect();
            size = [columns, rows];
            let byte = |x: f64| if is_data { x.round() as u8 } else { (255.0 * encoded(x)).round() as u8 };
            let bytes = || means.iter().map(|mean| [byte(mean.x), byte(mean.y), byte(mean.z), 0]).collect();
            let texels = match texture.texels {
                Texels::Srgb8(_) => Texels::Srgb8(bytes()),
                Texels::Unorm8(_) => Texels::Unorm8(bytes()),
                Texels::Float32(_) => {
                    Texels::Float32(means.iter().map(|mean| mean.extend(0.0).as_vec4().to_array()).collect())
                }
            };
            let [width, height] = [columns as u32, rows as u32];
            let (name, wrap) = (String::new(), texture.wrap);
            levels.push(Texture { name, width, height, filter: texture.filter, wrap, texels });
        }
        Self(levels)
    }

    /// The colour at `uv` where a path sees `area` of the texture, 1 being the whole: between the two levels
    /// in which that is nearest to the area of a texel.
    pub(super) fn lookup(&self, uv: DVec2, wraps: bool, area: f64) -> DVec3 {
        let [Texture { width, height, .. }, ..] = self.0[..] else { unreachable!("the texture itself") };
        let level = 0.5 * (area * f64::from(width) * f64::from(height)).log2();
        let level = level.max(0.0).min((self.0.len() - 1) as f64);
        let (lower, blend) = (level as usize, level.fract());
        let color = lookup(&self.0[lower], uv, wraps);
        if blend == 0.0 { color } else { color.lerp(lookup(&self.0[lower + 1], uv, wraps), blend) }
    }
}

/// Of `count` texels in a line, those that reach into texel `index` of the `halved` that replace them, and
/// the share of it that each has.
fn overlaps(count: usize, halved: usize, index: usize) -> impl Iterator<Item = (usize, f64)> {
    let [from, to] = [index, index + 1].map(|end| (end * count) as f64 / halved as f64);
    let part = move |texel: usize| (to.min(texel as f64 + 1.0) - from.max(texel as f64)).max(0.0);
    (from as usize..(to.ceil() as usize).min(count)).map(move |texel| (texel, part(texel) / (to - from)))
}

/// The texel, of `count` in a line, that stands at `index` of the endless line.
fn continued(index: i64, count: i64, wrap: Wrap) -> i64 {
    match wrap {
        Wrap::Repeat => index.rem_euclid(count),
        Wrap::Clamp => index.clamp(0, count - 1),
        Wrap::Mirror => match index.rem_euclid(2 * count) {
            there if there < count => there,
            back => 2 * count - 1 - back,
        },
    }
}

/// The sRGB value of a linear value.
fn encoded(linear: f64) -> f64 {
    if linear <= 0.0031308 { 12.92 * linear } else { 1.055 * linear.powf(1.0 / 2.4) - 0.055 }
}

/// The colour of a texture at `uv` (v from the top), without its levels of detail. Where `wraps`, columns and
/// rows continue as the texture says; otherwise columns repeat, and rows are clamped to the edge.
fn lookup(texture: &Texture, uv: DVec2, wraps: bool) -> DVec3 {
    let (width, height) = (i64::from(texture.width), i64::from(texture.height));
    let [along_u, along_v] = if wraps { texture.wrap } else { [Wrap::Repeat, Wrap::Clamp] };
    let texel = |column: i64, row: i64| {
        let (column, row) = (continued(column, width, along_u), continued(row, height, along_v));
        DVec3::from_array(texture.texels.linear((row * width + column) as usize))
    };
    let whole = |x: f64, wrap: Wrap| if wrap == Wrap::Repeat { fraction(x) } else { x };
    let (x, y) = (whole(uv.x, along_u) * width as f64, whole(uv.y, along_v) * height as f64);
    match texture.filter {
        Filter::Nearest => texel(x.floor() as i64, y.floor() as i64),
        Filter::Bilinear | Filter::Trilinear => {
            let (x, y) = (x - 0.5, y - 0.5);
            let (column, row) = (x.floor() as i64, y.floor() as i64);
            let (right, down) = (x - x.floor(), y - y.floor());
            let upper = texel(column, row).lerp(texel(column + 1, row), right);
            let lower = texel(column, row + 1).lerp(texel(column + 1, row + 1), right);
            upper.lerp(lower, down)
        }
    }
}
