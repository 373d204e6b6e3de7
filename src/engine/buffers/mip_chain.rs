//! Levels of detail of a texture: its mip chain.

use crate::scene::{Texels, Texture, srgb_to_linear};
use std::sync::LazyLock;

/// A level: columns and rows, and texels of the texture's own format.
pub(super) type Level = ([u32; 2], Texels);

/// The levels of [`Texture::level_sizes`]. A texel is the mean of the area that it covers in the level
/// before, which is not rounded: colours are averaged in linear light, data as the numbers that they are. A
/// side of 2 n + 1 texels is halved to n, each of them the mean of 2 + 1/n.
///
/// Source: L. Williams, "Pyramidal Parametrics", SIGGRAPH 1983; weights of odd sides: S. Guthe, P. Heckbert,
/// "Non-Power-of-Two Mipmap Creation", NVIDIA, 2005.
pub(super) fn mip_chain(texture: &Texture) -> Vec<Level> {
    let mut chain = Vec::new();
    let mut before = ([texture.width, texture.height], Vec::new());
    for size in texture.level_sizes() {
        let means = match chain.is_empty() {
            // Not decoded at once: that takes six times the memory of the texels.
            true => halve(before.0, size, |index| decode(&texture.texels, index)),
            false => halve(before.0, size, |index| before.1[index]),
        };
        chain.push((size, encode(&texture.texels, &means)));
        before = (size, means);
    }
    chain
}

/// The means of the texels of a level from the level before.
pub(super) fn halve(
    [width, height]: [u32; 2],
    [columns, rows]: [u32; 2],
    texel: impl Fn(usize) -> [f64; 3],
) -> Vec<[f64; 3]> {
    let mut means = Vec::with_capacity(columns as usize * rows as usize);
    for row in 0..rows {
        for column in 0..columns {
            let mut mean = [0.0; 3];
            for (y, down) in covered(height, rows, row) {
                for (x, across) in covered(width, columns, column) {
                    let texel = texel(y * width as usize + x);
                    mean = std::array::from_fn(|channel| mean[channel] + across * down * texel[channel]);
                }
            }
            means.push(mean);
        }
    }
    means
}

/// Of `count` texels in a line that `halved` ones replace: those that number `index` covers, and the share of
/// each.
fn covered(count: u32, halved: u32, index: u32) -> impl Iterator<Item = (usize, f64)> {
    let [count, halved, index] = [count, halved, index].map(u64::from);
    // In parts of a texel: `halved` to each of the `count`, `count` to each of the `halved`.
    let (start, end) = (index * count, (index + 1) * count);
    (start / halved..end.div_ceil(halved)).map(move |texel| {
        let part = end.min((texel + 1) * halved) - start.max(texel * halved);
        (texel as usize, part as f64 / count as f64)
    })
}

/// A texel in numbers that may be averaged. Bytes of data stay bytes: means of four are exact.
fn decode(texels: &Texels, index: usize) -> [f64; 3] {
    match texels {
        Texels::Unorm8(texels) => {
            let [r, g, b, _] = texels[index];
            [r, g, b].map(f64::from)
        }
        _ => texels.linear(index),
    }
}

/// Means in the format of `texels`, rounded to nearest: bytes of sRGB by their own scale.
fn encode(texels: &Texels, means: &[[f64; 3]]) -> Texels {
    let bytes = |byte: fn(f64) -> u8| {
        let texel = |mean: &[f64; 3]| {
            let [r, g, b] = mean.map(byte);
            [r, g, b, 0]
        };
        means.iter().map(texel).collect()
    };
    match texels {
        Texels::Srgb8(_) => Texels::Srgb8(bytes(srgb_byte)),
        Texels::Unorm8(_) => Texels::Unorm8(bytes(|x| (x + 0.5) as u8)),
        Texels::Float32(_) => {
            Texels::Float32(means.iter().map(|&[r, g, b]| [r as f32, g as f32, b as f32, 0.0]).collect())
        }
    }
}

