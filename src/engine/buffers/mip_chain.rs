//! Computes the levels of detail of a texture: its mip chain.

use crate::scene::{SRGB_BORDERS, Texels, Texture};

/// A level: columns and rows, and texels in the texture's own format.
pub(super) type Level = ([u32; 2], Texels);

/// Computes the levels of [`Texture::level_sizes`]. A texel is the mean of the area that it covers in the
/// previous level before rounding: colours are averaged in linear light, data as plain numbers. An odd side
/// of 2 n + 1 texels is halved to n, each of them the mean of 2 + 1/n.
///
/// Source: L. Williams, "Pyramidal Parametrics", SIGGRAPH 1983; weights of odd sides: S. Guthe, P. Heckbert,
/// "Non-Power-of-Two Mipmap Creation", NVIDIA, 2005.
pub(super) fn mip_chain(texture: &Texture) -> Vec<Level> {
    let mut chain = Vec::new();
    let mut before = ([texture.width, texture.height], Vec::new());
    for size in texture.level_sizes() {
        let means = match chain.is_empty() {
            // The texels are decoded one by one: all at once they take six times the memory.
            true => halve(before.0, size, |index| decode(&texture.texels, index)),
            false => halve(before.0, size, |index| before.1[index]),
        };
        chain.push((size, encode(&texture.texels, &means)));
        before = (size, means);
    }
    chain
}

/// Returns the means of the texels of a level from the previous level.
pub(crate) fn halve(
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

/// Iterates over the texels that texel `index` of a halved line covers, with the share of each; `halved`
/// texels replace `count`.
fn covered(count: u32, halved: u32, index: u32) -> impl Iterator<Item = (usize, f64)> {
    let [count, halved, index] = [count, halved, index].map(u64::from);
    // In parts of a texel: each of the `count` has `halved` parts, each of the `halved` has `count`.
    let (start, end) = (index * count, (index + 1) * count);
    (start / halved..end.div_ceil(halved)).map(move |texel| {
        let part = end.min((texel + 1) * halved) - start.max(texel * halved);
        (texel as usize, part as f64 / count as f64)
    })
}

/// Decodes a texel to numbers that may be averaged. Bytes of data stay bytes: means of four are exact.
fn decode(texels: &Texels, index: usize) -> [f64; 3] {
    match texels {
        Texels::Unorm8(texels) => {
            let [r, g, b, _] = texels[index];
            [r, g, b].map(f64::from)
        }
        _ => texels.linear(index),
    }
}

/// Encodes means in the format of `texels`, rounded to nearest: sRGB bytes by their own scale.
fn encode(texels: &Texels, means: &[[f64; 3]]) -> Texels {
    let bytes = |byte: fn(f64) -> u8| {
        let texel = |mean: &[f64; 3]| {
            let [r, g, b] = mean.map(byte);
            [r, g, b, 0]
        };
        means.iter().map(texel).collect()
    };
    match texels {
        Texels::Srgb8(_) => {
            Texels::Srgb8(bytes(|x| SRGB_BORDERS.partition_point(|&border| border <= x) as u8))
        }
        Texels::Unorm8(_) => Texels::Unorm8(bytes(|x| (x + 0.5) as u8)),
        Texels::Float32(_) => {
            Texels::Float32(means.iter().map(|&[r, g, b]| [r as f32, g as f32, b as f32, 0.0]).collect())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Filter;

    #[test]
    fn sizes_are_halved_down_to_one_texel_and_memory_is_counted() {
        let (name, filter, texels) = (String::new(), Filter::Trilinear, Texels::Srgb8(vec![[0; 4]; 14]));
        let odd = Texture { name, width: 7, height: 2, filter, wrap: Default::default(), texels };
        let sizes: Vec<[u32; 2]> = odd.level_sizes().collect();
        assert_eq!(sizes, [[3, 1], [1, 1]]);
        assert_eq!(odd.bytes(), 4 * (14 + 3 + 1));
        assert_eq!(mip_chain(&odd).iter().map(|level| level.0).collect::<Vec<_>>(), sizes);
        let plain = Texture { filter: Filter::Bilinear, ..odd };
        assert_eq!((plain.bytes(), mip_chain(&plain).len()), (56, 0));
    }

    #[test]
    fn bytes_of_data_are_rounded_to_the_nearest() {
        let (name, filter, texels) =
            (String::new(), Filter::Trilinear, Texels::Unorm8(vec![[0; 4], [255; 4]]));
        let pair = Texture { name, width: 2, height: 1, filter, wrap: Default::default(), texels };
        assert_eq!(mip_chain(&pair)[0].1, Texels::Unorm8(vec![[128, 128, 128, 0]]));
    }
}
