//! Computes texels of normal and roughness maps from those of other images.

use super::texture::Decoded;
use glam::DVec3;
use octray_engine::scene::{Texels, Wrap};

/// The weights of red, green and blue in a number.
pub type Channel = [f64; 3];

fn number(texels: &Texels, index: usize, channel: Channel) -> f64 {
    DVec3::from_array(texels.linear(index)).dot(channel.into())
}

/// Returns the index of a texel in a line of `count`, or beyond its ends by less than `count`.
fn continued(index: i64, count: u32, wrap: Wrap) -> usize {
    let count = i64::from(count);
    let index = match wrap {
        Wrap::Repeat => index.rem_euclid(count),
        // Beside a mirror is the same texel once more.
        Wrap::Clamp | Wrap::Mirror => index.clamp(0, count - 1),
    };
    index as usize
}

/// Returns the map of the normals of a relief of these heights, in units of a texel's width times `scale`.
///
/// Where the texel at column x and row y, counted downwards, has the height h(x, y), the normal is the unit
/// vector along (−sₓ, −s_y, 1), with the central differences sₓ = scale · (h(x + 1, y) − h(x − 1, y)) / 2 and
/// s_y = scale · (h(x, y − 1) − h(x, y + 1)) / 2.
pub fn normals(&(width, height, ref heights): &Decoded, channel: Channel, scale: f64, wrap: Wrap) -> Texels {
    let at = |x: i64, y: i64| {
        let (x, y) = (continued(x, width, wrap), continued(y, height, wrap));
        number(heights, y * width as usize + x, channel)
    };
    let normal = |index: usize| {
        let (x, y) = ((index % width as usize) as i64, (index / width as usize) as i64);
        let right = 0.5 * scale * (at(x + 1, y) - at(x - 1, y));
        let up = 0.5 * scale * (at(x, y - 1) - at(x, y + 1));
        encoded(DVec3::new(-right, -up, 1.0))
    };
    Texels::Float32((0..heights.len()).map(normal).collect())
}

/// Multiplies the slopes of a normal map.
pub fn scale_slopes(texels: &Texels, scale: f64) -> Texels {
    let scaled = (0..texels.len()).map(|index| {
        let [x, y, z] = texels.linear(index).map(|channel| 2.0 * channel - 1.0);
        encoded(DVec3::new(x * scale, y * scale, z))
    });
    Texels::Float32(scaled.collect())
}

/// Returns the texel of a normal of any length.
fn encoded(normal: DVec3) -> [f32; 4] {
    let [x, y, z] = normal.try_normalize().unwrap_or(DVec3::Z).to_array().map(|c| (0.5 * c + 0.5) as f32);
    [x, y, z, 0.0]
}

/// Tests whether an image is surely a normal map and no map of heights, which are grey: on the mean it is
/// much bluer than red and green.
pub fn are_normals(texels: &Texels) -> bool {
    let sum: DVec3 = (0..texels.len()).map(|index| DVec3::from(texels.linear(index))).sum();
    let mean = sum / texels.len() as f64;
    mean.z > 0.6 && mean.z - mean.x.max(mean.y) > 0.2
}

/// Packs roughness into red and green and the metallic share into blue, as
/// [`octray_engine::scene::Material::roughness_map`] has them; a roughness of 1 without its image. The
/// smaller image is interpolated to the size of the larger.
pub fn packed(rough: Option<(&Decoded, Channel)>, metal: (&Decoded, Channel), wrap: Wrap) -> Decoded {
    let maps = [rough, Some(metal)];
    let side = |of: fn(&Decoded) -> u32| maps.iter().flatten().map(|map| of(map.0)).max().unwrap_or(1);
    let (width, height) = (side(|image| image.0), side(|image| image.1));
    let is_8_bit = maps.iter().flatten().all(|(image, _)| matches!(image.2, Texels::Unorm8(_)));
    let texel = |index: u32| {
        let (x, y) = (f64::from(index % width) + 0.5, f64::from(index / width) + 0.5);
        let at = [x / f64::from(width), y / f64::from(height)];
        maps.map(|map| map.map_or(1.0, |(image, channel)| interpolated(image, channel, at, wrap)))
    };
    let texels = (0..width * height).map(texel);
    let texels = if is_8_bit {
        let byte = |x: f64| (255.0 * x).round() as u8;
        Texels::Unorm8(
            texels.map(|maps| maps.map(byte)).map(|[rough, metal]| [rough, rough, metal, 0]).collect(),
        )
    } else {
        let texels = texels.map(|maps| maps.map(|x| x as f32));
        Texels::Float32(texels.map(|[rough, metal]| [rough, rough, metal, 0.0]).collect())
    };
    (width, height, texels)
}

/// Returns the number at a point of the unit square, v downwards, between the four nearest texels.
fn interpolated(
    &(width, height, ref texels): &Decoded,
    channel: Channel,
    [u, v]: [f64; 2],
    wrap: Wrap,
) -> f64 {
    let (x, y) = (u * f64::from(width) - 0.5, v * f64::from(height) - 0.5);
    let (right, down) = (x - x.floor(), y - y.floor());
    let row = |y: f64| {
        let row = continued(y as i64, height, wrap) * width as usize;
        let at = |x: f64| number(texels, row + continued(x as i64, width, wrap), channel);
        at(x.floor()) * (1.0 - right) + at(x.floor() + 1.0) * right
    };
    row(y.floor()) * (1.0 - down) + row(y.floor() + 1.0) * down
}