/// The sRGB byte of a linear value.
fn srgb_byte(x: f64) -> u8 {
    /// The linear values in the middle between two bytes.
    static STEPS: LazyLock<[f64; 255]> =
        LazyLock::new(|| std::array::from_fn(|byte| srgb_to_linear((byte as f64 + 0.5) / 255.0)));
    STEPS.partition_point(|&step| step <= x) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Filter;

    fn texture([width, height]: [u32; 2], texels: Texels) -> Texture {
        Texture { name: String::new(), width, height, filter: Filter::Trilinear, texels }
    }
    /// All formats, of these bytes.
    fn formats(size: [u32; 2], byte: impl Fn(u32) -> u8) -> [Texture; 3] {
        let bytes: Vec<[u8; 4]> =
            (0..size[0] * size[1]).map(|i| [byte(3 * i), byte(3 * i + 1), byte(3 * i + 2), 0]).collect();
        let floats = bytes.iter().map(|texel| texel.map(|byte| f32::from(byte) / 16.0)).collect();
        [Texels::Srgb8(bytes.clone()), Texels::Unorm8(bytes), Texels::Float32(floats)]
            .map(|texels| texture(size, texels))
    }
    fn mean(texels: &Texels) -> [f64; 3] {
        let sum = (0..texels.len())
            .map(|index| texels.linear(index))
            .fold([0.0; 3], |sum, texel| std::array::from_fn(|channel| sum[channel] + texel[channel]));
        sum.map(|sum| sum / texels.len() as f64)
    }

    #[test]
    fn sizes_are_halved_down_to_one_texel_and_memory_is_counted() {
        let [odd, ..] = formats([7, 2], |_| 0);
        let sizes: Vec<[u32; 2]> = odd.level_sizes().collect();
        assert_eq!(sizes, [[3, 1], [1, 1]]);
        assert_eq!(odd.bytes(), 4 * (14 + 3 + 1));
        assert_eq!(mip_chain(&odd).iter().map(|level| level.0).collect::<Vec<_>>(), sizes);
        let plain = Texture { filter: Filter::Bilinear, ..odd };
        assert_eq!((plain.bytes(), mip_chain(&plain).len()), (56, 0));
    }

    #[test]
    fn constant_textures_stay_constant_in_every_byte() {
        for byte in [0, 1, 7, 54, 127, 200, 255] {
            for texture in formats([13, 6], |_| byte) {
                for (_, level) in mip_chain(&texture) {
                    for index in 0..level.len() {
                        let (own, level) = (texture.texels.linear(0), level.linear(index));
                        let differs = own.iter().zip(level).any(|(own, level)| (own - level).abs() > 1e-6);
                        assert!(!differs, "{byte}: {level:?} instead of {own:?}");
                    }
                }
            }
        }
    }

    /// In linear light, whatever the sides.
    #[test]
    fn every_level_has_the_mean_of_the_texture() {
        for size in [[16, 8], [13, 7], [1, 9], [5, 1], [3, 3]] {
            for texture in formats(size, |i| (i.wrapping_mul(0x9E37_79B1) >> 24) as u8) {
                let whole = mean(&texture.texels);
                for (level_size, level) in mip_chain(&texture) {
                    let [r, g, b] = mean(&level);
                    for (channel, own) in [r, g, b].into_iter().zip(whole) {
                        // Half a byte of rounding, at the steepest part of the sRGB curve 2.3 / 255.
                        let bound = if matches!(level, Texels::Float32(_)) { 1e-5 } else { 1.2 / 255.0 };
                        assert!((channel - own).abs() <= bound, "{size:?} {level_size:?}: {channel}, {own}");
                    }
                }
            }
        }
    }

    #[test]
    fn texels_of_odd_sides_are_shared_by_area() {
        let row = |values: &[f32]| Texels::Float32(values.iter().map(|&x| [x, 0.0, 0.0, 0.0]).collect());
        let [(_, half), (_, last)] =
            <[Level; 2]>::try_from(mip_chain(&texture([5, 1], row(&[10.0, 20.0, 30.0, 40.0, 50.0]))))
                .unwrap();
        // 10 and 20, and half of 30, over 2.5.
        assert_eq!((half, last), (row(&[18.0, 42.0]), row(&[30.0])));
    }

    #[test]
    fn black_and_white_average_to_half_the_light_and_not_to_half_the_byte() {
        let [srgb, data, _] = formats([2, 1], |i| if i < 3 { 0 } else { 255 });
        assert_eq!(mip_chain(&srgb)[0].1, Texels::Srgb8(vec![[188, 188, 188, 0]]));
        assert_eq!(mip_chain(&data)[0].1, Texels::Unorm8(vec![[128, 128, 128, 0]]));
    }
}
